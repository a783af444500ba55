"""Room sizes as printed: of all of a room, or of a rectangle in it around the text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations, product

import numpy as np
from shapely.geometry import Polygon, box

from chord_usd.base.scene.types import FloatArray

_MOST_MISMATCH = math.log(1.12)
"""Both sides of a room must speak for scales that differ by no more than this..."""
_PART_MISMATCH = math.log(1.05)
"""...and both sides of a part of it: of many rectangles some come near by chance."""
_LEAST_SHARE = 0.4
"""Of a room's floor is the rectangle whose size is printed."""
_FILLED = 0.85
"""...and of that rectangle, what is floor, where it says the scale."""
_TORN_SHARE = 0.02
"""Of the room's longer side: corners that are nearer are one."""
_MOST_PLACES = 24
_ALIKE = math.log(1.03)
_MOST_READINGS = 3
"""Of one size: more say nothing."""


def scales_by_sides(
    room: Polygon, sides_m: Sequence[float], at_px: FloatArray, sizes: int = 1
) -> list[float]:
    """Metres per pixel by each rectangle that has the proportions of these sides, the likeliest
    first: all of the room, and those within it that hold the text at at_px (2,).

    sizes: how many are printed in the room.
    """
    whole = _scale(room.bounds, sides_m, _MOST_MISMATCH)
    scales = [] if whole is None else [whole]
    # Wardrobes and shafts stand in what is measured; no walls are moved by such rectangles.
    for bounds in rectangles_in(room, sides_m, at_px, _PART_MISMATCH, sizes, _FILLED):
        scale = _scale(bounds, sides_m, _PART_MISMATCH)
        if scale is not None and all(abs(math.log(scale / known)) > _ALIKE for known in scales):
            scales.append(scale)
    return scales[:_MOST_READINGS]


def _scale(
    bounds: tuple[float, float, float, float], sides_m: Sequence[float], most: float
) -> float | None:
    low_x, low_y, high_x, high_y = bounds
    width, height = high_x - low_x, high_y - low_y
    first, second = sides_m
    mismatch, scale = min(
        (abs(math.log(a / width / (b / height))), math.sqrt(a * b / (width * height)))
        for a, b in ((first, second), (second, first))
    )
    return scale if mismatch < most else None


def rectangles_in(
    room: Polygon,
    sides_m: Sequence[float],
    at_px: FloatArray,
    most: float,
    sizes: int = 1,
    filled: float = 1.0 - 1e-6,
) -> Iterator[tuple[float, float, float, float]]:
    """Bounds of rectangles between the room's corners that hold a place (2,), the largest first.

    Their proportions match two sides to within most, a logarithm; a share of filled is floor."""
    reach = _TORN_SHARE * max(np.ptp(np.array(room.bounds).reshape(2, 2), axis=0))
    corners = np.asarray(room.simplify(reach).exterior.coords)
    x, y = at_px
    widths, heights = (
        [
            (low, high)
            for low, high in combinations(_places(corners[:, axis], reach), 2)
            if low < place < high
        ]
        for axis, place in ((0, x), (1, y))
    )
    boxes = [
        (west, north, east, south)
        for (west, east), (north, south) in product(widths, heights)
        if (east - west) * (south - north) >= _LEAST_SHARE * room.area / sizes
        and _scale((west, north, east, south), sides_m, most) is not None
    ]
    inner = room.buffer(reach)
    for bounds in sorted(boxes, key=_area, reverse=True):
        if inner.intersection(box(*bounds)).area >= filled * _area(bounds):
            yield bounds


def _area(bounds: tuple[float, float, float, float]) -> float:
    return (bounds[2] - bounds[0]) * (bounds[3] - bounds[1])


def _places(values: FloatArray, reach: float) -> list[float]:
    """Coordinates of corners, those that are nearly the same once."""
    places: list[float] = []
    for value in np.sort(values):
        if not places or value - places[-1] > reach:
            places.append(float(value))
    return places if len(places) <= _MOST_PLACES else []
