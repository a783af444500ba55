"""Which wall of which room each door, passage and window belongs to, and what it keeps free."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from chord_usd.base.scene.types import WALL_THICKNESS_M, Opening
from chord_usd.workshop.data.furnish.floor import Bounds, Door, Floor
from chord_usd.workshop.data.furnish.free_spans import NO_SILL_M, REACH, ZONE, Wall

WINDOW_ZONE_M = 0.5
"""Nothing higher than the sill stands nearer to a window."""

DEEPEST_DOOR_ZONE_M = 0.9
"""A door keeps its own width free in front of it, wide ones no more than a leaf's."""

WAY_IN_M = 0.6
"""Beyond that the way into larger rooms stays open where it can."""

FARTHEST_INSIDE_M = 0.2
"""An opening whose middle is farther inside a room is not in that wall."""

OPEN_SIDE_M = 0.02
"""Along sides where two rooms touch there is no wall to stand against."""

PARALLEL = 0.1
"""Largest sine between an opening and the wall it is in."""

SIDE_MARGIN_M, DEPTH_MARGIN_M = 0.06, 0.08
"""What stays free beyond that where the room allows it: a pixel of a layout raster."""

_ROOMY_KINDS = ("living", "bedroom", "study")

_ENTRANCE_KINDS = ("corridor", "living", "unknown", "dining", "kitchen", "store")
"""Where a door to the outside is the front door, best first."""


def attach_open_sides(floors: Sequence[Floor]) -> None:
    """Find where rooms touch. One walks through there, and nothing stands with its back to it.

    To be called before attach_openings: what a door keeps free reaches into touching rooms.
    """
    bounds = [floor.bounds_m for floor in floors]
    for i, floor in enumerate(floors):
        for j, other in enumerate(floors):
            if i != j and _near(bounds[i], bounds[j]):
                _share_sides(floor, other)


def attach_openings(floors: Sequence[Floor], openings: Sequence[Opening]) -> None:
    """Attach doors and windows to their floors and keep the space in front of them free.

    room_ids of an opening are trusted; openings without any are attached by their position.
    """
    by_id = {floor.room.id: floor for floor in floors}
    sides = []
    for opening in openings:
        named = [by_id[i] for i in opening.room_ids if i in by_id] or floors
        yaw = math.radians(opening.box.yaw_deg)
        along = math.cos(yaw), math.sin(yaw)
        walls = [(floor, side) for floor in named if (side := _side_of(floor, opening, along))]
        sides.append((opening, walls))
    entrance = _entrance(sides)
    for opening, walls in sides:
        for floor, (wall, s_from, s_to) in walls:
            beyond = next((other for other, _ in walls if other is not floor), None)
            _open(floor, opening, Door(wall, s_from, s_to, opening is entrance, beyond))


def _open(floor: Floor, opening: Opening, side: Door) -> None:
    wall, s_from, s_to = side[:3]
    if opening.kind == "window":
        sill = opening.box.center_m[2] + 1e-6
        floor.windows.append((wall, s_from, s_to, sill))
        _keep_both_sides(floor, opening, side, WINDOW_ZONE_M, sill)
        wall.has_window = True
        return
    floor.doors.append(side)
    deep = min(s_to - s_from, DEEPEST_DOOR_ZONE_M)
    _keep_both_sides(floor, opening, side, deep, NO_SILL_M)
    wall.has_door = True


def _keep_both_sides(floor: Floor, opening: Opening, side: Door, deep: float, sill: float) -> None:
    """Free floor before an opening; behind it, too, where a touching room may lie there.

    Drawings put openings a little beside their wall: the depth counts from the opening's face.
    """
    wall, s_from, s_to = side[:3]
    face = opening.box.size_m[1] / 2
    _, t = wall.local(*opening.box.center_m[:2])
    floor.keep(wall, s_from, s_to, 0.0, max(0.0, t + face) + deep, ZONE, sill)
    for other in floor.touching:
        other.keep(wall, s_from, s_to, t - face - deep, max(0.0, t + face) + deep, ZONE, sill)


def keep_ways_in(floor: Floor) -> None:
    """Keep a margin around what doors and windows need, and in larger rooms the way in beyond.

    Whoever furnishes by eye, as a layout model does, must not learn to stop at the last centimetre.
    """
    margin = SIDE_MARGIN_M
    for wall, s_from, s_to, *_ in floor.doors:
        deep = min(s_to - s_from, DEEPEST_DOOR_ZONE_M)
        floor.keep(wall, s_from - margin, s_to + margin, 0.0, deep + DEPTH_MARGIN_M, REACH)
        if floor.kind in _ROOMY_KINDS:
            floor.keep(wall, s_from, s_to, deep, deep + WAY_IN_M, REACH)
    for wall, s_from, s_to, sill in floor.windows:
        deep = WINDOW_ZONE_M + DEPTH_MARGIN_M
        floor.keep(wall, s_from - margin, s_to + margin, 0.0, deep, REACH, sill)


def _side_of(
    floor: Floor, opening: Opening, along: tuple[float, float]
) -> tuple[Wall, float, float] | None:
    """The wall that holds the opening and the opening's span on it."""
    x, y, _ = opening.box.center_m
    half = opening.box.size_m[0] / 2
    ux, uy = along
    farthest = max(WALL_THICKNESS_M, opening.box.size_m[1]) + 0.05
    best, nearest = None, farthest
    for wall in floor.walls:
        if abs(ux * wall.uy - uy * wall.ux) > PARALLEL:
            continue
        s, t = wall.local(x, y)
        if -half < s < wall.length + half and abs(t) < nearest and t < FARTHEST_INSIDE_M:
            best, nearest = (wall, max(0.0, s - half), min(wall.length, s + half)), abs(t)
    return best


def _entrance(
    sides: Sequence[tuple[Opening, list[tuple[Floor, tuple[Wall, float, float]]]]],
) -> Opening | None:
    """The front door: marked as such, else the likeliest door that leads outside."""
    best, rank = None, 99.0
    for opening, walls in sides:
        if opening.kind == "window" or len(walls) != 1:
            continue
        if _marked(opening.extra):
            return opening
        kind = walls[0][0].kind
        if opening.kind == "door" and kind in _ENTRANCE_KINDS:
            preference = _ENTRANCE_KINDS.index(kind) - opening.box.size_m[0] / 10
            if preference < rank:
                best, rank = opening, preference
    return best


def _marked(extra: Mapping[str, object]) -> bool:
    return bool(extra.get("entrance")) or extra.get("role") == "entrance"


def _near(a: Bounds, b: Bounds, gap: float = 0.05) -> bool:
    return a[0] < b[2] + gap and b[0] < a[2] + gap and a[1] < b[3] + gap and b[1] < a[3] + gap


def _share_sides(floor: Floor, other: Floor) -> None:
    for wall in floor.walls:
        for twin in other.walls:
            if wall.ux * twin.ux + wall.uy * twin.uy > -0.9998:
                continue
            s_end, t = wall.local(twin.x, twin.y)
            if abs(t) > 0.05:
                continue
            s_from, s_to = max(0.0, s_end - twin.length), min(wall.length, s_end)
            if s_to - s_from > 0.3:
                floor.keep(wall, s_from, s_to, 0.0, OPEN_SIDE_M)
                if other not in floor.touching:
                    floor.touching.append(other)
                floor.doors.append(Door(wall, s_from, s_to, False, other))
                wall.has_door = True
