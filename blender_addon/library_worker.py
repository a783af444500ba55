"""Runs in a Blender of its own: models of a folder become a library of marked assets.

A file per category; a model is a collection with its catalog, preview, author and licence. Tells
of itself as chord-usd does: progress on stderr, one JSON object on stdout.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))  # no extension is enabled in this Blender

from core.library import CATALOGS, Model, catalog_id, catalogs, models


def build(folder: Path) -> int:
    """Write the library into the folder that holds its models; returns how many there are."""
    groups = models(folder)
    total = sum(map(len, groups.values()))
    done = 0
    for category, group in groups.items():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        for model in group:
            _report(done, total)
            _add(model)
            done += 1
        bpy.ops.file.pack_all()
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / f"{category}.blend"), compress=True)
    (folder / CATALOGS).write_text(catalogs(groups), encoding="utf-8")
    _report(total, total)
    return total


def _add(model: Model) -> None:
    """A model as a marked collection of this file."""
    scene = bpy.context.scene
    before = set(scene.collection.objects)
    bpy.ops.wm.usd_import(filepath=str(model.usd), import_cameras=False, import_lights=False)
    collection = bpy.data.collections.new(model.label)
    for item in [item for item in scene.collection.objects if item not in before]:
        scene.collection.objects.unlink(item)
        collection.objects.link(item)
    collection.asset_mark()
    data = collection.asset_data
    data.catalog_id = catalog_id(model.category)
    data.author, data.license = model.author, model.licence
    data.tags.new(model.category)
    if model.picture.is_file():
        with bpy.context.temp_override(id=collection):
            bpy.ops.ed.lib_id_load_custom_preview(filepath=str(model.picture))


def _report(done: int, total: int) -> None:
    sys.stderr.write(json.dumps({"step": "library", "done": done, "total": total}) + "\n")
    sys.stderr.flush()


if __name__ == "__main__":
    target = Path(sys.argv[sys.argv.index("--") + 1])
    try:
        count = build(target)
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        sys.stderr.write(f"error: {' '.join(str(error).split())}\n")
        sys.exit(2)
    sys.stdout.write(json.dumps({"folder": str(target), "assets": count}) + "\n")
