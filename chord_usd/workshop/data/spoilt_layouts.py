"""Layouts as networks and files leave them: torn edges, holes, specks, other colours."""

from __future__ import annotations

import cv2
import numpy as np

from chord_usd.base.raster.canvas import CANVAS_PX
from chord_usd.base.scene.palette import HOUSE_CATEGORIES
from chord_usd.base.scene.types import BoolArray, ByteArray


def fray(
    labels: ByteArray, front: BoolArray, floor: BoolArray, rng: np.random.Generator
) -> tuple[ByteArray, BoolArray]:
    """Edges that wander by a pixel or two: each pixel is read a little beside itself."""
    reach = rng.uniform(0.3, 1.6)
    wander = rng.normal(0.0, 1.0, (2, *labels.shape)).astype(np.float32)
    grain = float(rng.uniform(0.4, 1.5))
    offsets = [cv2.GaussianBlur(plane, (0, 0), grain) for plane in wander]
    rows, columns = np.indices(labels.shape)
    last = labels.shape[0] - 1
    row = np.clip(np.rint(rows + reach * offsets[0] / offsets[0].std()), 0, last).astype(int)
    column = np.clip(np.rint(columns + reach * offsets[1] / offsets[1].std()), 0, last).astype(int)
    moved = np.where(floor, labels[row, column], 0).astype(np.uint8)
    return moved, front[row, column] & (moved > 0)


def patch(
    labels: ByteArray, front: BoolArray, floor: BoolArray, rng: np.random.Generator
) -> tuple[ByteArray, BoolArray]:
    """Holes, lost marks, marks too many and specks of any category."""
    labels, front = labels.copy(), front.copy()
    for _ in range(int(rng.integers(3, 30))):
        row, column = rng.integers(0, CANVAS_PX, 2)
        height, width = rng.integers(1, 4, 2)
        spot = (slice(row, row + height), slice(column, column + width))
        kind = rng.integers(4)
        if kind == 0:
            labels[spot] = 0
        elif kind == 1:
            front[spot] = False
        elif kind == 2:
            front[spot] = True
        else:
            labels[spot] = rng.integers(1, len(HOUSE_CATEGORIES) + 1)
    labels = np.where(floor, labels, 0).astype(np.uint8)
    return labels, front & (labels > 0)


def drift(rgb: ByteArray, rng: np.random.Generator) -> ByteArray:
    """Colours as a JPEG file or a noisy source leaves them."""
    if rng.random() < 0.5:
        quality = int(rng.integers(70, 96))
        coded = cv2.imencode(".jpg", rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
        return np.ascontiguousarray(cv2.imdecode(coded, cv2.IMREAD_COLOR)[..., ::-1])
    reach = int(rng.integers(2, 9))
    noisy = rgb.astype(np.int16) + rng.integers(-reach, reach + 1, rgb.shape)
    return np.clip(noisy, 0, 255).astype(np.uint8)
