"""What a network that plans floors sees: an open plan, or a blank sheet of a known scale.

An open plan (plan_labels.open_plan, painted) shows a house's outer walls with their doors and
windows. A blank sheet leaves the house's shape to the network; words then describe the house
(line/planning/words.py). Either may show a bubble diagram of the rooms (bubbles.py).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from chord_usd.base.raster.plan_labels import fill_shell
from chord_usd.base.scene.palette import ROOM_SHADES, category
from chord_usd.base.scene.types import ByteArray
from chord_usd.base.scene.wish import WISHED_KINDS
from chord_usd.line.layout.condition import (
    Condition,
    distance_planes,
    free_length_planes,
    near,
    size_planes,
)

SHELL = ("wall", "door", "window")
"""What an open plan draws."""

PIXEL_PLANES = 1 + len(SHELL) + len(WISHED_KINDS)
"""Where the house is (everywhere, on a blank sheet), what its outer walls are made of, and the
bubbles of each kind of room."""

GROUND_PLANE = 0

GRID_PLANES = 1 + 1 + 3 + 4 + len(SHELL) + 2 + 1
"""Whether an open plan is given, the house, its area, width and height, free length in the four
directions, distance to the nearest wall, door and window, place on the sheet, and its scale."""

FAR_M = 4.0
"""Distances saturate here: a window lights a room about this deep."""


def floor_condition(rgb: ByteArray, m_per_px: float, cell_px: int) -> Condition:
    """Masks and measures of an (H, W, 3) sheet; one grid cell is cell_px pixels wide."""
    shell = [near(rgb, category(name).rgb) for name in SHELL]
    house = fill_shell(np.any(shell, axis=0))
    given = bool(house.any())
    half = cell_px // 2
    coarse = house[half::cell_px, half::cell_px].astype(np.int32)
    grid = np.concatenate(
        [
            np.full((1, *coarse.shape), float(given)),
            (coarse > 0)[None],
            size_planes(coarse, _boxes_px(house), m_per_px),
            free_length_planes(coarse, m_per_px * cell_px),
            distance_planes(shell, cell_px, m_per_px, FAR_M),
            _places(*coarse.shape),
            np.full((1, *coarse.shape), m_per_px * 10.0),
        ]
    ).astype(np.float32)
    ground = house if given else np.ones_like(house)
    bubbles = [rgb[..., 0] == ROOM_SHADES[kind][0] for kind in WISHED_KINDS]
    return Condition(np.stack([ground, *shell, *bubbles]).astype(np.uint8), grid)


def _boxes_px(house: npt.NDArray[np.bool_]) -> npt.NDArray[np.float64]:
    """(2, 3) width, height and area in pixels: of nothing, and of the house."""
    rows, columns = np.flatnonzero(house.any(axis=1)), np.flatnonzero(house.any(axis=0))
    if not len(rows):
        return np.zeros((2, 3))
    width, height = columns[-1] - columns[0] + 1, rows[-1] - rows[0] + 1
    return np.array([[0.0, 0.0, 0.0], [width, height, float(house.sum())]])


def _places(rows: int, columns: int) -> npt.NDArray[np.float64]:
    """(2, rows, columns) place of each cell, from -1 to 1: a blank sheet has no other landmarks."""
    return np.stack(
        np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    )
