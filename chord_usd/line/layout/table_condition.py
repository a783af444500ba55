"""What the layout network sees of the top view of a supporting piece (table_top.draw_table).

As at the house level everything is computed from the picture alone.
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.raster.table_top import NEIGHBOURS, border_rgb, top_mask
from chord_usd.base.scene.palette import SUPPORTS, TOP_SHADES
from chord_usd.base.scene.types import BoolArray, ByteArray
from chord_usd.line.layout.condition import (
    Condition,
    distance_planes,
    free_length_planes,
    near,
    size_planes,
)

PIXEL_PLANES = 1 + len(NEIGHBOURS)
"""The top, then walls, seats and beds beside it."""

TOP_PLANE = 0

GRID_PLANES = 1 + len(SUPPORTS) + 3 + 4 + len(NEIGHBOURS) + 1
"""Top, its category one-hot, its area, width and height, free length in the four directions,
distance to the nearest wall, seat and bed, and the picture's scale."""

AREA_PLANE = 1 + len(SUPPORTS)
"""Of the grid: log(1 + area in m²) / AREA_SCALE of the top."""

FAR_M = 1.0
"""Distances to what is beside the top saturate here."""

_SHADE_LEVELS = np.array([TOP_SHADES[name][0] for name in SUPPORTS])


def table_condition(rgb: ByteArray, m_per_px: float, cell_px: int) -> Condition:
    """Masks and measures of an (H, W, 3) top view; one grid cell is cell_px pixels wide."""
    top = top_mask(rgb)
    beside = [near(rgb, border_rgb(kind)) & ~top for kind in NEIGHBOURS]
    half = cell_px // 2
    coarse = top[half::cell_px, half::cell_px].astype(np.int32)
    grid = np.concatenate(
        [
            (coarse > 0)[None],
            _category_planes(coarse, rgb[..., 0][top]),
            size_planes(coarse, _boxes_px(top), m_per_px),
            free_length_planes(coarse, m_per_px * cell_px),
            distance_planes(beside, cell_px, m_per_px, FAR_M),
            np.full((1, *coarse.shape), m_per_px * 100.0),
        ]
    ).astype(np.float32)
    return Condition(np.stack([top, *beside]).astype(np.uint8), grid)


def _category_planes(coarse: npt.NDArray[np.int32], greys: ByteArray) -> BoolArray:
    """One-hot over SUPPORTS, by the grey that most of the top has."""
    named = np.zeros(len(SUPPORTS), bool)
    if len(greys):
        named[int(np.abs(_SHADE_LEVELS - int(np.bincount(greys).argmax())).argmin())] = True
    return (coarse > 0)[None] & named[:, None, None]


def _boxes_px(top: BoolArray) -> npt.NDArray[np.float64]:
    """(2, 3) width, height and area in pixels: of nothing, and of the top."""
    _, _, width, height = cv2.boundingRect(top.astype(np.uint8))
    return np.array([[0.0, 0.0, 0.0], [width, height, float(top.sum())]])
