"""Gaps between the units of a kitchen run: floor along a wall that nothing can stand on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import shapely

from chord_usd.base.scene.geometry import footprint_polygon, to_own
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import Item
from chord_usd.base.scene.units import wrap_deg

KITCHEN_UNITS = having("kitchen_unit")
"""What stands end to end."""

JOINT_M = 0.06
"""What is no wider is a joint: as much as lists and rasters leave open."""
LEAST_USE_M = 0.6
"""What is as wide takes a dishwasher, or a way through."""
_ONE_LINE_M = 0.13
"""Backs of a run lie within this."""
_PARALLEL_DEG = 2.0
_TAKEN = 0.2
"""A gap of which others cover as large a share, or that lies so far out of the room, is none."""


def unit_gaps(items: Sequence[Item], floor: shapely.Polygon) -> Iterator[tuple[Item, Item, float]]:
    """Each gap of a room: the unit on its left as one faces them, the one on its right, and metres.

    items: all that stands in the room. floor: its outline.
    """
    units = [item for item in items if item.category in KITCHEN_UNITS]
    for unit in units:
        beside = [(gap_m, other) for other in units if (gap_m := _gap_m(unit, other)) is not None]
        gap_m, other = min(beside, key=lambda beside_it: beside_it[0], default=(0.0, unit))
        if JOINT_M < gap_m < LEAST_USE_M and _is_free(unit, other, items, floor):
            yield unit, other, gap_m


def _gap_m(unit: Item, other: Item) -> float | None:
    """From a unit to one on its right in its run, metres; None for one that is not there."""
    if other is unit or abs(wrap_deg(other.box.yaw_deg - unit.box.yaw_deg)) > _PARALLEL_DEG:
        return None
    x, y = to_own(unit.box, other.box.center_m[:2])
    (length, depth, _), (other_length, other_depth, _) = unit.box.size_m, other.box.size_m
    is_in_line = abs(y + (other_depth - depth) / 2) < _ONE_LINE_M
    return x - (length + other_length) / 2 if x > 0.0 and is_in_line else None


def _is_free(unit: Item, other: Item, items: Sequence[Item], floor: shapely.Polygon) -> bool:
    ends = [footprint_polygon(unit.box), footprint_polygon(other.box)]
    between = shapely.difference(shapely.union_all(ends).convex_hull, shapely.union_all(ends))
    around = [footprint_polygon(item.box) for item in items if item not in (unit, other)]
    taken_m2 = shapely.intersection(between, shapely.union_all(around)).area
    outside_m2 = shapely.difference(between, floor).area
    return bool(max(taken_m2, outside_m2) < _TAKEN * between.area)
