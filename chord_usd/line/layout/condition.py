"""What the layout network sees of a plan raster: masks at pixels, room measures on a grid.

Everything is computed from the raster alone, so that any drawing of a plan can be a condition.
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.palette import BACKGROUND_RGB, PLAN_CATEGORIES, ROOM_SHADES
from chord_usd.base.scene.types import LEARNED_KINDS, BoolArray, ByteArray
from chord_usd.line.layout.clearance import clearance_planes, passage_mask
from chord_usd.line.layout.condition_planes import (
    Condition,
    distance_planes,
    free_length_planes,
    near,
    size_planes,
)

PIXEL_PLANES = 6
"""Walls, doors, windows, floor, and the floor that doors and that windows keep free."""

FLOOR_PLANE, DOOR_FLOOR_PLANE, WINDOW_FLOOR_PLANE = 3, 4, 5

GRID_PLANES = 1 + len(LEARNED_KINDS) + 10
"""Floor, room kind one-hot, then room area, width and height, free length in the four directions,
distance to the nearest door and window, and the raster's scale."""

AREA_PLANE = 1 + len(LEARNED_KINDS)
"""Of the grid: log(1 + area in m²) / AREA_SCALE of the cell's room, 0 outside."""

SHADE_TOLERANCE = 3
_UNKNOWN = LEARNED_KINDS.index("unknown")
FAR_M = 4.0
"""Distances to doors and windows saturate here."""


def plan_condition(rgb: ByteArray, m_per_px: float, cell_px: int) -> Condition:
    """Masks and room measures of a (H, W, 3) plan raster; one grid cell is cell_px pixels wide."""
    wall, door, window = (near(rgb, row.rgb) for row in PLAN_CATEGORIES)
    regions, kinds, boxes_px = _rooms(rgb[..., 0], ~(wall | door | window))
    half = cell_px // 2
    coarse = regions[half::cell_px, half::cell_px]
    inside = regions > 0
    gaps = passage_mask(regions, boxes_px, kinds == _UNKNOWN, m_per_px)
    kept_free = clearance_planes(door | gaps, window, np.where(gaps, 0, regions), m_per_px)
    pixels = np.stack([wall, door, window, inside, *kept_free]).astype(np.uint8)
    grid = np.concatenate(
        [
            (coarse > 0)[None],
            _kind_planes(coarse, kinds),
            size_planes(coarse, boxes_px, m_per_px),
            free_length_planes(coarse, m_per_px * cell_px),
            distance_planes((door, window), cell_px, m_per_px, FAR_M),
            np.full((1, *coarse.shape), m_per_px * 10.0),
        ]
    ).astype(np.float32)
    return Condition(pixels, grid)


def floor_regions(rgb: ByteArray, m_per_px: float) -> tuple[npt.NDArray[np.int32], BoolArray]:
    """Number of each room's floor (H, W), 0 elsewhere, and the passages in walls (H, W)."""
    free = ~np.any([near(rgb, row.rgb) for row in PLAN_CATEGORIES], axis=0)
    regions, kinds, boxes_px = _rooms(rgb[..., 0], free)
    gaps = passage_mask(regions, boxes_px, kinds == _UNKNOWN, m_per_px)
    return np.where(gaps, 0, regions), gaps


def _rooms(
    grey: ByteArray, free: BoolArray
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int64], npt.NDArray[np.float64]]:
    """Rooms as connected regions of one shade.

    Returns regions (H, W), 0 outside; per region (index 0 unused) the kind's index in LEARNED_KINDS
    and (width, height, area) in pixels. White regions that touch the canvas border lie outside.
    """
    regions = np.zeros(grey.shape, np.int32)
    kinds, boxes = [0], [(0.0, 0.0, 0.0)]
    present = np.bincount(grey[free], minlength=256)
    for kind_index, kind in enumerate(LEARNED_KINDS):
        shade = ROOM_SHADES[kind][0]
        if present[max(shade - SHADE_TOLERANCE, 0) : shade + SHADE_TOLERANCE + 1].sum() < 4:
            continue
        mask = free & (grey >= max(shade - SHADE_TOLERANCE, 0)) & (grey <= shade + SHADE_TOLERANCE)
        count, labels, stats, _ = cv2.connectedComponentsWithStats(
            mask.astype(np.uint8), connectivity=4
        )
        outside = _border_labels(np.asarray(labels)) if shade == BACKGROUND_RGB[0] else set()
        names = np.zeros(count, np.int32)
        for label in range(1, count):
            if label in outside or stats[label, cv2.CC_STAT_AREA] < 4:
                continue
            names[label] = len(kinds)
            kinds.append(kind_index)
            boxes.append(tuple(stats[label, [2, 3, 4]].astype(float)))
        regions += names[labels]
    return regions, np.array(kinds), np.array(boxes)


def _border_labels(labels: npt.NDArray[np.int32]) -> set[int]:
    edges = (labels[0], labels[-1], labels[:, 0], labels[:, -1])
    return {int(label) for edge in edges for label in np.unique(edge)}


def _kind_planes(coarse: npt.NDArray[np.int32], kinds: npt.NDArray[np.int64]) -> BoolArray:
    kind_at = np.where(coarse > 0, kinds[coarse], -1)
    return kind_at[None] == np.arange(len(LEARNED_KINDS))[:, None, None]
