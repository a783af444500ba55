"""Detections -> items: which room, what size and height, which mesh, which name."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from chord_usd.base.metrics.clear_floor import TOUCH_M, ClearFloors, clearances
from chord_usd.base.metrics.design.view import screenless
from chord_usd.base.runtime.asset_stages import try_assets
from chord_usd.base.scene.geometry import footprint_polygon, room_polygon, to_world
from chord_usd.base.scene.oriented_rect import Footprint
from chord_usd.base.scene.palette import Category, Level, Mount, category
from chord_usd.base.scene.types import (
    Asset,
    Box,
    Detection,
    Facts,
    Item,
    PixelFrame,
    Room,
    SceneGraph,
)
from chord_usd.base.scene.units import m_from_px, wrap_deg
from chord_usd.line.graph.flush import (
    ALIGN_BUILT_IN_DEG,
    ALIGN_DEG,
    align,
    flush_with_walls,
    kept_deep,
    parted,
)

if TYPE_CHECKING:
    from chord_usd.line.graph.snap import FoundItem

LEAST_INSIDE = 0.5
"""An item with less of its footprint in its room (grown by a pixel) is in no room, and dropped."""

FLUSH_PX = 0.55
"""Edges this close to a wall are on it: half a pixel of drawing, and some for rounding."""


_DESK = "table"
"""What a single person sits at, in bedrooms and studies."""
_AT_DESK_M = 0.4


class Database(Protocol):
    """Where meshes come from; chord_usd.library.database has it."""

    def nearest(
        self,
        name: str,
        size_m: tuple[float, float, float],
        most_height_m: float | None = None,
        /,
        *,
        at_desk: bool = True,
        variety: str | None = None,
        is_screenless: bool = False,
    ) -> Asset:
        """The mesh of this category whose size differs least, of those that are low enough.
        at_desk: elsewhere no chair swivels."""


def place_items(
    detected: Sequence[FoundItem],
    rooms: Sequence[Room],
    frame: PixelFrame,
) -> tuple[Item, ...]:
    """Items in the rooms they lie in, named per room; edges that are half a pixel from a wall or a
    neighbour's edge are on it.

    An item goes to the room that covers most of it. What lies in no room is dropped. Ids are
    room/category_n, counted in a fixed order: rooms as given, then category, then position.
    """
    floors = _Floors(rooms, frame.m_per_px)
    by_room: dict[int, list[tuple[FoundItem, Box]]] = defaultdict(list)
    for item in detected:
        box = box_of(item.detection, frame)
        index = floors.holding(footprint_polygon(box))
        if index is not None:
            by_room[index].append((item, box))
    items: list[Item] = []
    for index, room in enumerate(rooms):
        items += _items_of(room, by_room[index], FLUSH_PX * frame.m_per_px)
    return tuple(items)


def box_of(detection: Detection, frame: PixelFrame) -> Box:
    """The box of a detection: its footprint, with the usual height and mount of its category."""
    back_left, front_left, front_right, back_right = m_from_px(detection.corners_px, frame)
    row = category(detection.category)
    x, y = (back_left + front_left + front_right + back_right) / 4
    size_m = (
        float(np.hypot(*(front_right - front_left))),
        float(np.hypot(*(back_left - front_left))),
        sum(row.height_m) / 2,
    )
    center_m = (float(x), float(y), row.mount_height_m)
    return Box(center_m, size_m, _yaw_deg(front_right - front_left))


def items_seen(detections: Iterable[Detection], frame: PixelFrame) -> tuple[Item, ...]:
    """Detections as items just where they were seen, in no room and without meshes."""
    return tuple(
        Item(f"{detection.category}_{index}", detection.category, box_of(detection, frame))
        for index, detection in enumerate(detections)
    )


def match_assets(graph: SceneGraph, database: Database, but: Collection[str] = ()) -> SceneGraph:
    """Give every item without a mesh the nearest one: same category, least difference in size.

    Tabletop items and dressing too. Its box becomes what the mesh fills (fit.fitted_box); how far
    the mesh missed the box asked for is one of its facts. Raises AssetError when the database has
    nothing of a category, or a mesh that cannot be read. but: ids of items that stay as they are.
    """
    desks = shapely.union_all(
        [footprint_polygon(i.box) for i in graph.items if i.category == _DESK]
    )
    bare = screenless(graph)
    clear = ClearFloors(list(clearances(graph.rooms, graph.openings)))

    def matched(item: Item) -> Item:
        if item.id in but:
            return item
        best = _matched(item, database, desks, bare)
        if item.asset:
            return best
        # Pieces that came before a window after they were read know nothing of the sill.
        low = clear.below_sill(replace(item, box=best.box)).facts.below_sill_m
        if low is None or best.box.top_m <= low + TOUCH_M:
            return best
        return _matched(item.with_facts(below_sill_m=low), database, desks, bare)

    items, dressing = (tuple(map(matched, all_)) for all_ in (graph.items, graph.dressing))
    graph = replace(graph, items=items, dressing=dressing)
    try_assets(asset.usd_path for asset in graph.assets())
    return graph


def _matched(item: Item, database: Database, desks: BaseGeometry, bare: Collection[str]) -> Item:
    if item.asset:
        children = tuple(_matched(child, database, desks, bare) for child in item.children)
        return replace(item, children=children)
    facts = item.facts
    near = footprint_polygon(item.box).distance(desks) if item.category == "chair" else 0.0
    asset = database.nearest(
        item.category, item.box.size_m, facts.below_sill_m, at_desk=near < _AT_DESK_M,
        variety=facts.unit, is_screenless=item.id in bare,
    )  # fmt: skip
    missed_m = float(np.hypot(*np.subtract(asset.size_m[:2], item.box.size_m[:2])))
    # A picture from above shows no height.
    is_guess = (bool(facts.source_px) or facts.locked) and facts.unit is None
    box = fitted_box(item.box, asset, category(item.category), is_guess=is_guess)
    raised_m = box.size_m[2] - item.box.size_m[2]
    children = tuple(
        _matched(_raised(child, raised_m), database, desks, bare) for child in item.children
    )
    matched = replace(item, asset=asset, box=box, children=children)
    return matched.with_facts(asset_distance_m=round(missed_m, 6))


def _raised(child: Item, by_m: float) -> Item:
    """The child on a top that is higher by this much."""
    x, y, z = child.box.center_m
    return replace(child, box=replace(child.box, center_m=(x, y, z + by_m)))


def _yaw_deg(along: np.ndarray) -> float:
    """Yaw of an item whose own x axis points along this vector; quarter turns are exact."""
    yaw = float(np.degrees(np.arctan2(along[1], along[0])))
    nearest = round(yaw / 90.0) * 90.0
    return wrap_deg(nearest if abs(yaw - nearest) < 1e-6 else yaw)


class _Floors:
    """The rooms' floors, to ask which of them an item stands on."""

    def __init__(self, rooms: Sequence[Room], m_per_px: float) -> None:
        self.polygons = np.array([room_polygon(room) for room in rooms])
        # A thin panel may be painted up to a pixel off; it still touches its own room only.
        self.grown = shapely.buffer(self.polygons, m_per_px, join_style="mitre")
        self._tree = shapely.STRtree(self.grown)

    def holding(self, shape: Polygon) -> int | None:
        """Index of the room that covers most of a footprint; None if that is not enough of it."""
        near = np.sort(self._tree.query(shape, predicate="intersects"))
        if not len(near):
            return None
        shares = shapely.area(shapely.intersection(self.polygons[near], shape))
        if not shares.any():
            shares = shapely.area(shapely.intersection(self.grown[near], shape))
        best = int(near[shares.argmax()])
        inside = shapely.area(shapely.intersection(self.grown[best], shape))
        return best if 0.0 < inside >= LEAST_INSIDE * shape.area else None


