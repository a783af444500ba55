"""Plan -> SceneGraph by lists alone: all rooms of a house together, the best of several drafts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
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
from chord_usd.metrics.complete import homely_rooms
from chord_usd.metrics.openings import blocked_openings
from chord_usd.metrics.overlap import items_overlap
from chord_usd.types import Item, Plan, Room, SceneGraph

OUTSIDE_M2 = 0.01
"""Less of a piece beyond its room's walls is rounding."""

BLOCKED, MISSING, MISPLACED = 0.3, 1.0, 0.2
"""What a blocked opening, something missing and a piece that stands wrongly weigh beside a square
metre of overlap."""


@dataclass(frozen=True)
class Drafts:
    """How lists are drawn."""

    seed: int = 0
    count: int = 1
    """Of each room; the one with the fewest faults is taken, of equal ones the likeliest."""
    heat: Heat = HEAT
    teacher: Teacher = "homes"


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
    subjects = [_subject(around, own) for (_, around), own in zip(jobs, wishes, strict=True)]
    rng = np.random.default_rng(drafts.seed)
    drawn = drawer.draw(subjects * drafts.count, rng, drafts.heat)
    if any(own.lengths for own in wishes):
        # Once more, around pieces that were made as long as they shall be.
        again = [
            _lengthened(subject, around, own, drawn[at], at)
            for at, (subject, (_, around), own) in enumerate(
                list(zip(subjects, jobs, wishes, strict=True)) * drafts.count
            )
        ]
        drawn = [*drawn, *drawer.draw(again, rng, drafts.heat)]
    tries = [
        [_told(room, around, one) for (room, around), one in zip(jobs, part, strict=True)]
        for part in _parts(drawn, len(jobs))
    ]
    rooms_drawn = [room for room, _ in jobs]
    best = tries[0] if len(tries) == 1 else _best(house, rooms_drawn, tries, wishes)
    return replace(house, items=(*there, *(item for own, _ in best for item in own)))


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


def _told(room: Room, around: Around, drawn: Drawn) -> tuple[list[Item], float]:
    """The pieces, and how likely what was said of each is: short lists gain nothing by it."""
    values = len(drawn.elements) * (1 + len(PIECES.slots)) + 1
    return items_from(drawn.elements, around, room.id), drawn.likelihood / values


def _parts(drawn: Sequence[Drawn], count: int) -> list[Sequence[Drawn]]:
    return [drawn[start : start + count] for start in range(0, len(drawn), count)] or [[]]


def _best(
    house: SceneGraph,
    rooms: Sequence[Room],
    tries: Sequence[Sequence[tuple[list[Item], float]]],
    wishes: Sequence[Asked],
) -> list[tuple[list[Item], float]]:
    """Of each room, the draft with the fewest faults, then the likeliest."""
    faults = [
        room_faults(
            replace(house, items=(*house.items, *(item for own, _ in one for item in own))), rooms
        )
        for one in tries
    ]
    best = []
    for index in range(len(rooms)):
        order = [
            (own[index] + MISSING * len(wishes[index].missing(one[index][0])), -one[index][1], i)
            for i, (own, one) in enumerate(zip(faults, tries, strict=True))
        ]
        best.append(tries[min(order)[2]][index])
    return best


def room_faults(graph: SceneGraph, rooms: Sequence[Room]) -> list[float]:
    """How much is wrong in each of these rooms; 0 is good.

    Per piece, in square metres or what weighs as much: pieces in each other, beyond walls, before
    openings, off their places. A total would favour short lists. Then essentials that are missing.
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
        faults.append(round(MISSING * len(found.missing) + total / max(1, len(items)), 4))
    return faults
