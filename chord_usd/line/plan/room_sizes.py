"""Room sizes as printed: of all of a room, or of a rectangle in it around the text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from shapely.geometry import Polygon, box

from chord_usd.base.scene.types import FloatArray

_MOST_MISMATCH = math.log(1.12)
"""Both sides of a room must speak for scales that differ by no more than this..."""
_PART_MISMATCH = math.log(1.05)
"""...and those of a part of it: of many rectangles some come near by chance."""
_LEAST_SHARE = 0.4
"""Of a room's floor is the rectangle whose size is printed."""
_TORN_SHARE = 0.02
"""Of the room's longer side: corners that are nearer are one."""
_MOST_PLACES = 10


def scale_by_sides(room: Polygon, sides_m: Sequence[float], at_px: FloatArray) -> float | None:
    """Metres per pixel, if the room, or else the largest rectangle within it that holds the text at
    at_px (2,), has the proportions of these sides."""
    whole = _scale(room.bounds, sides_m, _MOST_MISMATCH)
    if whole is not None:
        return whole
    reach = _TORN_SHARE * max(np.ptp(np.array(room.bounds).reshape(2, 2), axis=0))
    inner = room.buffer(reach)
    for bounds in _rectangles(room, at_px, reach):
        scale = _scale(bounds, sides_m, _PART_MISMATCH)
        if scale is not None and inner.covers(box(*bounds)):
            return scale
    return None


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


def _rectangles(
    room: Polygon, at_px: FloatArray, reach: float
) -> Iterator[tuple[float, float, float, float]]:
    """Bounds between the room's corners, the largest first."""
    corners = np.asarray(room.simplify(reach).exterior.coords)
    xs, ys = (_places(corners[:, axis], reach) for axis in (0, 1))
    x, y = at_px
    found = [
        (west, north, east, south)
        for west, east in combinations(xs, 2)
        for north, south in combinations(ys, 2)
        if west < x < east and north < y < south
    ]
    large = [one for one in found if _area(one) >= _LEAST_SHARE * room.area]
    yield from sorted(large, key=_area, reverse=True)


def _area(bounds: tuple[float, float, float, float]) -> float:
    return (bounds[2] - bounds[0]) * (bounds[3] - bounds[1])


def _places(values: FloatArray, reach: float) -> list[float]:
    """Coordinates of corners, those that are nearly the same once."""
    found: list[float] = []
    for value in np.sort(values):
        if not found or value - found[-1] > reach:
            found.append(float(value))
    return found if len(found) <= _MOST_PLACES else []
