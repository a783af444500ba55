"""Open plans: a floor that several rooms share becomes these rooms, open to each other.

Where a kitchen, a table and a sofa share a floor, what is furnished, labelled and lit as one room
would be a home without a kitchen. So the floor is cut, straight across and along its main
direction, where each part comes out as large and as wide as rooms of its kind are, with its name on
it, what is drawn there in it, and no cut meets a door or a window. The parts touch: nothing is
between them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import product

import numpy as np
import shapely
from shapely.affinity import rotate
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient
from shapely.ops import polygonize, unary_union

from chord_usd.base.scene.geometry import footprint_polygon, room_polygon
from chord_usd.base.scene.room_areas import fit_of_area
from chord_usd.base.scene.room_names import LEADING
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    WET_KINDS,
    Opening,
    Plan,
    Room,
    RoomKind,
    frozen_array,
)
from chord_usd.line.plan.seen_kinds import SeenKinds

_MISSED: dict[RoomKind, float] = {
    "kitchen": 12.0, "bedroom": 9.0, "living": 6.0, "dining": 3.0, "study": 3.0, "corridor": 2.5,
}  # fmt: skip
"""What a use costs that gets no part of its own, in nats. Other kinds never share a floor."""

_LEAST_WIDTH_M: dict[RoomKind, float] = {
    "kitchen": 1.8, "bedroom": 2.4, "living": 2.6, "dining": 2.0, "study": 1.8, "corridor": 0.9,
}  # fmt: skip
_TOO_NARROW = 6.0
"""Nats a metre that a part lacks in width."""
_RAGGED = 3.0
"""Nats for a part that fills nothing of the rectangle around it."""
_DRAWN = 0.5
"""Of the evidence of a drawing, in nats for a square metre: neighbouring spots see the same."""
_CUT = 0.5
"""Nats a metre of a cut: floors are parted where they are narrow."""
_IN_OPENING = 6.0
"""Nats for a cut that ends in a door or window."""

_DRY, _PIPES_M = 1.5, 0.5
"""Nats for a kitchen, not named, farther than this from all baths."""

_UNIT_WALL_M = 2.4
_SHORT = 3.0
"""Nats a metre of wall, free of doors, that a kitchen lacks for its units."""
_LEAST_RUN_M = 0.8

_STEP_M = 0.25
_TORN_M = 0.15
"""Corners of torn rims are no places for a cut."""
_BESIDE_NAME_M = 0.4
"""A cut stays so far from the middle of a name."""
_JAMB_M = 0.1
_AT_WALL_M = 0.2
"""An end is in an opening if it lies within its jambs, and no farther from its wall."""
_LEAST_CUT_M = 0.7
_EXTENDED_M = 1e-3
_ON_LINE_M = 0.01
_TRIED = 4
"""So many of the best cuts are looked at further."""


@dataclass(frozen=True, eq=False)
class Use:
    """What a floor is used for, in part."""

    kind: RoomKind
    names: tuple[str, ...] = ()
    spots_m: tuple[tuple[float, float], ...] = ()
    """Where its names are printed; none where it may be anywhere."""
    is_needed: bool = True
    """Whether it has to have a part of its own, rather than may."""


@dataclass(frozen=True, eq=False)
class _Around:
    """What a floor is parted with a view to."""

    openings: Sequence[Opening]
    """Of the floor."""
    baths: BaseGeometry
    """Of the house: a kitchen that may be anywhere shares their pipes."""
    rim: BaseGeometry
    """The walls around the whole floor."""
    doorways: BaseGeometry
    """Before which nothing stands."""
    seen: SeenKinds | None
    """What the drawing shows."""
    shapes: dict[Polygon, _Shape] = field(default_factory=dict)
    """Of floors that were looked at: each comes back with every way to share out the uses."""
    walls_m: dict[Polygon, float] = field(default_factory=dict)
    ends: dict[LineString, int] = field(default_factory=dict)
    """By cut, how many of its ends lie in openings."""


@dataclass(frozen=True, eq=False)
class _Shape:
    """What a floor is, whatever it is used for."""

    side_m: float
    """Of the rectangle around it, the shorter."""
    ragged: float
    """Share of that rectangle that it leaves free."""
    is_dry: bool
    """Whether it is far from all baths."""
    drawn: Mapping[RoomKind, float]
    """Logarithms of chances of what the drawing shows there; empty without one."""


@dataclass(frozen=True, eq=False)
class _Part:
    floor: Polygon
    uses: tuple[Use, ...]

    @property
    def kind(self) -> RoomKind:
        """Of what counts most in it."""
        return min((use.kind for use in self.uses), key=LEADING.index)


def can_share(kind: RoomKind) -> bool:
    """Whether a room of this kind may be a part of an open plan."""
    return kind in _MISSED


def part_room(plan: Plan, room_id: str, uses: Sequence[Use], seen: SeenKinds | None = None) -> Plan:
    """The plan with a room parted into its uses, as far as it has room for them.

    seen: what the plan's drawing shows, where there is one.
    The part of the leading use keeps the room's id; what opened into the room opens into the part
    beside it.
    """
    room = plan.room(room_id)
    room_openings = [opening for opening in plan.openings if room_id in opening.room_ids]
    baths = unary_union([room_polygon(each) for each in plan.rooms if each.kind in WET_KINDS])
    floor = orient(room_polygon(room))
    ways = [footprint_polygon(opening.box) for opening in room_openings if opening.kind != "window"]
    doorways = unary_union(ways).buffer(WALL_THICKNESS_M, join_style="mitre")
    around = _Around(room_openings, baths, floor.exterior, doorways, seen)
    parts = _best_parts(floor, tuple(uses), around)[1]
    if len(parts) < 2:
        return plan
    rooms = _rooms(plan, room, parts)
    floors = [part.floor for part in parts]
    moved = [_moved(o, room_id, rooms, floors) if o in room_openings else o for o in plan.openings]
    others = [other for other in plan.rooms if other.id != room_id]
    return replace(plan, rooms=(*others, *rooms), openings=tuple(moved))


# Cuts --------------------------------------------------------------------------------------------


def _best_parts(
    floor: Polygon, uses: tuple[Use, ...], around: _Around
) -> tuple[float, list[_Part]]:
    """The likeliest way to part a floor, and how likely it is, in nats."""
    whole = _Part(floor, uses)
    leading = replace(whole, uses=tuple(use for use in uses if use.kind == whole.kind))
    best = _nats(leading, around) - _missed(whole), [whole]
    if len(uses) < 2:
        return best
    tried = sorted(_tries(whole, around), key=lambda tried: -tried[0])[:_TRIED]
    for _, cost, halves in tried:
        sides = [_best_parts(half.floor, half.uses, around) for half in halves]
        nats = sum(each[0] for each in sides) - cost
        if nats > best[0]:
            best = nats, [part for each in sides for part in each[1]]
    return best


def _tries(whole: _Part, around: _Around) -> Iterator[tuple[float, float, tuple[_Part, _Part]]]:
    """(nats, cost of the cut, halves) of the ways to cut a floor once. What a half's further uses
    cost that get no part is left out: it may be cut again."""
    for cut, first, second in _cuts(whole.floor):
        if any(
            cut.distance(Point(spot)) < _BESIDE_NAME_M for u in whole.uses for spot in u.spots_m
        ):
            continue
        if cut not in around.ends:
            around.ends[cut] = _ends_in(cut, around.openings)
        cost = _CUT * cut.length + _IN_OPENING * around.ends[cut]
        for halves in _shared_out(whole.uses, first, second):
            yield sum(_nats(half, around) for half in halves) - cost, cost, halves


@lru_cache(1024)
def _cuts(floor: Polygon) -> tuple[tuple[LineString, Polygon, Polygon], ...]:
    """Chords along the floor's main direction and across it, each with the two halves."""
    # The same floors come back with every way to share out the uses.
    return tuple(_cuts_of(floor))


