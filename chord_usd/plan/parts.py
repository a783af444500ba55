"""Several plans or storeys on one sheet: which rooms belong together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse.csgraph import connected_components
from shapely import STRtree
from shapely.geometry import Polygon

from chord_usd.types import FloatArray

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
    count, labels = connected_components(near, directed=False)
    groups = [np.flatnonzero(labels == label).tolist() for label in range(count)]
    areas = [sum(shapes[i].area for i in group) for group in groups]
    order = sorted(range(count), key=lambda index: -areas[index])
    return [groups[i] for i in order if areas[i] >= _SHED * areas[order[0]]]
