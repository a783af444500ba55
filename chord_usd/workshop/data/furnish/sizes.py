"""Sizes that pieces come in: steps and pairs as they are sold, inside the ranges of the palette."""

from __future__ import annotations

import random

from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.workshop.data.furnish.floor import Size

BED_LENGTHS_M = (2.0, 1.8, 1.5, 1.35, 1.2, 1.0, 0.9)
"""Across the bed, widest first."""

LEAST_BED: Size = (0.9, 1.9, 0.85)
"""Lower than a window sill."""


def between(dice: random.Random, low: float, high: float, step: float = 0.05) -> float:
    """A multiple of step, uniform over [low, high]; low where no multiple fits."""
    steps = int((high - low) / step + 1e-6)
    return round(low + step * int(dice.random() * (steps + 1)), 3) if steps > 0 else low


def sampled(
    dice: random.Random,
    category: str,
    *,
    shortest: float = 0.0,
    longest: float = 9.0,
    shallowest: float = 0.0,
    deepest: float = 9.0,
    step: float = 0.05,
) -> Size:
    """A size of the category as short, long and deep as asked, where the palette allows that."""
    row = CATEGORIES[category]
    low, high = row.length_m
    length = between(dice, max(low, min(shortest, high)), min(longest, high), step)
    shallow, deep = row.width_m
    width = between(dice, max(shallow, min(shallowest, deepest)), min(deepest, deep), step)
    height = between(dice, row.height_m[0], row.height_m[1])
    return length, width, height


def bed(dice: random.Random, length: float) -> Size:
    """A bed this wide; narrow ones are shorter, as for children."""
    low, high = (1.95, 2.1) if length < 1.3 else (2.05, 2.2)
    return length, between(dice, low, high), between(dice, 0.85, 1.1)


def panel(dice: random.Random, category: str, length: float) -> Size:
    """A wall panel behind a bed or sofa."""
    row = CATEGORIES[category]
    length = min(max(length, row.length_m[0]), row.length_m[1])
    return length, between(dice, 0.05, 0.1, 0.01), between(dice, *row.height_m, 0.1)


def wardrobe(dice: random.Random) -> tuple[float, float]:
    """(depth, height) of a tall cabinet for clothes."""
    return between(dice, 0.55, 0.65), between(dice, 2.0, 2.4, 0.1)


def square(dice: random.Random, category: str) -> Size:
    """A piece as deep as long."""
    row = CATEGORIES[category]
    side = between(dice, row.length_m[0], min(row.length_m[1], row.width_m[1]))
    return side, side, between(dice, *row.height_m)
