"""Pillows and cushions: two sheets sewn together and filled, with the creases that this draws.

Drawn, not simulated: what shows a filling are a few deep creases where the seam and the corners
pull, and where somebody leant; air in a bag, which is what can be simulated, gives none of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from chord_usd.base.scene.types import FloatArray, frozen_array
from chord_usd.library.cloth.cloth_grids import bag
from chord_usd.library.cloth.stored import Cloth
from chord_usd.library.kit.solids import Solid

_SEAM_M = 0.0012
"""Half the thickness of the case alone."""

_DRAWN_IN = 0.1
"""Share by which the middle of an edge is drawn in: the corners stand out."""


@dataclass(frozen=True)
class Filling:
    """What is in a case and how it is used."""

    thick_m: float = 0.17
    creases: int = 6
    """Along each edge."""
    depth_m: float = 0.015
    """Of the deepest."""
    slump: float = 0.12
    """Share of the filling that has sunk from the upper edge (+y) to the lower."""
    chop: float = 0.0
    """How deep the upper edge is struck in, as a share of the width."""
    tuft: float = 0.0
    """How deep the middle is buttoned, as a share of the thickness."""
    flange_m: float = 0.0
    """A flat border around it."""
    seed: int = 0


@lru_cache(maxsize=64)
def stuffed(length_m: float, width_m: float, filling: Filling, cells: int = 30) -> Cloth:
    """A cushion that lies on its back, its middle at the origin; cells: along its length."""
    rows = 2 * max(round(cells * width_m / length_m / 2), 4)
    case = bag(length_m, width_m, cells, rows, 0.01)
    flat = case.points_m[:, :2]
    side = np.sign(case.points_m[:, 2])
    rng = np.random.default_rng(filling.seed)
    # Cells are narrow at the seam, where the cushion is round.
    s, t = (_narrow_at_ends(2 * flat[:, axis] / span)
            for axis, span in enumerate((length_m, width_m)))  # fmt: skip
    uvs = np.stack([s * length_m / 2, t * width_m / 2], axis=-1)
    height = np.zeros(len(flat))
    for sign in (-1.0, 1.0):
        mine = _height(s, t, (length_m, width_m), filling, rng)
        height = np.where(side == sign, mine, height)
    x = uvs[:, 0] * (1.0 - _DRAWN_IN * (1.0 - t**2) * s**2)
    y = uvs[:, 1] * (1.0 - _DRAWN_IN * (1.0 - s**2) * t**2)
    upper = np.clip((t + 0.2) / 1.2, 0.0, 1.0)
    y -= filling.chop * width_m * upper**2 * np.exp(-((s / 0.3) ** 2))
    wave = 0.006 * np.sin(5.0 * s + 4.0 * t + filling.seed) * np.maximum(np.abs(s), np.abs(t)) ** 4
    points = np.stack([x, y, side * height + wave], axis=-1)
    solid = Solid(frozen_array(points), frozen_array(case.faces(), np.int64))
    return Cloth(solid, frozen_array(uvs))


def _narrow_at_ends(share: FloatArray) -> FloatArray:
    return 0.45 * share + 0.55 * np.sin(0.5 * np.pi * share)


def _height(
    s: FloatArray,
    t: FloatArray,
    size_m: tuple[float, float],
    filling: Filling,
    rng: np.random.Generator,
) -> FloatArray:
    """Of one side over the plane of the seam; s and t run from -1 to 1."""
    inner = [np.clip(share / (1.0 - 2 * filling.flange_m / span), -1.0, 1.0)
             for share, span in zip((s, t), size_m, strict=True)]  # fmt: skip
    room = np.maximum((1.0 - inner[0] ** 2) * (1.0 - inner[1] ** 2), 0.0)
    round_ = room**0.42
    sunk = 1.0 - filling.slump * (inner[1] + 0.3 * (1.0 - inner[1] ** 2))
    hills = 0.05 * np.sin(2.6 * s + rng.uniform(0, 6)) * np.sin(2.2 * t + rng.uniform(0, 6))
    height = filling.thick_m / 2 * round_ * (sunk + hills)
    crease = _creases(s, t, filling, rng) + _corner_creases(s, t, filling, rng)
    if filling.chop:
        struck = np.clip((t + 0.25) / 1.25, 0.0, 1.0)
        crease += 1.8 * filling.thick_m * filling.chop * struck * np.exp(-((s / 0.2) ** 2))
    if filling.tuft:
        away = np.hypot(s, t)
        crease += filling.tuft * filling.thick_m / 2 * np.exp(-((away / 0.16) ** 2))
        around = np.arctan2(t, s)
        crease += 0.006 * (0.5 + 0.5 * np.cos(8 * around)) ** 2 * np.exp(-((away / 0.4) ** 2))
    return np.maximum(height - crease * np.clip(4 * room, 0.0, 1.0), 0.3 * height) + _SEAM_M


def _creases(
    s: FloatArray, t: FloatArray, filling: Filling, rng: np.random.Generator
) -> FloatArray:
    """From the seam inwards: the cloth is too long there once the cushion is filled."""
    total = np.zeros_like(s)
    for along, across in ((s, t), (s, -t), (t, s), (t, -s)):
        places = np.linspace(-0.75, 0.75, filling.creases) + rng.normal(0.0, 0.07, filling.creases)
        for place in places:
            depth, wide = rng.uniform(0.25, 1.0) * filling.depth_m, rng.uniform(0.035, 0.075)
            length, lean = rng.uniform(0.2, 0.55), -0.35 * place + rng.normal(0.0, 0.15)
            inwards = 1.0 - across
            beside = (along - place - lean * inwards) / (wide + 0.08 * inwards)
            total += depth * np.exp(-(beside**2) - (inwards / length) ** 2)
    return total


def _corner_creases(
    s: FloatArray, t: FloatArray, filling: Filling, rng: np.random.Generator
) -> FloatArray:
    """From the corners towards the middle, two or three each."""
    total = np.zeros_like(s)
    for at_s in (-1.0, 1.0):
        for at_t in (-1.0, 1.0):
            u, v = 1.0 - s * at_s, 1.0 - t * at_t
            away, angle = np.hypot(u, v), np.degrees(np.arctan2(v, u))
            for turn in rng.choice([18.0, 32.0, 45.0, 58.0, 72.0], 3, replace=False):
                depth = rng.uniform(0.4, 1.0) * filling.depth_m
                beside = (angle - turn - rng.normal(0.0, 4.0)) / rng.uniform(5.0, 9.0)
                reach = (away / rng.uniform(0.5, 0.9)) ** 2
                total += depth * np.exp(-(beside**2) - reach)
    return total