def _cuts_of(floor: Polygon) -> Iterator[tuple[LineString, Polygon, Polygon]]:
    angle = _direction_deg(floor)
    turned = rotate(floor, -angle, origin=(0.0, 0.0))
    beside_rim = turned.exterior.buffer(_ON_LINE_M)
    corners = np.asarray(turned.simplify(_TORN_M).exterior.coords)
    low, high = corners.min(axis=0), corners.max(axis=0)
    for axis in (0, 1):
        places = np.arange(low[axis] + _STEP_M, high[axis], _STEP_M)
        far = np.abs(places[:, None] - corners[:, axis]).min(axis=1) > _STEP_M / 3
        for place in np.unique(np.round([*corners[:, axis], *places[far]], 2)):
            ends = np.array([low - 1.0, high + 1.0])
            ends[:, axis] = place
            for chord in _chords(turned, LineString(ends), beside_rim):
                back = [rotate(end, angle, origin=(0.0, 0.0)) for end in chord] if angle else chord
                yield back[0], orient(back[1]), orient(back[2])


def _chords(
    floor: Polygon, line: LineString, beside_rim: BaseGeometry
) -> Iterator[tuple[LineString, Polygon, Polygon]]:
    rim = floor.exterior
    for piece in shapely.get_parts(floor.intersection(line)):
        inner = piece.difference(beside_rim) if piece.length else piece
        if inner.geom_type != "LineString" or inner.length < _LEAST_CUT_M:
            continue
        (x0, y0), (x1, y1) = piece.coords[0], piece.coords[-1]
        more = _EXTENDED_M / piece.length
        longer = LineString([
            (x0 - more * (x1 - x0), y0 - more * (y1 - y0)),
            (x1 + more * (x1 - x0), y1 + more * (y1 - y0)),
        ])  # fmt: skip
        halves = [half for half in polygonize(unary_union([rim, longer])) if half.area > _ON_LINE_M]
        if len(halves) == 2:
            yield inner, halves[0], halves[1]


