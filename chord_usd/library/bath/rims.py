"""Colliders of round hollow things, as boxes: rows along a rim, strips of a floor.

Solvers make one hull of a mesh, in which nothing can lie; a box collides as it is.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import shapely

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.solids import Solid, box

_STEP_M = 0.06
"""Length of a box along a curve, and width of a strip: a rim strays by a third of it."""

_ALIKE_M = 0.005
"""Strips whose ends differ by less are one."""


def bowl_colliders(
    line_m: FloatArray, thick_m: float, low_m: float, floor_m: float, high_m: float
) -> tuple[Solid, ...]:
    """Walls around the middle line of a rim, (N, 2), from low_m to high_m, and a floor between them
    up to floor_m."""
    return (
        *colliders_along(line_m, thick_m, low_m, high_m),
        *floor_colliders(line_m, low_m, floor_m),
    )


def colliders_along(
    line_m: FloatArray, thick_m: float, low_m: float, high_m: float
) -> tuple[Solid, ...]:
    """Boxes from low_m to high_m that follow an outline, (N, 2); as long as they can be where it
    runs along an axis."""
    boxes = []
    for start, end in zip(line_m, np.roll(line_m, -1, axis=0), strict=True):
        across = np.abs(end - start).min()
        count = max(1, math.ceil(across / _STEP_M))
        for n in range(count):
            first, second = (start + (end - start) * k / count for k in (n, n + 1))
            middle, size = (first + second) / 2, np.abs(second - first) + thick_m
            boxes.append(_upright(middle, size, low_m, high_m))
    return tuple(boxes)


def floor_colliders(outline_m: FloatArray, low_m: float, high_m: float) -> tuple[Solid, ...]:
    """Strips along x that fill an outline, (N, 2), from low_m to high_m."""
    area = shapely.Polygon(outline_m)
    left, near, right, far = area.bounds
    edges = np.linspace(near, far, max(1, math.ceil((far - near) / _STEP_M)) + 1)
    strips: list[tuple[float, float, float, float]] = []
    for front, back in pairwise(edges):
        x0, _, x1, _ = area.intersection(shapely.box(left, front, right, back)).bounds
        if strips and np.allclose(strips[-1][:2], (x0, x1), atol=_ALIKE_M):
            front = strips.pop()[2]
        strips.append((x0, x1, front, back))
    return tuple(
        _upright(np.array([x0 + x1, y0 + y1]) / 2, np.array([x1 - x0, y1 - y0]), low_m, high_m)
        for x0, x1, y0, y1 in strips
    )


def _upright(middle_m: FloatArray, size_m: FloatArray, low_m: float, high_m: float) -> Solid:
    length, width = (float(side) for side in size_m)
    return box((length, width, high_m - low_m)).moved(float(middle_m[0]), float(middle_m[1]), low_m)
