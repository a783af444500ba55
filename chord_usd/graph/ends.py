"""Kitchen units end where the floor begins that a door keeps free: units are made to measure.

In a galley the model paints them a few centimetres too deep, or runs them on past the door. Other
furniture comes in its sizes and is not cut.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace

import shapely

from chord_usd.geometry import footprint_polygon, to_own, to_world
from chord_usd.graph.fit import is_built_in
from chord_usd.graph.match import Database, match_assets
from chord_usd.metrics.openings import blocked_openings, clearances
from chord_usd.palette import Category, category
from chord_usd.types import MOVED, Box, Item, SceneGraph

_CLEAR_M = 0.001
"""Beyond the floor that stays free, against rounding."""


def end_before_openings(graph: SceneGraph, database: Database) -> SceneGraph:
    """The graph with kitchen units cut back that stand in the way of a door or window.

    The largest part is left that stands against the wall beside the free floor, if it is as large
    as the smallest usual unit; else the unit stays as it is. It gets a mesh of its new size, and
    how far its edge went is noted in its extra. Raises AssetError.
    """
    kept_free: defaultdict[str, list[shapely.Geometry]] = defaultdict(list)
    for opening, floor in clearances(graph.rooms, graph.openings):
        kept_free[opening.id].append(floor)
    in_the_way: defaultdict[str, list[shapely.Geometry]] = defaultdict(list)
    for blocked in blocked_openings(graph):
        in_the_way[blocked.item] += kept_free[blocked.opening]
    items = tuple(
        _ended(item, in_the_way[item.id]) if item.id in in_the_way else item for item in graph.items
    )
    return match_assets(replace(graph, items=items), database)


def _ended(item: Item, floors: Iterable[shapely.Geometry]) -> Item:
    """The item beside these floors; without a mesh where it had to be cut."""
    row = category(item.category)
    if not is_built_in(row):
        return item
    box = item.box
    for floor in floors:
        shared = footprint_polygon(box).intersection(floor)
        if shared.is_empty:
            continue
        parts = [part for part in _parts_beside(box, shared) if _is_usual(part, row)]
        if not parts:
            return item
        box = max(parts, key=lambda part: part.size_m[0] * part.size_m[1])
    cut_m = max(item.box.size_m[0] - box.size_m[0], item.box.size_m[1] - box.size_m[1])
    if cut_m <= 0.0:
        return item
    return replace(item, box=box, asset=None, extra={**item.extra, MOVED: round(cut_m, 6)})


def _parts_beside(box: Box, shared: shapely.Geometry) -> Iterable[Box]:
    """What is left of a box to the left of a shape, to its right and behind it."""
    own = to_own(box, shapely.get_coordinates(shared))
    (left, _), (right, back) = own.min(axis=0) - _CLEAR_M, own.max(axis=0) + _CLEAR_M
    length, depth, height = box.size_m
    for low, high, front in (
        (-length / 2, left, -depth / 2),
        (right, length / 2, -depth / 2),
        (-length / 2, length / 2, back),
    ):
        x, y = to_world(box, ((low + high) / 2, (front + depth / 2) / 2))
        size_m = (float(high - low), float(depth / 2 - front), height)
        yield Box((float(x), float(y), box.center_m[2]), size_m, box.yaw_deg)


def _is_usual(box: Box, row: Category) -> bool:
    return box.size_m[0] >= row.length_m[0] and box.size_m[1] >= row.width_m[0]
