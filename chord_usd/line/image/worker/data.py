"""Depth, normals and which thing each pixel shows: geometry at the centres of pixels.

Cycles' own index pass gives all instances of a piece of furniture one number, and its data passes
come from a random place in each pixel. Here a second scene shares the objects of the first; it
paints each with the number that its instance carries, and sends one ray through each centre.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

from chord_usd.line.image.job import Job
from chord_usd.line.image.worker.layers import write_layers

NUMBER_MARK = "chord_number"
"""Property of objects: the number of the thing they belong to (see marks.py)."""

_NARROWEST_PX = 0.01
"""The narrowest filter Cycles has: every ray passes the centre of its pixel."""


def data_scene(scene: Any, job: Job) -> Any:
    """A scene with the same objects and camera that renders numbers instead of light."""
    data = scene.copy()
    data.name = "Data"
    data.render.engine = "CYCLES"
    data.render.film_transparent = True
    data.render.use_persistent_data = job.quality.keep_scene
    data.render.resolution_x, data.render.resolution_y = job.width_px, job.height_px
    cycles = data.cycles
    cycles.device = "CPU"  # one ray a pixel: not worth a second upload
    cycles.samples, cycles.max_bounces = 1, 0
    cycles.use_denoising = cycles.use_adaptive_sampling = cycles.use_guiding = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", _NARROWEST_PX
    layer = data.view_layers[0]
    layer.material_override = _numbers()
    layer.use_pass_z = layer.use_pass_normal = True
    layer.pass_alpha_threshold = 0.0
    write_layers(data)
    return data


def _numbers() -> Any:
    """A material that shines with the number of the instance, or of the object."""
    material = bpy.data.materials.new("Numbers")
    tree = material.node_tree
    tree.nodes.clear()
    number = tree.nodes.new("ShaderNodeAttribute")
    number.attribute_type, number.attribute_name = "INSTANCER", NUMBER_MARK
    emission = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(number.outputs["Fac"], emission.inputs["Color"])
    tree.links.new(emission.outputs["Emission"], output.inputs["Surface"])
    return material


def render_data(data: Any, path: Path) -> None:
    """Write depth, normals and numbers of what the camera sees."""
    lens = data.camera.data
    blurred, lens.dof.use_dof = lens.dof.use_dof, False
    data.render.filepath = str(path)
    bpy.ops.render.render(write_still=True, scene=data.name)
    lens.dof.use_dof = blurred
