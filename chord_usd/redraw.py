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
from chord_usd.errors import ChordError
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
    from chord_usd.lists.wishes import Asked, Piece
    from chord_usd.progress import Progress, Stopwatch

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

WISH_DRAWS = 3
"""So often a room that lacks a piece that was wished for is drawn again."""

_WISHED = 3
"""A wish that is not granted weighs as much as this many pieces in the way."""

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
        from chord_usd.lists.house import Drafts, furnish_by_lists
        from chord_usd.lists.wishes import Asked

        asked = {
            room.id: replace(
                self.asked.get(room.id, Asked()),
                kept=tuple(item for item in graph.items_of(room.id) if item.id in kept_ids),
            )
            for room in rooms
        }
        drafts = Drafts(self.seed, DRAFTS)
        return furnish_by_lists(graph.plan, self.lists, drafts, asked, list(asked), graph.items)

    def heeded(self, graph: SceneGraph) -> SceneGraph:
        """A house that was read, without what its rooms shall not hold."""
        shut_out = {room_id: own.excluded for room_id, own in self.asked.items()}
        return graph.without(
            item.id for item in graph.items if item.category in shut_out.get(item.room_id, ())
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
    graph: SceneGraph,
    essential: Mapping[RoomKind, tuple[str, ...]] = _ESSENTIAL,
    draw: Draw | None = None,
) -> Counter[str]:
    """How much is wrong in each room, by id; rooms that are right have none.

    Counted are pieces that stand in another or in the way of a door or window, scraps of pieces,
    second toilets, essential pieces that are missing, a room that the entrance does not lead to,
    and, _BARE times, a room to furnish without furniture of its kind (metrics has the terms).
    draw: what rooms shall hold and lack counts, too, and that they shall not is no fault.
    """
    from chord_usd.lists.wishes import Asked
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
        own = draw.asked.get(room.id, Asked()) if draw else Asked()
        needed = [name for name in essential.get(room.kind, ()) if name not in own.excluded]
        faults[room.id] += sum(not held[name] for name in needed)
        wanted = Counter(piece.category for piece in own.wanted)
        faults[room.id] += sum(max(held[name] - max(1, wanted[name]), 0) for name in _ONE_IS_ENOUGH)
    for room_id, pieces in (draw.lacking(graph) if draw else {}).items():
        faults[room_id] += _WISHED * len(pieces)
    return +faults


def _unlivable(graph: SceneGraph, draw: Draw) -> set[str]:
    """Ids of rooms to furnish that are bare, and of those with something before an opening that
    would not be left out."""
    from chord_usd.metrics.openings import blocked_openings
    from chord_usd.metrics.rooms import empty_rooms

    built = graph.without(_unbuildable(graph, draw))
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

    Rooms that lack what they shall hold are drawn again up to WISH_DRAWS times, whatever times is,
    around pieces of lists, which have no meshes.

    graph: as read reads it in layout, which was drawn over plan_image; times: draws, _MORE_DRAWS
    more for what nobody could live in, 0 for none at all.
    """
    later: dict[str, None] = {}
    faults = faults_by_room(graph, draw=draw) if times or draw.asked else Counter()
    most = times + _MORE_DRAWS if times else 0
    for attempt in range(1, max(most, WISH_DRAWS if draw.asked else 0) + 1):
        wrong = set(faults) if attempt <= times else set()
        if times < attempt <= most:
            wrong = _unlivable(graph, draw)
        if draw.asked:
            wrong |= set(draw.lacking(graph.without(_unbuildable(graph, draw) if times else ())))
        rooms = [room for room in graph.rooms if room.id in wrong]
        if not rooms:
            break
        own = replace(draw, seed=draw.seed + attempt * _SEEDS_APART)
        for group in _drawn_together(rooms):
            base, given = with_wishes(graph, group, own) if draw.asked else (graph, frozenset())
            drawn = redraw_rooms(base, group, plan_image, model, own, kept_ids=given)
            found = draw.heeded(read(drawn.alone, graph.plan))
            for room in group:
                items = tuple(item for item in base.items_of(room.id) if item.id in given)
                new = with_furniture(graph, room, items)
                new = with_furniture(new, room, found.items_of(room.id), given)
                left = faults_by_room(new, draw=draw)
                if left.total() < faults.total():
                    graph, layout, faults = new, _pasted(layout, drawn.layout, room), left
                    later[room.id] = None
        if progress and attempt <= times:
            progress(attempt, times)
    out = _unbuildable(graph, draw) if times else ()
    return Mended(graph.without(out), layout, tuple(later), out)


def _unbuildable(graph: SceneGraph, draw: Draw) -> tuple[str, ...]:
    """Ids of scraps, and of pieces in the way without which less is wrong, the least missed first.

    A bed before a window stays: a bedroom without one is worse.
    """

    def faults(out: tuple[str, ...]) -> int:
        return faults_by_room(graph.without(out), _WORTH_A_VIEW, draw).total()

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
            found = draw.heeded(read(drawn.alone, graph.plan))
            made = replace(drawn.layout.provenance, seed=draw.seed)
            new = with_furniture(base, room, found.items_of(room.id), stay)
            new = replace(new, provenance=made)
        if not draw.asked or not draw.lacking(new.without(_unbuildable(new, draw))):
            break
    draw.refuse_lacking(new)
    before = raster.layout_image(plan_image, graph.items)
    return replace(drawn, before=before, layout=replace(drawn.layout, provenance=made)), new


def with_wishes(
    graph: SceneGraph, rooms: Sequence[Room], draw: Draw, kept_ids: Collection[str] = ()
) -> tuple[SceneGraph, frozenset[str]]:
    """The house with nothing in the rooms that are asked for anything but what is kept and, from
    lists, what they shall hold, where that stands in nobody's way; and the ids of all that.

    What the painter will not paint is given to it, as what is kept is.
    """
    from chord_usd.lists.pieces import CATEGORY_ORDER
    from chord_usd.metrics.rooms import out_of_room

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
            in_the_way = {item_id for clash in _clashes(tried) for item_id in clash}
            if met and new and not new & {*in_the_way, *out_of_room(tried)}:
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