def _direction_deg(floor: Polygon) -> float:
    """Of most of the floor's rim, from 0 to 90."""
    corners = np.asarray(floor.exterior.coords)
    edges = np.diff(corners, axis=0)
    lengths = np.hypot(*edges.T)
    angles = np.degrees(np.arctan2(edges[:, 1], edges[:, 0])) % 90.0
    near = np.abs((angles[:, None] - angles + 45.0) % 90.0 - 45.0) < 2.0
    return float(angles[(near @ lengths).argmax()])


def _shared_out(
    uses: tuple[Use, ...], first: Polygon, second: Polygon
) -> Iterator[tuple[_Part, _Part]]:
    """The halves with the uses whose names lie in them, and each way to share out the others."""
    free = [use for use in uses if not use.spots_m]
    placed = [use for use in uses if use.spots_m]
    inside = [[first.contains(Point(spot)) for spot in use.spots_m] for use in placed]
    if any(any(each) and not all(each) for each in inside):
        return  # through the names of one use
    for sides in product((True, False), repeat=len(free)):
        pairs = [*zip(placed, map(any, inside), strict=True), *zip(free, sides, strict=True)]
        first_uses = tuple(use for use, is_first in pairs if is_first)
        other = tuple(use for use, is_first in pairs if not is_first)
        if first_uses and other:
            yield _Part(first, first_uses), _Part(second, other)


def _missed(part: _Part) -> float:
    """What the uses of a part cost that it is not named by."""
    needed = {use.kind for use in part.uses if use.is_needed}
    return sum(_MISSED[other] for other in needed - {part.kind})


