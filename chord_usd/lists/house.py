"""Plan -> SceneGraph by lists alone: all rooms of a house together, the best of several drafts."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from chord_usd.geometry import footprint_polygon, room_polygon
from chord_usd.lists.draw import HEAT, Drawn, Heat, ListDrawer, Subject, without
from chord_usd.lists.piece_words import ANY_M
from chord_usd.lists.pieces import (
    PIECES,
    Around,
    Teacher,
    items_from,
    of_length,
    pieces_of,
    rooms_around,
    segments_of,
)
from chord_usd.lists.wishes import Asked
from chord_usd.metrics.complete import ESSENTIALS, homely_rooms
from chord_usd.metrics.openings import blocked_openings
from chord_usd.metrics.overlap import items_overlap
from chord_usd.types import Item, Plan, Room, SceneGraph

OUTSIDE_M2 = 0.01
"""Less of a piece beyond its room's walls is rounding."""

BLOCKED, MISSING, MISPLACED = 0.3, 1.0, 0.2
"""What a blocked opening, something missing and a piece that stands wrongly weigh beside a square
metre of overlap."""

WISHED = 4
"""Times as many drafts."""


@dataclass(frozen=True)
class Drafts:
    """How lists are drawn."""

    seed: int = 0
    count: int = 1
    """Of each room, WISHED times as many where something is wanted; the one with the fewest faults
    is taken, of equal ones the likeliest."""
    heat: Heat = HEAT
    teacher: Teacher = "homes"


_Told = tuple[list[Item], float]
"""The pieces of a room, and how likely what was said of each is."""


def furnish_by_lists(
    plan: Plan,
    drawer: ListDrawer,
    drafts: Drafts,
    asked: Mapping[str, Asked] | None = None,
    rooms: Iterable[str] | None = None,
    standing: Sequence[Item] = (),
) -> SceneGraph:
    """The plan with the pieces that lists tell, where they tell them; heights are usual ones.

    asked: by room id. rooms: ids of those to furnish (all); in the others stays what is standing,
    and the lists know of it.
    """
    chosen = {room.id for room in plan.rooms} if rooms is None else set(rooms)
    there = [item for item in standing if item.room_id not in chosen]
    house = SceneGraph(plan.rooms, plan.openings, tuple(there), extra=plan.extra)
    others = {room.id for room in plan.rooms} - chosen
    arounds = rooms_around(house, drafts.teacher, others if others else None)
    jobs = [
        (room, around)
        for room, around in zip(plan.rooms, arounds, strict=True)
        if room.id in chosen
    ]
    wishes = [(asked or {}).get(room.id, Asked()) for room, _ in jobs]
    told = _drawn(jobs, wishes, drawer, drafts)
    tries = [
        [own[draft % len(own)] for own in told] for draft in range(max(map(len, told), default=1))
    ]
    rooms_drawn = [room for room, _ in jobs]
    best = tries[0] if len(tries) == 1 else _best(house, rooms_drawn, tries, wishes)
    return replace(house, items=(*there, *(item for own, _ in best for item in own)))


def _drawn(
    jobs: Sequence[tuple[Room, Around]], wishes: Sequence[Asked], drawer: ListDrawer, drafts: Drafts
) -> list[list[_Told]]:
    """All drafts of every room."""
    subjects = [_subject(around, own) for (_, around), own in zip(jobs, wishes, strict=True)]
    counts = [drafts.count * (WISHED if own.wanted else 1) for own in wishes]
    order = [at for draft in range(max(counts, default=0)) for at, n in enumerate(counts)
             if draft < n]  # fmt: skip
    rng = np.random.default_rng(drafts.seed)
    drawn = drawer.draw([subjects[at] for at in order], rng, drafts.heat)
    # Once more, around pieces that were made as long as they are wanted.
    sized = [nth for nth, at in enumerate(order) if wishes[at].has_lengths]
    again = [
        _lengthened(subjects[at], jobs[at][1], wishes[at], drawn[nth], nth)
        for nth, at in ((nth, order[nth]) for nth in sized)
    ]
    drawn = [*drawn, *drawer.draw(again, rng, drafts.heat)]
    told: list[list[_Told]] = [[] for _ in jobs]
    for at, one in zip([*order, *(order[nth] for nth in sized)], drawn, strict=True):
        told[at].append(_told(*jobs[at], one))
    return told


