"""Plants that stand on tables."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from chord_usd.library.kit.forms import lofted, rng_of
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import Size, joined
from chord_usd.library.plants.leaves import (
    HEART,
    LANCE,
    Pot,
    PotKind,
    bow,
    foliage,
    grown,
    leaf,
    pot,
    tapered,
    turned,
)

Grow = Callable[[Size, Pot], list]


def potted(
    size_m: Size, *, kind: PotKind, radius_m: float, height_m: float, grow: Grow
) -> tuple[Part, ...]:
    """A pot and what grows in it."""
    length, width, height = size_m
    vessel = pot(kind, radius_m, height_m)
    return (*vessel.parts, *grown(grow(size_m, vessel), length, width, vessel.soil_m, height))


def bush(
    size_m: Size,
    vessel: Pot,
    *,
    leaves: int = 26,
    long: float = 0.07,
    wide: float = 0.055,
    outline=HEART,
    droop: float = 70.0,
    seed: str = "bush",
) -> list:
    """Thin stalks close together, a round leaf on each."""
    rng = rng_of(f"{seed}/{size_m}")
    foot, height = vessel.soil_m, size_m[2]
    stalks, grids = [], []
    for index in range(leaves):
        share = math.sqrt((index + 0.5) / leaves)
        yaw = 137.508 * index + float(rng.uniform(-10, 10))
        at = 0.5 * vessel.radius_m * share
        start = (at * math.cos(math.radians(yaw)), at * math.sin(math.radians(yaw)), foot - 0.006)
        path = bow(
            start,
            yaw,
            size_m[0] * 0.32 * share,
            (height - foot) * (1.0 - 0.62 * share**1.6),
            0.06,
            5,
        )
        stalks.append(tapered(path, 0.0017, 0.0011, 5))
        size = float(rng.uniform(0.82, 1.15))
        grid = leaf(
            long * size,
            wide * size,
            outline,
            pitch_deg=48 - 46 * share,
            droop_deg=droop,
            fold=0.14,
            columns=5,
        )
        grids.append(turned(grid, yaw, path[-1]))
    return [("Stalks", joined(stalks), "stem", False), ("Leaves", foliage(grids), "leaf", True)]


def fern(size_m: Size, vessel: Pot, *, fronds: int = 16) -> list:
    """Arching fronds with leaflets on both sides."""
    rng = rng_of(f"fern/{size_m}")
    foot, height = vessel.soil_m, size_m[2]
    stalks, grids = [], []
    for index in range(fronds):
        share = (index + 0.5) / fronds
        yaw = 137.508 * index + float(rng.uniform(-8, 8))
        start = (
            0.008 * math.cos(math.radians(yaw)),
            0.008 * math.sin(math.radians(yaw)),
            foot - 0.006,
        )
        path = bow(
            start,
            yaw,
            size_m[0] * (0.24 + 0.26 * share),
            (height - foot) * (0.95 - 0.5 * share),
            0.42,
            9,
        )
        stalks.append(tapered(path, 0.0018, 0.0009, 4))
        for step in range(2, 10):
            long = size_m[0] * 0.14 * math.sin(math.pi * (0.16 + 0.78 * step / 9))
            for side in (-1, 1):
                grid = leaf(long, long * 0.36, LANCE, pitch_deg=16, droop_deg=44, rows=4, columns=2)
                grids.append(turned(grid, yaw + side * 66, path[step]))
    return [("Stalks", joined(stalks), "stem", False), ("Leaves", foliage(grids), "leaf", True)]


def rosette(size_m: Size, vessel: Pot, *, leaves: int = 34) -> list:
    """Thick spoon leaves in a close spiral."""
    foot, height = vessel.soil_m, size_m[2]
    solids = []
    for index in range(leaves):
        share = (index + 0.5) / leaves
        out = size_m[0] * (0.1 + 0.38 * share)
        pitch = math.radians(84 - 66 * share)
        rings = []
        section = np.linspace(0, 2 * math.pi, 8, endpoint=False)
        for t, wide, thick in (
            (0.0, 0.24, 0.5),
            (0.3, 0.4, 0.8),
            (0.62, 0.82, 1.0),
            (0.84, 0.94, 0.8),
            (0.95, 0.6, 0.5),
            (1.0, 0.0, 0.0),
        ):
            half = out * 0.27 * wide
            x = out * t * math.cos(pitch + 0.25 * t)
            z = out * t * math.sin(pitch + 0.25 * t)
            rings.append(
                np.stack(
                    [
                        x + 0.0 * section - half * 0.26 * thick * np.sin(section) * math.sin(pitch),
                        half * np.cos(section),
                        z + half * 0.26 * thick * np.sin(section) * math.cos(pitch),
                    ],
                    -1,
                )
            )
        solids.append(
            lofted(rings)
            .moved(0.004 + 0.0002 * index, 0.0, foot - 0.002 + 0.2 * (height - foot) * (1 - share))
            .turned("z", 137.508 * index)
        )
    return [("Leaves", joined(solids), "leaf", False)]
