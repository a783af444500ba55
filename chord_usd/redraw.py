"""Rooms drawn again: the floor of some rooms is sampled anew, given what stands in the others.

For somebody who wants another arrangement, and for what a first draw got wrong. A room in twenty
comes out bare, or with a piece before a window or in another one; the next draw of it seldom does.
Nothing is moved: whatever stands in a house was placed by the model. What the last draw leaves and
nobody could build is left out: scraps, which only a doll's piece would fit, of two pieces that
stand in each other the one that is missed less, and what is before an opening and is not missed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from typing import TYPE_CHECKING

import numpy as np

from chord_usd import raster
from chord_usd.lists.house import Asked, Drafts, furnish_by_lists
from chord_usd.palette import category
from chord_usd.types import (
    BoolArray,
    ByteArray,
    Item,
    LayoutImage,
    PixelFrame,
    Plan,
    PlanImage,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)

if TYPE_CHECKING:
    from chord_usd.layout.sample import LayoutModel
    from chord_usd.lists.draw import ListDrawer
    from chord_usd.progress import Progress

Read = Callable[[LayoutImage, Plan], SceneGraph]
"""Reads a layout in the rooms of its plan."""

_BARE = 3
"""A room without furniture weighs as much as this many pieces in the way."""

_ESSENTIAL: dict[RoomKind, tuple[str, ...]] = {
    "bathroom": ("toilet",),
    "bedroom": ("bed",),
    "dining": ("dining_table",),
    "kitchen": ("sink_cabinet", "cooker_cabinet"),
    "living": ("sofa",),
    "study": ("table",),
}
"""What a room of a kind is not without: in the data at most one in twenty-five is."""

_WORTH_A_VIEW: dict[RoomKind, tuple[str, ...]] = {
    "bedroom": _ESSENTIAL["bedroom"],
    "kitchen": _ESSENTIAL["kitchen"],
}
"""What rather stands before an opening than not at all."""

_ONE_IS_ENOUGH = ("toilet", "shower", "bathtub")

_MORE_DRAWS = 3
"""Beyond those asked for, of rooms that are bare or have something before a door or window."""

_SEEDS_APART = 1_000_003
"""Between the seeds of draws, so that the next house's first is not this one's second."""

DRAFTS = 4
"""Lists drawn of each room, of which the best is painted."""

_TOUCH_M2 = 1e-4
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

    def listed(
        self, graph: SceneGraph, rooms: Sequence[Room], kept_ids: Collection[str] = ()
    ) -> SceneGraph | None:
        """The house with a list of pieces in place of the furniture of these rooms.

        kept_ids: items of the rooms that the lists hold, too. None without a list network.
        """
        if self.lists is None:
            return None
        asked = {
            room.id: replace(
                self.asked.get(room.id, Asked()),
                kept=tuple(item for item in graph.items_of(room.id) if item.id in kept_ids),
            )
            for room in rooms
        }
        drafts = Drafts(self.seed, DRAFTS)
        return furnish_by_lists(graph.plan, self.lists, drafts, asked, list(asked), graph.items)


@dataclass(frozen=True, eq=False)
class Redrawn:
    """Layout rasters of a house of which some rooms were sampled anew."""

    before: LayoutImage
    """The house as it stands, drawn from its graph."""
    layout: LayoutImage
    """The same with the new furniture; every pixel outside the rooms is that of before."""
    alone: LayoutImage
    """The new furniture without that of other rooms, which would run into it where rooms touch."""


@dataclass(frozen=True, eq=False)
class Mended:
    """A house after second draws."""

    graph: SceneGraph
    layout: LayoutImage
    rooms: tuple[str, ...]
    """Ids of the rooms whose furniture is that of a later draw."""
    left_out: tuple[str, ...] = ()
    """Ids of what was left out of the graph; the layout shows it."""


def faults_by_room(
    graph: SceneGraph, essential: Mapping[RoomKind, tuple[str, ...]] = _ESSENTIAL
) -> Counter[str]:
    """How much is wrong in each room, by id; rooms that are right have none.

    Counted are pieces that stand in another or in the way of a door or window, scraps of pieces,
    second toilets, essential pieces that are missing, a room that the entrance does not lead to,
    and, _BARE times, a room to furnish without furniture of its kind (metrics has the terms).
    """
    from chord_usd.metrics.rooms import empty_rooms
    from chord_usd.metrics.walk import walk

    home = {item.id: item.room_id for item in graph.items}
    faults = Counter(dict.fromkeys(empty_rooms(graph), _BARE))
    for clash in _clashes(graph):
        faults.update({home[item_id] for item_id in clash})
    faults.update(walk(graph).unreachable)
    faults.update(item.room_id for item in _scraps(graph))
    for room in graph.rooms:
        held = Counter(item.category for item in graph.items_of(room.id))
        faults[room.id] += sum(not held[name] for name in essential.get(room.kind, ()))
        faults[room.id] += sum(max(held[name] - 1, 0) for name in _ONE_IS_ENOUGH)
    return +faults


def _unlivable(graph: SceneGraph) -> set[str]:
    """Ids of rooms to furnish that are bare, and of those with something before an opening that
    would not be left out."""
    from chord_usd.metrics.openings import blocked_openings
    from chord_usd.metrics.rooms import empty_rooms

    built = graph.without(_unbuildable(graph))
    home = {item.id: item.room_id for item in built.items}
    return {*empty_rooms(built), *(home[blocked.item] for blocked in blocked_openings(built))}


def _clashes(graph: SceneGraph) -> Iterator[tuple[str, ...]]:
    """Ids of every two pieces that stand in each other, and of each piece before an opening."""
    from chord_usd.metrics.openings import blocked_openings
    from chord_usd.metrics.overlap import scene_overlap

    pieces = {item.id for item in graph.items}
    for pair in scene_overlap(graph).overlapping:
        if not pair.natural and pair.a in pieces:
            yield pair.a, pair.b
    for blocked in blocked_openings(graph):
        yield (blocked.item,)


def _scraps(graph: SceneGraph) -> list[Item]:
    return [item for item in graph.items if category(item.category).is_scrap(item.box.size_m)]


def mend_rooms(
    graph: SceneGraph,
    layout: LayoutImage,
    plan_image: PlanImage,
    model: LayoutModel,
    read: Read,
    draw: Draw,
    *,
    times: int,
    progress: Progress | None = None,
) -> Mended:
    """The house with those rooms drawn again that have faults; what has fewer of them is kept.

    graph: as read reads it in layout, which was drawn over plan_image; times: draws, _MORE_DRAWS
    more for what nobody could live in, 0 for none at all.
    """
    later: dict[str, None] = {}
    faults = faults_by_room(graph) if times else Counter()
    for attempt in range(1, times + _MORE_DRAWS + 1 if times else 1):
        wrong = faults if attempt <= times else _unlivable(graph)
        rooms = [room for room in graph.rooms if room.id in wrong]
        if not rooms:
            break
        own = replace(draw, seed=draw.seed + attempt * _SEEDS_APART)
        for group in _drawn_together(rooms):
            drawn = redraw_rooms(graph, group, plan_image, model, own)
            found = read(drawn.alone, graph.plan)
            for room in group:
                new = with_furniture(graph, room, found.items_of(room.id))
                left = faults_by_room(new)
                if left.total() < faults.total():
                    graph, layout, faults = new, _pasted(layout, drawn.layout, room), left
                    later[room.id] = None
        if progress and attempt <= times:
            progress(attempt, times)
    out = _unbuildable(graph) if times else ()
    return Mended(graph.without(out), layout, tuple(later), out)


def _unbuildable(graph: SceneGraph) -> tuple[str, ...]:
    """Ids of scraps, and of pieces in the way without which less is wrong, the least missed first.

    A bed before a window stays: a bedroom without one is worse.
    """

    def faults(out: tuple[str, ...]) -> int:
        return faults_by_room(graph.without(out), _WORTH_A_VIEW).total()

    out = tuple(item.id for item in _scraps(graph))
    while clashing := {item_id for clash in _clashes(graph.without(out)) for item_id in clash}:
        floor_m2 = {item.id: item.box.size_m[0] * item.box.size_m[1] for item in graph.items}
        left, _, worst = min((faults((*out, one)), floor_m2[one], one) for one in clashing)
        if left >= faults(out):
            break
        out = (*out, worst)
    return out


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
    from chord_usd.layout.upright import direction_of, upright_sheet
    from chord_usd.pose import posed

    ids = {room.id for room in rooms}
    sheet = upright_sheet(graph.plan, rooms, direction_of(rooms[0]), plan_image)
    stay = [item for item in graph.items if item.room_id not in ids or item.id in kept_ids]
    around = posed(replace(graph, items=tuple(stay)), sheet.pose)
    labels, front = raster.draw_items(around.items, sheet.image.frame)

    def free_floor(house: SceneGraph, frame: PixelFrame) -> BoolArray:
        kept = [item for item in house.items if item.id in kept_ids]
        own = [raster.room_pixels(house.plan.room(room_id), frame) for room_id in sorted(ids)]
        free: BoolArray = np.logical_or.reduce(own) & ~raster.taken_pixels(kept, frame)
        return free

    listed = draw.listed(graph, rooms, kept_ids)
    layout = model.resample(
        sheet.image, labels, front, free_floor(around, sheet.image.frame),
        seed=draw.seed, steps=draw.steps, sampler=draw.sampler,
        draft=sheet.draft(listed) if listed else None, progress=progress,
    )  # fmt: skip
    region = free_floor(replace(graph, items=tuple(stay)), plan_image.frame)
    before = raster.layout_image(plan_image, graph.items)

    def in_rooms_else(drawn: ByteArray) -> LayoutImage:
        rgb = sheet.turned_back(layout.rgb, drawn, plan_image, region)
        return replace(layout, rgb=frozen_array(rgb, rgb.dtype), frame=plan_image.frame)

    return Redrawn(before, in_rooms_else(before.rgb), in_rooms_else(plan_image.rgb))


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
    from chord_usd.geometry import footprint_polygon

    kept = [
        (category(item.category).mount, footprint_polygon(item.box))
        for item in stay
        if item.id in kept_ids
    ]
    ids = {item.id for item in stay}
    for item in new:
        mount, shape = category(item.category).mount, footprint_polygon(item.box)
        if any(
            mount is other and shape.intersection(taken).area > _TOUCH_M2 for other, taken in kept
        ):
            continue
        stem, number = item.id.rsplit("_", 1)
        own = next(i for n in count(int(number)) if (i := f"{stem}_{n}") not in ids)
        ids.add(own)
        yield replace(item, id=own)


def _drawn_together(rooms: Sequence[Room]) -> list[list[Room]]:
    """Rooms whose walls run in one direction are sampled at once: it takes as long as one does."""
    from chord_usd.layout.upright import rooms_by_direction

    return list(rooms_by_direction(rooms).values())


def _pasted(layout: LayoutImage, other: LayoutImage, room: Room) -> LayoutImage:
    """The layout with the floor of a room as another one of the same frame has it."""
    floor = raster.room_pixels(room, layout.frame)
    rgb = np.where(floor[..., None], other.rgb, layout.rgb)
    return replace(layout, rgb=frozen_array(rgb, np.uint8))
