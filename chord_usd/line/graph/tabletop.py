"""The second level of the scene graph: which pieces carry items, and what came to stand on them."""

from __future__ import annotations

import zlib
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import cv2
import numpy as np
import shapely

from chord_usd.base.metrics.clear_floor import sides_of
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.raster.relief import Relief, Reliefs
from chord_usd.base.raster.table_top import SIDES, Border, Side, TableTop
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    front_direction,
    room_polygon,
    to_own,
    to_world,
)
from chord_usd.base.scene.palette import CATEGORIES, having
from chord_usd.base.scene.trim import boards
from chord_usd.base.scene.types import Box, FloatArray, Item, Room, SceneGraph
from chord_usd.line.graph.match import Database
from chord_usd.line.graph.table_place import Laid, place_on

_HANGS_FROM_M = 0.3
"""What has its underside higher than this hangs, and things may be below it."""


@dataclass(frozen=True, eq=False)
class View:
    """A supporting piece as seen from above."""

    item: Item
    top: TableTop
    relief: Relief
    """Of its mesh, at its own size."""
    around: tuple[Box, ...]
    """What items on it could run into: what hangs in its room, rises beside it, or stands out of
    the walls."""

    @property
    def is_too_small(self) -> bool:
        """Whether nothing fits on it."""
        return is_too_small(self.top)

    def seed(self, house_seed: int) -> int:
        """A seed of its own, which what else is in the house does not change."""
        return zlib.crc32(f"{house_seed}/{self.item.id}".encode())

    def laid(self, things: Sequence[Item], database: Database, reliefs: Reliefs) -> Laid:
        """What was drawn for its top, standing on the piece."""
        return place_on(self.item, self.relief, things, database, reliefs, self.around)


class TopModel(Protocol):
    """What says what stands on tops: lists.top_lists.TopLister or graph.table_items.TopPainter."""

    @property
    def content_hash(self) -> str:
        """Of the weights."""

    def things(
        self, tops: Sequence[TableTop], seeds: Sequence[int], progress: Progress | None = None
    ) -> list[list[Item]]:
        """Things on each top, in its frame, without meshes; a top's seed alone varies its own."""


@dataclass(frozen=True, eq=False)
class Tabletops:
    """A house whose supporting pieces have been filled."""

    graph: SceneGraph
    laid: dict[str, Laid]
    """By id of the piece."""
    too_small: tuple[str, ...]
    """Pieces on which nothing fits."""

    @property
    def bare(self) -> tuple[str, ...]:
        """Pieces that are large enough and carry nothing all the same."""
        return tuple(name for name, laid in self.laid.items() if not laid.children)

    @property
    def items(self) -> int:
        """How many items stand on all pieces together."""
        return sum(len(laid.children) for laid in self.laid.values())

    @property
    def left_out(self) -> int:
        """How many were drawn and found no place to stand."""
        return sum(laid.left_out for laid in self.laid.values())


def table_views(graph: SceneGraph, reliefs: Reliefs, rooms: Collection[str] = ()) -> list[View]:
    """Every supporting piece with a mesh and nothing on it, in the order of the graph.

    rooms: ids of the rooms to look into, by default all.
    """
    chosen = set(rooms) or {room.id for room in graph.rooms}
    views = []
    trim = _boards(graph)
    for item in graph.items:
        carries = item.category in CATEGORIES and CATEGORIES[item.category].supports
        if not carries or item.asset is None or item.children or item.room_id not in chosen:
            continue
        relief = reliefs(item.asset).scaled(item.box.size_m)
        others = tuple(other for other in graph.items_of(item.room_id) if other.id != item.id)
        top = view_from_above(item, others, graph.plan.room(item.room_id), relief)
        around = [other.box for other in others if _can_be_hit(other, item)]
        views.append(View(item, top, relief, (*around, *trim.get(item.room_id, ()))))
    return views


def _boards(graph: SceneGraph) -> dict[str, list[Box]]:
    """Window boards, by id of the room that they stand out into."""
    by_room: dict[str, list[Box]] = {}
    for opening, room in sides_of(graph.openings, graph.rooms):
        by_room.setdefault(room.id, []).extend(boards(opening, room))
    return by_room


def _can_be_hit(other: Item, piece: Item) -> bool:
    """Whether what stands on a piece could run into another that is not below it.

    Chairs reach under a table, and what lies before them is not in their way.
    """
    base_m = other.box.center_m[2]
    if base_m > _HANGS_FROM_M:
        return True
    rises = base_m + other.box.size_m[2] > piece.box.top_m
    shared = footprint_polygon(other.box).intersection(footprint_polygon(piece.box))
    return bool(rises and shared.area <= MIN_OVERLAP_M2)


def lay_pieces(
    views: Sequence[View],
    model: TopModel,
    house_seed: int,
    database: Database,
    reliefs: Reliefs,
    progress: Progress | None = None,
) -> dict[str, Laid]:
    """What comes to stand on each piece that is not too small, by the id of the piece.

    All are drawn in one batch.
    """
    fitting = [view for view in views if not view.is_too_small]
    if not fitting:
        return {}
    tops, seeds = [view.top for view in fitting], [view.seed(house_seed) for view in fitting]
    drawn = model.things(tops, seeds, progress)
    return {
        view.item.id: view.laid(things, database, reliefs)
        for view, things in zip(fitting, drawn, strict=True)
    }


