"""Rooms drawn again: the floor of some rooms is sampled anew, given what stands in the others.

For somebody who wants another arrangement, and for what a first draw got wrong: a room that lacks
what its kind cannot do without, or has a piece in another or before a door.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.errors import ChordError
from chord_usd.base.raster import canvas
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import (
    BoolArray,
    ByteArray,
    Item,
    LayoutImage,
    PixelFrame,
    Plan,
    PlanImage,
    Room,
    SceneGraph,
    frozen_array,
)

if TYPE_CHECKING:
    from chord_usd.base.runtime.progress import Progress, Stopwatch
    from chord_usd.line.compose.kitchens import Kitchens
    from chord_usd.line.layout.sample import LayoutModel
    from chord_usd.line.lists.list_sampler import ListDrawer
    from chord_usd.line.lists.wishes import Asked, Piece

Read = Callable[[LayoutImage, Plan], SceneGraph]
"""Reads a layout in the rooms of its plan."""

Settle = Callable[[SceneGraph], SceneGraph]

_SEEDS_APART = 1_000_003
"""Between the seeds of draws, so that the next house's first is not this one's second."""

DRAFTS = 12
"""Lists drawn of each room; those with which room and home cost least are painted."""

WISH_DRAWS = 3
"""So often a room that lacks a piece that was wished for is drawn again."""

_WISHED = 1.0
"""What a wish that is not granted weighs, beside what metrics.violations.room_faults weighs."""

_BARRED = frozenset(("overlap", "before an opening", "out of room"))
"""What no piece that was wished for may have wrong."""

TOUCH_M2 = 1e-4
"""Footprints that share less only touch."""


@dataclass(frozen=True)
class Draw:
    """How a layout is sampled."""

    seed: int = 0
    steps: int | None = None
    sampler: str | None = None
    lists: ListDrawer | None = None
    """Decides which pieces a room has before they are painted; None leaves it to the painter."""
    asked: Mapping[str, Asked] = field(default_factory=dict)
    """What rooms shall hold, by room id."""
    shut: frozenset[str] = frozenset()
    """Ids of rooms in which nothing stands: those of stairs."""
    composes: bool = False
    """Whether kitchens are composed before they are painted, and put back as composed."""

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
        kitchens = self._kitchens(listed, rooms, asked)
        if not self.composes:
            return listed
        from chord_usd.line.compose.kitchens import displaced, with_kitchens
        from chord_usd.line.lists.put_back import put_back

        gone = {item.id for own in displaced(listed, kitchens).values() for item in own}
        drawn = with_kitchens(listed.without(gone), kitchens)
        decided = {room_id for room_id, own in asked.items() if own.is_asked}

        def finish(house: SceneGraph) -> SceneGraph:
            new = {item.id for item in house.items if item.room_id in asked.keys() - decided}
            return arrange_drawn(house, self, new) if new else house

        return put_back(finish(drawn), listed, asked, decided, finish)

    def _kitchens(
        self, house: SceneGraph, rooms: Sequence[Room], asked: Mapping[str, Asked]
    ) -> Kitchens:
        """Units composed for the kitchens of a house, which holds what was placed in them."""
        if not self.composes:
            return {}
        from chord_usd.line.compose.kitchens import composed_kitchens, with_kitchens

        found = composed_kitchens(
            house, [room for room in rooms if room.id not in self.shut], self.seed,
            {room_id: own.excluded for room_id, own in asked.items()},
            {room_id: own.kept for room_id, own in asked.items()},
        )  # fmt: skip
        made = with_kitchens(house, found)

        def grants(room_id: str) -> bool:
            """Whether composing takes nothing away that is wished for."""
            own = asked.get(room_id)
            if own is None or not own.wanted:
                return True
            before, after = (own.missing(one.items_of(room_id)) for one in (house, made))
            return len(after) <= len(before)

        return {room_id: units for room_id, units in found.items() if grants(room_id)}

    def heeded(
        self,
        graph: SceneGraph,
        listed: SceneGraph | None = None,
        rooms: Sequence[Room] | None = None,
        kept: Collection[Item] = (),
    ) -> SceneGraph:
        """A house that was read, without what its rooms shall not hold, kitchens as composed.

        listed: what was painted; without, kitchens are composed from what was read. rooms: those
        that were drawn, by default all. kept: pieces that stand in them and are not in the graph.
        """
        graph = self._without_excluded(graph)
        if not self.composes:
            return graph
        from chord_usd.line.compose.kitchens import composed_of, put_back
        from chord_usd.line.lists.wishes import Asked

        if listed is not None:
            return put_back(graph, composed_of(listed))
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
        shut_out = {room_id: own.excluded for room_id, own in self.asked.items()}
        return graph.without(
            item.id
            for item in graph.items
            if item.room_id in self.shut or item.category in shut_out.get(item.room_id, ())
        )

    def lacking(self, graph: SceneGraph) -> dict[str, tuple[Piece, ...]]:
        """The pieces that rooms lack of what they shall hold, by room id; of such rooms only."""
        lacks = {
            room_id: own.missing(graph.items_of(room_id)) for room_id, own in self.asked.items()
        }
        return {room_id: pieces for room_id, pieces in lacks.items() if pieces}

    def refuse_lacking(self, graph: SceneGraph) -> None:
        """Raises ChordError for a piece that a room shall hold and does not."""
        for room_id, pieces in self.lacking(graph).items():
            told = Counter(piece.word or piece.category for piece in pieces)
            words = ", ".join(f"{n} × {word}" if n > 1 else word for word, n in told.items())
            raise ChordError(
                f"no place was found for: {words}",
                where=self.asked[room_id].room,
                expected="what the room has place for",
                try_="another --seed, or less furniture",
            )


@dataclass(frozen=True, eq=False)
class Redrawn:
    """Layout rasters of a house of which some rooms were sampled anew."""

    before: LayoutImage
    """The house as it stands, drawn from its graph."""
    layout: LayoutImage
    """The same with the new furniture; every pixel outside the rooms is that of before."""
    alone: LayoutImage
    """The new furniture without that of other rooms, which would run into it where rooms touch."""
    listed: SceneGraph | None = None
    """What lists tell of the rooms; None without lists."""


@dataclass(frozen=True, eq=False)
class Mended:
    """A house after second draws."""

    graph: SceneGraph
    layout: LayoutImage
    rooms: tuple[str, ...]
    """Ids of the rooms whose furniture is that of a later draw."""
    left_out: tuple[str, ...] = ()
    """Ids of pieces in the layout that are not in the house."""


def faults_by_room(graph: SceneGraph, draw: Draw | None = None) -> dict[str, float]:
    """How much is wrong in each room, by id (metrics.violations.room_faults); rooms that are right
    have none.

    draw: what rooms shall hold and lack counts, too, and that they lack what they shall not hold is
    no fault.
    """
    from chord_usd.base.metrics.violations import room_faults

    asked = draw.asked if draw else {}
    found = room_faults(graph, graph.rooms, {key: own.excluded for key, own in asked.items()})
    faults = {room.id: fault for room, fault in zip(graph.rooms, found, strict=True) if fault}
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


def mend_rooms(
    graph: SceneGraph,
    layout: LayoutImage,
    plan_image: PlanImage,
    model: LayoutModel,
    read: Read,
    draw: Draw,
    *,
    times: int,
    settle: Settle | None = None,
    progress: Progress | None = None,
) -> Mended:
    """The house with those rooms drawn again that have faults; what costs less by planning rules
    and faults (metrics.design.price) is kept.

    graph: as read reads it in layout, which was drawn over plan_image. times: draws of a room that
    has faults; one that lacks what it shall hold is drawn WISH_DRAWS times at least, around pieces
    of lists, which have no meshes. settle: what is done to a draw before its faults are looked at.
    """
    from chord_usd.base.metrics.design.price import house_price

    later: dict[str, None] = {}
    out: dict[str, str] = {}

    def settled(house: SceneGraph) -> SceneGraph:
        return settle(house) if settle else house

    painted, graph = graph, settled(graph)
    out |= _gone(painted, graph)
    faults = faults_by_room(graph, draw)
    least = house_price(graph, faults)
    for attempt in range(1, max(times, WISH_DRAWS if draw.asked else 0) + 1):
        wrong = set(faults) if attempt <= times else set(draw.lacking(graph))
        rooms = [room for room in graph.rooms if room.id in wrong]
        if not rooms:
            break
        own = replace(draw, seed=draw.seed + attempt * _SEEDS_APART)
        for group in _drawn_together(rooms):
            base, given = with_wishes(graph, group, own) if draw.asked else (graph, frozenset())
            drawn = redraw_rooms(base, group, plan_image, model, own, kept_ids=given)
            given_items = [item for item in base.items if item.id in given]
            found = own.heeded(read(drawn.alone, graph.plan), drawn.listed, group, given_items)
            for room in group:
                items = tuple(item for item in base.items_of(room.id) if item.id in given)
                new = with_furniture(graph, room, items)
                painted = with_furniture(new, room, found.items_of(room.id), given)
                new = settled(painted)
                left = faults_by_room(new, draw)
                price = house_price(new, left)
                if price < least:
                    graph, layout, faults = new, pasted(layout, drawn.layout, room), left
                    least = price
                    later[room.id] = None
                    out = {one: at for one, at in out.items() if at != room.id}
                    out |= _gone(painted, new)
        if progress and attempt <= times:
            progress(attempt, times)
    return Mended(graph, layout, tuple(later), tuple(out))


def _gone(before: SceneGraph, after: SceneGraph) -> dict[str, str]:
    """The room's id by that of each piece that is no longer there."""
    there = {item.id for item in after.items}
    return {item.id: item.room_id for item in before.items if item.id not in there}


