"""Inner faces of walls to less than half a pixel, from how thick the walls came out.

A face lies up to half a pixel beside the drawn edge. The wall's other face does, too, and the two
are exactly WALL_THICKNESS_M apart: where 3.4 pixels came out as 3, both faces were rounded into
the wall, by 0.2 pixels each on average; where they came out as 4, out of it, by 0.3.
"""

from __future__ import annotations

import math

import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.graph.colours import CLEAR, LabelArray

_END_PX = 2.0
"""Ends of a side that are not looked behind: other walls begin there."""
_AXIS_PX = 1e-6
_LEAST_TURN = 0.2
"""Sine of the least angle at which two sides meet in a point to speak of."""


def settle_faces(polygon_px: FloatArray, structure: LabelArray, thickness_px: float) -> FloatArray:
    """The outline of a room with its upright and level sides moved to where the faces must be.

    polygon_px: (N, 2) canvas pixels, counter-clockwise in the world. structure: (H, W) labels.
    Sides without wall all along, slanted ones and walls of another thickness stay where they are.
    """
    following = np.roll(polygon_px, -1, axis=0)
    along = following - polygon_px
    lengths = np.hypot(along[:, 0], along[:, 1])
    along = along / np.maximum(lengths, 1e-9)[:, None]
    # Counter-clockwise: outside lies to the right of a side, which is (-y, x) where y points down.
    outward = np.stack([-along[:, 1], along[:, 0]], axis=1)
    moves = np.array(
        [
            _move_px(start, stop, out, structure, thickness_px) if length > 2 * _END_PX else 0.0
            for start, stop, out, length in zip(
                polygon_px, following, outward, lengths, strict=True
            )
        ]
    )
    if not moves.any():
        return polygon_px
    moved = _corners(polygon_px + outward * moves[:, None], along, polygon_px)
    return moved if Polygon(moved).is_valid else polygon_px


def _move_px(
    start: FloatArray,
    stop: FloatArray,
    outward: FloatArray,
    structure: LabelArray,
    thickness_px: float,
) -> float:
    """How far outwards the face behind this side is to be looked for."""
    if np.abs(stop - start).min() > _AXIS_PX:
        return 0.0
    length = float(np.hypot(*(stop - start)))
    steps = np.arange(_END_PX + 0.5, length - _END_PX)
    if not len(steps):
        return 0.0
    deep = np.arange(math.ceil(thickness_px) + 2) + 0.5
    points = start + (stop - start) / length * steps[:, None]
    across = points[:, None, :] + outward * deep[None, :, None]
    rows, columns = np.floor(across[..., 1]).astype(int), np.floor(across[..., 0]).astype(int)
    height, width = structure.shape
    if rows.min() < 0 or columns.min() < 0 or rows.max() >= height or columns.max() >= width:
        return 0.0
    solid = structure[rows, columns] != CLEAR
    counts = np.cumprod(solid, axis=1).sum(axis=1)
    if (counts == 0).any():
        # Somewhere the floor goes on: that side is shared with another room, which must not move.
        return 0.0
    fitting = counts[np.abs(counts - thickness_px) < 1.0]
    if 2 * len(fitting) < len(counts):
        return 0.0
    return float(np.median(fitting) - thickness_px) / 2


def _corners(through: FloatArray, along: FloatArray, before: FloatArray) -> FloatArray:
    """(N, 2) where each side, given by a point and a direction, meets the one before it."""
    corners = np.empty_like(through)
    for index in range(len(through)):
        point, direction = through[index], along[index]
        other, turned = through[index - 1], along[index - 1]
        sine = direction[0] * turned[1] - direction[1] * turned[0]
        if abs(sine) < _LEAST_TURN:
            corners[index] = before[index]
            continue
        gap = other - point
        share = (gap[0] * turned[1] - gap[1] * turned[0]) / sine
        corners[index] = point + share * direction
    return corners
