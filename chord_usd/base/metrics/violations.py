"""Everything that can be wrong with furniture on its floor: one list for all who ask.

Lists and second draws weigh it, rules mend it, cleaning takes it out, scores and the certificate
count it. What only meshes show (contacts, what floats) the certificate adds (check_stage.py).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import shapely

from chord_usd.base.metrics.clear_floor import blocked_openings
from chord_usd.base.metrics.complete import (
    ESSENTIALS,
    SHUT,
    UNDERSIZED,
    Fault,
    Homely,
    homely_rooms,
)
from chord_usd.base.metrics.design.shell import shells
from chord_usd.base.metrics.design.shut_leaves import stuck
from chord_usd.base.metrics.design.view import View
from chord_usd.base.metrics.overlap import Overlap, scene_overlap
from chord_usd.base.metrics.rooms import is_of_kind, mixed_kind, out_of_room
from chord_usd.base.metrics.walk import ways_shut
from chord_usd.base.scene.geometry import footprint_polygon, room_polygon
from chord_usd.base.scene.types import Item, Room, SceneGraph

Kind = Literal[
    "overlap", "out of room", "before an opening", "undersized", "out of reach", "misplaced",
    "missing",
]  # fmt: skip

WEIGHTS: Mapping[Kind, float] = {
    "overlap": 1.0, "out of room": 1.0, "before an opening": 0.3, "undersized": 0.5,
    "out of reach": 0.3, "misplaced": 0.2, "missing": 1.0,
}  # fmt: skip
"""What each weighs beside a square metre of overlap."""

_KINDS_OF: Mapping[Fault, Kind] = {UNDERSIZED: "undersized", SHUT: "out of reach"}
"""Faults of a place that weigh more than others."""

_OUT_OF_PLACE = 1.0
"""What a piece weighs in a room where its kind never stands, as a table in a bath."""

ROUNDING_M2 = 0.01
"""Less of a piece beyond its room's walls weighs nothing."""


@dataclass(frozen=True)
class Violation:
    """One thing that is wrong."""

    kind: Kind
    room: str
    """Id; empty for what stands in no room."""
    item: str = ""
    """Id of the piece; none where one is missing."""
    other: str = ""
    """The other piece, the opening, what is wrong with the place, or what is missing."""
    amount: float = 1.0
    """Square metres of an overlap and of floor beyond the room."""

    @property
    def items(self) -> tuple[str, ...]:
        """Ids of the pieces that it is about."""
        ids = (self.item, self.other) if self.kind == "overlap" else (self.item,)
        return tuple(item_id for item_id in ids if item_id)


def violations(
    graph: SceneGraph,
    *,
    overlap: Overlap | None = None,
    homely: Sequence[Homely] | None = None,
) -> list[Violation]:
    """What is wrong in a house: overlaps that are not natural, pieces and dressing beyond their
    room's floor or before openings, then what each room has wrong and lacks.

    overlap, homely: of the same house, where they are known.
    """
    things = (*graph.items, *graph.dressing)
    room_of = {item.id: room_id for item, room_id in _standing(things)}
    pairs = (overlap or scene_overlap(graph)).overlapping
    violated = [
        Violation("overlap", room_of[pair.a], pair.a, pair.b, pair.area_m2)
        for pair in pairs
        if not pair.natural
    ]
    violated += _beyond(graph)
    violated += [
        Violation("before an opening", room_of[block.item], block.item, block.opening)
        for block in blocked_openings(graph)
    ]
    for room in homely_rooms(graph) if homely is None else homely:
        violated += [
            Violation(_KINDS_OF.get(piece.fault, "misplaced"), room.room, piece.item, piece.fault)
            for piece in room.misplaced
        ]
        violated += [Violation("missing", room.room, other=name) for name in room.missing]
    return violated


def _standing(items: Iterable[Item], room_id: str = "") -> Iterator[tuple[Item, str]]:
    """Every piece, and what stands on it, with the room's id."""
    for item in items:
        place = room_id or item.room_id
        yield item, place
        yield from _standing(item.children, place)


def _beyond(graph: SceneGraph) -> Iterator[Violation]:
    floors = {room.id: room_polygon(room) for room in graph.rooms}
    out = set(out_of_room(graph))
    for item in (*graph.items, *graph.dressing):
        if item.id in out:
            floor = floors.get(item.room_id, shapely.Polygon())
            outside = shapely.difference(footprint_polygon(item.box), floor).area
            yield Violation("out of room", item.room_id, item.id, amount=float(outside))


def room_faults(
    graph: SceneGraph,
    rooms: Sequence[Room],
    excluded: Mapping[str, Collection[str]] | None = None,
    *,
    unpainted: bool = False,
) -> list[float]:
    """How much is wrong in each of these rooms, by WEIGHTS; 0 is good.

    Per piece: a total would favour short lists. Pieces that stand in no room of its kind count, as
    a table in a bathroom does. Then essentials that are missing, but for excluded
    categories, by room id, pieces that a wall keeps shut, which serve as little as missing ones,
    and doors that one does not get to from others of the room.

    unpainted: whether what stands before openings is missing, since the painter may not paint it.
    """
    violated = violations(graph)
    blocked = {violation.item for violation in violated if violation.kind == "before an opening"}
    if unpainted and blocked:
        stays = homely_rooms(graph.without(blocked))
        violated = [violation for violation in violated if violation.kind != "missing"]
        violated += [Violation("missing", room.room, other=name) for room in stays
                  for name in room.missing]  # fmt: skip
    pieces = Counter(item.room_id for item in graph.items)
    by_id = {room.id: room for room in rooms}
    faults = dict.fromkeys(by_id, 0.0)
    mixed = mixed_kind([room.kind for room in graph.rooms])
    for item in graph.items:
        room = by_id.get(item.room_id)
        if room is not None and not is_of_kind(item, room.kind, mixed):
            faults[room.id] += _OUT_OF_PLACE / max(1, pieces[room.id])
    for violation in violated:
        room = by_id.get(violation.room)
        if room is None or (violation.kind == "out of room" and violation.amount <= ROUNDING_M2):
            continue
        if violation.kind != "missing":
            faults[room.id] += WEIGHTS[violation.kind] * violation.amount / max(1, pieces[room.id])
        elif not _is_excluded(violation.other, room, excluded or {}):
            faults[room.id] += WEIGHTS["missing"]
    known = shells(graph.rooms, graph.openings)
    for room in rooms:
        faults[room.id] += WEIGHTS["before an opening"] * ways_shut(graph, room)
        view = View(known[room.id], tuple(graph.items_of(room.id)))
        faults[room.id] += WEIGHTS["missing"] * int(stuck(view).sum())
    return [round(fault, 4) for fault in faults.values()]


def _is_excluded(name: str, room: Room, excluded: Mapping[str, Collection[str]]) -> bool:
    """Whether a room must not hold one of its essentials."""
    categories = {essential.name: essential.categories for essential in ESSENTIALS[room.kind]}
    return bool(categories.get(name, frozenset()).intersection(excluded.get(room.id, ())))
