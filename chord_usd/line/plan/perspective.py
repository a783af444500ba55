"""A sheet of paper in a photograph: its four corners, and the picture as seen from straight above.

The proportions of the sheet follow from its corners alone if the camera has square pixels and looks
through the middle of the picture (Zhang and He, Whiteboard scanning and image enhancement, 2003).
"""

from __future__ import annotations

import math
from itertools import pairwise

import cv2
import numpy as np

from chord_usd.base.scene.types import BoolArray, ByteArray, FloatArray

_SMALL_PX = 500
"""The sheet is looked for in a picture scaled down to this."""

_LEAST_SHARE = 0.25
"""Of the picture that is a sheet on a table."""

_MOST_SHARE = 0.97
_LEAST_FILL = 0.96
"""Share of its hull, and of the four sides through its corners, that a sheet fills."""

_LEAST_CONTRAST = 25.0
"""Grey levels between the paper and what it lies on."""

_RIM = 0.02
_MOST_INK_AT_RIM = 0.02
"""Along its edges, over this share of its size, paper bears no more ink than this share."""

_LEAST_TILT = 0.008
"""Sides that differ by less from a rectangle's sides, as a share of their length, are straight."""

_STRAIGHT = 1e-3


def find_sheet(rgb: ByteArray) -> FloatArray | None:
    """(4, 2) corners of a sheet seen at a slant, continuous pixels, clockwise from the upper left.

    None where the picture, RGB (H, W, 3), shows no sheet on something darker, or none at a slant.
    """
    shrink = min(1.0, _SMALL_PX / max(rgb.shape[:2]))
    small = cv2.resize(rgb, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA)
    grey = cv2.GaussianBlur(cv2.cvtColor(small, cv2.COLOR_RGB2GRAY), (5, 5), 0)
    paper = _brightest_region(np.asarray(grey, np.uint8))
    if paper is None:
        return None
    corners = _four_corners(paper)
    if corners is None or not _is_paper(np.asarray(grey, np.uint8), corners):
        return None
    corners = _clockwise(corners / shrink)
    return corners if _is_slanted(corners) else None


def sheet_size(corners_px: FloatArray, shape: tuple[int, ...]) -> tuple[int, int]:
    """Width and height in pixels of a sheet with these corners in a picture of a shape (H, W)."""
    across = _length(corners_px[1] - corners_px[0]) + _length(corners_px[2] - corners_px[3])
    down = _length(corners_px[3] - corners_px[0]) + _length(corners_px[2] - corners_px[1])
    ratio = _proportions(corners_px - np.array([shape[1], shape[0]]) / 2, across / down)
    area = across * down / 4
    return round(math.sqrt(area * ratio)), round(math.sqrt(area / ratio))


def rectifying(corners_px: FloatArray, size_px: tuple[int, int]) -> FloatArray:
    """(3, 3) from a picture's continuous pixels to the pixels of the sheet seen from above."""
    width, height = size_px
    target = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float32)
    matrix = cv2.getPerspectiveTransform(corners_px.astype(np.float32), target)
    return np.asarray(matrix, np.float64)


def _length(vector: FloatArray) -> float:
    return float(np.hypot(*vector))


def _brightest_region(grey: ByteArray) -> BoolArray | None:
    """(H, W) the paper with all that is drawn on it, if there is one region like that."""
    level, _ = cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    # What is drawn must not part the paper.
    side = max(grey.shape) // 40 * 2 + 1
    bright = cv2.morphologyEx(
        (grey > level).astype(np.uint8), cv2.MORPH_CLOSE, np.ones((side,) * 2)
    )
    _, labels, stats, _ = cv2.connectedComponentsWithStats(bright, connectivity=4)
    if len(stats) < 2:
        return None
    label = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    outline, _ = cv2.findContours(
        (labels == label).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
    )
    filled = cv2.drawContours(np.zeros(grey.shape, np.uint8), outline, -1, (1.0,), -1)
    share = float(filled.mean())
    return filled > 0 if _LEAST_SHARE < share < _MOST_SHARE else None