def redraw_rooms(
    graph: SceneGraph,
    rooms: Sequence[Room],
    plan_image: PlanImage,
    model: LayoutModel,
    draw: Draw,
    progress: Progress | None = None,
    kept_ids: Collection[str] = (),
) -> Redrawn:
    """Sample the floor of rooms whose walls run in one direction, given what stands elsewhere.

    plan_image: the raster of the graph's plan. kept_ids: items of the rooms that stay; what is
    sampled ends a pixel short of them.
    """
    from chord_usd.base.scene.pose import posed
    from chord_usd.line.layout.upright import direction_of, upright_sheet

    ids = {room.id for room in rooms}
    sheet = upright_sheet(graph.plan, rooms, direction_of(rooms[0]), plan_image)
    stay = [item for item in graph.items if item.room_id not in ids or item.id in kept_ids]
    around = posed(replace(graph, items=tuple(stay)), sheet.pose)
    labels, front = canvas.draw_items(around.items, sheet.image.frame)

    def free_floor(house: SceneGraph, frame: PixelFrame) -> BoolArray:
        kept = [item for item in house.items if item.id in kept_ids]
        own = [canvas.room_pixels(house.plan.room(room_id), frame) for room_id in sorted(ids)]
        free: BoolArray = np.logical_or.reduce(own) & ~canvas.taken_pixels(kept, frame)
        return free

    listed = draw.listed(graph, rooms, kept_ids)
    layout = model.resample(
        sheet.image, labels, front, free_floor(around, sheet.image.frame),
        seed=draw.seed, steps=draw.steps, sampler=draw.sampler,
        draft=sheet.draft(listed) if listed else None, progress=progress,
    )  # fmt: skip
    region = free_floor(replace(graph, items=tuple(stay)), plan_image.frame)
    before = canvas.layout_image(plan_image, graph.items)

    def in_rooms_else(drawn: ByteArray) -> LayoutImage:
        rgb = sheet.turned_back(layout.rgb, drawn, plan_image, region)
        return replace(layout, rgb=frozen_array(rgb, rgb.dtype), frame=plan_image.frame)

    return Redrawn(before, in_rooms_else(before.rgb), in_rooms_else(plan_image.rgb), listed)


