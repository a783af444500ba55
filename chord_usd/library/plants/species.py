"""How plants grow: for each species, the parts above its pot, ready for leaves.grown()."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.forms import (
    outward,
    rng_of,
)
from chord_usd.library.kit.solids import Size, joined, loft
from chord_usd.library.plants.leaves import (
    FIDDLE,
    HEART,
    LANCE,
    SWORD,
    bow,
    foliage,
    leaf,
    tapered,
    turned,
)

GOLDEN_DEG = 137.508


def tree(
    size_m: Size,
    vessel,
    *,
    outline=FIDDLE,
    leaves=34,
    long=0.24,
    wide=0.15,
    stems=1,
    bare=0.36,
    pitch=38.0,
    droop=62.0,
    seed="tree",
) -> list:
    """Big leaves in a spiral around one or several stems."""
    rng = rng_of(f"{seed}/{size_m}")
    foot, height = vessel.soil_m, size_m[2]
    rise = height - foot
    wood, grids = [], []
    for stem in range(stems):
        yaw = 360.0 * stem / stems + 40
        lean = 0.05 + 0.05 * (stems > 1)
        start = (
            0.03 * (stems > 1) * math.cos(math.radians(yaw)),
            0.03 * (stems > 1) * math.sin(math.radians(yaw)),
            foot - 0.01,
        )
        tall = rise * (0.9, 0.74, 0.6)[stem]
        path = bow(start, yaw, lean, tall, steps=9)
        path[1:-1, :2] += 0.008 * rng.standard_normal((len(path) - 2, 2))
        wood.append(tapered(path, 0.013 if stems == 1 else 0.009, 0.004, 8))
        count = leaves // stems
        for index in range(count):
            share = bare + (1.0 - bare) * (index + 0.5) / count
            at = _along(path, share)
            top = (share - bare) / (1 - bare)
            size = (0.72 + 0.5 * math.sin(math.pi * (0.25 + 0.6 * top))) * float(
                rng.uniform(0.88, 1.1)
            )
            grid = leaf(
                long * size,
                wide * size,
                outline,
                droop_deg=droop * float(rng.uniform(0.8, 1.25)),
                pitch_deg=pitch - 22 + 52 * top + float(rng.uniform(-9, 9)),
                fold=0.2,
                columns=5 if leaves < 40 else 3,
            )
            grid[..., 0] += 0.03
            grids.append(turned(grid, GOLDEN_DEG * index + yaw + float(rng.uniform(-14, 14)), at))
            # The stalk: a narrow strip from the stem to the blade.
            reach = turned(
                np.array(
                    [
                        [[0, -0.0016, 0], [0, 0.0016, 0]],
                        [[0.034, -0.0016, 0.004], [0.034, 0.0016, 0.004]],
                    ]
                ),
                GOLDEN_DEG * index + yaw,
                at,
            )
            grids.append(reach)
    return [("Stem", joined(wood), "bark", False), ("Leaves", foliage(grids), "leaf", True)]


def _along(path: FloatArray, share: float) -> FloatArray:
    where = share * (len(path) - 1)
    low = min(int(where), len(path) - 2)
    return path[low] + (where - low) * (path[low + 1] - path[low])


def monstera(
    size_m: Size,
    vessel,
    *,
    leaves: int = 12,
    slits: int = 4,
    outline=HEART,
    long: float = 0.3,
    wide: float = 0.29,
    pitch: float = 26.0,
    seed: str = "monstera",
) -> list:
    """Long stalks from the pot, each with one broad leaf: parts for grown()."""
    rng = rng_of(f"{seed}/{size_m}")
    foot, height = vessel.soil_m, size_m[2]
    stalks, grids = [], []
    for index in range(leaves):
        share = (index + 0.5) / leaves
        yaw = GOLDEN_DEG * index + float(rng.uniform(-12, 12))
        rise = (height - foot) * (0.94 - 0.62 * share)
        out = size_m[0] * (0.1 + 0.2 * share)
        at = 0.012 + 0.001 * index
        foot_m = (at * math.cos(math.radians(yaw)), at * math.sin(math.radians(yaw)), foot - 0.01)
        path = bow(foot_m, yaw, out, rise, 0.1)
        stalks.append(tapered(path, 0.006, 0.0035, 6))
        size = float(rng.uniform(0.86, 1.14)) * (1.06 - 0.2 * share)
        grid = leaf(
            long * size,
            wide * size,
            outline,
            pitch_deg=pitch - 30 * share,
            droop_deg=58,
            fold=0.12,
            rows=24 if slits else 9,
            columns=5,
            slits=slits,
        )
        grid[..., 0] -= 0.16 * long * size * (slits > 0)
        grids.append(turned(grid, yaw, path[-1]))
    return [("Stalks", joined(stalks), "stem", False), ("Leaves", foliage(grids), "leaf", True)]


def snake(size_m: Size, vessel, *, leaves: int = 15) -> list:
    """Stiff swords with a pale edge: parts for grown()."""
    rng = rng_of(f"snake/{size_m}")
    foot, height = vessel.soil_m, size_m[2]
    green, edge = [], []
    for index in range(leaves):
        share = math.sqrt((index + 0.5) / leaves)
        yaw = GOLDEN_DEG * index
        tall = (height - foot) * (1.0 - 0.45 * share**2) * float(rng.uniform(0.86, 1.0))
        wide = float(rng.uniform(0.05, 0.07)) * (0.8 + 0.3 * height)
        grid = leaf(
            tall,
            wide,
            SWORD,
            pitch_deg=88 - 13 * share,
            droop_deg=float(rng.uniform(-3, 5)),
            fold=0.22,
            rows=11,
            columns=7,
            twist_deg=float(rng.uniform(-70, 70)),
        )
        at = (
            0.62 * vessel.radius_m * share * math.cos(math.radians(yaw)),
            0.62 * vessel.radius_m * share * math.sin(math.radians(yaw)),
            foot - 0.005,
        )
        spun = turned(grid, yaw + 90 * (index % 2), at)
        green.append(spun[:, 1:-1])
        edge += [spun[:, :2], spun[:, -2:]]
    return [("Leaves", foliage(green), "leaf", True), ("Edges", foliage(edge), "edge", True)]


def palm(size_m: Size, vessel, *, fronds: int = 13) -> list:
    """Arching fronds of narrow leaflets."""
    rng = rng_of(f"palm/{size_m}")
    foot, height = vessel.soil_m, size_m[2]
    stalks, grids = [], []
    for index in range(fronds):
        share = (index + 0.5) / fronds
        yaw = GOLDEN_DEG * index + float(rng.uniform(-10, 10))
        path = bow(
            (0.012 * math.cos(index), 0.012 * math.sin(index), foot - 0.01),
            yaw,
            size_m[0] * (0.2 + 0.34 * share),
            (height - foot) * (0.98 - 0.46 * share),
            0.3,
            10,
        )
        stalks.append(tapered(path, 0.006, 0.002, 5))
        for step in range(14):
            t = 0.36 + 0.64 * step / 13
            at = _along(path, t)
            long = 0.2 * (0.55 + 0.6 * math.sin(math.pi * (t - 0.3) / 0.75)) * (0.6 + 0.3 * height)
            for side in (-1, 1):
                grid = leaf(long, 0.02, LANCE, pitch_deg=14, droop_deg=58, rows=4, columns=2)
                grids.append(turned(grid, yaw + side * (62 - 34 * t), at))
    return [("Stalks", joined(stalks), "stem", False), ("Leaves", foliage(grids), "leaf", True)]


def olive(
    size_m: Size,
    vessel,
    *,
    twigs: int = 44,
    leaves: int = 10,
    long: float = 0.07,
    wide: float = 0.02,
    outline=LANCE,
    crown: float = 0.5,
    seed: str = "olive",
) -> list:
    """A slim trunk, forked branches, small leaves in pairs along the twigs."""
    rng = rng_of(f"{seed}/{size_m}")
    foot, height = vessel.soil_m, size_m[2]
    rise = height - foot
    trunk = bow((0.0, 0.0, foot - 0.01), 60, 0.03, rise * 0.62, steps=8)
    trunk[1:-1, :2] += 0.006 * rng.standard_normal((len(trunk) - 2, 2))
    wood, grids = [tapered(trunk, 0.016, 0.007, 8)], []
    middle = np.array([0.0, 0.0, foot + rise * (1 - crown * 0.62)])
    for index in range(twigs):
        start = _along(trunk, 0.5 + 0.5 * ((index * 0.618) % 1.0))
        z = 1.0 - 2.0 * (index + 0.5) / twigs
        yaw = math.radians(GOLDEN_DEG * index)
        flat = math.sqrt(1 - z * z)
        goal = middle + np.array(
            [
                size_m[0] * 0.46 * flat * math.cos(yaw),
                size_m[1] * 0.46 * flat * math.sin(yaw),
                rise * crown * 0.56 * z,
            ]
        ) * float(rng.uniform(0.72, 1.0))
        elbow = (start + goal) / 2 + np.array([0, 0, 0.03])
        t = np.linspace(0, 1, 5)[:, None]
        path = (1 - t) ** 2 * start + 2 * t * (1 - t) * elbow + t**2 * goal
        wood.append(tapered(path, 0.004, 0.0014, 4))
        for step in range(leaves):
            at = _along(path, 0.34 + 0.66 * step / (leaves - 1))
            size = float(rng.uniform(0.8, 1.15))
            grid = leaf(
                long * size,
                wide * size,
                outline,
                pitch_deg=float(rng.uniform(-20, 60)),
                droop_deg=25,
                rows=4,
                columns=2,
            )
            grids.append(
                turned(
                    grid,
                    math.degrees(yaw) + (step % 2 * 2 - 1) * 62 + float(rng.uniform(-25, 25)),
                    at,
                )
            )
    return [("Wood", joined(wood), "bark", False), ("Leaves", foliage(grids), "leaf", True)]


def bamboo(size_m: Size, vessel, *, canes: int = 7) -> list:
    """Jointed canes with sprays of narrow leaves."""
    rng = rng_of(f"bamboo/{size_m}")
    foot, height = vessel.soil_m, size_m[2]
    wood, grids = [], []
    for cane in range(canes):
        yaw = GOLDEN_DEG * cane
        spot = 0.55 * vessel.radius_m * math.sqrt((cane + 0.5) / canes)
        tall = (height - foot) * float(rng.uniform(0.72, 0.97))
        start = (
            spot * math.cos(math.radians(yaw)),
            spot * math.sin(math.radians(yaw)),
            foot - 0.01,
        )
        path = bow(start, yaw, size_m[0] * 0.2, tall, steps=8)
        wood.append(tapered(path, 0.0085, 0.004, 6))
        for joint in range(3, 9):
            at = path[joint]
            for spray in range(3):
                turn = yaw + 120 * spray + 47 * joint + float(rng.uniform(-20, 20))
                for blade in range(4):
                    long = float(rng.uniform(0.11, 0.17))
                    grid = leaf(
                        long,
                        0.017,
                        LANCE,
                        pitch_deg=20 + 16 * blade,
                        droop_deg=78,
                        rows=4,
                        columns=2,
                    )
                    grid[..., 0] += 0.04 + 0.02 * blade
                    grid[..., 2] += 0.02 * blade
                    grids.append(turned(grid, turn + (blade - 1.5) * 20, at))
    return [("Canes", joined(wood), "stem", False), ("Leaves", foliage(grids), "leaf", True)]


def cactus(size_m: Size, vessel) -> list:
    """Ribbed columns, one tall, two short."""
    foot, height = vessel.soil_m, size_m[2]
    columns = []
    for x, y, tall, wide in (
        (0.0, 0.0, 1.0, 1.0),
        (0.085, 0.03, 0.56, 0.75),
        (-0.06, -0.06, 0.34, 0.62),
    ):
        ribs, sides = 9, 36
        turn = np.linspace(0, 2 * math.pi, sides, endpoint=False)
        rings = []
        top = (height - foot) * tall
        for share, swell in (
            (0.0, 0.8),
            (0.2, 0.96),
            (0.6, 1.0),
            (0.84, 0.92),
            (0.94, 0.68),
            (0.985, 0.34),
            (1.0, 0.0),
        ):
            radius = 0.062 * wide * swell * (1.0 + 0.13 * np.cos(ribs * turn))
            rings.append(
                np.stack(
                    [
                        x + radius * np.cos(turn),
                        y + radius * np.sin(turn),
                        np.full(sides, foot - 0.01 + top * share),
                    ],
                    -1,
                )
            )
        columns.append(outward(loft(rings)))
    return [("Columns", joined(columns), "leaf", False)]