def _items_of(room: Room, detected: Sequence[tuple[FoundItem, Box]], reach_m: float) -> list[Item]:
    boxes = _flush_boxes(room, detected, reach_m)
    placed = [(item, box) for (item, _), box in zip(detected, boxes, strict=True)]
    placed.sort(key=lambda pair: reading_order(pair[0].detection.category, pair[1]))
    counts: dict[str, int] = defaultdict(int)
    items = []
    for item, box in placed:
        name = item.detection.category
        items.append(_item(f"{room.id}/{name}_{counts[name]}", item, box, room.id))
        counts[name] += 1
    return items


def _flush_boxes(
    room: Room, detected: Sequence[tuple[FoundItem, Box]], reach_m: float
) -> list[Box]:
    """The boxes of a room, square to its walls; edges that lie within reach_m of a wall or of each
    other are on it."""
    on_wall = [category(item.detection.category).mount is Mount.WALL for item, _ in detected]
    footprints = [
        align(Footprint.of(box), room.polygon_m, _align_within_deg(item.detection.category))
        for item, box in detected
    ]
    for index, footprint in enumerate(footprints):
        others = footprints[:index] + footprints[index + 1 :]
        flush = flush_with_walls(footprint, room.polygon_m, reach_m, others)
        footprints[index] = kept_deep(footprint, flush) if on_wall[index] else flush
    apart = parted(footprints, reach_m, share=0.0)
    return [footprint.on(box) for footprint, (_, box) in zip(apart, detected, strict=True)]