def with_items(graph: SceneGraph, views: Sequence[View], laid: dict[str, Laid]) -> Tabletops:
    """The graph with what was laid as children of its pieces."""
    items = tuple(
        replace(item, children=laid[item.id].children) if item.id in laid else item
        for item in graph.items
    )
    too_small = tuple(view.item.id for view in views if view.is_too_small)
    return Tabletops(replace(graph, items=items), laid, too_small)


# A supporting piece in its room -> its top view: the top of its mesh and what is beside ----------

SEATS = {row.name: row.seat_reach_m for row in CATEGORIES.values() if row.seat_reach_m}
"""What people sit on, and how far from a table they still sit at it, metres."""

SAT_AT = having("sat_at")
"""Supporting pieces that people sit at."""

BED_REACH_M, WALL_REACH_M = 0.25, 0.12
"""A bed or wall this near is beside the piece."""

LEAST_SIDE_M = 0.12
"""A top in which no square of this side fits is too small for anything."""

_LEAST_SEAT_M = 0.46
"""Width of a seat, as in the data."""

_WALL_SHARE = 0.6
_SAMPLES = 9


def view_from_above(item: Item, others: Iterable[Item], room: Room, relief: Relief) -> TableTop:
    """The top of a supporting piece.

    others: what else stands in the room. relief: of the piece's mesh at the size of the piece.
    """
    beside = [*_walls(item.box, room)]
    for other in others:
        beside += _neighbour(item, other)
    length, width, _ = item.box.size_m
    return TableTop(item.category, (length, width), relief.free, tuple(beside), room.kind)


def is_too_small(top: TableTop) -> bool:
    """Whether nothing fits on a top."""
    rows, columns = top.free.shape
    cell_m = max(top.size_m[0] / columns, top.size_m[1] / rows)
    padded = np.pad(top.free.astype(np.uint8), 1)
    reach_m = float(cv2.distanceTransform(padded, cv2.DIST_C, 3).max()) * cell_m
    return 2.0 * reach_m < LEAST_SIDE_M


def _walls(box: Box, room: Room) -> Iterator[Border]:
    floor = room_polygon(room)
    half = np.array(box.size_m[:2]) / 2
    for side in SIDES:
        axis, sign = _axis(side)
        points = np.zeros((_SAMPLES, 2))
        points[:, axis] = sign * (half[axis] + WALL_REACH_M)
        reach = half[1 - axis]
        points[:, 1 - axis] = np.linspace(-0.9 * reach, 0.9 * reach, _SAMPLES)
        world = to_world(box, points)
        outside = ~shapely.contains_xy(floor, world[:, 0], world[:, 1])
        if outside.mean() >= _WALL_SHARE:
            yield Border(side, "wall", -float(reach), float(reach))


def _neighbour(item: Item, other: Item) -> list[Border]:
    """The seat or bed that another item is to this one, if it is one."""
    is_seat = other.category in SEATS and item.category in SAT_AT
    is_bed = other.category == "bed" and item.category == "bedside_table"
    if other is item or not (is_seat or is_bed):
        return []
    reach_m = SEATS[other.category] if is_seat else BED_REACH_M
    if footprint_polygon(item.box).distance(footprint_polygon(other.box)) > reach_m:
        return []
    local = to_own(item.box, footprint(other.box))
    side = _side_of(local, item.box)
    axis, _ = _axis(side)
    if is_seat and not _faces(item.box, other.box):
        return []
    half = item.box.size_m[1 - axis] / 2
    low, high = local[:, 1 - axis].min(), local[:, 1 - axis].max()
    if is_bed or high - low > 2 * _LEAST_SEAT_M:
        low, high = max(float(low), -half), min(float(high), half)
        return [Border(side, "bed" if is_bed else "seat", low, high)] if low < high else []
    middle = float(np.clip((low + high) / 2, -half, half))
    return [Border(side, "seat", middle - _LEAST_SEAT_M / 2, middle + _LEAST_SEAT_M / 2)]


def _faces(table: Box, seat: Box) -> bool:
    """Whether who sits there has the table before them."""
    towards = np.array(table.center_m[:2]) - np.array(seat.center_m[:2])
    return bool(front_direction(seat.yaw_deg) @ towards > 0.3 * np.hypot(*towards))


def _side_of(corners: FloatArray, box: Box) -> Side:
    """The side that own corners (4, 2) lie beyond, or lie under least."""
    gaps = [
        (sign * corners[:, axis]).min() - box.size_m[axis] / 2
        for axis, sign in (_axis(side) for side in SIDES)
    ]
    return SIDES[int(np.argmax(gaps))]


def _axis(side: Side) -> tuple[int, float]:
    """Own axis that a side lies across, and its sign."""
    return {"back": (1, 1.0), "front": (1, -1.0), "left": (0, -1.0), "right": (0, 1.0)}[side]
