"""Plan -> SceneGraph by lists alone: all rooms of a house together, the best of several drafts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from chord_usd.base.metrics.clear_floor import ClearFloors, clearances
from chord_usd.base.metrics.complete import ESSENTIALS, lacking
from chord_usd.base.metrics.rooms import stands_in
from chord_usd.base.metrics.violations import room_faults
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import ROOM_KINDS, Item, Plan, Room, SceneGraph
from chord_usd.line.lists.list_sampler import HEAT, Drawer, Drawn, Heat, Subject, without
from chord_usd.line.lists.piece_words import ANY_M
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
from chord_usd.line.lists.wishes import Asked, Piece

WISHED = 4
"""Times as many drafts."""

NEW_PLACES = Heat(places=0.6)
"""For pieces that stood wrongly: at the usual heat they would stand where they stood."""

ROUNDS = 4
"""So often at most drafts are drawn of a room, as long as the best of it has faults."""


@dataclass(frozen=True)
class Drafts:
    """How lists are drawn."""

    seed: int = 0
    count: int = 1
    """Of each room in a round, as long as it has faults: the same pieces in other places, WISHED
    times as many where something is wanted. The one with the fewest faults is taken."""
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
    rng = np.random.default_rng(drafts.seed)
    clear = ClearFloors(list(clearances(plan.rooms, plan.openings)))
    table = _Table(jobs, wishes, drawer, drafts, rng, clear)
    best: dict[int, _Try] = {}
    first: dict[int, Drawn] = {}
    due = list(range(len(jobs)))

    def keep_best(drawn: Mapping[int, Sequence[Drawn]]) -> list[int]:
        """Returns the rooms that still have faults."""
        _keep_best(house, jobs, wishes, table.told(drawn), best)
        return [at for at in due if best[at].key > _FAULTLESS]

    for _ in range(ROUNDS if drafts.count > 1 else 1):
        held = table.held(due, first)
        first = held | first
        due = keep_best({at: [own] for at, own in held.items()})
        due = keep_best(table.placed_anew({at: held[at] for at in due}))
        if not due:
            break
    return replace(house, items=(*there, *(item for at in sorted(best) for item in best[at].items)))


class _Try(NamedTuple):
    """A draft of a room that is the best so far."""

    key: tuple[int, float]
    """What it lacks of what is wanted, and its faults."""
    items: list[Item]


_FAULTLESS = (0, 0.0)


@dataclass(frozen=True, eq=False)
class _Table:
    """Where lists are drawn: rooms go by their number among the jobs."""

    jobs: Sequence[tuple[Room, Around]]
    wishes: Sequence[Asked]
    drawer: Drawer
    drafts: Drafts
    rng: np.random.Generator
    clear: ClearFloors

    def held(self, due: Sequence[int], before: Mapping[int, Drawn]) -> dict[int, Drawn]:
        """One list for each of these rooms; of several where there was one before, one that lacks
        least of what rooms of its kind cannot do without; of these the one nearest in length to
        that before that is not shorter, or else the longest.
        """
        order = [(at, own) for at in due for own in self._subjects(at, before.get(at))]

        def unlike(at: int, drawn: Drawn) -> tuple[int, int, int]:
            longer = len(drawn.elements) - (len(before[at].elements) if at in before else 0)
            return self._lacks(at, drawn), max(-longer, 0), abs(longer)

        return {
            at: min(own, key=lambda drawn: unlike(at, drawn))
            for at, own in self._drawn(order).items()
        }

    def _subjects(self, at: int, before: Drawn | None) -> list[Subject]:
        """What to draw lists of. A room of a size that is rare for its kind is taken for one of
        another kind, and its lists lack what its own needs: then some are of that alone."""
        if before is None:
            return [self._subject(at)]
        plain = [self._subject(at)] * self.drafts.count
        return plain + [self._as_its_kind(at)] * (len(plain) if self._lacks(at, before) else 0)

    def _as_its_kind(self, at: int) -> Subject:
        room, around = self.jobs[at]
        asked = self.wishes[at]
        held = [item.category for item in asked.kept]
        names = lacking(room.kind, room_polygon(room).area, held)
        wanted = []
        for essential in ESSENTIALS.get(room.kind, ()):
            known = sorted(essential.categories.difference(asked.excluded) & {*PIECES.categories})
            if essential.name in names and known:
                wanted.append(Piece(known[int(self.rng.integers(len(known)))]))
        # Nothing else: what the network would add is of the other kind.
        own = replace(asked, wanted=(*asked.wanted, *wanted), excluded=frozenset(PIECES.categories))
        return _subject(around, own)

    def _lacks(self, at: int, drawn: Drawn) -> int:
        room, _ = self.jobs[at]
        held = [PIECES.categories[one.category] for one in drawn.elements]
        return len(lacking(room.kind, room_polygon(room).area, held))

    def placed_anew(self, held: Mapping[int, Drawn]) -> dict[int, list[Drawn]]:
        """The rest of the drafts, of the same pieces in other places.

        What a room holds is drawn once: fewest faults among lists of any length would be fewest
        pieces.
        """
        order = []
        for at, drawn in held.items():
            count = self.drafts.count * (WISHED if self.wishes[at].wanted else 1) - 1
            order += [(at, _of_these(self._subject(at), drawn))] * count
        found = self._drawn(order, NEW_PLACES)
        # Once more, around pieces that were made as long as they are wanted.
        again = [
            (at, _lengthened(self._subject(at), self.jobs[at][1], self.wishes[at], drawn, nth))
            for at, own in found.items() if self.wishes[at].has_lengths
            for nth, drawn in enumerate((held[at], *own))
        ]  # fmt: skip
        for at, own in self._drawn(again, NEW_PLACES).items():
            found[at] += own
        return found

    def told(self, drawn: Mapping[int, Sequence[Drawn]]) -> dict[int, list[list[Item]]]:
        """As pieces in the plan."""
        return {at: [self._items(at, one) for one in own] for at, own in drawn.items()}

    def _items(self, at: int, drawn: Drawn) -> list[Item]:
        room, around = self.jobs[at]
        return [self.clear.below_sill(item) for item in items_from(drawn.elements, around, room.id)]

    def _subject(self, at: int) -> Subject:
        return _subject(self.jobs[at][1], self.wishes[at])

    def _drawn(
        self, order: Sequence[tuple[int, Subject]], heat: Heat = HEAT
    ) -> dict[int, list[Drawn]]:
        found: dict[int, list[Drawn]] = {}
        drawn = self.drawer.draw([subject for _, subject in order], self.rng, heat)
        for (at, _), one in zip(order, drawn, strict=True):
            found.setdefault(at, []).append(one)
        return found


def _of_these(subject: Subject, drawn: Drawn) -> Subject:
    """The subject that shall hold just what this list holds."""
    held = [one.category for one in drawn.elements]
    for one in subject.kept:
        if one.category in held:
            held.remove(one.category)
    return replace(subject, wanted=tuple(held), excluded=without(PIECES.categories, PIECES))


def _subject(around: Around, asked: Asked) -> Subject:
    return Subject(
        segments_of(around),
        around.facts,
        around.flags,
        wanted=tuple(PIECES.categories.index(one.category) for one in asked.missing(asked.kept)),
        excluded=without({*asked.excluded, *_foreign(around)}, PIECES),
        kept=tuple(pieces_of(asked.kept, around.frame)),
    )


def _foreign(around: Around) -> set[str]:
    """Categories that stand in no room of this kind. A garage as large as a living room would be
    furnished as one."""
    kind = ROOM_KINDS[int(around.facts[0])]
    return {name for name in PIECES.categories if not stands_in(name, kind)}


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


def _keep_best(
    house: SceneGraph,
    jobs: Sequence[tuple[Room, Around]],
    wishes: Sequence[Asked],
    told: Mapping[int, Sequence[list[Item]]],
    best: dict[int, _Try],
) -> None:
    """Of each room, keep the draft that lacks the least of what is wanted, then has the fewest
    faults. told: drafts by number of the job."""
    rooms = [jobs[at][0] for at in told]
    settled = [item for at, one in best.items() if at not in told for item in one.items]
    for draft in range(max(map(len, told.values()), default=0)):
        tried = {at: own[draft % len(own)] for at, own in told.items()}
        items = (*house.items, *settled, *(item for own in tried.values() for item in own))
        faults = room_faults(replace(house, items=items), rooms, unpainted=True)
        for (at, own), fault in zip(tried.items(), faults, strict=True):
            found = _Try((len(wishes[at].missing(own)), fault), own)
            if at not in best or found.key < best[at].key:
                best[at] = found
