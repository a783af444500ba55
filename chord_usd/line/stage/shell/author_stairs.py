"""Stairs of a storey, the railings around their holes, and what one steps on there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import footprint_polygon, polygons_of, room_polygon
from chord_usd.base.scene.stair_spirals import is_round
from chord_usd.base.scene.types import Box, FloatArray
from chord_usd.line.stage.author.names import NamedRoom
from chord_usd.line.stage.author.prims import label, place
from chord_usd.line.stage.author.stage_levels import Level, note_stair
from chord_usd.line.stage.author.surfaces import floor_material
from chord_usd.line.stage.shell.mesh import Face, flat, prism
from chord_usd.line.stage.shell.shell_layers import Frame, ShellComponent
from chord_usd.line.stage.shell.slabs import SEAM_M, SLAB_M
from chord_usd.line.stage.shell.stair_parts import (
    floor_boxes,
    guard_lines,
    guard_part,
    open_landing_sides,
    stair_boxes,
    stair_hulls,
    stair_parts,
)

_INNER_M = 0.05
"""An edge of a hole so far within a stair needs no railing: the stair lies over it."""


def draw_stairs(component: ShellComponent, room: NamedRoom, level: Level) -> None:
    """The stairs up from a room, and the railings around the hole that one comes up through."""
    solid = level.walls.solid_m
    for index, climb in enumerate(level.rising.get(room.room.id, ())):
        group = component.group(f"Stair_{index}_{room.name}")
        label(group, "category", "stairs")
        note_stair(group, climb)
        for part in stair_parts(climb.built, solid):
            material = floor_material(room) if part.surface == "Floor" else part.surface
            component.mesh(f"{group.name}/{part.name}", part.faces, material)
        for number, (line, low_m) in enumerate(open_landing_sides(climb.built, solid)):
            _draw_guard(component, f"{group.name}/Guard_{number}_{group.name}", line, low_m)
    ways = level.ways.get(room.room.id)
    if ways is not None:
        component.reserve(floor_material(room))
        rising = [climb.built for climb in level.rising.get(room.room.id, ())]
        stairs = [stair.area_m.buffer(-_INNER_M) for stair in rising if not stair.is_spiral]
        around = unary_union([solid, *stairs])
        own_holes = [hole for hole in level.holes if hole.intersects(room_polygon(room.room))]
        edged = [_largest(hole.difference(unary_union(level.landings))) for hole in own_holes]
        lines = [line for hole in edged for line in guard_lines(hole, around, ways)]
        for number, line in enumerate(lines):
            _draw_guard(component, f"Guard_{number}_{room.name}", line, 0.0)


def _draw_guard(component: ShellComponent, name: str, line: FloatArray, low_m: float) -> None:
    part, colliders = guard_part(line)
    group = component.group(name)
    place(group, at_m=(0.0, 0.0, low_m))
    label(group, "category", "railing")
    component.mesh(f"{name}/{part.name}", part.faces, part.surface, Frame(0.0, (0.0, 0.0, low_m)))
    component.guard(group, colliders, part.surface)


def stair_colliders(
    room: NamedRoom, level: Level, floor: Polygon, holes: Sequence[Polygon]
) -> tuple[list[Box], list[Sequence[Face]]]:
    """Boxes and convex hulls of the steps up from a room, and of its slab around round holes."""
    rising = [climb.built for climb in level.rising.get(room.room.id, ())]
    hulls = [hull for built in rising for hull in stair_hulls(built)]
    return [box for built in rising for box in stair_boxes(built)], [
        *hulls, *_slab_around(floor, holes)
    ]  # fmt: skip


def holed_slabs(slab: Box, holes: Sequence[Polygon]) -> list[Box]:
    """A slab as boxes that leave holes open."""
    sided = [hole for hole in holes if not is_round(hole)]
    (x0, y0), (x1, y1) = np.asarray((sided or [footprint_polygon(slab)])[0].exterior.coords)[:2]
    yaw_deg = float(np.degrees(np.arctan2(y1 - y0, x1 - x0)))
    return list(floor_boxes(slab, holes, yaw_deg))


def _slab_around(floor: Polygon, holes: Sequence[Polygon]) -> list[list[Face]]:
    """Parts of the slab around round holes that boxes leave out, as convex solids."""
    around = [hole.buffer(SEAM_M, join_style="mitre").envelope for hole in holes if is_round(hole)]
    left = floor.intersection(unary_union(around)).difference(unary_union(list(holes)))
    return [
        prism(Polygon(piece.corners_m[:, :2]), -SLAB_M, 0.0)
        for piece in flat(left, 0.0, up=True)
    ]  # fmt: skip


def _largest(area: BaseGeometry) -> Polygon:
    return max(polygons_of(area), key=lambda part: part.area)
