"""A supporting piece in its room -> its top view: the top of its mesh and what is beside it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import cv2
import numpy as np
import shapely

from chord_usd.base.raster.relief import Relief
from chord_usd.base.raster.table_top import SIDES, Border, Side, TableTop
from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    front_direction,
    room_polygon,
    to_own,
    to_world,
)
from chord_usd.base.scene.palette import CATEGORIES, having
from chord_usd.base.scene.types import Box, FloatArray, Item, Room

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
    own = to_own(item.box, footprint(other.box))
    side = _side_of(own, item.box)
    axis, _ = _axis(side)
    if is_seat and not _faces(item.box, other.box):
        return []
    half = item.box.size_m[1 - axis] / 2
    low, high = own[:, 1 - axis].min(), own[:, 1 - axis].max()
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
