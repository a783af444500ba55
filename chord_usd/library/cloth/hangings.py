"""Curtains: pleated sheets that hang from their heading."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.cloth.blender_cloth import Fabric, draped
from chord_usd.library.cloth.cloth_grids import grid_faces

Heading = Literal["wave", "pinch", "gather"]

HEIGHT_M = 2.4
TIE = 0.56
"""How far down a tied curtain is held, as a share of its height."""

_TIED_M = 0.13
_ROWS = 60
_MOST_ROWS, _MOST_TRIANGLES = 27, 5600


@dataclass(frozen=True)
class Hanging:
    """A curtain to be simulated."""

    heading: Heading
    width_m: float
    """From one side of the heading to the other."""
    folds: int
    """Pleats along the heading."""
    fullness: float
    """Cloth per metre of heading."""
    hem_folds: int
    """Folds at the hem: several pleats flow into one."""
    is_tied: bool = False
    """Held together by a band, TIE of the way down."""
    seed: int = 0


def hung(hanging: Hanging) -> tuple[FloatArray, np.ndarray, FloatArray]:
    """Points, faces and cloth coordinates of a curtain; its heading is at HEIGHT_M."""
    rng = np.random.default_rng(hanging.seed)
    columns = hanging.folds * (9 if hanging.heading == "gather" else 14) + 1
    cloth_m = hanging.width_m * hanging.fullness
    rows = [
        _row(hanging, share, columns, angles)
        for angles in (_angles(hanging, columns, rng),)
        for share in np.linspace(0.0, 1.0, _ROWS + 1)
    ]
    grid = np.stack(rows)
    index = np.arange(grid.shape[0] * columns).reshape(-1, columns)
    pinned = list(index[:2].ravel())
    if hanging.is_tied:
        pinned += list(index[_tie_row() - 1 : _tie_row() + 1].ravel())
    rest = np.zeros_like(grid)
    rest[..., 0] = np.linspace(-cloth_m / 2, cloth_m / 2, columns)
    rest[..., 2] = grid[..., 2]
    fabric = Fabric(bending=0.3, self_collision=False, gap_m=0.004)
    settled = draped(
        grid.reshape(-1, 3), grid_faces(*grid.shape[:2]), fabric, 70, pinned,
        rest_m=rest.reshape(-1, 3),
    ).reshape(grid.shape)  # fmt: skip
    count = min(_MOST_TRIANGLES // (2 * columns), _MOST_ROWS)
    kept = np.unique(np.round(_ROWS * np.linspace(0.0, 1.0, count) ** 1.25).astype(int))
    points = settled[kept]
    v = np.broadcast_to(grid[kept, :1, 2], points.shape[:2])
    uvs = np.stack([rest[kept, :, 0], v], axis=-1)
    return points.reshape(-1, 3), grid_faces(*points.shape[:2]), uvs.reshape(-1, 2)


def _tie_row() -> int:
    return round(TIE * _ROWS)


def _angles(hanging: Hanging, columns: int, rng: np.random.Generator) -> tuple[FloatArray, ...]:
    """Direction of the cloth along its heading and along its hem, -1 to 1, before it is scaled."""
    s = np.linspace(0.0, 1.0, columns)
    turn = 2 * math.pi
    uneven = 0.06 if hanging.heading != "gather" else 0.3
    heading = _uneven_phase(s, hanging.folds, uneven, rng)
    if hanging.heading == "pinch":
        # A narrow loop, then a flat stretch: the sine is squeezed into a third of each pleat.
        part = np.clip((heading % 1.0 - 0.5) / 0.42 + 0.5, 0.0, 1.0)
        top = np.sin(turn * part)
    else:
        top = np.sin(turn * heading)
    # Folds go on where the pleats are; several narrow ones flow into one.
    below = heading * hanging.hem_folds / hanging.folds
    amount = 0.12 if hanging.heading != "gather" else 0.2
    stray = [amount * _slow(s, 7, rng) for _ in range(2)]
    middle = np.sin(turn * (below + stray[0])) * (1.0 + 0.15 * _slow(s, 9, rng))
    hem = np.sin(turn * (below + stray[0] + stray[1])) * (1.0 + 0.25 * _slow(s, 9, rng))
    return top, middle, hem


def _slow(s: FloatArray, knots: int, rng: np.random.Generator) -> FloatArray:
    return np.interp(s, np.linspace(0.0, 1.0, knots), rng.uniform(-1.0, 1.0, knots))


def _uneven_phase(s: FloatArray, folds: int, by: float, rng: np.random.Generator) -> FloatArray:
    wide = np.cumsum(1.0 + by * rng.uniform(-1.0, 1.0, folds))
    return np.interp(s, np.concatenate([[0.0], wide]) / wide[-1], np.arange(folds + 1.0))


def _row(
    hanging: Hanging, share: float, columns: int, angles: tuple[FloatArray, ...]
) -> FloatArray:
    """(columns, 3) points at a share of the way down; the cloth keeps its length."""
    top, middle, hem = angles
    low = min(share / 0.35, 1.0)
    low = low * low * (3 - 2 * low)
    turned = (1 - low) * top + low * ((1 - share) * middle + share * hem)
    cloth_m = hanging.width_m * hanging.fullness
    width = _width_at(hanging, share)
    step = cloth_m / (columns - 1)
    lowest, highest = 0.0, 2.6
    for _ in range(40):
        scale = (lowest + highest) / 2
        span = step * float(np.cos(scale * turned[:-1]).sum())
        lowest, highest = (scale, highest) if span > width else (lowest, scale)
    x = np.concatenate([[0.0], np.cumsum(np.cos(scale * turned[:-1]))]) * step
    y = np.concatenate([[0.0], np.cumsum(np.sin(scale * turned[:-1]))]) * step
    line = np.polyval(np.polyfit(x, y, 3), x)
    points = np.stack([x - x[-1] / 2, y - line, np.full(columns, 0.0)], axis=-1)
    points[:, 2] = HEIGHT_M * (1.0 - share)
    return points


def _width_at(hanging: Hanging, share: float) -> float:
    """Width of the curtain at a share of the way down."""
    if not hanging.is_tied:
        return hanging.width_m
    if share <= TIE:
        return hanging.width_m + (_TIED_M - hanging.width_m) * (share / TIE) ** 1.6
    below = (share - TIE) / (1 - TIE)
    return _TIED_M + 0.22 * (1 - (1 - below) ** 2)
