"""Measures that standards ask beside the rules of rooms: doors, ways, places to turn, heights."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import cv2
import numpy as np

from chord_usd.base.metrics.design.rule import Measured
from chord_usd.base.metrics.design.view import HomeView, View
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import FloatArray

_CELL_M = 0.02
_MARGIN_CELLS = 2
_LOW_M = 0.03
"""What is no higher is rolled over: rugs and mats."""
_HEAD_M = 0.4
"""Of a bed beside which bedside tables stand."""
_WIDE_M = 2.0
"""Ways are not measured wider."""
_FURNITURE = ("cabinet", "wardrobe", "table", "dining_cabinet", "shoe_cabinet")


def door_width(view: View) -> Iterator[Measured]:
    """Width of each door and passage of a room, but for open borders."""
    for hole in view.shell.ways:
        if hole.depth_m > 0.05:
            yield Measured(hole.length_m, (float(hole.middle[0]), float(hole.middle[1])))


def door_height(view: View) -> Iterator[Measured]:
    """Height of the hole of each door of a room."""
    for hole in view.shell.ways:
        if hole.depth_m > 0.05 and hole.kind == "door":
            yield Measured(hole.height_m, (float(hole.middle[0]), float(hole.middle[1])))


def entrance_width(home: HomeView) -> Iterator[Measured]:
    """Width of the front door."""
    if home.entrance is not None:
        x, y, _ = home.entrance.box.center_m
        yield Measured(float(home.entrance.box.size_m[0]), (float(x), float(y)))


def turning_circle(view: View) -> Iterator[Measured]:
    """Diameter of the largest circle on the free floor of a room."""
    yield _largest(view, cv2.DIST_L2, 5)


def turning_square(view: View) -> Iterator[Measured]:
    """Side of the largest square on the free floor, along the axes of the plan."""
    yield _largest(view, cv2.DIST_C, 3)


def _largest(view: View, metric: int, mask: int) -> Measured:
    floor, low = _floor(view)
    away = cv2.distanceTransform(floor, metric, mask)
    row, column = np.unravel_index(int(away.argmax()), away.shape)
    # From the middle of a cell to the nearest cell that is taken: half a cell less on both sides.
    size = max(0.0, 2.0 * (float(away[row, column]) - 0.5) * _CELL_M)
    x, y = low + _CELL_M * np.array([column, row])
    return Measured(size, (float(x), float(y)))


def way_width(view: View) -> Iterator[Measured]:
    """The widest way that joins all doors of a room over its free floor; of a room with one door,
    the widest into its middle. A way no narrower than _WIDE_M is not measured wider."""
    floor, low = _floor(view)
    away: FloatArray = cv2.distanceTransform(floor, cv2.DIST_L2, 5).astype(float)
    places = [_cell(hole.middle + hole.inward * (hole.depth_m / 2 + 0.05), low)
              for hole in view.shell.ways]  # fmt: skip
    if not places:
        return
    if len(places) == 1:
        row, column = np.unravel_index(int(away.argmax()), away.shape)
        places.append((int(row), int(column)))
    lower, upper = 0.0, _WIDE_M
    while upper - lower > _CELL_M:
        width = (lower + upper) / 2
        lower, upper = (width, upper) if _joins(away, width, places) else (lower, width)
    yield Measured(lower, view.middle)


def _joins(away: FloatArray, width_m: float, places: list[tuple[int, int]]) -> bool:
    """Whether one part of the floor that is so far from all that is taken is near all places."""
    cells = width_m / 2 / _CELL_M
    _, parts = cv2.connectedComponents((away >= cells).astype(np.uint8))
    reach = int(np.ceil(cells)) + 8
    near = [
        set(np.unique(parts[max(row - reach, 0) : row + reach + 1,
                            max(column - reach, 0) : column + reach + 1]).tolist()) - {0}
        for row, column in places
    ]  # fmt: skip
    return bool(set.intersection(*near))


def _cell(at: FloatArray, low: FloatArray) -> tuple[int, int]:
    column, row = np.rint((at - low) / _CELL_M).astype(int).tolist()
    return row, column


def _floor(view: View) -> tuple[np.ndarray, FloatArray]:
    """A mask of the free floor of a room, 1 where nothing stands, and the world place of cell 0."""
    polygon = view.shell.room.polygon_m
    low = polygon.min(axis=0) - _MARGIN_CELLS * _CELL_M
    width, height = (np.ceil(np.ptp(polygon, axis=0) / _CELL_M).astype(int)
                     + 2 * _MARGIN_CELLS + 1).tolist()  # fmt: skip
    floor = np.zeros((height, width), np.uint8)
    stands = view.stands & (view.height > _LOW_M)
    for value, outline in ((1, polygon), *((0, corners) for corners in view.corners[stands])):
        cv2.fillPoly(floor, [np.rint((outline - low) / _CELL_M).astype(np.int32)], (value,))
    return floor, low


def beside_bed(which: int) -> Callable[[View], Iterator[Measured]]:
    """Free width beside each bed: 0 of its lesser side, 1 of its greater one."""

    def measure(view: View) -> Iterator[Measured]:
        tables = view.of("bedside_table")
        for at in view.of("bed")[:1]:
            low, high = _HEAD_M - view.depth[at] / 2, view.depth[at] / 2 - 0.05
            free = [(view.beside(at, side, low, high, tables), side) for side in (-1, 1)]
            width, side = sorted(free)[which]
            at_m = view.point(at, side * view.length[at] / 2)
            yield Measured(width, at_m, (view.items[at].id,))

    return measure


def before_furniture(view: View) -> Iterator[Measured]:
    """Free depth before each cabinet and desk; chairs at a desk are no obstacle."""
    chairs = view.of("chair")
    for at in view.of(*_FURNITURE):
        half = view.length[at] / 2 - 0.02
        at_m = view.point(at, 0, view.depth[at] / 2)
        yield Measured(view.before(at, -half, half, chairs), at_m, (view.items[at].id,))


def beside_toilet(which: int) -> Callable[[View], Iterator[Measured]]:
    """Free width beside the toilet: 0 of its lesser side, 1 of its greater one."""

    def measure(view: View) -> Iterator[Measured]:
        for at in view.of("toilet")[:1]:
            low, high = 0.15 - view.depth[at] / 2, view.depth[at] / 2
            free = sorted(view.beside(at, side, low, high) for side in (-1, 1))
            yield Measured(free[which], view.point(at), (view.items[at].id,))

    return measure


def basin_height(view: View) -> Iterator[Measured]:
    """Height of each basin's top."""
    for at in view.of(*having("basin")):
        yield Measured(float(view.height[at]), view.point(at), (view.items[at].id,))
