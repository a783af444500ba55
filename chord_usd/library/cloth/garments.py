"""Coats that hang from a hook, at a wall behind them (+y)."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.library.cloth.blender_cloth import Fabric, draped
from chord_usd.library.cloth.cloth_grids import Made, grid_faces, smoothed
from chord_usd.library.kit.solids import box

_AROUND = 48
_ROW_M = 0.03
_WALL_M = 0.075
"""From the middle of the collar to the wall."""


def coat(length_m: float, seed: int) -> Made:
    """A coat this long, its collar at z = 0: a body that falls in folds, and two sleeves."""
    tubes = [_tube((0.05, 0.19, 0.22), (0.035, 0.05, 0.06), length_m, 1.3, (0.0, 0.0, 0.0), seed)]
    for side in (-1, 1):
        at = (side * 0.2, 0.0, -0.07)
        tubes.append(_tube((0.05, 0.06, 0.055), (0.04, 0.045, 0.04), 0.58, 0.4, at, seed + side))
    points, faces, uvs, count = [], [], [], 0
    for found, quads, flat in tubes:
        points.append(found)
        faces.append(quads + count)
        uvs.append(flat)
        count += len(found)
    return np.concatenate(points), np.concatenate(faces), np.concatenate(uvs)


def _tube(
    wide_m: tuple[float, float, float],
    deep_m: tuple[float, float, float],
    length_m: float,
    cloth_m: float,
    at_m: tuple[float, float, float],
    seed: int,
) -> Made:
    """A tube let fall from its upper end: half widths and depths there, at the shoulder, at the
    hem; cloth_m: around it."""
    rng = np.random.default_rng(seed + 10)
    rows = round(length_m / _ROW_M) + 1
    down, around = np.meshgrid(
        np.linspace(0.0, 1.0, rows), np.linspace(0.0, 2 * math.pi, _AROUND + 1), indexing="ij"
    )
    phase = rng.uniform(0.0, 2 * math.pi, 2)
    fold = 0.6 * np.sin(7 * around + phase[0]) + 0.4 * np.sin(11 * around + phase[1])
    knots = (0.0, 0.12, 1.0)
    swell = 1.0 + 0.14 * np.clip(down * 4.0, 0.0, 1.0) * fold
    x = np.interp(down, knots, wide_m) * np.cos(around) * swell
    y = np.interp(down, knots, deep_m) * np.sin(around) * swell
    # The shoulders slope.
    z = -length_m * down - 0.22 * np.abs(x) * np.clip(1.0 - 3.0 * down, 0.0, 1.0)
    start = np.stack([x, y, z], axis=-1) + at_m
    radius = cloth_m / (2 * math.pi)
    cut = np.stack([radius * np.cos(around), radius * np.sin(around), -length_m * down], axis=-1)
    flat = np.stack([cloth_m * around / (2 * math.pi), -length_m * down], axis=-1)
    columns = _AROUND
    index = np.arange(rows * columns).reshape(rows, columns)
    after = np.roll(index, -1, axis=1)
    quads = np.stack([index[:-1], after[:-1], after[1:], index[1:]], axis=-1).reshape(-1, 4)
    wall = box((2.0, 0.2, 3.0)).moved(y=_WALL_M + 0.1, z=-2.0)
    found = draped(
        start[:, :-1].reshape(-1, 3), quads, Fabric(bending=0.6, self_collision=False, gap_m=0.004),
        40, list(index[:4].ravel()), [wall], rest_m=cut[:, :-1].reshape(-1, 3),
    ).reshape(rows, columns, 3)  # fmt: skip
    # The seam is closed in space and open on the cloth.
    grid = np.concatenate([found, found[:, :1]], axis=1)
    points = smoothed(grid, 1)
    points[:, -1] = points[:, 0] = (points[:, -1] + points[:, 0]) / 2
    # Every second line shows all folds that there are.
    points, flat = points[::2, ::2], flat[::2, ::2]
    return points.reshape(-1, 3), grid_faces(*points.shape[:2]), flat.reshape(-1, 2)