def _subject(around: Around, asked: Asked) -> Subject:
    return Subject(
        segments_of(around),
        around.facts,
        around.flags,
        wanted=tuple(PIECES.categories.index(one.category) for one in asked.missing(asked.kept)),
        excluded=without(asked.excluded, PIECES),
        kept=tuple(pieces_of(asked.kept, around.frame)),
    )


def _lengthened(subject: Subject, around: Around, asked: Asked, drawn: Drawn, at: int) -> Subject:
    """The subject with pieces of the list in it, as long as they are wanted. at: number of a draft:
    each keeps another end in place."""
    given, wanted = list(subject.kept), list(subject.wanted)
    for piece in asked.missing(asked.kept):
        index = PIECES.categories.index(piece.category)
        own = [one for one in drawn.elements if one.category == index]
        nth = sum(one.category == index for one in given)
        if piece.length_m != ANY_M and nth < len(own):
            given.append(of_length(own[nth], around, piece.length_m, (0.5, 0.0, 1.0)[at % 3]))
            wanted.remove(index)
    return replace(subject, kept=tuple(given), wanted=tuple(wanted))


def _told(room: Room, around: Around, drawn: Drawn) -> _Told:
    # Per value: short lists gain nothing by it.
    values = len(drawn.elements) * (1 + len(PIECES.slots)) + 1
    return items_from(drawn.elements, around, room.id), drawn.likelihood / values


def _best(
    house: SceneGraph,
    rooms: Sequence[Room],
    tries: Sequence[Sequence[_Told]],
    wishes: Sequence[Asked],
) -> list[_Told]:
    """Of each room, the draft that lacks the least of what is wanted, then has the fewest faults,
    then is the likeliest."""
    faults = [
        room_faults(
            replace(house, items=(*house.items, *(item for own, _ in one for item in own))), rooms
        )
        for one in tries
    ]
    best = []
    for index in range(len(rooms)):
        order = [
            (len(wishes[index].missing(one[index][0])), own[index], -one[index][1], i)
            for i, (own, one) in enumerate(zip(faults, tries, strict=True))
        ]
        best.append(tries[min(order)[-1]][index])
    return best


def room_faults(
    graph: SceneGraph,
    rooms: Sequence[Room],
    excluded: Mapping[str, Collection[str]] | None = None,
) -> list[float]:
    """How much is wrong in each of these rooms; 0 is good.

    Per piece, in square metres or what weighs as much: pieces in each other, beyond walls, before
    openings, off their places. A total would favour short lists. Then essentials that are missing,
    but for those of excluded categories, by room id.
    """
    blocked = {one.item for one in blocked_openings(graph)}
    homely = {one.room: one for one in homely_rooms(graph)}
    faults = []
    for room in rooms:
        items = tuple(graph.items_of(room.id))
        floor = room_polygon(room)
        overlap = items_overlap(items)
        total = sum(pair.area_m2 for pair in overlap.overlapping if not pair.natural)
        for item in items:
            outside = shapely.difference(footprint_polygon(item.box), floor).area
            total += outside if outside > OUTSIDE_M2 else 0.0
            total += BLOCKED * (item.id in blocked)
        found = homely[room.id]
        total += MISPLACED * len(found.misplaced)
        missing = [n for n in found.missing if not _is_excluded(n, room, excluded or {})]
        faults.append(round(MISSING * len(missing) + total / max(1, len(items)), 4))
    return faults


def _is_excluded(name: str, room: Room, excluded: Mapping[str, Collection[str]]) -> bool:
    """Whether an essential of a room is one that it shall not hold."""
    own = {one.name: one.categories for one in ESSENTIALS[room.kind]}
    return bool(own.get(name, frozenset()).intersection(excluded.get(room.id, ())))