def _four_corners(paper: BoolArray) -> FloatArray | None:
    """(4, 2) of the region's hull, if four sides do."""
    outline, _ = cv2.findContours(paper.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    hull = cv2.convexHull(max(outline, key=cv2.contourArea))
    for share in (0.01, 0.02, 0.03, 0.04):
        corners = cv2.approxPolyDP(hull, share * cv2.arcLength(hull, closed=True), closed=True)
        if len(corners) == 4:
            break
    else:
        return None
    quad: FloatArray = corners.reshape(4, 2).astype(np.float64)
    fitted = _fitted(quad, hull.reshape(-1, 2).astype(np.float64))
    area = float(cv2.contourArea(fitted.astype(np.float32)))
    filled = float(paper.sum())
    # Contours pass through pixel centres.
    return fitted + 0.5 if area > 0 and min(filled / area, area / filled) > _LEAST_FILL else None


def _fitted(corners: FloatArray, hull: FloatArray) -> FloatArray:
    """(4, 2) where lines meet that are fitted to the hull between these corners."""
    closed = np.concatenate([hull, hull[:1]])
    steps = np.linspace(0.0, 1.0, 40)[:, None]
    dense = np.concatenate([a + steps * (b - a) for a, b in pairwise(closed)])
    lines = []
    for start, stop in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = (stop - start) / max(_length(stop - start), 1e-9)
        progress = (dense - start) @ along / max(_length(stop - start), 1e-9)
        apart = np.abs((dense - start) @ np.array([-along[1], along[0]]))
        near = dense[(progress > 0.08) & (progress < 0.92) & (apart < 4.0)]
        points = near if len(near) > 1 else np.stack([start, stop])
        vx, vy, x, y = cv2.fitLine(points.astype(np.float32), cv2.DIST_HUBER, 0, 0.01, 0.01).ravel()
        lines.append(np.cross([x, y, 1.0], [x + vx, y + vy, 1.0]))
    meets = [np.cross(lines[i - 1], lines[i]) for i in range(4)]
    if any(abs(meet[2]) < 1e-9 for meet in meets):
        return corners
    return np.array([meet[:2] / meet[2] for meet in meets])


def _is_paper(grey: ByteArray, corners: FloatArray) -> bool:
    """Whether these are the edges of paper: bare along them, and darker beyond."""
    inside = cv2.fillConvexPoly(
        np.zeros(grey.shape, np.uint8), np.rint(corners).astype(int), (1.0,)
    )
    reach = max(round(_RIM * math.sqrt(float(inside.sum()))), 2)
    square = np.ones((2 * reach + 1,) * 2, np.uint8)
    # The blurred edge itself is neither.
    core = cv2.erode(inside, np.ones((7, 7), np.uint8))
    rim = (core > 0) & (cv2.erode(core, square) == 0)
    beyond = (cv2.dilate(inside, square) > 0) & (cv2.dilate(inside, np.ones((7, 7))) == 0)
    if not rim.any() or not beyond.any():
        return False
    paper, table = float(np.median(grey[rim])), float(np.percentile(grey[beyond], 75))
    ink = float((grey[rim] < (paper + table) / 2).mean())
    return paper - table > _LEAST_CONTRAST and ink < _MOST_INK_AT_RIM


def _clockwise(corners: FloatArray) -> FloatArray:
    """Corners as seen: upper left, upper right, lower right, lower left."""
    middle = corners.mean(axis=0)
    angles = np.arctan2(corners[:, 1] - middle[1], corners[:, 0] - middle[0])
    ordered = corners[np.argsort(angles)]
    return np.roll(ordered, -int(np.argmin(ordered.sum(axis=1))), axis=0)


def _is_slanted(corners: FloatArray) -> bool:
    """Whether the sheet is no rectangle in the picture; a turn alone is none."""
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    uneven = np.abs(lengths[:2] / lengths[2:] - 1.0).max()
    units = sides / lengths[:, None]
    skewed = max(abs(float(units[i - 1] @ units[i])) for i in range(4))
    return bool(max(uneven, skewed) > _LEAST_TILT)


def _proportions(corners: FloatArray, seen: float) -> float:
    """Width over height of a rectangle seen with these corners, round the picture's middle.

    seen: what its sides measure, which has to do where opposite sides are nearly parallel.
    """
    points = np.column_stack([corners[[0, 1, 3, 2]], np.ones(4)])
    first, second, third, fourth = points
    k2 = np.dot(np.cross(first, fourth), third) / np.dot(np.cross(second, fourth), third)
    k3 = np.dot(np.cross(first, fourth), second) / np.dot(np.cross(third, fourth), second)
    n2, n3 = k2 * second - first, k3 * third - first
    if abs(n2[2]) < _STRAIGHT or abs(n3[2]) < _STRAIGHT:
        return seen
    focal2 = -(n2[0] * n3[0] + n2[1] * n3[1]) / (n2[2] * n3[2])
    if focal2 <= 0.0:
        return seen
    weights = np.array([1.0 / focal2, 1.0 / focal2, 1.0])
    ratio = math.sqrt(float((n2**2 * weights).sum() / (n3**2 * weights).sum()))
    # A camera that far from the usual says that the corners are not as exact as that.
    return ratio if 0.75 < ratio / seen < 1.33 else seen
