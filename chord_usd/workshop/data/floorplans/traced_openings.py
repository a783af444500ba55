"""Traced floor plans: which rooms an opening joins, and whether it is a door or a window.

Metres, y up. The drawings call doors and windows alike "door".
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    Box,
    FloatArray,
    Opening,
    OpeningKind,
    RoomKind,
)
from chord_usd.workshop.data.floorplans.traced import FIXTURES
from chord_usd.workshop.data.floorplans.traced_rooms import TracedRoom

_REACH_M = 0.15
"""How far off its place a wall face may lie from a drawn opening."""

_LEAST_WIDTH_M = 0.5
_LEAST_OVERLAP_M = 0.2
_LEAST_DOOR_M = 0.6
_WIDEST_ENTRANCE_M = 1.4

_TOILET_ROOM_M2 = 2.0
_TOILET_DOOR_M, _WET_DOOR_M = 0.65, 0.8
"""Clear width of the doors of toilets and of other wet rooms; drawings add frames and pockets."""

_ENTRANCE_M = 3.5
"""The entrance is at most this far from the label that names it."""

_CORNER_M = 0.02

_LARGEST_SHAFT_M2 = 2.5
_MOST_INFERRED = 3

_ENTRY: dict[RoomKind, tuple[RoomKind, ...]] = {
    "bathroom": ("bathroom", "corridor", "kitchen", "living", "bedroom"),
    "bedroom": ("corridor", "living", "dining", "kitchen"),
    "balcony": ("living", "bedroom", "kitchen", "dining"),
    "kitchen": ("corridor", "living", "dining"),
    "living": ("corridor", "kitchen", "dining"),
    "store": ("bedroom", "corridor", "living", "kitchen"),
}
"""What a room is entered from, the best first."""

_DOOR_HEIGHT_M = 2.1
_SILL_M = 0.9
_WINDOW_HEIGHT_M = 1.3


@dataclass(frozen=True, eq=False)
class _Hole:
    """A gap in a wall: its span along the direction, from start, on the wall's middle line."""

    rooms: tuple[int, ...]
    center: FloatArray
    direction: FloatArray
    width: float


@dataclass(frozen=True)
class _Side:
    """The edge of a room's face that an opening cuts through, as a span along the opening."""

    room: int
    low: float
    high: float
    offset: float
    """Of the face from the drawn line, positive to its left."""
    is_left: bool
    """Whether the room, not only its face, lies to the left: lines are drawn inside rooms, too."""

    def overlap(self, length: float) -> float:
        """How much of the opening, which spans 0 to length, lies on this edge."""
        return min(self.high, length) - max(self.low, 0.0)


def traced_openings(
    rooms: Sequence[TracedRoom], doors: Sequence[LineString], ids: Sequence[str]
) -> tuple[Opening, ...]:
    """Doors and windows of these rooms, the entrance first.

    Drawings forget a door now and then. Up to _MOST_INFERRED are put where a room is entered from
    a room that could be its entry; their extra says {"inferred": True}. Raises PlanError where
    more are missing.
    """
    holes = [hole for door in doors if (hole := _hole(rooms, door)) is not None]
    holes = [_clear(rooms, hole) for hole in _without_overlaps(_without_inward(rooms, holes))]
    entrance = _entrance(rooms, holes)
    inferred: list[_Hole] = []
    if entrance is None:
        entrance = _inferred_entrance(rooms, holes)
        inferred.append(entrance)
    holes = [entrance, *(hole for hole in holes if hole is not entrance)]
    while missing := _next_door(rooms, holes):
        inferred.append(missing)
        holes.append(missing)
        if len(inferred) > _MOST_INFERRED:
            raise PlanError("too many doors are missing")
    return tuple(
        _opening(
            "door" if hole is entrance else _kind(rooms, hole), hole, index, ids,
            {"inferred": True} if hole in inferred else {},
        )
        for index, hole in enumerate(holes)
    )  # fmt: skip


def unreached(rooms: Sequence[TracedRoom], links: Iterable[Sequence[int]], start: int) -> set[int]:
    """Rooms one cannot walk to from this one through these links and between rooms that touch."""
    links = [
        *links,
        *(
            (first, second)
            for first, second in combinations(range(len(rooms)), 2)
            if rooms[first].cell is rooms[second].cell
        ),
    ]
    reached = {start}
    for _ in rooms:
        reached |= {room for link in links if reached.intersection(link) for room in link}
    return set(range(len(rooms))) - reached


