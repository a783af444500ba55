"""Outlines of upright rooms, straight from the corners of their pixels.

vectorize fits lines to any outline; most rooms have none but upright and level sides, and need it
not.
"""

from __future__ import annotations

import numpy as np

from chord_usd.base.raster.vectorize import polygon_from_mask
from chord_usd.base.scene.types import BoolArray, FloatArray

_LEAST_SIDE_PX = 3
"""Shorter sides may be the steps of a slanted one."""


def outline_of(mask: BoolArray) -> FloatArray:
    """(N, 2) outline of a 4-connected region of a window, continuous pixels, counter-clockwise in
    the world. Holes are passed over. Raises ValueError for an empty mask."""
    upright = _upright_outline(mask)
    return polygon_from_mask(mask) if upright is None else upright


def _upright_outline(mask: BoolArray) -> FloatArray | None:
    """The outline if it has only upright and level sides, none of them short."""
    whole = np.pad(mask, 1).astype(np.int8)
    # Around each grid point the four pixels; a corner has one or three of the region.
    around = whole[:-1, :-1] + whole[1:, :-1] + whole[:-1, 1:] + whole[1:, 1:]
    crossed = (around == 2) & (whole[:-1, :-1] == whole[1:, 1:])
    if crossed.any():
        return None
    rows, columns = np.nonzero(around % 2)
    corners = np.stack([columns, rows], axis=1)
    across, along = _partners(corners, 0), _partners(corners, 1)
    order: list[int] = []
    at = 0
    # The first corner in reading order is one of the outer outline.
    while not order or at != 0:
        order += [at, int(across[at])]
        at = int(along[across[at]])
    outline = corners[order].astype(np.float64)
    sides = np.abs(np.roll(outline, -1, axis=0) - outline).sum(axis=1)
    if sides.min(initial=0.0 if not len(sides) else np.inf) < _LEAST_SIDE_PX:
        return None
    return outline if _area(outline) < 0.0 else outline[::-1]


def _partners(corners: np.ndarray, axis: int) -> np.ndarray:
    """(N,) the corner that each corner shares a side along this axis with.

    Sides of a region alternate with gaps: along a line, corners pair off from one end.
    """
    order = np.lexsort((corners[:, axis], corners[:, 1 - axis]))
    partners = np.empty(len(corners), dtype=np.intp)
    partners[order[::2]], partners[order[1::2]] = order[1::2], order[::2]
    return partners


def _area(outline: FloatArray) -> float:
    """Signed; below zero where the outline is counter-clockwise in the world (y points down)."""
    x, y = outline.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
