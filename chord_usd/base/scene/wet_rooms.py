"""Which wet rooms of a home are bathrooms, washrooms and WCs: one most likely choice for all.

Plans, rasters and networks know one class, "bathroom". What is printed in a room, its size, what is
drawn in it, the doors between wet rooms and the needs of the home decide, all in nats.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import product

import shapely

from chord_usd.base.scene.drawn_pieces import drawn_items
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.types import WET_KINDS, Opening, Plan, Room, RoomKind

_USUAL_M2: Mapping[RoomKind, tuple[float, float]] = {
    "bathroom": (4.5, 0.5), "washroom": (3.2, 0.5), "wc": (1.6, 0.3),
}  # fmt: skip
"""Median, and standard deviation of the logarithm, of a room that is known to be of the kind."""
_MOST_OFF = 4.0
"""Nats of an unusual size, at most."""
_PRIOR: Mapping[RoomKind, float] = {"bathroom": 0.0, "washroom": -1.8, "wc": -0.5}
_NAMED: Mapping[RoomKind, float] = {"bathroom": 0.0, "washroom": 6.0, "wc": 3.0}
"""Nats of a name that says the kind. People call any wet room a bathroom, and some of them WC."""
_BATHING = frozenset(("bathtub", "shower"))
_DRAWN: Mapping[str, tuple[RoomKind, float]] = {
    "bathtub": ("bathroom", 6.0), "shower": ("bathroom", 6.0), "washing_machine": ("washroom", 2.0),
}  # fmt: skip
"""By what is drawn in a room: the kind it speaks for, and nats."""
_TOILET_IN_WASHROOM = 4.0
_BATH_ELSEWHERE = 2.0
"""Nats of no bath in a room where a bath is drawn in another."""
_BEHIND = 2.0
"""Nats of a washroom for each wet room that is entered through it, and against one behind it."""
_NO_BATH, _NO_TOILET = 6.0, 4.0
_MORE_BATHS, _MORE_WCS, _MORE_WASHROOMS = 1.0, 0.7, 3.0
"""Nats of the first of a kind that a home does not need; of the second twice as many."""
_SLEPT_IN = 2
"""Bedrooms that share a bath."""
_TITLES: Mapping[RoomKind, str] = {"bathroom": "Bathroom", "washroom": "Washroom", "wc": "WC"}
_NUMBERED = re.compile(r"(bathroom|wc)\s*\d*", re.IGNORECASE)
"""A name that says no more than the class."""
_MOST = 6
"""Rooms that are weighed together; of more, each by itself."""


def with_wet_kinds(plan: Plan, decided: Collection[str] = ()) -> Plan:
    """The plan with its wet rooms as bathrooms, washrooms and WCs.

    decided: ids of rooms whose kind somebody has said; what is a washroom stays one. plan.extra's
    "drawn" and "fixtures" ({category, x, y}, metres) say what is drawn where.
    """
    open_ids = [room.id for room in plan.rooms
                if room.kind in ("bathroom", "wc") and room.id not in decided]  # fmt: skip
    if not open_ids:
        return plan
    wet = [room for room in plan.rooms if room.kind in WET_KINDS]
    behind = _entered_through(wet, plan.openings)
    drawn = _drawn(plan, wet)
    bathed_in = {room_id for room_id, categories in drawn.items() if categories & _BATHING}
    nats = {room.id: _own_nats(room, drawn[room.id], behind) for room in wet}
    for room_id, room_nats in nats.items():
        room_nats["bathroom"] -= _BATH_ELSEWHERE * bool(bathed_in and room_id not in bathed_in)
    known = [room.kind for room in wet if room.id not in open_ids]
    bedrooms = sum(room.kind == "bedroom" for room in plan.rooms)
    chosen = _chosen([nats[room_id] for room_id in open_ids], known, bedrooms)
    kinds = dict(zip(open_ids, chosen, strict=True))
    rooms: list[Room] = []
    for room in plan.rooms:
        kind = kinds.get(room.id, room.kind)
        number = 1 + sum(room.kind == kind for room in rooms)
        is_new = kind != room.kind and _NUMBERED.fullmatch(room.name)
        name = f"{_TITLES[kind]} {number}" if is_new else room.name
        rooms.append(replace(room, kind=kind, name=name))
    return replace(plan, rooms=tuple(rooms))


def _chosen(
    nats: Sequence[Mapping[RoomKind, float]], known: Sequence[RoomKind], bedrooms: int
) -> tuple[RoomKind, ...]:
    if len(nats) > _MOST:
        return tuple(max(WET_KINDS, key=lambda kind: room_nats[kind]) for room_nats in nats)

    def weight(kinds: tuple[RoomKind, ...]) -> float:
        total = sum(room_nats[kind] for room_nats, kind in zip(nats, kinds, strict=True))
        return total - _missed((*known, *kinds), bedrooms)

    return max(product(WET_KINDS, repeat=len(nats)), key=weight)


def _missed(kinds: Sequence[RoomKind], bedrooms: int) -> float:
    """Nats of what a home of such wet rooms lacks, and has too much of."""
    baths, washrooms, closets = (kinds.count(kind) for kind in WET_KINDS)
    needed = max(1, math.ceil(bedrooms / _SLEPT_IN))
    extra = ((max(0, baths - needed), _MORE_BATHS), (max(0, closets - needed), _MORE_WCS),
             (max(0, washrooms - 1), _MORE_WASHROOMS))  # fmt: skip
    lacks = _NO_BATH * (not baths) + _NO_TOILET * (not baths + closets)
    return lacks + sum(cost * count * (count + 1) / 2 for count, cost in extra)


def _own_nats(
    room: Room, drawn: Collection[str], behind: Mapping[str, Collection[str]]
) -> dict[RoomKind, float]:
    area_m2 = room_polygon(room).area
    said = room_kind(room.name)
    scores: dict[RoomKind, float] = {}
    for kind in WET_KINDS:
        median, spread = _USUAL_M2[kind]
        off = 0.5 * (math.log(max(area_m2, 0.1) / median) / spread) ** 2
        scores[kind] = _PRIOR[kind] - min(off, _MOST_OFF) + _NAMED[kind] * (said == kind)
    for kind, nats in {_DRAWN[category] for category in drawn if category in _DRAWN}:
        scores[kind] += nats
    scores["washroom"] -= _TOILET_IN_WASHROOM * ("toilet" in drawn)
    before = sum(room.id in others for others in behind.values())
    scores["washroom"] += _BEHIND * (before - bool(behind[room.id]))
    return scores


def _entered_through(rooms: Iterable[Room], openings: Iterable[Opening]) -> dict[str, set[str]]:
    """By id of a wet room, the other wet room that its only ways lead into; else nothing."""
    ways = [opening for opening in openings if opening.kind != "window"]
    ids = {room.id for room in rooms}
    entered: dict[str, set[str]] = {}
    for room_id in ids:
        room_ways = [opening for opening in ways if room_id in opening.room_ids]
        beyond = {other for opening in room_ways for other in opening.room_ids} - {room_id}
        is_inner = (
            len(beyond) == 1
            and beyond <= ids
            and all(len(opening.room_ids) == 2 for opening in room_ways)
        )
        entered[room_id] = beyond if is_inner else set()
    return entered


def _drawn(plan: Plan, rooms: Sequence[Room]) -> dict[str, set[str]]:
    """By id of a room, the categories that its drawing shows, or that plan.extra's "fixtures" note
    there; these may hold anything."""
    noted = plan.extra.get("fixtures", ())
    seen = [(item.category, item.box.center_m[:2]) for item in drawn_items(plan.extra)]
    categories: dict[str, set[str]] = {room.id: set() for room in rooms}
    floors = [(room.id, room_polygon(room)) for room in rooms]
    for entry in noted if isinstance(noted, list | tuple) else ():
        x, y = (entry.get(axis) for axis in "xy") if isinstance(entry, Mapping) else (None, None)
        if isinstance(x, int | float) and isinstance(y, int | float):
            seen.append((str(entry.get("category")), (float(x), float(y))))
    for category, at in seen:
        for room_id, floor in floors:
            if floor.intersects(shapely.Point(at)):
                categories[room_id].add(category)
    return categories