def _align_within_deg(name: str) -> float:
    return ALIGN_BUILT_IN_DEG if is_built_in(category(name)) else ALIGN_DEG


def reading_order(name: str, box: Box) -> tuple[int, float, float]:
    """By which items are numbered, whatever order they were found in: category, then position."""
    x, y, _ = box.center_m
    return category(name).detector_class, round(x, 3), round(y, 3)


def _item(item_id: str, item: FoundItem, box: Box, room_id: str) -> Item:
    corners = np.round(item.detection.corners_px, 2).tolist()
    facts = Facts(
        source_px=tuple((x, y) for x, y in corners),
        front_from="mark" if item.front_seen else "wall",
        detected=item.in_detector,
    )
    score = round(item.detection.score, 4)
    return Item(item_id, item.detection.category, box, room_id, score=score, facts=facts)


# How a mesh fills the box that it was found for: stretched a little, never out of ----------------

MOST_STRETCH = 1.05
"""Most that one side of a mesh is stretched against another."""

MOST_DRESSING_STRETCH = 1.15


_OWN_HEIGHT_FROM = 0.85
"""A mesh that is scaled down less than this keeps its height."""


def is_built_in(row: Category) -> bool:
    """Whether pieces of a category stand in a run along their wall: kitchen units."""
    return row.rooms == ("kitchen",)


def fitted_box(box: Box, asset: Asset, row: Category, *, is_guess: bool) -> Box:
    """The part of box that the mesh fills, against the back of the box and in the middle of it.

    Length and width never exceed the box's, so that no new collision appears;
    where the mesh has other proportions, it fills less of the longer side. Panels on walls have no
    proportions to keep, and kitchens no gaps: they fill their box. is_guess: the height is the
    category's usual one, which no picture shows; the mesh brings its own. Dressing keeps its own
    size, or nearly; what hangs from above fills the height.
    """
    if row.level is Level.DRESSING:
        return _hung_box(box, asset, row)
    ratio = np.array(box.size_m) / np.array(asset.size_m)
    if row.mount is Mount.WALL or is_built_in(row):
        scale, least = ratio, 1.0
    else:
        least = float(ratio[:2].min())
        scale = np.minimum(ratio, least * MOST_STRETCH)
    if is_guess:
        scale[2] = min(1.0, least / _OWN_HEIGHT_FROM)
    size_m = np.round(np.array(asset.size_m) * scale, 6)
    x, y = to_world(box, (0.0, (box.size_m[1] - size_m[1]) / 2))
    length, width, height = (float(side) for side in size_m)
    return Box((float(x), float(y), box.center_m[2]), (length, width, height), box.yaw_deg)


def _hung_box(box: Box, asset: Asset, row: Category) -> Box:
    """What dressing fills, its back at the back of the box, its top or underside where that is."""
    most = MOST_DRESSING_STRETCH if "to_measure" in row.traits else 1.0
    ratio = np.array(box.size_m) / np.array(asset.size_m)
    scale = np.clip(ratio, 1.0 / most, most)
    if row.mount in (Mount.CEILING, Mount.WINDOW):
        scale[2] = ratio[2]
    length, width, height = (float(v) for v in np.round(np.array(asset.size_m) * scale, 6))
    at_wall = row.mount in (Mount.WALL, Mount.WINDOW)
    x, y = to_world(box, (0.0, (box.size_m[1] - width) / 2 if at_wall else 0.0))
    return Box((float(x), float(y), box.center_m[2]), (length, width, height), box.yaw_deg)
