"""Duvets with folds, their turned-back ends, towels over a rail.

A bed's own frame here: the mattress' upper side at z = 0, its foot end at y = 0, its head at +y.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.cloth.blender_cloth import Fabric, draped
from chord_usd.library.cloth.cloth_grids import Made, grid_faces, smoothed, thickened
from chord_usd.library.kit.solids import Solid, box, soft_block

MATTRESS_INSET_M = 0.08
"""From the side of a bed to the side of its mattress: what hangs down needs it."""

_CELL_M = 0.025


@dataclass(frozen=True)
class Duvet:
    """A duvet on a bed."""

    length_m: float
    """Of the bed, across it."""
    reach_m: float
    """From the mattress' foot end to the duvet's upper end."""
    hang_m: float
    bending: float
    slack: float
    """Share by which it is larger than its place: it lies in folds."""
    thick_m: float
    seed: int
    turned_m: float = 0.0
    """How much of the upper end is turned back."""


def laid(duvet: Duvet) -> dict[str, Made]:
    """Points, faces, cloth coordinates of the "duvet" and, where it is turned back, the "band"."""
    half = duvet.length_m / 2 - MATTRESS_INSET_M
    bed = [
        soft_block((2 * half, 2.0, 0.24), 0.06, (8, 8, 1)).moved(y=1.0, z=-0.24),
        box((2 * half + 0.05, 2.06, 0.2)).moved(y=0.99, z=-0.42),
    ]
    wide, deep = 2 * (half + duvet.hang_m), duvet.reach_m + duvet.hang_m
    middle_y = (duvet.reach_m - duvet.hang_m) / 2
    top = _dropped(wide, deep, (0.0, middle_y, 0.05), duvet, bed)
    whole = _finished(*top, duvet.thick_m, (0.0, 0.6, -0.12))
    cloths = {"duvet": stuffed_unevenly(whole, duvet.bending > 1.0, duvet.seed)}
    if duvet.turned_m:
        under = [*bed, Solid(whole[0], whole[1])]
        y = duvet.reach_m - duvet.turned_m / 2 + 0.015
        lift = float(whole[0][:, 2].max()) + 0.01
        band = _dropped(wide - 0.04, duvet.turned_m, (0.0, y, lift), duvet, under)
        end = _finished(*band, 0.6 * duvet.thick_m, (0.0, y, -0.1))
        cloths["band"] = stuffed_unevenly(end, duvet.bending > 1.0, duvet.seed)
    return cloths


def stuffed_unevenly(made: Made, is_smooth: bool, seed: int) -> Made:
    """The same cloth with its filling shaken into soft hills: broad ones, or many small ones.

    Layers with the same seed stay on each other.
    """
    points, faces, uvs = made
    rng = np.random.default_rng(seed)
    count, size_m, depth_m = (26, 0.16, 0.022) if is_smooth else (60, 0.075, 0.024)
    corners = np.array([(-0.9, -0.1), (0.9, 1.6)])
    x, y = points[:, 0], points[:, 1]
    hills = np.zeros_like(x)
    for _ in range(count):
        (cx, cy), turn = rng.uniform(*corners), rng.uniform(0.0, np.pi)
        u = (x - cx) * np.cos(turn) + (y - cy) * np.sin(turn)
        v = (y - cy) * np.cos(turn) - (x - cx) * np.sin(turn)
        hills += rng.uniform(-0.7, 1.0) * np.exp(-((u / size_m) ** 2) - (v / (3 * size_m)) ** 2)
    above = np.clip(1.0 + points[:, 2] / 0.06, 0.0, 1.0)
    lifted = points.copy()
    lifted[:, 2] += depth_m * hills * above
    return lifted, faces, uvs


def _dropped(
    wide: float,
    deep: float,
    at: tuple[float, float, float],
    duvet: Duvet,
    under: list[Solid],
) -> tuple[FloatArray, FloatArray]:
    """A sheet after its fall, every second line of it, and its cloth coordinates."""
    rng = np.random.default_rng(duvet.seed)
    columns, rows = (2 * round(side / _CELL_M / 2) + 1 for side in (wide, deep))
    x, y = np.meshgrid(np.linspace(-wide / 2, wide / 2, columns),
                       np.linspace(deep / 2, -deep / 2, rows))  # fmt: skip
    rest = np.stack([x, y, np.zeros_like(x)], axis=-1)
    start = rest * (1.0 - duvet.slack) + at
    start[..., 2] += 0.03 * _bumps(x, y, rng, 26, 0.12)
    fabric = Fabric(bending=duvet.bending, self_collision=False, gap_m=0.012, mass_kg=0.2)
    settled = draped(
        start.reshape(-1, 3), grid_faces(rows, columns), fabric, 45,
        obstacles=under, rest_m=rest.reshape(-1, 3),
    ).reshape(rest.shape)  # fmt: skip
    return smoothed(settled, 1)[::2, ::2], rest[::2, ::2, :2]


def _bumps(
    x: FloatArray, y: FloatArray, rng: np.random.Generator, count: int, size_m: float
) -> FloatArray:
    total = np.zeros_like(x)
    for _ in range(count):
        cx, cy = rng.uniform(x.min(), x.max()), rng.uniform(y.min(), y.max())
        turn = rng.uniform(0.0, np.pi)
        u = (x - cx) * np.cos(turn) + (y - cy) * np.sin(turn)
        v = (y - cy) * np.cos(turn) - (x - cx) * np.sin(turn)
        total += rng.uniform(-1, 1) * np.exp(-((u / size_m) ** 2) - (v / (3 * size_m)) ** 2)
    return total


def _finished(
    grid: FloatArray, flat: FloatArray, thick_m: float, core_m: tuple[float, float, float]
) -> Made:
    points, faces, owner = thickened(grid, thick_m, core_m)
    return points, faces, flat.reshape(-1, 2)[owner]


def over_rail(length_m: float, drop_m: float, seed: int) -> Made:
    """A towel over a rail along x at z = 0; it hangs a little longer in front.

    Drawn, not simulated: its two sides would slip off the rail or through each other.
    """
    rng = np.random.default_rng(seed)
    columns, rows = (round(side / 0.03) + 1 for side in (length_m, 1.9 * drop_m))
    x, y = np.meshgrid(np.linspace(-length_m / 2, length_m / 2, columns),
                       np.linspace(0.9 * drop_m, -drop_m, rows))  # fmt: skip
    flat = np.stack([x, y, np.zeros_like(x)], axis=-1)
    grid = _folded_over(flat, 0.02)
    down = np.abs(y) / drop_m
    fold = np.sin(2 * np.pi * x / 0.15 + 1.0 + 0.8 * down)
    grid[..., 1] += 0.01 * down * fold * (down > 0.1) + 0.006 * _bumps(x, y, rng, 8, 0.08)
    grid[..., 0] *= 1.0 - 0.05 * down**1.5
    return _finished(grid, flat[..., :2], 0.011, (0.0, 0.0, -0.05))


def _folded_over(flat: FloatArray, radius_m: float) -> FloatArray:
    """Bent over a bar of this radius at the origin's height."""
    y = flat[..., 1]
    turn = np.clip(y / radius_m, -np.pi / 2, np.pi / 2)
    down = np.abs(y) - np.abs(turn) * radius_m
    bent = flat.copy()
    bent[..., 1] = radius_m * np.sin(turn)
    bent[..., 2] = radius_m * np.cos(turn) - down
    return bent