def _next_door(rooms: Sequence[TracedRoom], holes: Sequence[_Hole]) -> _Hole | None:
    """A door to a room that has none, from one that can be reached; None where all is well."""
    links = [hole.rooms for hole in holes if _kind(rooms, hole) == "door"]
    lost = unreached(rooms, links, holes[0].rooms[0])
    # A small cupboard without a door is a shaft; the caller drops it.
    lost_rooms = [i for i in lost if not is_shaft(rooms[i])]
    if not lost_rooms:
        return None
    for index in sorted(lost_rooms, key=lambda i: (-rooms[i].face.area, i)):
        kinds = _ENTRY.get(rooms[index].kind, ("corridor", "living", "kitchen"))
        entries = [i for i in range(len(rooms)) if i not in lost and rooms[i].kind in kinds]
        for entry in sorted(entries, key=lambda i: kinds.index(rooms[i].kind)):
            hole = _inferred(rooms, holes, (min(index, entry), max(index, entry)), 0.75)
            if hole is not None:
                return hole
    raise PlanError(f"no door leads to a {rooms[lost_rooms[0]].kind}")


def is_shaft(room: TracedRoom) -> bool:
    """Whether this would be a mere shaft if no door led into it."""
    return room.kind in ("store", "unknown") and room.face.area <= _LARGEST_SHAFT_M2


def _inferred(
    rooms: Sequence[TracedRoom], holes: Sequence[_Hole], joins: tuple[int, ...], width: float
) -> _Hole | None:
    """A door of this width in the longest free wall between these rooms, or None."""
    best, longest = None, 0.0
    taken = [_line(hole) for hole in holes]
    corners = np.array(orient(rooms[joins[0]].face).exterior.coords)
    for start, end in pairwise(corners):
        length = float(np.linalg.norm(end - start))
        if length < width + 0.1:
            continue
        direction = (end - start) / length
        start = start + WALL_THICKNESS_M / 2 * np.array([direction[1], -direction[0]])
        for low in np.arange(0.05, length - width, 0.2):
            line = LineString([start + low * direction, start + (low + width) * direction])
            hole = _hole(rooms, line)
            fits = hole is not None and hole.rooms == joins and hole.width >= 0.9 * width
            if fits and length > longest and all(line.distance(t) > 0.1 for t in taken):
                best, longest = hole, length
    return best


def _inferred_entrance(rooms: Sequence[TracedRoom], holes: Sequence[_Hole]) -> _Hole:
    """A door to the outside in the hall, or in the room that serves as one."""
    ranks = {"corridor": 1, "kitchen": 2, "living": 3, "dining": 3}
    order = sorted(
        (0 if any(mark.label == "entrance" for mark in room.marks) else ranks[room.kind], index)
        for index, room in enumerate(rooms)
        if room.kind in ranks
    )
    for _, index in order:
        hole = _inferred(rooms, holes, (index,), 0.9)
        if hole is not None:
            return hole
    raise PlanError("no entrance door")


def _hole(rooms: Sequence[TracedRoom], door: LineString) -> _Hole | None:
    start, end = (np.array(point) for point in door.coords)
    length = float(np.linalg.norm(end - start))
    if length < _LEAST_WIDTH_M:
        return None
    sides = [side for i, room in enumerate(rooms) for side in _sides(i, room, start, end)]
    lefts = [side for side in sides if side.is_left]
    rights = [side for side in sides if not side.is_left]
    left = max(lefts, key=lambda s: s.overlap(length), default=None)
    right = max(rights, key=lambda s: s.overlap(length), default=None)
    beside = [side for side in (left, right) if side is not None]
    if not beside:
        return None
    if len(beside) == 2 and abs(beside[0].offset - beside[1].offset - WALL_THICKNESS_M) > 0.02:
        return None
    low = max(side.low for side in beside) + _CORNER_M
    high = min(side.high for side in beside) - _CORNER_M
    # Thick walls leave less room beside a door than the drawing's thin ones: slide it along.
    width = min(max(length, _LEAST_DOOR_M), high - low)
    if width < _LEAST_WIDTH_M:
        return None
    middle = min(max(length / 2, low + width / 2), high - width / 2)
    direction = (end - start) / length
    normal = np.array([-direction[1], direction[0]])
    offset = beside[0].offset + WALL_THICKNESS_M / 2 * (-1.0 if beside[0].is_left else 1.0)
    center = start + middle * direction + offset * normal
    return _Hole(tuple(sorted(s.room for s in beside)), center, direction, width)


