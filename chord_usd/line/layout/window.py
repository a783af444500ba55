"""The part of the canvas that a house fills: the network need not look at the empty rest."""

from __future__ import annotations

import numpy as np

from chord_usd.base.scene.palette import BACKGROUND_RGB
from chord_usd.base.scene.types import ByteArray

BORDER_PX = 2
"""White all around the house, so that what lies outside it stays one region."""

WindowSize = tuple[int, int]
"""Height and width in pixels."""

Window = tuple[slice, slice]
"""Rows and columns of the canvas."""


def window_size(rgb: ByteArray, multiple_px: int) -> WindowSize:
    """Smallest window around all that is drawn, sides a multiple of multiple_px, within the canvas.

    rgb: (H, W, 3) raster whose sides are multiples of multiple_px themselves.
    """
    low, high = _extent(rgb)
    needed = high - low + 2 * BORDER_PX
    sides = np.minimum(-(-needed // multiple_px) * multiple_px, rgb.shape[:2])
    return int(sides[0]), int(sides[1])


def window_of(rgb: ByteArray, size: WindowSize) -> Window:
    """Rows and columns of a window of this size with the drawing in its middle."""
    low, high = _extent(rgb)
    first = (low + high - np.array(size)) // 2
    top, left = np.clip(first, 0, np.array(rgb.shape[:2]) - size)
    return slice(int(top), int(top) + size[0]), slice(int(left), int(left) + size[1])


def _extent(rgb: ByteArray) -> tuple[np.ndarray, np.ndarray]:
    """First and behind-the-last (row, column) of what is not background."""
    drawn = (rgb != np.array(BACKGROUND_RGB, np.uint8)).any(axis=2)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    if not len(rows):
        return np.zeros(2, int), np.array(rgb.shape[:2])
    return np.array([rows[0], columns[0]]), np.array([rows[-1] + 1, columns[-1] + 1])
