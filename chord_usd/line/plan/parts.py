"""Several plans or storeys on one sheet: which rooms belong together."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import cv2
import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.scene.types import BoolArray, FloatArray
from chord_usd.line.plan.regions import Labels, Regions

_SHED = 0.15
"""What is smaller than this share of the largest part is no plan of its own, but a shed."""


def built_parts(regions: Regions) -> tuple[BoolArray, Labels]:
    """(H, W) what is built, and the number of the part that it belongs to; 0 beside it."""
    built = regions.solid | (regions.labels > 0)
    near = cv2.dilate(built.astype(np.uint8), np.ones((3, 3)))
    _, parts = cv2.connectedComponents(near, connectivity=8)
    return built, np.asarray(parts, np.int32)


def parts_of(polygons_px: Sequence[FloatArray], regions: Regions) -> list[list[int]]:
    """The rooms of each plan on a sheet, by index; the plan with most floor comes first.

    Rooms that hang together by walls are of one plan.
    """
    _, parts = built_parts(regions)
    groups: dict[int, list[int]] = defaultdict(list)
    shapes = [Polygon(polygon) for polygon in polygons_px]
    for index, shape in enumerate(shapes):
        inner = shape.representative_point()
        groups[int(parts[int(inner.y), int(inner.x)])].append(index)
    areas = {part: sum(shapes[i].area for i in group) for part, group in groups.items()}
    order = sorted(groups, key=lambda part: -areas[part])
    return [groups[part] for part in order if areas[part] >= _SHED * areas[order[0]]]