def _nats(part: _Part, around: _Around) -> float:
    """How likely it is that floors for its uses are as large together, of such a form and there."""
    floor = part.floor
    shape = around.shapes.get(floor) or around.shapes.setdefault(floor, _shape(floor, around))
    narrow = max(0.0, _LEAST_WIDTH_M[part.kind] - shape.side_m)
    is_dry = shape.is_dry and any(use.kind == "kitchen" and not use.spots_m for use in part.uses)
    fit = fit_of_area({use.kind for use in part.uses}, floor.area)
    nats = fit - _TOO_NARROW * narrow - _RAGGED * shape.ragged - _DRY * is_dry
    if shape.drawn:
        nats += _DRAWN * max(shape.drawn[use.kind] for use in part.uses)
    if part.kind == "kitchen":
        if floor not in around.walls_m:
            around.walls_m[floor] = _free_wall_m(floor, around)
        nats -= _SHORT * max(0.0, _UNIT_WALL_M - around.walls_m[floor])
    return nats


def _shape(floor: Polygon, around: _Around) -> _Shape:
    frame = floor.minimum_rotated_rectangle
    sides = np.hypot(*np.diff(np.asarray(frame.exterior.coords)[:3], axis=0).T)
    drawn = around.seen.log_chances(floor) if around.seen else {}
    is_dry = floor.distance(around.baths) > _PIPES_M
    return _Shape(float(sides.min()), 1.0 - floor.area / frame.area, is_dry, drawn)


def _free_wall_m(floor: Polygon, around: _Around) -> float:
    """Wall along which units can stand, in runs of _LEAST_RUN_M or more."""
    wall = floor.exterior.intersection(around.rim.buffer(_ON_LINE_M))
    runs = wall.difference(around.doorways)
    corners = floor.exterior.simplify(_TORN_M).coords
    bends = shapely.MultiPoint(corners).buffer(_ON_LINE_M)
    pieces = shapely.get_parts(shapely.line_merge(runs.difference(bends)))
    lengths = shapely.length(pieces)
    return float(lengths[lengths >= _LEAST_RUN_M].sum())


def _ends_in(cut: LineString, openings: Sequence[Opening]) -> int:
    """How many ends of a cut lie in an opening."""
    ends = np.array([cut.coords[0], cut.coords[-1]])
    count = 0
    for opening in openings:
        yaw = math.radians(opening.box.yaw_deg)
        along = np.array([math.cos(yaw), math.sin(yaw)])
        offset = ends - np.array(opening.box.center_m[:2])
        half = opening.box.size_m[0] / 2 + _JAMB_M
        aside = np.abs(offset @ np.array([-along[1], along[0]]))
        is_in = (np.abs(offset @ along) < half) & (aside < opening.box.size_m[1] + _AT_WALL_M)
        count += int(is_in.sum())
    return count


# What comes of it ---------------------------------------------------------------------------------


def _rooms(plan: Plan, room: Room, parts: Sequence[_Part]) -> list[Room]:
    """A room for each part; the leading one keeps the id."""
    kinds = [part.kind for part in parts]
    leading = min(range(len(parts)), key=lambda i: (LEADING.index(kinds[i]), -parts[i].floor.area))
    taken = {other.id for other in plan.rooms}
    rooms = []
    for index, (part, kind) in enumerate(zip(parts, kinds, strict=True)):
        new_id, name = (room.id, room.name) if index == leading else (_free_id(kind, taken), "")
        taken.add(new_id)
        corners = np.asarray(part.floor.simplify(_ON_LINE_M).exterior.coords)[:-1]
        said = ", ".join(dict.fromkeys(word for use in part.uses for word in use.names))
        rooms.append(Room(new_id, kind, frozen_array(corners), said or name, room.extra))
    return rooms


def _free_id(kind: RoomKind, taken: set[str]) -> str:
    number = 1
    while f"{kind}{number}" in taken:
        number += 1
    return f"{kind}{number}"


def _moved(
    opening: Opening, room_id: str, rooms: Sequence[Room], floors: Sequence[Polygon]
) -> Opening:
    """An opening of the whole room as one of the part that it is nearest to."""
    middle = Point(opening.box.center_m[:2])
    nearest = min(range(len(rooms)), key=lambda index: floors[index].distance(middle))
    ids = tuple(
        rooms[nearest].id if joined_id == room_id else joined_id for joined_id in opening.room_ids
    )
    return replace(opening, room_ids=ids)
