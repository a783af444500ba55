"""Rooms sampled again: the floor of some rooms of a house, given what stands in the others.

For another arrangement, and for faults of a first sample: a room that lacks what its kind cannot do
without, or has a piece in another or before a door.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from itertools import count
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.raster import canvas
from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import (
    BoolArray,
    ByteArray,
    Item,
    LayoutImage,
    PixelFrame,
    Plan,
    PlanImage,
    Provenance,
    Room,
    SceneGraph,
    frozen_array,
)
from chord_usd.base.scene.units import px_from_m
from chord_usd.line.pipeline.redraw import (
    SEEDS_APART,
    WISH_DRAWS,
    Draw,
    arrange_drawn,
    faults_by_room,
)

if TYPE_CHECKING:
    from chord_usd.base.runtime.progress import Progress
    from chord_usd.line.layout.sample import LayoutModel

Read = Callable[[LayoutImage, Plan], SceneGraph]
"""Reads a layout in the rooms of its plan."""

Settle = Callable[[SceneGraph], SceneGraph]

_BARRED = frozenset(("overlap", "before an opening", "out of room"))
"""What no piece that was wished for may have wrong."""

TOUCH_M2 = 1e-4
"""Footprints that share less only touch."""


@dataclass(frozen=True, eq=False)
class Redrawn:
    """Layout rasters of a house of which some rooms were sampled again."""

    layout: LayoutImage
    """The house with the new furniture; every pixel outside the rooms is as its graph draws it."""
    alone: LayoutImage
    """The new furniture without that of other rooms, which would run into it where rooms touch."""
    listed: SceneGraph | None = None
    """What lists tell of the rooms; None without lists."""


@dataclass(frozen=True, eq=False)
class Mended:
    """A house after second draws."""

    graph: SceneGraph
    layout: LayoutImage
    rooms: tuple[str, ...] = ()
    """Ids of the rooms whose furniture is that of a later draw."""
    gone: Mapping[str, str] = field(default_factory=dict)
    """Ids of pieces in the layout that are not in the house, each with its room's."""
    made: Provenance = field(default_factory=Provenance)
    """Of the last sample that was kept."""

    @property
    def left_out(self) -> tuple[str, ...]:
        """Ids of pieces in the layout that are not in the house."""
        return tuple(self.gone)

    def with_room(
        self, room: Room, painted: SceneGraph, settled: SceneGraph, layout: LayoutImage
    ) -> Mended:
        """With one room as it was painted in another layout, and then settled."""
        others = {item: at for item, at in self.gone.items() if at != room.id}
        rooms = dict.fromkeys((*self.rooms, room.id))
        gone = others | _gone(painted, settled)
        pictured = pasted(self.layout, layout, room)
        return Mended(settled, pictured, tuple(rooms), gone, layout.provenance)


@dataclass(frozen=True, eq=False)
class Sample:
    """Rooms of a house sampled again."""

    redrawn: Redrawn
    given: tuple[Item, ...]
    """What stood in the rooms while they were sampled."""
    read: SceneGraph
    """The house as read, without what was given."""

    def furnished(self, graph: SceneGraph, room: Room) -> SceneGraph:
        """The house with one of the rooms as sampled."""
        given = [item for item in self.given if item.room_id == room.id]
        kept_ids = {item.id for item in given}
        house = with_furniture(graph, room, given)
        return with_furniture(house, room, self.read.items_of(room.id), kept_ids)


@dataclass(frozen=True, eq=False)
class Resampler:
    """Samples rooms again until nothing is wrong in them, and keeps what costs less."""

    plan_image: PlanImage
    model: LayoutModel
    read: Read
    """Reads a layout in the rooms of the plan that plan_image shows."""
    draw: Draw
    kept_ids: Collection[str] = ()
    """Pieces of the rooms that stay; the rest is sampled around them."""
    step: Callable[[str], AbstractContextManager[Progress | None]] = lambda _: nullcontext()
    """Times the steps "layout" and "graph"."""

    def sample(self, graph: SceneGraph, rooms: Sequence[Room], attempt: int) -> Sample:
        """Rooms whose walls run in one direction, with the seed of this attempt.

        From the second attempt on requested pieces are placed from lists, before painting.
        """
        draw = replace(self.draw, seed=self.draw.seed + attempt * SEEDS_APART)
        base, stay = graph, frozenset(self.kept_ids)
        with self.step("layout") as progress:
            if attempt and draw.asked:
                base, stay = with_wishes(graph, rooms, draw, self.kept_ids)
            redrawn = redraw_rooms(base, rooms, self.plan_image, self.model, draw, progress, stay)
        given = tuple(item for item in base.items if item.id in stay)
        with self.step("graph"):
            read = self.read(redrawn.alone, graph.plan)
            return Sample(redrawn, given, draw.heeded(read, redrawn.listed, rooms, given))

    def resample(
        self,
        house: Mended,
        attempts: Iterable[int],
        due: Callable[[SceneGraph, int], Sequence[Room]],
        settle: Callable[[SceneGraph, Collection[str]], SceneGraph],
        cost: Callable[[SceneGraph], float],
        least: float,
    ) -> Mended:
        """Sample the rooms that are due until none is.

        Args:
            due: rooms to sample at an attempt.
            settle: arranges a house of which the pieces with these ids are new.
            cost: of a settled house; a sample is kept that costs less than least and those before.
        """
        for attempt in attempts:
            rooms = due(house.graph, attempt)
            if not rooms:
                break
            for group in _drawn_together(rooms):
                sample = self.sample(house.graph, group, attempt)
                for room in group:
                    painted = sample.furnished(house.graph, room)
                    new = {item.id for item in painted.items_of(room.id)}
                    settled = settle(painted, new.difference(self.kept_ids))
                    price = cost(settled)
                    if price < least:
                        least = price
                        house = house.with_room(room, painted, settled, sample.redrawn.layout)
        return house


