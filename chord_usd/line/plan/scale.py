"""How many pixels thick the walls of a plan raster are, which gives the raster its scale."""

from __future__ import annotations

import numpy as np

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.types import WALL_THICKNESS_M, BoolArray

_SHORTEST_WALL_PX = 4
_HEAVIEST_WALL_PX = 20
"""A longer wall says no more about the thickness than one of this length."""


def wall_thickness_px(solid: BoolArray) -> float:
    """Thickness of the walls to a fraction of a pixel, (H, W) pixels of walls and openings given.

    Each wall along an axis is drawn a whole number of pixels thick, rounded up or down as it
    happens to lie; their mean is the thickness. Raises PlanError where there is no such wall.
    """
    lengths, weights = (
        np.concatenate(parts) for parts in zip(_crossings(solid), _crossings(solid.T), strict=True)
    )
    if len(lengths) == 0:
        raise PlanError(
            "no wall along an axis was found", expected="walls drawn black", try_="--scale M_PER_PX"
        )
    # The thickness that most wall has; thicker runs are junctions and walls seen lengthwise.
    usual = int(np.argmax(np.convolve(np.bincount(lengths, weights), [1.0, 1.0])[1:]))
    near = (lengths >= usual) & (lengths <= usual + 1)
    return float(np.average(lengths[near], weights=weights[near]))


def measure_scale(solid: BoolArray) -> float:
    """Metres per pixel, from walls WALL_THICKNESS_M thick. Raises PlanError."""
    return WALL_THICKNESS_M / wall_thickness_px(solid)


def _crossings(solid: BoolArray) -> tuple[np.ndarray, np.ndarray]:  # type: ignore[type-arg]
    """Thickness and weight of every wall that runs along the rows."""
    padded = np.pad(solid, ((1, 1), (0, 0))).astype(np.int8)
    change = np.diff(padded, axis=0).T
    columns, tops = np.nonzero(change == 1)
    bottoms = np.nonzero(change == -1)[1]
    # Runs of neighbouring columns with the same ends are one wall.
    order = np.lexsort((columns, bottoms, tops))
    columns, tops, bottoms = columns[order], tops[order], bottoms[order]
    starts = np.ones(len(columns), bool)
    starts[1:] = (np.diff(tops) != 0) | (np.diff(bottoms) != 0) | (np.diff(columns) != 1)
    walls = np.flatnonzero(starts)
    extents = np.diff(np.append(walls, len(columns)))
    thickness = bottoms[walls] - tops[walls]
    is_wall = (extents >= _SHORTEST_WALL_PX) & (extents > 1.5 * thickness)
    weights = np.minimum(extents[is_wall], _HEAVIEST_WALL_PX).astype(np.float64)
    return thickness[is_wall], weights
