"""Chairs as they stand at tables: they face them, and those of one table are a set.

Where tables are, the model paints chairs with torn edges and marks. Without a mark a chair says
nothing of its front, being about square and off the walls; and by their edges alone no two chairs
of a table would be of one size, and so of one design.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chord_usd.base.metrics.overlap import natural_partners
from chord_usd.base.scene.geometry import (
    footprint_polygon,
    front_direction,
    resized,
    to_own,
)
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Box, FloatArray, Item, SceneGraph
from chord_usd.base.scene.units import rotation_2d, wrap_deg
from chord_usd.line.arrange.arrangement import Arrangement

SEAT = "chair"
_TABLES = natural_partners(SEAT)
_AT_TABLE_M = 0.4
"""A chair this close to a table is one of its."""


def seat_chairs(work: Arrangement) -> SceneGraph:
    """The graph with chairs that face their tables, in sets of one size; meshes are to be matched.

    A chair whose front was seen faces as it did, and so does one at no table.
    """
    faced = tuple(_facing(item, work.graph.items) for item in work.graph.items)
    return _even_sets(work.holding(replace(work.graph, items=faced)))


def _table_of(chair: Item, items: Sequence[Item]) -> Item | None:
    """The nearest table of the chair's room, if it is near."""
    shape = footprint_polygon(chair.box)
    near = [
        (gap_m, item.id, item)
        for item in items
        if item.category in _TABLES
        and item.room_id == chair.room_id
        and (gap_m := shape.distance(footprint_polygon(item.box))) < _AT_TABLE_M
    ]
    return min(near)[2] if near else None


def _facing(item: Item, items: Sequence[Item]) -> Item:
    """A chair without a mark turned by quarters to its table, its footprint where it was."""
    if item.category != SEAT or item.facts.front_from != "wall":
        return item
    table = _table_of(item, items)
    if table is None:
        return item
    way = _inward(table.box, item.box)
    turned = [_turned(item.box, quarters) for quarters in range(4)]
    box = max(turned, key=lambda one: float(front_direction(one.yaw_deg) @ way))
    return replace(item, box=box).found(front_from="table")


def _inward(table: Box, chair: Box) -> FloatArray:
    """(2,) from the side of a table that a chair is at to the other one."""
    own = to_own(table, chair.center_m[:2])
    side = int(np.argmax(np.abs(own) - np.array(table.size_m[:2]) / 2))
    across = np.zeros(2)
    across[side] = -np.sign(own[side])
    return rotation_2d(table.yaw_deg) @ across


def _turned(box: Box, quarters: int) -> Box:
    """The same footprint, its front elsewhere."""
    length, depth, height = box.size_m
    if quarters % 2:
        length, depth = depth, length
    return Box(box.center_m, (length, depth, height), wrap_deg(box.yaw_deg + 90.0 * quarters))


def _even_sets(work: Arrangement) -> SceneGraph:
    """The graph with the chairs of each table in the middle one of their sizes, of usual ones.

    Their fronts stay where they were. A chair that would grow into something, or before a door,
    stays as it is.
    """
    items = {item.id: item for item in work.graph.items}
    for chairs in _sets(work.graph.items):
        length_m, depth_m = _usual_size_m(chairs)
        for chair in chairs:
            box = _sized(chair.box, length_m, depth_m)
            if work.free_places(chair, items.values()).has(box):
                items[chair.id] = replace(chair, box=box)
    return replace(work.graph, items=tuple(items.values()))


def _sets(items: Sequence[Item]) -> list[list[Item]]:
    """The chairs of each table, without undersized chairs."""
    row = category(SEAT)
    sets: defaultdict[str, list[Item]] = defaultdict(list)
    for item in items:
        if item.category == SEAT and not row.is_undersized(item.box.size_m):
            table = _table_of(item, items)
            if table is not None:
                sets[table.id].append(item)
    return list(sets.values())


def _sized(box: Box, length_m: float, depth_m: float) -> Box:
    """The box in another size, the middle of its front where it was."""
    return resized(box, (length_m, depth_m), (0.0, (depth_m - box.size_m[1]) / 2))


def _usual_size_m(chairs: Sequence[Item]) -> tuple[float, float]:
    row = category(SEAT)
    length_m, depth_m = np.median([chair.box.size_m[:2] for chair in chairs], axis=0)
    return float(np.clip(length_m, *row.length_m)), float(np.clip(depth_m, *row.width_m))
