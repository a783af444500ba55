"""The stage as Blender has it: import, sky, camera, and what of it is shown."""

from __future__ import annotations

from typing import Any

import bpy
from mathutils import Matrix

from chord_usd.base.scene.palette import CATEGORIES, Mount
from chord_usd.line.image.job import Job
from chord_usd.line.image.stage_cameras import StageCamera

SUN_IMPORT = 4.0
"""The importer makes suns this many times as strong as USD means them, measured on white."""

CEILING = "Ceiling"
"""Names of ceilings start so."""

ROOF = "Roof"
"""Name of the prim above the roof's meshes."""

_LEFT_OUT = "left_out"
"""Property of what an open roof hides."""

SKY_STRENGTH = 6.0
"""Radiance outside, for stages without a sky of their own: several times that of a lit wall."""

SKY_STOPS = (
    (0.0, (0.30, 0.28, 0.26)),
    (0.495, (0.42, 0.40, 0.37)),
    (0.505, (0.95, 0.97, 1.0)),
    (0.7, (0.62, 0.78, 1.0)),
    (1.0, (0.40, 0.60, 1.0)),
)
"""Linear colours from straight down (0) over the horizon (0.5) to straight up (1): soft daylight
over pale ground, so that one does not look into a void through a window."""


class UnreadableError(Exception):
    """Textures of the stage are damaged, or of a kind that Blender does not read."""


def import_stage(job: Job) -> Any:
    """A new scene with the stage and a camera in it. Raises UnreadableError."""
    scene = bring_in(job.stage, cameras=False)
    lost = drop_missing_textures()
    if lost and not job.allow_missing:
        named = ", ".join(lost[:3]) + (", ..." if len(lost) > 3 else "")
        raise UnreadableError(f"the stage has textures that cannot be read: {len(lost)} ({named})")
    if not job.has_dome:
        _paint_sky(scene.world)
    camera = bpy.data.objects.new("ShotCamera", bpy.data.cameras.new("ShotCamera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def bring_in(stage: str, *, cameras: bool) -> Any:
    """A new scene with the stage in it, and nothing else; returns it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    # Without a world the importer drops a DomeLight silently.
    scene.world = bpy.data.worlds.new("World")
    bpy.ops.wm.usd_import(
        filepath=stage,
        import_cameras=cameras,
        set_frame_range=False,
        import_textures_mode="IMPORT_PACK",  # of .usdz packages; files elsewhere are left there
        mtl_name_collision_mode="MAKE_UNIQUE",
    )
    for mesh in bpy.data.meshes:
        # USD draws faces without normals flat, Blender's importer makes them smooth.
        if not mesh.has_custom_normals:
            mesh.shade_flat()
    for light in bpy.data.lights:
        if light.type == "SUN":
            light.energy /= SUN_IMPORT
    return scene


def drop_missing_textures() -> list[str]:
    """Let materials fall back to plain colours where Blender would paint a loud magenta.

    Returns the names of the textures, or of their materials.
    """
    lost: dict[str, None] = {}
    for material in bpy.data.materials:
        if material.node_tree is None:
            continue
        for node in list(material.node_tree.nodes):
            # size is what makes Blender look for the file; without one it stays (0, 0).
            if node.type == "TEX_IMAGE" and (node.image is None or not node.image.size[0]):
                lost[node.image.name if node.image else material.name] = None
                material.node_tree.nodes.remove(node)
    return list(lost)


def _paint_sky(world: Any) -> None:
    """A world whose colour follows SKY_STOPS from nadir to zenith."""
    nodes, links = world.node_tree.nodes, world.node_tree.links
    direction = nodes.new("ShaderNodeTexCoord")
    split = nodes.new("ShaderNodeSeparateXYZ")
    height = nodes.new("ShaderNodeMapRange")
    height.inputs["From Min"].default_value = -1.0
    ramp = nodes.new("ShaderNodeValToRGB")
    stops = ramp.color_ramp.elements
    while len(stops) < len(SKY_STOPS):
        stops.new(0.5)
    for stop, (position, rgb) in zip(stops, SKY_STOPS, strict=True):
        stop.position, stop.color = position, (*rgb, 1.0)
    background = nodes["Background"]
    background.inputs["Strength"].default_value = SKY_STRENGTH
    links.new(direction.outputs["Generated"], split.inputs["Vector"])
    links.new(split.outputs["Z"], height.inputs["Value"])
    links.new(height.outputs["Result"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], background.inputs["Color"])


def aim(camera: Any, view: StageCamera) -> None:
    """Set the lens from the USD values: the importer gets orthographic cameras wrong tenfold."""
    lens = camera.data
    camera.matrix_world = Matrix(view.matrix)
    lens.clip_start, lens.clip_end = view.clip_m
    lens.type = "ORTHO" if view.orthographic else "PERSP"
    lens.sensor_fit = "HORIZONTAL"
    if view.orthographic:
        lens.ortho_scale = view.aperture_m
    else:
        lens.sensor_width = view.aperture_m * 1000.0  # Blender's lens is in millimetres
        lens.lens = view.focal_m * 1000.0
    lens.shift_x, lens.shift_y = view.shift
    lens.dof.use_dof = view.f_stop > 0
    if view.f_stop > 0:
        lens.dof.aperture_fstop = view.f_stop
        lens.dof.focus_distance = view.focus_m


def open_roof(scene: Any, is_open: bool) -> None:
    """Let the camera see through roof and ceilings, what hangs from them, and sky, or not.

    Ceilings go on casting shadows: so the rooms keep the light they have inside.
    """
    for thing in bpy.data.objects:
        if thing.type == "MESH" and (thing.name.startswith(CEILING) or is_of_roof(thing)):
            thing.visible_camera = not is_open
        if thing.type != "LIGHT" and _hangs_high(thing):
            _leave_out(thing, is_open)
    scene.render.film_transparent = is_open


def is_of_roof(thing: Any) -> bool:
    """Whether it is a mesh of /House/Roof: all of them are in a group Geometry."""
    above = thing.parent and thing.parent.parent
    return above is not None and above.name.split(".")[0] == ROOF


def _leave_out(thing: Any, is_out: bool) -> None:
    """Hide a thing, or show it again where it was hidden here: instances know no camera."""
    if is_out and not thing.hide_render:
        thing.hide_render, thing[_LEFT_OUT] = True, True
    elif not is_out and thing.get(_LEFT_OUT):
        thing.hide_render = False
        del thing[_LEFT_OUT]


def _hangs_high(thing: Any) -> bool:
    """Whether it is part of a lamp at the ceiling."""
    while thing is not None:
        row = CATEGORIES.get(str(thing.get("chord:category")))
        if row is not None:
            return row.mount is Mount.CEILING
        thing = thing.parent
    return False