def listed_well(
    graph: SceneGraph, rooms: Sequence[Room], draw: Draw, times: int
) -> tuple[SceneGraph | None, frozenset[str], frozenset[str]]:
    """The house with lists, ids of rooms that they leave wrong, and of rooms with a later list.
    A room where something is wrong is listed again, so often at most, before anything is painted:
    what costs less stays."""
    from chord_usd.base.metrics.design.price import house_price

    listed = draw.listed(graph, rooms)
    if listed is None:
        return None, frozenset(), frozenset()
    faults, later = faults_by_room(listed, draw), set[str]()
    for attempt in range(1, times + 1):
        due = [room for room in rooms if room.id in faults and room.id not in draw.shut]
        if not due:
            break
        bare = listed.without(item.id for room in due for item in listed.items_of(room.id))
        again = replace(draw, seed=draw.seed + attempt * SEEDS_APART).listed(bare, due)
        assert again is not None
        for room in due:
            tried = with_furniture(listed, room, again.items_of(room.id))
            wrong = faults_by_room(tried, draw)
            if house_price(tried, wrong) < house_price(listed, faults):
                listed, faults = tried, wrong
                later.add(room.id)
    return listed, frozenset(faults), frozenset(later)


def mend_rooms(
    graph: SceneGraph,
    layout: LayoutImage,
    sampler: Resampler,
    *,
    times: int,
    spared: Collection[str] = (),
    settle: Settle | None = None,
    progress: Progress | None = None,
) -> Mended:
    """The house with those rooms sampled again that have faults; what costs less by planning rules
    and faults (metrics.design.price) is kept.

    graph: as the sampler reads it in layout. times: samples of a room that has faults; one that
    lacks a required piece is sampled WISH_DRAWS times at least. spared: ids of rooms that are
    sampled once, but for that. settle: what is done to a sample
    before its faults are looked at.
    """
    from chord_usd.base.metrics.design.price import house_price

    draw = sampler.draw
    faults = lru_cache(maxsize=4)(partial(faults_by_room, draw=draw))

    def attempts() -> Iterator[int]:
        for attempt in range(1, max(times, WISH_DRAWS if draw.asked else 0) + 1):
            yield attempt
            if progress and attempt <= times:
                progress(attempt, times)

    def due(house: SceneGraph, attempt: int) -> list[Room]:
        rooms = faults(house).keys() - (spared if attempt > 1 else ())
        wrong = {*(rooms if attempt <= times else ()), *draw.lacking(house)}
        return [room for room in house.rooms if room.id in wrong]

    def cost(house: SceneGraph) -> float:
        return house_price(house, faults(house))

    def settled(house: SceneGraph, _: Collection[str] = ()) -> SceneGraph:
        return settle(house) if settle else house

    first = settled(graph)
    start = Mended(first, layout, gone=_gone(graph, first))
    return sampler.resample(start, attempts(), due, settled, cost, cost(first))


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
        parts = [canvas.room_pixels(house.plan.room(room_id), frame) for room_id in sorted(ids)]
        free: BoolArray = np.logical_or.reduce(parts) & ~canvas.taken_pixels(kept, frame)
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

    return Redrawn(in_rooms_else(before.rgb), in_rooms_else(plan_image.rgb), listed)


