"""Tools to cook with, and the crock in which they stand."""

from __future__ import annotations

import numpy as np

from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    cylinder,
    joined,
    lathe,
    rounded_profile,
    tube,
)
from chord_usd.library.kitchen.vessels import vessel


def whisk_head(low_m: float, long_m: float) -> Solid:
    """Three loops of wire about the upright axis, from low_m up."""
    wires = []
    for index, turn in enumerate((0.0, 61.7, 123.1)):
        arc = [
            [0.025 * np.sin(a) * (1 - 0.3 * np.cos(a)), 0.0,
             low_m + 0.0008 * index + long_m * (1 - np.cos(a)) / 2]
            for a in np.linspace(0.06, 2 * np.pi - 0.06, 15)
        ]  # fmt: skip
        wires.append(tube(arc, 0.0013, 5).turned("z", turn))
    return joined(wires)


def utensil_jar(size_m: Size) -> tuple[Part, ...]:
    """A crock of wooden spoons and other tools."""
    _length, _width, tall = size_m
    radius = 0.055
    high = 0.155
    crock = vessel(
        rounded_profile(
            [
                (radius * 0.9, 0),
                (radius, 0.006),
                (radius, 0.02),
                (radius, high - 0.01),
                (radius * 1.02, high),
            ],
            1,
        ),
        0.005,
        0.01,
        30,
    )
    wooden: list[Solid] = []
    steel: list[Solid] = []
    leans = ((-11, 6, 0), (8, 10, 1), (10, -9, 2), (-5, -10, 0), (2, 2, 1))
    for index, (about_y, about_x, kind) in enumerate(leans):
        stem_top = tall - 0.08 - 0.014 * index
        tool = cylinder(0.0048, stem_top - 0.012, 0.001, 8).moved(z=0.0)
        if kind == 0:
            tool += (
                lathe([(0.004, 0), (0.018, 0.02), (0.023, 0.045), (0.016, 0.07), (0, 0.076)], 16)
                .scaled(1.0, 0.36, 1.0)
                .moved(z=stem_top - 0.018)
            )
        elif kind == 1:
            tool += block((0.05, 0.006, 0.075), 0.002).moved(0.0005, 0.0003, z=stem_top - 0.016)
        else:
            tool += whisk_head(stem_top - 0.03, 0.1)
        placed = tool.turned("y", about_y).turned("x", about_x).moved(0.0007 * index, 0.0, 0.016)
        (steel if kind == 2 else wooden).append(placed)
    return (
        Part("Crock", crock, "ware"),
        Part("Spoons", joined(wooden), "wood", collider=None),
        Part("Whisk", joined(steel), "steel", collider=None),
    )
