"""Plants that spill over shelves."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.library.kit.forms import (
    ball,
    rng_of,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    joined,
)
from chord_usd.library.plants.leaves import (
    HEART,
    LANCE,
    foliage,
    leaf,
    pot,
    tapered,
    turned,
)


def trailing(size_m: Size, *, kind: str = "pothos") -> tuple[Part, ...]:
    """A pot from which vines rise, bend over its rim and hang beside it."""
    length, width, height = size_m
    rng = rng_of(f"{kind}/{size_m}")
    r, h = min(length, width) * 0.28, height * 0.42
    vessel = pot("taper" if kind != "pearls" else "cylinder", r, h)
    stems, grids, pearls = [], [], []
    count = {"pothos": 12, "ivy": 11, "pearls": 13, "fern": 16}[kind]
    for index in range(count):
        yaw = 137.5 * index
        share = (index + 0.5) / count
        reach = length / 2 * (0.5 + 0.45 * share)
        peak = vessel.soil_m + (height - vessel.soil_m) * (0.9 - 0.65 * share)
        end = vessel.soil_m * (0.95 - 0.75 * share) if kind != "fern" else vessel.soil_m * 0.9
        t = np.linspace(0, 1, 9)
        out = reach * t**0.8
        z = (
            vessel.soil_m
            + (peak - vessel.soil_m) * np.sin(math.pi * np.clip(t * 1.25, 0, 1))
            + (end - vessel.soil_m) * t**2.4
        )
        # Over the rim, not through it.
        z = np.where((out < r * 1.25) & (out > r * 0.6), np.maximum(z, h + 0.008), z)
        z = np.maximum(z, 0.008)
        a = math.radians(yaw) + 0.5 * (t - 0.3) * float(rng.uniform(-1, 1))
        path = np.stack([out * np.cos(a), out * np.sin(a), z], -1)
        path[0] = [0.3 * r * math.cos(a[0]), 0.3 * r * math.sin(a[0]), vessel.soil_m - 0.008]
        stems.append(tapered(path, 0.0018, 0.001, 4))
        if kind == "pearls":
            for step in range(2, 9):
                for half in (0.0, 0.5):
                    low = min(step, 8)
                    at = path[low - 1] + half * (path[low] - path[low - 1])
                    pearls.append(
                        ball(0.006, 3, 6).moved(
                            *map(
                                float,
                                at + 0.004 * rng.standard_normal(3) * [1, 1, 0] + [0, 0, 0.004],
                            )
                        )
                    )
            continue
        for step in range(1, 9):
            for side in (-1, 1):
                if kind == "fern":
                    long = 0.045 * math.sin(math.pi * (0.2 + 0.75 * step / 9)) * length / 0.3
                    grid = leaf(
                        long, long * 0.34, LANCE, pitch_deg=12, droop_deg=40, rows=3, columns=3
                    )
                elif kind == "ivy":
                    long = float(rng.uniform(0.028, 0.04)) * length / 0.3
                    grid = leaf(
                        long,
                        long * 1.05,
                        (0.5, 1.0, 0.5, 0.62, 0.3, 0.0),
                        pitch_deg=float(rng.uniform(0, 40)),
                        droop_deg=60,
                        columns=3,
                    )
                else:
                    long = float(rng.uniform(0.045, 0.062)) * length / 0.3
                    grid = leaf(
                        long,
                        long * 0.8,
                        HEART,
                        pitch_deg=float(rng.uniform(5, 45)),
                        droop_deg=80,
                        columns=3,
                    )
                grids.append(
                    turned(
                        grid, yaw + side * float(rng.uniform(35, 85)), path[step] + [0, 0, 0.003]
                    )
                )
    named = [("Stems", joined(stems), "stem", False)]
    if grids:
        named.append(("Leaves", foliage(grids), "leaf", True))
    if pearls:
        named.append(("Pearls", joined(pearls), "leaf", False))
    corners = np.array([solid.bounds_m() for _, solid, _, _ in named])
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    parts = list(vessel.parts)
    for name, solid, slot, two_sided in named:
        points = solid.points_m.copy()
        for axis, half in ((0, length / 2), (1, width / 2)):
            points[:, axis] *= np.where(points[:, axis] > 0, half / high[axis], half / -low[axis])
        above = points[:, 2] > h
        points[above, 2] = h + (points[above, 2] - h) * (height - h) / (high[2] - h)
        points[:, 2] = np.maximum(points[:, 2], 0.002 + 0.004 * (points[:, 2] - low[2]))
        parts.append(Part(name, Solid(points, solid.faces), slot, None, two_sided=two_sided))
    return tuple(parts)
