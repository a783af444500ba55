"""Where the labels of a raster lie: upright windows of pixels."""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.types import BoolArray

Window = tuple[slice, slice]
"""Rows and columns."""


def components(
    mask: BoolArray, connectivity: int = 4
) -> tuple[npt.NDArray[np.int32], list[Window]]:
    """Connected parts of a mask (H, W): labels from 1, 0 elsewhere, and the window of each."""
    _, labels, boxes, _ = cv2.connectedComponentsWithStats(
        mask.astype(np.uint8), connectivity=connectivity, ltype=cv2.CV_32S
    )
    return np.asarray(labels, np.int32), [_window(*box) for box in boxes[1:, :4].tolist()]


def label_windows(labels: npt.NDArray[np.integer]) -> Iterator[Window | None]:
    """The window of each label (H, W) from 1 to the largest; None for a label without pixels.

    Takes as long as there are labels; components serves many.
    """
    for label in range(1, int(labels.max(initial=0)) + 1):
        left, top, width, height = cv2.boundingRect((labels == label).astype(np.uint8))
        yield _window(left, top, width, height) if width else None


def _window(left: int, top: int, width: int, height: int) -> Window:
    return slice(top, top + height), slice(left, left + width)
