"""What the layout network sees of a plan raster: masks at pixels, room measures on a grid.

Everything is computed from the raster alone, so that any drawing of a plan can be a condition.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.palette import BACKGROUND_RGB, PLAN_CATEGORIES, ROOM_SHADES
from chord_usd.base.scene.types import LEARNED_KINDS, BoolArray, ByteArray, FloatArray

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


# The floor before doors and windows, read from a plan raster: what an item there would -----------

DEEPEST_DOOR_M = 0.9
"""A door needs its own width in front of it, but no more than a leaf's (metrics.clear_floor)."""

WINDOW_M = 0.5

PASSAGE_DEPTH_M = 0.36
"""White regions inside a shaded plan that are thinner than this are gaps in a wall, not rooms."""

LEAST_PX = 3
"""Smaller specks of an opening's colour are noise."""

_SUBPIXEL_BITS = 4


def clearance_planes(
    door: BoolArray, window: BoolArray, regions: npt.NDArray[np.int32], m_per_px: float
) -> ByteArray:
    """(2, H, W), 0 or 1: floor that doors and passages, and that windows keep free.

    door and window: (H, W) masks; regions: (H, W) room labels, 0 outside. Each opening's area goes
    as far as its metric's box does and stays in the rooms that it opens into.
    """
    planes = np.zeros((2, *door.shape), np.uint8)
    for mask, plane in ((door, planes[0]), (window, planes[1])):
        count, labels, stats, _ = cv2.connectedComponentsWithStats(
            mask.astype(np.uint8), connectivity=8
        )
        for label in range(1, count):
            if stats[label, cv2.CC_STAT_AREA] >= LEAST_PX:
                center, along, across = _rectangle(np.asarray(labels), label, stats[label])
                depth_px = WINDOW_M / m_per_px
                if mask is door:
                    depth_px = min(2 * math.hypot(*along), DEEPEST_DOOR_M / m_per_px)
                for side in (across, -across):
                    _keep_free(plane, regions, center, along, side, depth_px)
    return planes


def passage_mask(
    regions: npt.NDArray[np.int32], sizes_px: FloatArray, unknown: BoolArray, m_per_px: float
) -> BoolArray:
    """(H, W) regions that are gaps in walls.

    sizes_px: (R, 3) width, height and area of each region; unknown: (R,) whether it has no shade.
    """
    thin = sizes_px[:, :2].min(axis=1) * m_per_px < PASSAGE_DEPTH_M
    return (thin & unknown & (sizes_px[:, 2] > 0))[regions]


def _rectangle(
    labels: npt.NDArray[np.int32], label: int, stats: npt.NDArray[np.int32]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Centre, half length along the wall and half depth through it, as vectors in pixels."""
    left, top, width, height = (int(value) for value in stats[:4])
    part = labels[top : top + height, left : left + width] == label
    rows, columns = np.nonzero(part)
    points = np.stack([columns + left, rows + top], axis=1).astype(np.float32)
    (x, y), (first, second), angle = cv2.minAreaRect(points)
    turn = math.radians(angle)
    # Points are pixel centres: the pixels themselves reach half a pixel farther.
    u = np.array([math.cos(turn), math.sin(turn)]) * (first + 1) / 2
    v = np.array([-math.sin(turn), math.cos(turn)]) * (second + 1) / 2
    return np.array([x, y]), *((u, v) if first >= second else (v, u))


def _keep_free(
    plane: ByteArray,
    regions: npt.NDArray[np.int32],
    center: FloatArray,
    along: FloatArray,
    side: FloatArray,
    depth_px: float,
) -> None:
    """Mark the rectangle on one side of an opening, in the rooms that begin there."""
    outward = side / max(math.hypot(*side), 1e-6)
    beside = center + side + outward + np.linspace(-0.7, 0.7, 5)[:, None] * along
    columns, rows = np.clip(np.rint(beside).astype(int), 0, np.array(plane.shape[::-1]) - 1).T
    rooms = {int(label) for label in regions[rows, columns]} - {0}
    if not rooms:
        return
    far = side + outward * depth_px
    corners = center + np.array([side - along, side + along, far + along, far - along])
    low = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0)
    high = np.minimum(np.ceil(corners.max(axis=0)).astype(int) + 1, plane.shape[::-1])
    if (high <= low).any():
        return
    box = np.s_[low[1] : high[1], low[0] : high[0]]
    filled = np.zeros(plane[box].shape, np.uint8)
    # OpenCV fills the boundary's pixels as well, half a pixel too much on every side.
    inner = corners - low + 0.5 * np.sign(corners.mean(axis=0) - corners)
    fixed = np.rint(inner * (1 << _SUBPIXEL_BITS)).astype(np.int32)
    cv2.fillConvexPoly(filled, fixed, (1,), shift=_SUBPIXEL_BITS)
    plane[box] |= filled & np.isin(regions[box], list(rooms)).astype(np.uint8)


# What conditions are made of at every level: masks by colour, measures on a coarser grid ---------

AREA_SCALE = 3.0

COLOR_TOLERANCE = 24


@dataclass(frozen=True, eq=False)
class Condition:
    """A picture that layouts are drawn over, as the network sees it."""

    pixels: ByteArray
    """(planes, H, W), 0 or 1."""
    grid: npt.NDArray[np.float32]
    """(planes, H / cell, W / cell), values of order 1."""


def near(rgb: ByteArray, color: tuple[int, int, int]) -> BoolArray:
    """(H, W) pixels of about this colour."""
    low = np.maximum(np.array(color) - COLOR_TOLERANCE, 0)
    high = np.minimum(np.array(color) + COLOR_TOLERANCE, 255)
    return cv2.inRange(rgb, low, high).astype(bool)


def size_planes(
    coarse: npt.NDArray[np.int32], boxes_px: npt.NDArray[np.float64], m_per_px: float
) -> npt.NDArray[np.float64]:
    """Area, width and height of the region at each cell; logarithms, since rooms span 1 to 60 m².

    coarse: label of each cell, 0 outside; boxes_px: (R, 3) width, height and area by label.
    """
    sizes = np.stack(
        [
            np.log1p(boxes_px[:, 2] * m_per_px**2) / AREA_SCALE,
            np.log1p(boxes_px[:, 0] * m_per_px) / 2.0,
            np.log1p(boxes_px[:, 1] * m_per_px) / 2.0,
        ]
    )
    return np.where(coarse[None] > 0, sizes[:, coarse], 0.0)


def free_length_planes(coarse: npt.NDArray[np.int32], cell_m: float) -> npt.NDArray[np.float64]:
    """Distance to the region's edge towards -x, +x, -y and +y of the image, metres, compressed."""
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


def distance_planes(
    masks: Sequence[BoolArray], cell_px: int, m_per_px: float, far_m: float
) -> npt.NDArray[np.float64]:
    """Distance of each cell to the nearest pixel of each mask, in units of far_m, 1 at most."""
    planes = []
    for mask in masks:
        rows, columns = (length // cell_px for length in mask.shape)
        coarse = mask.reshape(rows, cell_px, columns, cell_px).any(axis=(1, 3))
        if coarse.any():
            distance = cv2.distanceTransform((~coarse).astype(np.uint8), cv2.DIST_L2, 3)
            planes.append(np.minimum(distance * cell_px * m_per_px, far_m) / far_m)
        else:
            planes.append(np.ones(coarse.shape))
    return np.stack(planes)
