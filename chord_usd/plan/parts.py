"""Several plans or storeys on one sheet: which rooms belong together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from shapely import STRtree
from shapely.geometry import Polygon

from chord_usd.types import BoolArray, FloatArray

_SHED = 0.15
"""What is smaller than this share of the largest part is no plan of its own, but a shed."""


def parts_of(polygons_px: Sequence[FloatArray], apart_px: float) -> list[list[int]]:
    """The rooms of each plan on a sheet, by index; the plan with most floor comes first.

    Rooms farther than apart_px from all others of a plan belong to another.
    """
    shapes = [Polygon(polygon) for polygon in polygons_px]
    if not shapes:
        return []
    first, second = STRtree(shapes).query(shapes, predicate="dwithin", distance=apart_px)
    near = np.zeros((len(shapes), len(shapes)), bool)
    near[first, second] = True
    groups = _groups(near)
    areas = [sum(shapes[i].area for i in group) for group in groups]
    order = sorted(range(len(groups)), key=lambda index: -areas[index])
    return [groups[i] for i in order if areas[i] >= _SHED * areas[order[0]]]


def _groups(near: BoolArray) -> list[list[int]]:
    """Who hangs together by way of others. near: (N, N), symmetric.

    As scipy.sparse.csgraph does, whose import takes longer than reading a small plan.
    """
    groups, left = [], np.ones(len(near), bool)
    while left.any():
        group = np.arange(len(near)) == np.argmax(left)
        while (grown := group | near[group].any(axis=0)).sum() > group.sum():
            group = grown
        groups.append(np.flatnonzero(group).tolist())
        left &= ~group
    return groups
