"""What conditions are made of at every level: masks by colour, measures on a coarser grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.types import BoolArray, ByteArray

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
