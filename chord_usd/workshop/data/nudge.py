"""Pieces that stick out of their room a little, brought back in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

from shapely.geometry.base import BaseGeometry

from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.types import Box


def nudged(box: Box, floor: BaseGeometry, steps_m: Sequence[float]) -> Box:
    """The box, moved along x and y by one of these steps each, or not, so that least is outside.

    Among moves that leave equally little outside, to a square centimetre, the shortest is taken.
    """
    x, y, z = box.center_m
    steps = (0.0, *steps_m, *(-step for step in steps_m))
    moves = sorted(product(steps, steps), key=lambda move: abs(move[0]) + abs(move[1]))
    moved = [replace(box, center_m=(x + dx, y + dy, z)) for dx, dy in moves]
    return min(
        moved, key=lambda candidate: round(footprint_polygon(candidate).difference(floor).area, 4)
    )
