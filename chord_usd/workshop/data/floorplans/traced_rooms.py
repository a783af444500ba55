"""Traced floor plans: from closed cells and labels to rooms with a kind and an inner face.

Metres, y up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from shapely.geometry import LineString, Point, Polygon
from shapely.ops import split, unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.types import WALL_THICKNESS_M, RoomKind
from chord_usd.workshop.data.floorplans.traced import FIXTURES, Mark

_WET = frozenset({"bathroom", "restroom", "washing_room"})
_HALL = frozenset({"entrance", "corridor"})

_LEAST_STORE_M = 0.6
_LEAST_STORE_M2 = 0.8
_LEAST_WET_M = 0.7
"""Narrower toilet rooms are joined to the wash room or bathroom beside them."""

_LEAST_SHAFT_M2 = 1.5
_LARGE_KITCHEN_M2 = 13.0
"""A kitchen larger than this is a dining kitchen."""

_LEAST_LIVING_M2 = 10.0
"""What is left of a dining kitchen beside its counter is a place to eat unless it is larger."""

_NICHE_M2 = 0.8
"""No bathroom is smaller: such a cell is the niche of a washing machine."""

_NICHE_SHARE = 0.55
"""Nor does a basin take as much of one; a washing machine, drawn alike, fills its niche."""

_SLIVER_M = 0.1
"""What a cut leaves of a room is nowhere thinner."""


@dataclass(eq=False)
class TracedRoom:
    """A room under construction."""

    kind: RoomKind
    cell: Polygon
    """Up to the middle lines of its walls."""
    names: frozenset[str]
    marks: list[Mark] = field(default_factory=list)
    face: Polygon = field(default_factory=Polygon)
    """Inner face of its walls."""


def traced_rooms(
    cells: Sequence[Polygon], marks: Sequence[Mark], doors: Sequence[LineString]
) -> list[TracedRoom]:
    """Rooms with kinds and inner faces; shafts and slivers are dropped or merged.

    Raises PlanError where a room is no simple polygon any more once its walls have thickness.
    """
    rooms = []
    for cell in cells:
        inside = [mark for mark in marks if cell.covers(Point(mark.center))]
        kind = _kind(cell, inside, doors)
        if kind is not None:
            names = frozenset(mark.label for mark in inside if mark.label not in FIXTURES)
            rooms.append(TracedRoom(kind, cell, names, inside))
    rooms = _without_narrow(rooms)
    for room in rooms:
        room.face = _inner_face(room)
        if room.kind == "bathroom" and _is_laundry_niche(room):
            room.kind = "store"
    return [part for room in rooms for part in _opened_up(room, rooms)]


def _kind(cell: Polygon, marks: Sequence[Mark], doors: Sequence[LineString]) -> RoomKind | None:
    names = {mark.label for mark in marks}
    for name, kind in _BY_NAME:
        if name in names:
            return kind
    if names & _WET and not names & {"entrance"}:
        return "bathroom"
    if names & (_HALL | {"stairs"}):
        return "corridor"
    if "closet" in names:
        return "store"
    if names & {"toilet", "bathtub", "washing_basin"}:
        return "bathroom"
    if "cooking_counter" in names:
        return "kitchen"
    # No label: a cupboard where a door leads into it, else a shaft.
    has_door = any(cell.exterior.distance(door.centroid) < WALL_THICKNESS_M for door in doors)
    if "PS" in names or not has_door or cell.area < _LEAST_SHAFT_M2:
        return None
    return "store" if cell.area < 5.0 else "unknown"


_BY_NAME: tuple[tuple[str, RoomKind], ...] = (
    ("balcony", "balcony"),
    ("living_room", "living"),
    ("bedroom", "bedroom"),
    ("kitchen", "kitchen"),
)


# --- merging ---------------------------------------------------------------------------------


def _is_narrower(cell: Polygon, width_m: float) -> bool:
    return bool(cell.buffer(-(WALL_THICKNESS_M + width_m) / 2, join_style="mitre").is_empty)


def _without_narrow(rooms: list[TracedRoom]) -> list[TracedRoom]:
    """Give cells too narrow to be rooms to the neighbour they belong to."""
    kept = list(rooms)
    for room in rooms:
        into: TracedRoom | None = None
        inner_m2 = room.cell.buffer(-WALL_THICKNESS_M / 2, join_style="mitre").area
        if room.kind == "store" and (
            _is_narrower(room.cell, _LEAST_STORE_M) or inner_m2 < _LEAST_STORE_M2
        ):
            into = _best_neighbour(room, kept, ("bedroom", "corridor", "living", "kitchen"))
        elif room.kind == "bathroom" and _is_narrower(room.cell, _LEAST_WET_M):
            into = _best_neighbour(room, kept, ("bathroom",))
        elif room.kind == "corridor" and _is_narrower(room.cell, _LEAST_STORE_M):
            into = _best_neighbour(room, kept, ("corridor", "kitchen", "living"))
        else:
            continue
        if into is not None:
            into.cell = unary_union([into.cell, room.cell])
            into.marks += room.marks
            kept.remove(room)
        elif room.kind == "store":
            kept.remove(room)
    return kept


def _best_neighbour(
    room: TracedRoom, rooms: Sequence[TracedRoom], kinds: Sequence[RoomKind]
) -> TracedRoom | None:
    """The neighbour that shares most of this room's outline, among these kinds."""
    shared = [
        (other.cell.intersection(room.cell).length, index)
        for index, other in enumerate(rooms)
        if other is not room and other.kind in kinds
    ]
    length, index = max(shared, default=(0.0, 0))
    merged = rooms[index].cell.union(room.cell) if length >= 0.6 else None
    if merged is None or merged.geom_type != "Polygon" or merged.interiors:
        return None
    return rooms[index]