def furnish_again(
    graph: SceneGraph,
    room: Room,
    plan_image: PlanImage,
    model: LayoutModel,
    read: Read,
    draw: Draw,
    kept_ids: Collection[str],
    watch: Stopwatch,
) -> tuple[Redrawn, SceneGraph]:
    """A room sampled anew, and the house with what was read in it; with the seed of the draw.

    One that lacks what it shall hold, or has it in the way, is sampled up to WISH_DRAWS times more,
    around pieces of lists, which have no meshes. Raises ChordError where it still lacks something.
    """
    for attempt in range(1 + (WISH_DRAWS if draw.asked else 0)):
        with watch.step("layout") as progress:
            own = replace(draw, seed=draw.seed + attempt * _SEEDS_APART)
            base, stay = with_wishes(graph, [room], own, kept_ids) if attempt else (graph, kept_ids)
            drawn = redraw_rooms(base, [room], plan_image, model, own, progress, stay)
        with watch.step("graph"):
            kept = [item for item in base.items if item.id in stay]
            found = own.heeded(read(drawn.alone, graph.plan), drawn.listed, [room], kept)
            made = replace(drawn.layout.provenance, seed=draw.seed)
            new = with_furniture(base, room, found.items_of(room.id), stay)
            new = replace(new, provenance=made)
        new = arrange_drawn(new, draw, {item.id for item in found.items})
        if not draw.lacking(new):
            break
    draw.refuse_lacking(new)
    before = canvas.layout_image(plan_image, graph.items)
    return replace(drawn, before=before, layout=replace(drawn.layout, provenance=made)), new


