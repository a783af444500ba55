"""A painted spot with two rooms' bubbles in it -> the two rooms.

Now and then the network paints two rooms of one kind as one, the wall between them broken or left
out. The bubble diagram shows that there are two; the wall is put where it is shortest, which is
along the rest of a wall, or else halfway between the bubbles.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np

from chord_usd.base.scene.types import BoolArray

OFF_HALFWAY_COST = 0.25
"""A wall so much shorter is worth a pixel's step away from halfway."""

_MOST_TRIED = 24
"""Walls, the cheapest first, that are looked at for one that leaves two rooms."""


@dataclass(frozen=True)
class Seed:
    """Where a room is known to be."""

    column: int
    row: int
    radius_px: float
    """About how large it is, beside others."""


@dataclass(frozen=True, order=True)
class _Wall:
    cost: float
    upright: bool
    at: int


def divided(spot: BoolArray, seeds: Sequence[Seed], least_px: float) -> list[BoolArray]:
    """Parts (H, W) of a spot (H, W) in one piece, each with one of the seeds that lie in it.

    least_px: pixels that a part must have; where there is no straight wall that leaves as many on
    both sides, seeds share a part.
    """
    if len(seeds) < 2:
        return [spot]
    for wall in sorted(_walls(spot, seeds))[:_MOST_TRIED]:
        parts = _parted(spot, wall)
        owned = [(part, [s for s in seeds if part[s.row, s.column]]) for part in parts]
        owned = [(part, within) for part, within in owned if within]
        if len(owned) > 1 and all(part.sum() >= least_px for part, _ in owned):
            return [room for part, seeds_in in owned for room in divided(part, seeds_in, least_px)]
    return [spot]


def _walls(spot: BoolArray, seeds: Sequence[Seed]) -> Iterator[_Wall]:
    """Straight lines between seeds that are neighbours in x or in y."""
    for upright in (True, False):
        lengths = spot.sum(axis=0 if upright else 1)
        places = sorted((seed.column if upright else seed.row, seed.radius_px) for seed in seeds)
        for (low, low_radius), (high, high_radius) in pairwise(places):
            halfway = low + (high - low) * low_radius / (low_radius + high_radius)
            for at in range(low + 1, high):
                cost = float(lengths[at]) + OFF_HALFWAY_COST * abs(at - halfway)
                yield _Wall(cost, upright, at)


def _parted(spot: BoolArray, wall: _Wall) -> list[BoolArray]:
    """What is left in pieces when a wall is taken out."""
    rest = spot.astype(np.uint8)
    rest[(slice(None), wall.at) if wall.upright else wall.at] = 0
    count, pieces = cv2.connectedComponents(rest, connectivity=4)
    return [pieces == piece for piece in range(1, count)]
