"""Makes the stored cloths again: `python -m chord_usd.library.cloth.simulate [NAME …]`.

Needs Blender's bpy and about a minute a cloth. The files differ by a hair from machine to machine,
since a simulation does; that is why they are stored.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from functools import partial

import numpy as np

from chord_usd.library.cloth.bedding import Duvet, laid, over_rail
from chord_usd.library.cloth.blender_cloth import Fabric, draped
from chord_usd.library.cloth.cloth_grids import Made, grid_faces, smoothed
from chord_usd.library.cloth.hangings import Hanging, hung
from chord_usd.library.cloth.stored import save
from chord_usd.library.kit.solids import box

_HANGINGS = {
    "curtain_wave_narrow": Hanging("wave", 0.6, 5, 2.0, 5, seed=1),
    "curtain_wave_wide": Hanging("wave", 1.2, 10, 2.0, 10, seed=2),
    "curtain_wave_open": Hanging("wave", 0.34, 6, 4.2, 6, seed=4),
    "curtain_pinch_narrow": Hanging("pinch", 0.6, 4, 2.0, 4, seed=12),
    "curtain_pinch_wide": Hanging("pinch", 1.2, 9, 2.0, 9, seed=13),
    "curtain_pinch_open": Hanging("pinch", 0.34, 5, 4.0, 5, seed=14),
    "curtain_pinch_tied": Hanging("pinch", 0.46, 5, 3.0, 5, is_tied=True, seed=5),
    "curtain_gather_narrow": Hanging("gather", 0.6, 10, 2.0, 5, seed=3),
    "curtain_gather_wide": Hanging("gather", 1.2, 17, 2.0, 9, seed=6),
    "curtain_gather_open": Hanging("gather", 0.34, 9, 3.4, 5, seed=7),
}

_DUVETS = {
    f"smooth_{100 * length:.0f}": Duvet(length, 1.42, 0.3, 3.0, 0.02, 0.04, seed, turned_m=0.36)
    for length, seed in ((1.0, 1), (1.6, 2))
} | {
    f"rumpled_{100 * length:.0f}": Duvet(length, 1.5, 0.32, 0.5, 0.06, 0.034, seed)
    for length, seed in ((1.0, 3), (1.6, 4))
}  # fmt: skip


def makers() -> dict[str, Callable[[], dict[str, Made]]]:
    """How the stored cloths are made: some hang together and are made at once."""
    by_name: dict[str, Callable[[], dict[str, Made]]] = {}
    for name, hanging in _HANGINGS.items():
        by_name[name] = partial(_alone, name, hung, hanging)
    for name, duvet in _DUVETS.items():
        by_name[name] = partial(_layers, name, duvet)
    for name, length, drop in (("towel_long", 0.46, 0.5), ("towel_short", 0.3, 0.34)):
        by_name[name] = partial(_alone, name, over_rail, length, drop, 9)
    for name, length, seed in (("coat_long", 1.0, 3), ("coat_short", 0.72, 4)):
        by_name[name] = partial(_alone, name, coat, length, seed)
    return by_name


def _alone(name: str, make: Callable[..., Made], *about: object) -> dict[str, Made]:
    return {name: make(*about)}


def _layers(name: str, duvet: Duvet) -> dict[str, Made]:
    return {f"{part}_{name}": made for part, made in laid(duvet).items()}


def main(names: list[str]) -> None:
    """Simulate these cloths, all of them by default, and store them."""
    every = makers()
    for name in names or list(every):
        for stored_name, made in every[name]().items():
            print(save(stored_name, *made))  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1:])


# Coats that hang from a hook, at a wall behind them (+y) -----------------------------------------

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
    for grid, quads, flat in tubes:
        points.append(grid)
        faces.append(quads + count)
        uvs.append(flat)
        count += len(grid)
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
    settled = draped(
        start[:, :-1].reshape(-1, 3), quads, Fabric(bending=0.6, self_collision=False, gap_m=0.004),
        40, list(index[:4].ravel()), [wall], rest_m=cut[:, :-1].reshape(-1, 3),
    ).reshape(rows, columns, 3)  # fmt: skip
    # The seam is closed in space and open on the cloth.
    grid = np.concatenate([settled, settled[:, :1]], axis=1)
    points = smoothed(grid, 1)
    points[:, -1] = points[:, 0] = (points[:, -1] + points[:, 0]) / 2
    # Every second line shows all folds that there are.
    points, flat = points[::2, ::2], flat[::2, ::2]
    return points.reshape(-1, 3), grid_faces(*points.shape[:2]), flat.reshape(-1, 2)