def with_wishes(
    graph: SceneGraph, rooms: Sequence[Room], draw: Draw, kept_ids: Collection[str] = ()
) -> tuple[SceneGraph, frozenset[str]]:
    """The house with nothing in the rooms that are asked for anything but what is kept and, from
    lists, what they shall hold, where that stands in nobody's way; and the ids of all that.

    What the painter will not paint is given to it, as what is kept is.
    """
    from chord_usd.base.metrics.violations import violations
    from chord_usd.line.lists.pieces import CATEGORY_ORDER

    # Lists of nothing else: the best of them has the best places for what is wished for.
    asked = {
        room_id: replace(own, excluded=frozenset(CATEGORY_ORDER))
        for room_id, own in draw.asked.items()
    }
    listed = replace(draw, asked=asked).listed(graph, rooms, kept_ids)
    given = set(kept_ids)
    for room in rooms:
        own = draw.asked.get(room.id)
        if own is None or listed is None:
            continue
        graph = with_furniture(graph, room, (), kept_ids)
        wanted = list(own.missing(graph.items_of(room.id)))
        for item in listed.items_of(room.id):
            met = next((piece for piece in wanted if piece.is_met_by(item)), None)
            stay = {one.id for one in graph.items_of(room.id)}
            tried = with_furniture(graph, room, [item], stay)
            new = {one.id for one in tried.items_of(room.id)} - stay
            wrong = {item_id for one in violations(tried) if one.kind in _BARRED
                     for item_id in one.items}  # fmt: skip
            if met and new and not new & wrong:
                wanted.remove(met)
                graph = tried
                given |= new
    return graph, frozenset(given)


def with_furniture(
    graph: SceneGraph, room: Room, new: Iterable[Item], kept_ids: Collection[str] = ()
) -> SceneGraph:
    """The graph with other furniture in one room. kept_ids: items of the room that stay."""
    stay = [item for item in graph.items if item.room_id != room.id or item.id in kept_ids]
    return replace(graph, items=(*stay, *_beside(new, stay, kept_ids)))


def _beside(new: Iterable[Item], stay: Sequence[Item], kept_ids: Collection[str]) -> Iterator[Item]:
    """New items of a room under ids of their own, without those that would stand in kept ones.

    Nothing is sampled where something is kept, but what is pulled to a wall may come in its way.
    """
    from chord_usd.base.scene.geometry import footprint_polygon

    kept = [
        (category(item.category).mount, footprint_polygon(item.box))
        for item in stay
        if item.id in kept_ids
    ]
    ids = {item.id for item in stay}
    for item in new:
        mount, shape = category(item.category).mount, footprint_polygon(item.box)
        if any(
            mount is other and shape.intersection(taken).area > TOUCH_M2 for other, taken in kept
        ):
            continue
        stem, number = item.id.rsplit("_", 1)
        own = next(i for n in count(int(number)) if (i := f"{stem}_{n}") not in ids)
        ids.add(own)
        yield replace(item, id=own)


def _drawn_together(rooms: Sequence[Room]) -> list[list[Room]]:
    """Rooms whose walls run in one direction are sampled at once: it takes as long as one does."""
    from chord_usd.line.layout.upright import rooms_by_direction

    return list(rooms_by_direction(rooms).values())


def pasted(layout: LayoutImage, other: LayoutImage, room: Room) -> LayoutImage:
    """The layout with the floor of a room as another one of the same frame has it."""
    floor = canvas.room_pixels(room, layout.frame)
    rgb = np.where(floor[..., None], other.rgb, layout.rgb)
    return replace(layout, rgb=frozen_array(rgb, np.uint8))
