"""How a house is sampled: lists, kitchens and requests for its rooms, and faults of a sample."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import Item, Room, SceneGraph
from chord_usd.line.pipeline.as_drawn import with_locked

if TYPE_CHECKING:
    from chord_usd.base.metrics.design.view import View
    from chord_usd.line.compose.composer import Kitchens
    from chord_usd.line.lists.list_sampler import ListDrawer
    from chord_usd.line.lists.wishes import Asked, Piece

SEEDS_APART = 1_000_003
"""Between the seeds of draws, so that the next house's first is not this one's second."""

DRAFTS = 12
"""Lists drawn of each room; those with which room and home cost least are painted."""

LITTLE_EFFORT = 4
"""Of composing, where a kitchen is composed around each of many tables."""

WISH_DRAWS = 3
"""So often a room that lacks a piece that was wished for is drawn again."""

_SURE_DRAWN = 0.7
"""Score from which on drawn furniture stays, whatever it costs."""

_WISHED = 1.0
"""What a wish that is not granted weighs, beside what metrics.violations.room_faults weighs."""


@dataclass(frozen=True)
class Draw:
    """How a layout is sampled."""

    seed: int = 0
    steps: int | None = None
    sampler: str | None = None
    lists: ListDrawer | None = None
    """Decides which pieces a room has before they are painted; None leaves it to the painter."""
    asked: Mapping[str, Asked] = field(default_factory=dict)
    """Pieces that rooms must hold, by room id."""
    shut: frozenset[str] = frozenset()
    """Ids of rooms in which nothing stands: those of stairs."""
    composes: bool = False
    """Whether kitchens are composed before they are painted, and put back as composed."""
    locked: tuple[Item, ...] = ()
    """Pieces that the plan shows, as they stand in their rooms: they stay there."""
    shown: tuple[Item, ...] = ()
    """Kitchen units that the plan shows: kitchens are composed around them."""

    def holding(self, house: SceneGraph, *, aside: bool = True) -> SceneGraph:
        """The house with what is locked (as_drawn.with_locked)."""
        return with_locked(house, self.locked, aside=aside) if self.locked else house

    def listed(
        self, graph: SceneGraph, rooms: Sequence[Room], kept_ids: Collection[str] = ()
    ) -> SceneGraph | None:
        """The house with a list of pieces in place of the furniture of these rooms.

        kept_ids: items of the rooms that the lists hold, too. None without a list network.
        """
        if self.lists is None:
            return None
        from chord_usd.line.lists.house import Drafts, furnish_by_lists
        from chord_usd.line.lists.wishes import Asked

        graph = self.holding(graph, aside=False)
        decided = {item.room_id for item in graph.items if item.id in kept_ids}
        decided |= {room_id for room_id, wish in self.asked.items() if wish.is_asked}
        kept_ids = {*kept_ids, *(item.id for item in self.locked)}
        asked = {
            room.id: replace(
                self.asked.get(room.id, Asked()),
                kept=tuple(item for item in graph.items_of(room.id) if item.id in kept_ids),
            )
            for room in rooms
            if room.id not in self.shut
        }
        drafts = Drafts(self.seed, DRAFTS)
        ids = list(asked)
        listed = furnish_by_lists(graph.plan, self.lists, drafts, asked, ids, graph.items)
        listed = self.holding(listed)
        kitchens = self._kitchens(listed, rooms, asked)
        if not self.composes:
            return listed
        from chord_usd.line.compose.composer import displaced, with_kitchens
        from chord_usd.line.lists.put_back import put_back

        gone = {item.id for pieces in displaced(listed, kitchens).values() for item in pieces}
        drawn = with_kitchens(listed.without(gone), kitchens)

        def finish(house: SceneGraph) -> SceneGraph:
            new = {item.id for item in house.items if item.room_id in asked.keys() - decided}
            return arrange_drawn(house, self, new) if new else house

        def compose(view: View, stays: Sequence[Item]) -> Sequence[Item]:
            room = view.shell.room
            wish = replace(asked[room.id], kept=tuple(stays))
            composed = self._kitchens(listed, [room], {room.id: wish}, LITTLE_EFFORT)
            return composed.get(room.id, ())

        return put_back(finish(drawn), listed, asked, decided, finish, compose=compose)

    def freed(self, listed: SceneGraph) -> tuple[Draw, SceneGraph]:
        """This draw and its lists, without unsure drawn furniture in rooms that are better without.

        What a drawing shows stays; what was seen where nothing is drawn stands before wardrobes.
        Beds and fixtures are what rooms are for, and stay.
        """
        draw, faults = self, faults_by_room(listed, self)
        for room in listed.rooms:
            unsure = {
                item.id for item in self.locked
                if item.room_id == room.id and item.score < _SURE_DRAWN
                and item.category not in {"bed", *having("fixture")}
            }  # fmt: skip
            if not unsure or room.id not in faults:
                continue
            locked = tuple(item for item in draw.locked if item.id not in unsure)
            freer = replace(draw, locked=locked)
            bare = listed.without({item.id for item in listed.items_of(room.id)})
            again = freer.listed(bare, [room])
            if again and faults_by_room(again, freer).get(room.id, 0.0) < faults[room.id]:
                draw, listed = freer, again
        return draw, listed

    def _kitchens(
        self, house: SceneGraph, rooms: Sequence[Room], asked: Mapping[str, Asked], effort: int = 0
    ) -> Kitchens:
        """Units composed for the kitchens of a house, which holds what was placed in them."""
        if not self.composes:
            return {}
        from chord_usd.line.compose.composer import composed_kitchens, with_kitchens
        from chord_usd.line.compose.search import EFFORT

        composed = composed_kitchens(
            house, [room for room in rooms if room.id not in self.shut], self.seed,
            {room_id: wish.excluded for room_id, wish in asked.items()},
            {room_id: wish.kept for room_id, wish in asked.items()}, self.shown, effort or EFFORT,
        )  # fmt: skip
        made = with_kitchens(house, composed)

        def grants(room_id: str) -> bool:
            """Whether composing takes nothing away that is wished for."""
            wish = asked.get(room_id)
            if wish is None or not wish.wanted:
                return True
            before, after = (wish.missing(state.items_of(room_id)) for state in (house, made))
            return len(after) <= len(before)

        return {room_id: units for room_id, units in composed.items() if grants(room_id)}

    def heeded(
        self,
        graph: SceneGraph,
        listed: SceneGraph | None = None,
        rooms: Sequence[Room] | None = None,
        kept: Collection[Item] = (),
    ) -> SceneGraph:
        """A house that was read, without excluded pieces, kitchens as composed, and
        pieces as listed that were painted there but for a few pixels.

        listed: what was painted; without, kitchens are composed from what was read. rooms: those
        that were drawn, by default all. kept: pieces that stand in them and are not in the graph.
        """
        graph = self.holding(self._without_excluded(graph))
        if not self.composes:
            return graph
        from chord_usd.line.compose.composer import composed_of, put_back
        from chord_usd.line.lists.as_listed import read_as_listed
        from chord_usd.line.lists.wishes import Asked

        if listed is not None:
            graph = put_back(graph, composed_of(listed))
            ids = [room.id for room in (graph.rooms if rooms is None else rooms)]
            return read_as_listed(graph, listed, ids, {item.id for item in self.locked})
        rooms = graph.rooms if rooms is None else rooms
        asked = {
            room.id: replace(
                self.asked.get(room.id, Asked()),
                kept=tuple(item for item in kept if item.room_id == room.id),
            )
            for room in rooms
        }
        return put_back(graph, self._kitchens(graph, rooms, asked))

    def _without_excluded(self, graph: SceneGraph) -> SceneGraph:
        """Without excluded pieces, and the plumbing that the painter alone sees in a bare room."""
        from chord_usd.base.metrics.rooms import plumbing_elsewhere

        shut_out: dict[str, Collection[str]] = {
            room_id: wish.excluded for room_id, wish in self.asked.items()
        }
        strange = plumbing_elsewhere([room.kind for room in graph.rooms])
        for room in graph.rooms:
            wish = self.asked.get(room.id)
            if room.kind == "unknown" and not (wish and wish.is_asked):
                shut_out[room.id] = strange
        return graph.without(
            item.id
            for item in graph.items
            if item.room_id in self.shut or item.category in shut_out.get(item.room_id, ())
        )

    def lacking(self, graph: SceneGraph) -> dict[str, tuple[Piece, ...]]:
        """The required pieces that rooms lack, by room id; of such rooms only."""
        lacks = {
            room_id: wish.missing(graph.items_of(room_id)) for room_id, wish in self.asked.items()
        }
        return {room_id: pieces for room_id, pieces in lacks.items() if pieces}

    def refuse_lacking(self, graph: SceneGraph) -> None:
        """Raises ChordError for a required piece that a room lacks."""
        for room_id, pieces in self.lacking(graph).items():
            counts = Counter(piece.word or piece.category for piece in pieces)
            words = ", ".join(f"{n} × {word}" if n > 1 else word for word, n in counts.items())
            raise ChordError(
                f"no place was found for: {words}",
                where=self.asked[room_id].room,
                expected="what the room has place for",
                try_=("another <seed>", "less furniture"),
            )


def faults_by_room(graph: SceneGraph, draw: Draw | None = None) -> dict[str, float]:
    """How much is wrong in each room, by id (metrics.violations.room_faults); rooms that are right
    have none.

    draw: pieces that a room must hold and lacks count, too; an excluded piece is no fault.
    """
    from chord_usd.base.metrics.violations import room_faults

    asked = draw.asked if draw else {}
    each = room_faults(graph, graph.rooms, {key: wish.excluded for key, wish in asked.items()})
    faults = {room.id: fault for room, fault in zip(graph.rooms, each, strict=True) if fault}
    for room_id, pieces in (draw.lacking(graph) if draw else {}).items():
        faults[room_id] = faults.get(room_id, 0.0) + _WISHED * len(pieces)
    return faults


def arrange_drawn(graph: SceneGraph, draw: Draw, among: Collection[str] = ()) -> SceneGraph:
    """The house after the rules for what the last draw leaves. among: ids of items that may go."""
    from chord_usd.line.arrange.arrangement import Arrangement
    from chord_usd.line.arrange.rules import arrange

    def faults(house: SceneGraph) -> float:
        return sum(faults_by_room(house, draw).values())

    return arrange(Arrangement.of(graph, faults=faults, movable=among or None), "drawn")