def _clear(rooms: Sequence[TracedRoom], hole: _Hole) -> _Hole:
    """The part of a wet room's door that opens, at the end away from what stands in there."""
    wet = [rooms[i] for i in hole.rooms if rooms[i].kind == "bathroom"]
    if len(hole.rooms) != 2 or not wet:
        return hole
    smallest = min(wet, key=lambda room: room.face.area)
    width = _TOILET_DOOR_M if smallest.face.area < _TOILET_ROOM_M2 else _WET_DOOR_M
    if hole.width <= width:
        return hole
    fixtures = [mark.center for mark in smallest.marks if mark.label in FIXTURES]
    aside = float(np.mean((np.array(fixtures) - hole.center) @ hole.direction)) if fixtures else 0.0
    shift = -np.sign(aside) * (hole.width - width) / 2
    return replace(hole, center=hole.center + shift * hole.direction, width=width)


def _sides(index: int, room: TracedRoom, start: FloatArray, end: FloatArray) -> list[_Side]:
    """Edges of a room's face beside the drawn line, as spans along it."""
    length = float(np.linalg.norm(end - start))
    direction = (end - start) / length
    normal = np.array([-direction[1], direction[0]])
    corners = np.array(orient(room.face).exterior.coords)
    along, across = (corners - start) @ direction, (corners - start) @ normal
    sides = []
    for i in range(len(corners) - 1):
        low, high = sorted((float(along[i]), float(along[i + 1])))
        if (
            min(high, length) - max(low, 0.0) < _LEAST_OVERLAP_M
            or abs(across[i] - across[i + 1]) > 0.02
        ):
            continue
        offset = float(across[i] + across[i + 1]) / 2
        if abs(abs(offset) - WALL_THICKNESS_M / 2) <= _REACH_M:
            sides.append(_Side(index, low, high, offset, bool(along[i] < along[i + 1])))
    return sides


def _without_inward(rooms: Sequence[TracedRoom], holes: Sequence[_Hole]) -> list[_Hole]:
    """Without the openings that lead into a shaft within the house."""
    outline = unary_union([room.cell for room in rooms])
    shafts = [
        Polygon(ring) for part in getattr(outline, "geoms", [outline]) for ring in part.interiors
    ]
    return [
        hole
        for hole in holes
        if len(hole.rooms) == 2 or not any(s.distance(Point(hole.center)) < 0.01 for s in shafts)
    ]


def _without_overlaps(holes: Sequence[_Hole]) -> list[_Hole]:
    kept: list[_Hole] = []
    for hole in sorted(holes, key=lambda hole: -hole.width):
        line = _line(hole)
        if all(line.distance(_line(other)) > 0.05 for other in kept):
            kept.append(hole)
    return kept


def _line(hole: _Hole) -> LineString:
    half = hole.direction * hole.width / 2
    return LineString([hole.center - half, hole.center + half])


def _entrance(rooms: Sequence[TracedRoom], holes: Sequence[_Hole]) -> _Hole | None:
    """The outer opening nearest to the label of the entrance; without label, that of a hall."""
    labels = [mark for room in rooms for mark in room.marks if mark.label == "entrance"]
    candidates: list[tuple[float, int, _Hole]] = []
    for hole in holes:
        room = rooms[hole.rooms[0]]
        if len(hole.rooms) != 1 or room.kind in ("balcony", "bathroom", "store"):
            continue
        if not _LEAST_DOOR_M <= hole.width <= _WIDEST_ENTRANCE_M:
            continue
        distances = [Point(mark.center).distance(_line(hole)) for mark in labels]
        distance = min(distances, default=0.0 if room.kind in ("corridor", "kitchen") else 9.0)
        if distance < _ENTRANCE_M:
            candidates.append((distance, len(candidates), hole))
    return min(candidates)[2] if candidates else None


def _kind(rooms: Sequence[TracedRoom], hole: _Hole) -> OpeningKind:
    if len(hole.rooms) == 1:
        return "window"
    onto_balcony = any(rooms[index].kind == "balcony" for index in hole.rooms)
    return "window" if onto_balcony and hole.width < _LEAST_DOOR_M else "door"


def _opening(
    kind: OpeningKind, hole: _Hole, index: int, ids: Sequence[str], extra: dict[str, bool]
) -> Opening:
    yaw_deg = math.degrees(math.atan2(hole.direction[1], hole.direction[0])) % 180.0
    is_door = kind == "door"
    box = Box(
        (float(hole.center[0]), float(hole.center[1]), 0.0 if is_door else _SILL_M),
        (hole.width, WALL_THICKNESS_M, _DOOR_HEIGHT_M if is_door else _WINDOW_HEIGHT_M),
        yaw_deg,
    )
    return Opening(f"{kind}{index + 1}", kind, box, tuple(ids[room] for room in hole.rooms), extra)