def furnish_again(graph: SceneGraph, room: Room, sampler: Resampler) -> Mended:
    """The house with a room sampled again, with the seed of the draw, around what is kept.

    A room that lacks a requested piece, or has it in another, is sampled up to WISH_DRAWS times
    more. Raises ChordError where it still lacks something.
    """
    draw = sampler.draw

    def due(house: SceneGraph, attempt: int) -> list[Room]:
        return [room] if not attempt or draw.lacking(house) else []

    def settle(house: SceneGraph, new: Collection[str]) -> SceneGraph:
        return arrange_drawn(house, draw, new)

    def lacking(house: SceneGraph) -> float:
        return sum(map(len, draw.lacking(house).values()))

    before = canvas.layout_image(sampler.plan_image, graph.items)
    attempts = range(1 + (WISH_DRAWS if draw.asked else 0))
    made = sampler.resample(Mended(graph, before), attempts, due, settle, lacking, math.inf)
    draw.refuse_lacking(made.graph)
    note = replace(made.made, seed=draw.seed)
    return replace(
        made,
        graph=replace(made.graph, provenance=note),
        layout=replace(made.layout, provenance=note),
    )


def with_wishes(
    graph: SceneGraph, rooms: Sequence[Room], draw: Draw, kept_ids: Collection[str] = ()
) -> tuple[SceneGraph, frozenset[str]]:
    """The house with nothing in the rooms that are asked for anything but what is kept and, from
    lists, their required pieces, where these block nothing; and the ids of all that.

    What the painter will not paint is given to it, as what is kept is.
    """
    from chord_usd.base.metrics.violations import violations
    from chord_usd.line.lists.pieces import CATEGORY_ORDER

    # Lists of nothing else: the best of them has the best places for what is wished for.
    asked = {
        room_id: replace(wish, excluded=frozenset(CATEGORY_ORDER))
        for room_id, wish in draw.asked.items()
    }
    listed = replace(draw, asked=asked).listed(graph, rooms, kept_ids)
    given = set(kept_ids)
    for room in rooms:
        wish = draw.asked.get(room.id)
        if wish is None or listed is None:
            continue
        graph = with_furniture(graph, room, (), kept_ids)
        wanted = list(wish.missing(graph.items_of(room.id)))
        for item in listed.items_of(room.id):
            met = next((piece for piece in wanted if piece.is_met_by(item)), None)
            stay = {item.id for item in graph.items_of(room.id)}
            tried = with_furniture(graph, room, [item], stay)
            new = {item.id for item in tried.items_of(room.id)} - stay
            wrong = {item_id for violation in violations(tried) if violation.kind in _BARRED
                     for item_id in violation.items}  # fmt: skip
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
        free = next(i for n in count(int(number)) if (i := f"{stem}_{n}") not in ids)
        ids.add(free)
        yield replace(item, id=free)


def _drawn_together(rooms: Sequence[Room]) -> list[list[Room]]:
    """Rooms whose walls run in one direction are sampled at once: it takes as long as one does."""
    from chord_usd.line.layout.upright import rooms_by_direction

    return list(rooms_by_direction(rooms).values())


def pasted(layout: LayoutImage, other: LayoutImage, room: Room) -> LayoutImage:
    """The layout with the floor of a room as another one of the same frame has it."""
    floor = canvas.room_pixels(room, layout.frame)
    rgb = np.where(floor[..., None], other.rgb, layout.rgb)
    return replace(layout, rgb=frozen_array(rgb, np.uint8))


# Rooms that the painter tore: where the list of a room keeps more planning rules than ------------

# painted after it, the room stands as it is listed.

TORN = 0.02
"""Share of a room's rules that the painter may break."""


def as_listed(
    graph: SceneGraph,
    listed: SceneGraph,
    layout: LayoutImage,
    plan_image: PlanImage,
    draw: Draw,
    settle: Callable[[SceneGraph], SceneGraph],
) -> tuple[SceneGraph, LayoutImage]:
    """The house with rooms as they are listed where that costs less once settled; its picture.

    graph: as it was read in the layout, which was painted over plan_image.
    """
    from chord_usd.base.metrics.design.price import room_prices

    def prices(house: SceneGraph) -> dict[str, float]:
        there = settle(house)
        return room_prices(there, faults_by_room(there, draw))

    painted, wanted = prices(graph), room_prices(listed, {})
    torn = [room for room in graph.rooms if painted[room.id] > wanted[room.id] + TORN]
    while torn:
        tried = graph
        for room in torn:
            pieces = (_seen(item, layout.frame) for item in listed.items_of(room.id))
            tried = with_furniture(tried, room, pieces)
        costs = prices(tried)
        better = [room for room in torn if costs[room.id] < painted[room.id] - TORN]
        if len(better) == len(torn):
            picture = canvas.layout_image(plan_image, listed.items)
            for room in torn:
                layout = pasted(layout, replace(layout, rgb=picture.rgb), room)
            return tried, layout
        torn = better
    return graph, layout


def _seen(item: Item, frame: PixelFrame) -> Item:
    """The piece as the picture shows it, which does not tell its height."""
    corners = px_from_m(footprint(item.box), frame).round(2).tolist()
    return item.with_facts(source_px=tuple((x, y) for x, y in corners), front_from="mark")