def _inner_face(room: TracedRoom) -> Polygon:
    cell = Polygon(room.cell.exterior)
    if cell.area - room.cell.area > 1.0:
        raise PlanError("a room lies inside another")
    face = cell.simplify(0.01).buffer(-WALL_THICKNESS_M / 2, join_style="mitre")
    parts = sorted(getattr(face, "geoms", [face]), key=lambda part: -part.area)
    if not parts or parts[0].is_empty:
        raise PlanError("a room is narrower than its walls")
    if sum(part.area for part in parts[1:]) > 0.5:
        raise PlanError("a room falls apart between its walls")
    return parts[0]


def _is_laundry_niche(room: TracedRoom) -> bool:
    """Whether this is the place of a washing machine rather than a room to wash oneself in."""
    fixtures = [mark for mark in room.marks if mark.label in FIXTURES]
    if any(mark.label in ("toilet", "bathtub") for mark in fixtures):
        return False
    drawn_m2 = sum((mark.x1 - mark.x0) * (mark.y1 - mark.y0) for mark in fixtures)
    return room.face.area < _NICHE_M2 or drawn_m2 > _NICHE_SHARE * room.face.area


# --- open plan -------------------------------------------------------------------------------


def _opened_up(room: TracedRoom, rooms: Sequence[TracedRoom]) -> list[TracedRoom]:
    """Divide a room with a kitchen in it into rooms that touch."""
    has_kitchen = any(r.kind == "kitchen" for r in rooms)
    cooks = any(mark.label == "cooking_counter" for mark in room.marks) and not has_kitchen
    other: RoomKind
    if room.kind in ("living", "bedroom") and ("kitchen" in room.names or cooks):
        other = room.kind
    elif room.kind == "kitchen" and room.face.area > _LARGE_KITCHEN_M2:
        other = "dining" if any(r.kind == "living" for r in rooms) else "living"
    else:
        return [room]
    parts = _split_off_kitchen(room)
    if parts is None:
        return [room]
    kitchen, rest = parts
    if other == "living" and room.kind == "kitchen" and rest.area < _LEAST_LIVING_M2:
        other = "dining"
    return [
        TracedRoom("kitchen", room.cell, frozenset({"kitchen"}), room.marks, kitchen),
        TracedRoom(other, room.cell, room.names - {"kitchen"}, room.marks, rest),
    ]


def _split_off_kitchen(room: TracedRoom) -> tuple[Polygon, Polygon] | None:
    """The shortest straight cut that leaves a usual kitchen around the counter, or None."""
    cooking = [mark for mark in room.marks if mark.label == "cooking_counter"]
    cooking = cooking or [mark for mark in room.marks if mark.label == "kitchen"]
    others = [m for m in room.marks if m.label in ("living_room", "bedroom")]
    if not cooking:
        return None
    best, least = None, float("inf")
    for cut in _cuts(room.face, cooking):
        parts = list(split(room.face, cut).geoms)
        if len(parts) != 2:
            continue
        for kitchen, rest in (parts, parts[::-1]):
            holds = all(kitchen.covers(Point(mark.center)) for mark in cooking)
            apart = not any(kitchen.covers(Point(mark.center)) for mark in others)
            usual = 3.5 <= kitchen.area <= 14.0 and rest.area >= 6.0
            length = cut.intersection(room.face).length
            # A kitchen of about 7 m2 is the most usual; a metre of cut weighs like 4 m2.
            cost = length + abs(kitchen.area - 7.0) / 4.0
            better = holds and apart and usual and cost < least
            thin = _is_thin(kitchen, 1.5) or _is_thin(rest, 1.8)
            if better and not thin and not any(map(_has_sliver, (kitchen, rest))):
                best, least = (kitchen, rest), cost
    return best


def _is_thin(face: Polygon, width_m: float) -> bool:
    return bool(face.buffer(-width_m / 2, join_style="mitre").is_empty)


def _has_sliver(face: Polygon) -> bool:
    """Whether a part of it is too thin to be a floor, and would make the wall behind it thicker."""
    half = _SLIVER_M / 2
    whole = face.buffer(-half, join_style="mitre").buffer(half, join_style="mitre")
    return bool(face.difference(whole).area > _SLIVER_M**2)


def _cuts(face: Polygon, cooking: Sequence[Mark]) -> list[LineString]:
    """Level and upright lines through corners of the room, and one step away from the counter."""
    left, low, right, high = face.bounds
    xs = {x for x, _ in face.exterior.coords}
    ys = {y for _, y in face.exterior.coords}
    for mark in cooking:
        for reach_m in (0.9, 1.3):
            xs |= {mark.x0 - reach_m, mark.x1 + reach_m}
            ys |= {mark.y0 - reach_m, mark.y1 + reach_m}
    upright = [LineString([(x, low - 1), (x, high + 1)]) for x in sorted(xs) if left < x < right]
    level = [LineString([(left - 1, y), (right + 1, y)]) for y in sorted(ys) if low < y < high]
    return upright + level
