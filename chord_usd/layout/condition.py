"""What the layout network sees of a plan raster: masks at pixels, room measures on a grid.

Everything is computed from the raster alone, so that any drawing of a plan can be a condition.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.layout.clearance import clearance_planes, passage_mask
from chord_usd.palette import BACKGROUND_RGB, PLAN_CATEGORIES, ROOM_SHADES
from chord_usd.types import ROOM_KINDS, BoolArray, ByteArray

PIXEL_PLANES = 6
"""Walls, doors, windows, floor, and the floor that doors and that windows keep free."""

FLOOR_PLANE = 3

GRID_PLANES = 1 + len(ROOM_KINDS) + 10
"""Floor, room kind one-hot, then room area, width and height, free length in the four directions,
distance to the nearest door and window, and the raster's scale."""

AREA_PLANE = 1 + len(ROOM_KINDS)
"""Of the grid: log(1 + area in m²) / AREA_SCALE of the cell's room, 0 outside."""

AREA_SCALE = 3.0

COLOR_TOLERANCE = 24
SHADE_TOLERANCE = 3
_UNKNOWN = ROOM_KINDS.index("unknown")
FAR_M = 4.0
"""Distances to doors and windows saturate here."""


@dataclass(frozen=True, eq=False)
class Condition:
    """A plan as the network sees it."""

    pixels: ByteArray
    """(PIXEL_PLANES, H, W), 0 or 1."""
    grid: npt.NDArray[np.float32]
    """(GRID_PLANES, H / cell, W / cell), values of order 1."""


def plan_condition(rgb: ByteArray, m_per_px: float, cell_px: int) -> Condition:
    """Masks and room measures of a (H, W, 3) plan raster; one grid cell is cell_px pixels wide."""
    wall, door, window = (_near(rgb, row.rgb) for row in PLAN_CATEGORIES)
    free = ~(wall | door | window)
    regions, kinds, boxes_px = _rooms(rgb[..., 0], free)
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
            _size_planes(coarse, boxes_px, m_per_px),
            _free_length_planes(coarse, m_per_px * cell_px),
            _opening_planes((door, window), cell_px, m_per_px),
            np.full((1, *coarse.shape), m_per_px * 10.0),
        ]
    ).astype(np.float32)
    return Condition(pixels, grid)


def _near(rgb: ByteArray, color: tuple[int, int, int]) -> BoolArray:
    low = np.maximum(np.array(color) - COLOR_TOLERANCE, 0)
    high = np.minimum(np.array(color) + COLOR_TOLERANCE, 255)
    return cv2.inRange(rgb, low, high).astype(bool)


def _rooms(
    grey: ByteArray, free: BoolArray
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int64], npt.NDArray[np.float64]]:
    """Rooms as connected regions of one shade.

    Returns regions (H, W), 0 outside; per region (index 0 unused) the kind's index in ROOM_KINDS
    and (width, height, area) in pixels. White regions that touch the canvas border lie outside.
    """
    regions = np.zeros(grey.shape, np.int32)
    kinds, boxes = [0], [(0.0, 0.0, 0.0)]
    present = np.bincount(grey[free], minlength=256)
    for kind_index, kind in enumerate(ROOM_KINDS):
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
    return kind_at[None] == np.arange(len(ROOM_KINDS))[:, None, None]


def _size_planes(
    coarse: npt.NDArray[np.int32], boxes_px: npt.NDArray[np.float64], m_per_px: float
) -> npt.NDArray[np.float64]:
    """Area, width and height of the room at each cell; logarithms, since rooms span 1 to 60 m²."""
    sizes = np.stack(
        [
            np.log1p(boxes_px[:, 2] * m_per_px**2) / AREA_SCALE,
            np.log1p(boxes_px[:, 0] * m_per_px) / 2.0,
            np.log1p(boxes_px[:, 1] * m_per_px) / 2.0,
        ]
    )
    return np.where(coarse[None] > 0, sizes[:, coarse], 0.0)


def _free_length_planes(coarse: npt.NDArray[np.int32], cell_m: float) -> npt.NDArray[np.float64]:
    """Distance to the room's edge towards -x, +x, -y and +y of the image, metres, compressed."""
    planes = [
        _run_length(coarse),
        _run_length(coarse[:, ::-1])[:, ::-1],
        _run_length(coarse.T).T,
        _run_length(coarse.T[:, ::-1])[:, ::-1].T,
    ]
    return np.where(coarse[None] > 0, np.log1p(np.stack(planes) * cell_m), 0.0)


def _run_length(labels: npt.NDArray[np.int32]) -> npt.NDArray[np.float64]:
    """Cells since the label last changed along each row, counted from half a cell."""
    columns = np.arange(labels.shape[1])
    changed = np.zeros(labels.shape, bool)
    changed[:, 1:] = labels[:, 1:] != labels[:, :-1]
    start = np.maximum.accumulate(np.where(changed, columns, 0), axis=1)
    return columns - start + 0.5


def _opening_planes(
    openings: tuple[BoolArray, ...], cell_px: int, m_per_px: float
) -> npt.NDArray[np.float64]:
    planes = []
    for mask in openings:
        rows, columns = (length // cell_px for length in mask.shape)
        coarse = mask.reshape(rows, cell_px, columns, cell_px).any(axis=(1, 3))
        if coarse.any():
            distance = cv2.distanceTransform((~coarse).astype(np.uint8), cv2.DIST_L2, 3)
            planes.append(np.minimum(distance * cell_px * m_per_px, FAR_M) / FAR_M)
        else:
            planes.append(np.ones(coarse.shape))
    return np.stack(planes)
