"""Open boards of an asset, seen from its front: where books and bowls can stand in it."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np

from chord_usd.base.scene.types import Asset, FloatArray
from chord_usd.library.asset_relief import relief_of, triangles_m
from chord_usd.library.kept_arrays import kept

CELL_M = 0.01

_LEAST_M = (0.14, 0.14, 0.12)
"""Smallest length, depth and clear height of a compartment that is worth filling."""

_FULL = 0.9
"""Share of its bounds that a compartment fills."""

_DEEP = 0.5
"""Share of the asset's depth that is clear: before what stands in a shelf already is no place."""

_OFF_FLOOR_M = 0.03
"""What is lower is the floor between the legs of a piece."""

_OPEN_ABOVE_M = 0.25
_TOP_SHARE = 0.75
"""Share of the footprint that a top covers."""

_FINE_BITS = 4


def boards_of(asset: Asset) -> FloatArray:
    """(N, 6) open boards in the asset's own frame: lowest x, front y, z of the board; highest x,
    back y, z up to which it is clear.

    Compartments without a door, and of what hangs on walls its top. Raises AssetError for a file
    that cannot be opened.
    """
    return _boards(asset.usd_path, asset)


@lru_cache(maxsize=256)
def _boards(path: Path, asset: Asset) -> FloatArray:
    def find() -> dict[str, FloatArray]:
        seen_m, _ = triangles_m(path)
        inside = _compartments(_from_front(seen_m, asset.size_m), asset.size_m)
        levelled = [board for one in inside if (board := _on_level(one, seen_m)) is not None]
        found = [*levelled, *_top(asset)]
        return {"boards": np.array(found, np.float64).reshape(-1, 6)}

    return kept(path, "boards", Path(__file__), find)["boards"]


def _from_front(triangles: FloatArray, size_m: tuple[float, float, float]) -> FloatArray:
    """(rows, columns) depth behind the front at which one sees something, rows from the floor up.

    Where nothing is seen, the depth of the asset.
    """
    columns, rows = (max(round(side / CELL_M), 1) for side in (size_m[0], size_m[2]))
    flat = triangles[:, :, [0, 2]]
    across = np.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0])
    shown = triangles[np.abs(across) > 1e-9]
    near = shown[:, :, 1].min(axis=1) + size_m[1] / 2
    scale = np.array([columns / size_m[0], rows / size_m[2]])
    points = shown[:, :, [0, 2]] * scale + (columns / 2 - 0.5, -0.5)
    points = np.rint(points * (1 << _FINE_BITS)).astype(np.int32)
    depth = np.full((rows, columns), size_m[1], np.float32)
    for index in (-near).argsort(kind="stable"):
        value = float(max(near[index], 0.0))
        cv2.fillConvexPoly(depth, points[index], (value,), shift=_FINE_BITS)
    return depth.astype(np.float64)


def _compartments(depth: FloatArray, size_m: tuple[float, float, float]) -> list[list[float]]:
    """Right-angled openings deep enough to stand something in."""
    is_open = (depth > _LEAST_M[1]).astype(np.uint8)
    count, _, stats, _ = cv2.connectedComponentsWithStats(is_open, connectivity=4)
    cell_x, cell_z = size_m[0] / depth.shape[1], size_m[2] / depth.shape[0]
    found = []
    for column, row, wide, high, cells in stats[1:count]:
        low, top = row * cell_z, (row + high) * cell_z
        is_small = wide * cell_x < _LEAST_M[0] or high * cell_z < _LEAST_M[2]
        if is_small or cells < _FULL * wide * high or low < _OFF_FLOOR_M:
            continue
        inside = depth[row : row + high, column : column + wide]
        deep = float(np.quantile(inside, 0.05))
        if deep < _DEEP * size_m[1]:
            continue
        if row + high >= depth.shape[0]:
            top += _OPEN_ABOVE_M
        left = column * cell_x - size_m[0] / 2
        front = -size_m[1] / 2
        found.append([left, front, low, left + wide * cell_x, front + deep, top])
    return found


def _on_level(board: list[float], triangles: FloatArray) -> list[float] | None:
    """The compartment from the very height of its board and from that board's front edge, which
    may lie behind doors and handles below; None where there is no board or it is too narrow.
    """
    flat = triangles[np.ptp(triangles[:, :, 2], axis=1) < 1e-4]
    level, x = flat[:, 0, 2], flat[:, :, 0]
    middle = (board[0] + board[3]) / 2
    below = (x.min(axis=1) < middle) & (x.max(axis=1) > middle)
    below &= np.abs(level - board[2]) < 1.5 * CELL_M
    if not below.any():
        return None
    height = float(level[below].max())
    front = float(flat[below & (level > height - 1e-4)][:, :, 1].min())
    is_deep = board[4] - front >= _LEAST_M[1]
    return [board[0], front, height, *board[3:]] if is_deep else None


def _top(asset: Asset) -> list[list[float]]:
    """The top of a shelf."""
    length, depth, height = asset.size_m
    if asset.category != "wall_shelf":
        return []
    covered = relief_of(asset).heights_m >= height - 0.004
    if float(covered.mean()) < _TOP_SHARE:
        return []
    return [[-length / 2, -depth / 2, height, length / 2, depth / 2, height + 0.45]]
