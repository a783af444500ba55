"""Pillows and cushions: bags that are blown up and left to settle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chord_usd.assets.cloth.blender_cloth import Fabric, draped
from chord_usd.assets.cloth.cloth_grids import bag, compact, relaxed
from chord_usd.assets.solids import box
from chord_usd.scene.types import FloatArray

_RELAXED = 3
"""Rounds that take the sharpest of the wrinkles away, which a coarse mesh shows as dents."""


@dataclass(frozen=True)
class Stuffed:
    """A bag to be filled, lying on a table at z = 0."""

    length_m: float
    width_m: float
    cells: tuple[int, int]
    """Even numbers; every second line is kept."""
    pressure: float = 3.0
    bending: float = 0.3
    frames: int = 50
    seed: int = 0
    uneven_m: float = 0.006


def filled(stuffed: Stuffed) -> tuple[FloatArray, np.ndarray, FloatArray]:
    """Points, faces and cloth coordinates, the middle of its underside at the origin."""
    made = bag(stuffed.length_m, stuffed.width_m, *stuffed.cells, swell_m=0.03)
    rng = np.random.default_rng(stuffed.seed)
    start = made.points_m + rng.normal(0.0, stuffed.uneven_m * 0.3, made.points_m.shape)
    start += [0.0, 0.0, 0.06]
    fabric = Fabric(
        bending=stuffed.bending, pressure=stuffed.pressure, self_collision=False, gap_m=0.003,
        mass_kg=0.05, stretch=40.0, shear=25.0,
    )  # fmt: skip
    table = box((2.0, 2.0, 0.5)).moved(z=-0.5)
    found = draped(start, made.faces(), fabric, stuffed.frames, obstacles=[table])
    points, faces, uvs = compact(found, made.faces(2), made.points_m[:, :2])
    points = relaxed(points, faces, _RELAXED)
    low, high = points.min(axis=0), points.max(axis=0)
    points = points - [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]
    return points, faces, uvs
