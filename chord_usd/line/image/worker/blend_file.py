"""A stage becomes a Blender file: python -m chord_usd.line.image.worker.blend_file STAGE BLEND."""

import sys

import bpy

from chord_usd.line.image.worker.scene import bring_in, drop_missing_textures


def main(stage: str, target: str) -> None:
    """Write the file, its pictures within."""
    scene = bring_in(stage, cameras=True)
    drop_missing_textures()
    scene.camera = next((obj for obj in scene.objects if obj.type == "CAMERA"), None)
    scene.render.engine = "CYCLES"
    bpy.ops.file.pack_all()
    # No backup of a file that is there: what is written takes its place as a whole.
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=target, compress=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
