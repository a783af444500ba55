"""One cloth let fall in Blender: sheets of points in, sheets of points out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.solids import Solid


@dataclass(frozen=True)
class Fabric:
    """How a cloth behaves, in the terms of Blender's cloth settings."""

    mass_kg: float = 0.3
    """Of one point."""
    stretch: float = 15.0
    shear: float = 5.0
    bending: float = 0.5
    damping: float = 5.0
    gap_m: float = 0.006
    """Distance kept from itself and from what it lies on."""
    self_collision: bool = True
    quality: int = 6
    friction: float = 20.0
    gravity: float = 1.0


def draped(
    points_m: FloatArray,
    faces: np.ndarray,
    fabric: Fabric,
    frames: int,
    pinned: Sequence[int] = (),
    obstacles: Sequence[Solid] = (),
    rest_m: FloatArray | None = None,
) -> FloatArray:
    """(N, 3) points after so many frames of 1/24 s.

    faces: triangles or quads. pinned: points that stay. obstacles: solids that do not
    move. rest_m: the cloth as it was cut, where it starts draped already.
    """
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, frames
    scene.gravity = (0.0, 0.0, -9.81 * fabric.gravity)
    for number, solid in enumerate(obstacles):
        thing = _thing(f"Obstacle_{number}", solid.points_m, solid.faces)
        thing.modifiers.new("Collision", "COLLISION")
        thing.collision.thickness_outer = fabric.gap_m
        thing.collision.thickness_inner = 0.05
        thing.collision.cloth_friction = fabric.friction
        thing.collision.damping = 0.5
    cloth = _thing("Cloth", points_m, faces)
    group = cloth.vertex_groups.new(name="Pinned")
    group.add([int(index) for index in pinned], 1.0, "REPLACE")
    if rest_m is not None:
        cloth.shape_key_add(name="Basis")
        cut = cloth.shape_key_add(name="Cut", from_mix=False)
        cut.data.foreach_set("co", np.asarray(rest_m, dtype=np.float32).reshape(-1))
        cut.value = 0.0
    _dress(cloth, fabric, "Pinned" if len(pinned) else "", frames)
    for frame in range(1, frames + 1):
        scene.frame_set(frame)
    evaluated = cloth.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flat = np.empty(3 * len(points_m), dtype=np.float32)
    evaluated.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(np.float64)


def _thing(name, points_m, faces):
    import bpy

    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(points_m).tolist(), [], [[int(i) for i in face] for face in faces])
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def _dress(cloth, fabric: Fabric, pinned: str, frames: int) -> None:
    modifier = cloth.modifiers.new("Cloth", "CLOTH")
    modifier.point_cache.frame_start, modifier.point_cache.frame_end = 1, frames
    settings, collision = modifier.settings, modifier.collision_settings
    settings.quality = fabric.quality
    settings.mass = fabric.mass_kg
    settings.tension_stiffness = settings.compression_stiffness = fabric.stretch
    settings.shear_stiffness = fabric.shear
    settings.bending_stiffness = fabric.bending
    settings.tension_damping = settings.compression_damping = fabric.damping
    settings.shear_damping, settings.bending_damping = fabric.damping, 0.5
    settings.air_damping = 1.0
    settings.vertex_group_mass = pinned
    keys = cloth.data.shape_keys
    if keys and "Cut" in keys.key_blocks:
        settings.rest_shape_key = keys.key_blocks["Cut"]
    collision.use_collision = True
    collision.collision_quality = 4
    collision.distance_min = fabric.gap_m
    collision.use_self_collision = fabric.self_collision
    collision.self_distance_min = fabric.gap_m
