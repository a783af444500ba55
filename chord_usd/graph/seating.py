"""Chairs whose front mark is torn face the table they stand at.

Without a mark a chair says nothing of its front: it is about square, and stands off the walls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chord_usd.geometry import footprint_polygon, front_direction, to_own
from chord_usd.graph.match import FRONT_FROM
from chord_usd.metrics.overlap import natural_partners
from chord_usd.types import Box, FloatArray, Item
from chord_usd.units import rotation_2d, wrap_deg

SEAT = "chair"
_TABLES = natural_partners(SEAT)
_AT_TABLE_M = 0.4
"""A chair this close to a table is one of its."""


def face_tables(items: Sequence[Item]) -> tuple[Item, ...]:
    """The items, chairs without a mark turned by quarters to the nearest table of their room.

    Their footprints stay. Chairs at no table keep the way they face.
    """
    tables = [item for item in items if item.category in _TABLES]
    return tuple(
        _facing(item, tables)
        if item.category == SEAT and item.extra.get(FRONT_FROM) == "wall"
        else item
        for item in items
    )


def _facing(chair: Item, tables: Sequence[Item]) -> Item:
    shape = footprint_polygon(chair.box)
    near = [
        (gap_m, table.id, table)
        for table in tables
        if table.room_id == chair.room_id
        and (gap_m := shape.distance(footprint_polygon(table.box))) < _AT_TABLE_M
    ]
    if not near:
        return chair
    way = _inward(min(near)[2].box, chair.box)
    turned = [_turned(chair.box, quarters) for quarters in range(4)]
    box = max(turned, key=lambda one: float(front_direction(one.yaw_deg) @ way))
    return replace(chair, box=box, extra={**chair.extra, FRONT_FROM: "table"})


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
