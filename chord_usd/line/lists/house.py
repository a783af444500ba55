"""Plan -> SceneGraph by lists alone: all rooms of a house together, the best of several drafts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from chord_usd.base.metrics.clear_floor import ClearFloors, clearances
from chord_usd.base.metrics.complete import ESSENTIALS, lacking
from chord_usd.base.metrics.design import ROOM_RULES
from chord_usd.base.metrics.rooms import mixed_kind, plumbing_elsewhere, stands_in
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import Item, Plan, Room, SceneGraph
from chord_usd.line.lists.home_programme import (
    LAUNDRY_M2,
    Programme,
    programme_of,
    toilets_elsewhere,
)
from chord_usd.line.lists.list_sampler import HEAT, Drawer, Drawn, Heat, Subject, without
from chord_usd.line.lists.pieces import (
    PIECES,
    Around,
    Teacher,
    items_from,
    of_length,
    pieces_of,
    rooms_around,
    segments_of,
)
from chord_usd.line.lists.ranking import Ranking
from chord_usd.line.lists.vocabulary import ANY_M
from chord_usd.line.lists.wishes import Asked, Piece

WISHED = 4
"""Times as many drafts."""

NEW_PLACES = Heat(places=0.6)
"""For pieces that stood wrongly: at the usual heat they would stand where they stood."""

UNRULED = 3
"""Drafts of a room that no planning rule is asked of."""


@dataclass(frozen=True)
class Drafts:
    """How lists are drawn."""

    seed: int = 0
    count: int = 1
    """Whole lists of each room, WISHED times as many where something is wanted; the room and the
    home that cost least by metrics.design.price are taken."""
    teacher: Teacher = "homes"


def furnish_by_lists(
    plan: Plan,
    drawer: Drawer,
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
    spared = toilets_elsewhere(plan.rooms)
    drawn_as = [replace(wish, excluded=wish.excluded | {"toilet"}) if room.id in spared else wish
                for wish, (room, _) in zip(wishes, jobs, strict=True)]  # fmt: skip
    rng = np.random.default_rng(drafts.seed)
    clear = ClearFloors(list(clearances(plan.rooms, plan.openings)))
    table = _Table(
        jobs, drawn_as, drawer, drafts, rng, clear, programme_of(plan.rooms, plan.openings)
    )
    ranking = Ranking(house, [room for room, _ in jobs], wishes)
    ranking.weigh(table.as_pieces(table.whole()))
    short = [at for at in range(len(jobs)) if drafts.count > 1 and ranking.lacks(at)]
    ranking.weigh(table.as_pieces(table.of_their_kind(short)))
    return replace(house, items=(*there, *ranking.chosen()))


@dataclass(frozen=True, eq=False)
class _Table:
    """Where lists are drawn: rooms go by their number among the jobs."""

    jobs: Sequence[tuple[Room, Around]]
    wishes: Sequence[Asked]
    drawer: Drawer
    drafts: Drafts
    rng: np.random.Generator
    clear: ClearFloors
    programme: Programme

    def whole(self) -> dict[int, list[Drawn]]:
        """Lists of every room: what it holds, and where."""
        order = [
            (at, self._planned(at) if nth % 2 or self._is_slept_in(at) else self._subject(at))
            for at in range(len(self.jobs)) for nth in range(self._count(at))
        ]  # fmt: skip
        return self._lengthened(self._drawn(order))

    def _is_slept_in(self, at: int) -> bool:
        """Networks have learned beds in bedrooms only: elsewhere the programme has to name them."""
        room, _ = self.jobs[at]
        return room.kind == "living" and "bed" in self.programme.get(room.id, ())

    def _planned(self, at: int) -> Subject:
        """With what the home needs in a room, unless somebody says what it must hold."""
        room, around = self.jobs[at]
        asked = self.wishes[at]
        if asked.wanted or any(not item.facts.locked for item in asked.kept):
            return self._subject(at)
        needed = (Piece(name) for name in self.programme.get(room.id, ())
                  if name not in asked.excluded)  # fmt: skip
        return _subject(room, around, replace(asked, wanted=tuple(needed)))

    def of_their_kind(self, due: Sequence[int]) -> dict[int, list[Drawn]]:
        """Lists of what rooms of their kind need alone. A room of a size that is rare for its kind
        is taken for one of another kind, and its lists lack what its own needs."""
        order = [(at, self._as_its_kind(at)) for at in due for _ in range(self._count(at))]
        return self._lengthened(self._drawn(order))

    def _count(self, at: int) -> int:
        room, _ = self.jobs[at]
        wished = WISHED if self.wishes[at].wanted else 1
        ruled = room.kind in ROOM_RULES or room.kind in ESSENTIALS
        return max(1, wished * (self.drafts.count if ruled else min(UNRULED, self.drafts.count)))

    def _lengthened(self, lists: dict[int, list[Drawn]]) -> dict[int, list[Drawn]]:
        """The lists, and others around pieces that were made as long as they are wanted."""
        again = [
            (at, _lengthened(self._subject(at), self.jobs[at][1], self.wishes[at], drawn, nth))
            for at, drafts in lists.items() if self.wishes[at].has_lengths
            for nth, drawn in enumerate(drafts)
        ]  # fmt: skip
        for at, drafts in self._drawn(again, NEW_PLACES).items():
            lists[at] = lists[at] + drafts
        return lists

    def _as_its_kind(self, at: int) -> Subject:
        room, around = self.jobs[at]
        asked = self.wishes[at]
        held = [item.category for item in asked.kept]
        names = lacking(room.kind, room_polygon(room).area, held)
        wanted = [Piece("bed")] if self._is_slept_in(at) and "bed" not in held else []
        for essential in ESSENTIALS.get(room.kind, ()):
            known = sorted(essential.categories.difference(asked.excluded) & {*PIECES.categories})
            if essential.name in names and known:
                wanted.append(Piece(known[int(self.rng.integers(len(known)))]))
        # Nothing else: what the network would add is of the other kind.
        wish = replace(
            asked, wanted=(*asked.wanted, *wanted), excluded=frozenset(PIECES.categories)
        )
        return _subject(room, around, wish)

    def as_pieces(self, drawn: Mapping[int, Sequence[Drawn]]) -> dict[int, list[list[Item]]]:
        """As pieces in the plan."""
        return {at: [self._items(at, pieces) for pieces in lists] for at, lists in drawn.items()}

    def _items(self, at: int, drawn: Drawn) -> list[Item]:
        room, around = self.jobs[at]
        return [self.clear.below_sill(item) for item in items_from(drawn.elements, around, room.id)]

    def _subject(self, at: int) -> Subject:
        return _subject(*self.jobs[at], self.wishes[at])

    def _drawn(
        self, order: Sequence[tuple[int, Subject]], heat: Heat = HEAT
    ) -> dict[int, list[Drawn]]:
        by_room: dict[int, list[Drawn]] = {}
        drawn = self.drawer.draw([subject for _, subject in order], self.rng, heat)
        for (at, _), pieces in zip(order, drawn, strict=True):
            by_room.setdefault(at, []).append(pieces)
        return by_room


def _subject(room: Room, around: Around, asked: Asked) -> Subject:
    return Subject(
        segments_of(around),
        around.facts,
        around.flags,
        wanted=tuple(
            PIECES.categories.index(piece.category) for piece in asked.missing(asked.kept)
        ),
        excluded=without({*asked.excluded, *_foreign(room, around)}, PIECES),
        kept=tuple(pieces_of(asked.kept, around.frame)),
    )


def _foreign(room: Room, around: Around) -> set[str]:
    """Categories that stand in no such room. A garage as large as a living room would be
    furnished as one, and networks know all wet rooms as bathrooms.

    In a small bathroom a washing machine would take the place of the shower.
    """
    if room.kind == "unknown":
        return plumbing_elsewhere(around.kinds_of_home)
    mixed = mixed_kind(around.kinds_of_home)
    foreign = {name for name in PIECES.categories if not stands_in(name, room.kind, mixed)}
    is_small = room.kind == "bathroom" and room_polygon(room).area < LAUNDRY_M2
    return {*foreign, *(having("laundry") if is_small else ())}


def _lengthened(subject: Subject, around: Around, asked: Asked, drawn: Drawn, at: int) -> Subject:
    """The subject with pieces of the list in it, as long as they are wanted. at: number of a draft:
    each keeps another end in place."""
    given, wanted = list(subject.kept), list(subject.wanted)
    for piece in asked.missing(asked.kept):
        index = PIECES.categories.index(piece.category)
        same = [element for element in drawn.elements if element.category == index]
        nth = sum(item.category == index for item in given)
        if piece.length_m != ANY_M and nth < len(same):
            given.append(of_length(same[nth], around, piece.length_m, (0.5, 0.0, 1.0)[at % 3]))
            wanted.remove(index)
    return replace(subject, kept=tuple(given), wanted=tuple(wanted))
