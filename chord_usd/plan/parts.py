"""Several plans or storeys on one sheet: which rooms belong together."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import cv2
import numpy as np
from shapely.geometry import Polygon

from chord_usd.plan.regions import Regions
from chord_usd.types import FloatArray

_SHED = 0.15
"""What is smaller than this share of the largest part is no plan of its own, but a shed."""


def parts_of(polygons_px: Sequence[FloatArray], regions: Regions) -> list[list[int]]:
    """The rooms of each plan on a sheet, by index; the plan with most floor comes first.

    Rooms that hang together by walls are of one plan.
    """
    built = cv2.dilate((regions.solid | (regions.labels > 0)).astype(np.uint8), np.ones((3, 3)))
    _, parts = cv2.connectedComponents(built, connectivity=8)
    groups: dict[int, list[int]] = defaultdict(list)
    shapes = [Polygon(polygon) for polygon in polygons_px]
    for index, shape in enumerate(shapes):
        inner = shape.representative_point()
        groups[int(parts[int(inner.y), int(inner.x)])].append(index)
    areas = {part: sum(shapes[i].area for i in group) for part, group in groups.items()}
    order = sorted(groups, key=lambda part: -areas[part])
    return [groups[part] for part in order if areas[part] >= _SHED * areas[order[0]]]
