"""Towels: over rails and ladders on the wall, and folded in stacks."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from chord_usd.base.scene.types import FloatArray, frozen_array
from chord_usd.library.cloth.stored import Cloth, stored
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import Size, Solid, block, cylinder, joined, pair, tube

_BAR_M = 0.009
_SIDE_M = (0.02, 0.038)
"""From the bar outwards: where a towel keeps its form, and how far it may flare."""


def _towel(name: str, length: float) -> Cloth:
    """A towel over a bar at the origin, this long along the bar, and no thicker than a rail's."""
    cloth = stored(name)
    low, high = cloth.solid.bounds_m()
    share = length / float(high[0] - low[0])
    cloth = cloth.scaled(x=share).moved(x=-share * float(low[0] + high[0]) / 2)
    points = cloth.solid.points_m.copy()
    side = np.abs(points[:, 1])
    most = max(float(side.max()), _SIDE_M[1])
    flare = (_SIDE_M[1] - _SIDE_M[0]) / (most - _SIDE_M[0])
    near = np.minimum(side, _SIDE_M[0]) + (side - _SIDE_M[0]).clip(0.0) * flare
    points[:, 1] = np.sign(points[:, 1]) * near
    return replace(cloth, solid=Solid(frozen_array(points), cloth.solid.faces))


def rail(size_m: Size, *, square: bool = False) -> tuple[Part, ...]:
    """A bar on two brackets with a bath towel and, where it is long, a hand towel beside it."""
    length, width, height = size_m
    hung = [("towel_long", 0.42, 0.0)]
    if length >= 0.6:
        hung = [("towel_long", 0.34, -length / 2 + 0.07 + 0.17),
                ("towel_short", 0.2, length / 2 - 0.07 - 0.1)]  # fmt: skip
    elif length < 0.5:
        hung = [("towel_long", length - 0.12, 0.0)]
    towels = [_towel(name, wide).moved(x=x) for name, wide, x in hung]
    high = max(float(towel.solid.bounds_m()[1, 2]) for towel in towels)
    front = min(float(towel.solid.bounds_m()[0, 1]) for towel in towels)
    y, z = -width / 2 - front, height - high
    if square:
        bar = block((length - 0.004, 0.016, 0.016), 0.002).moved(y=y, z=z - 0.008)
    else:
        bar = cylinder(_BAR_M, length - 0.004, 0.001, 16).turned("y", 90)
        bar = bar.moved(-length / 2 + 0.002, y, z)
    return (
        Part("Bar", bar, "metal", None),
        Part("Brackets", _brackets(length, width / 2, y, z), "metal", None),
        *_towel_parts(towels, y, z),
    )


def _brackets(length: float, back: float, y: float, z: float) -> Solid:
    foot = cylinder(0.022, 0.008, 0.002, 18).turned("x", 90).moved(y=back, z=z)
    arm = tube([[0, back - 0.004, z], [0, y, z]], 0.007, 10)
    side = length / 2 - 0.02
    return joined(pair(foot + arm, x=side))


def _towel_parts(towels: list[Cloth], y: float, z: float) -> tuple[Part, ...]:
    names = (("Towel", "towel"), ("Hand_Towel", "second"))
    return tuple(
        Part(name, towel.solid.moved(y=y, z=z), slot, None, uvs=towel.corner_uvs_m())
        for (name, slot), towel in zip(names, towels, strict=False)
    )


def ladder(size_m: Size) -> tuple[Part, ...]:
    """A heated rail: bars in groups between two posts, a towel over one of the upper bars."""
    length, width, height = size_m
    post, bar = 0.016, 0.011
    y = -width / 2 + 0.055
    side = length / 2 - post
    posts = pair(cylinder(post, height, 0.003, 16).moved(y=y), x=side)
    steps = [0.06 + 0.062 * i for i in range(int((height - 0.12) / 0.062) + 1)]
    levels = [z for i, z in enumerate(steps) if i % 6 != 5]
    bars = [
        cylinder(bar, 2 * side, 0.0, 12).turned("y", 90).moved(-side, y - 0.014, z) for z in levels
    ]
    feet = [
        tube([[s * side, y, z], [s * side, width / 2, z]], 0.008, 8)
        for s in (-1, 1)
        for z in (0.1, height - 0.1)
    ]
    towel = _towel("towel_long", min(0.36, length - 0.1))
    high = [z for z in levels if z < height - 0.12][-1]
    return (
        Part("Ladder", joined([*posts, *bars, *feet]), "metal", None),
        *_towel_parts([towel], y - 0.014, high),
    )


def stack(size_m: Size, *, layers: int) -> tuple[Part, ...]:
    """Folded towels on each other, their folds to the front."""
    length, width, height = size_m
    each = height / layers
    rng = np.random.default_rng(layers * 100 + round(1000 * length))
    parts: dict[str, list[tuple[Solid, FloatArray]]] = {}
    for layer in range(layers):
        slot = ("towel", "second")[layer % 2 if layers > 2 else 0]
        wide = length * (1.0 - 0.05 * rng.random()) if layer else length
        deep = width * (1.0 - 0.05 * rng.random()) if layer else width
        solid, uvs = _folded(wide, deep, each * 1.03 if layer < layers - 1 else each, rng)
        aside = (length - wide) / 2 * rng.uniform(-1, 1)
        solid = solid.moved(aside, 0.0, each * layer)
        parts.setdefault(slot, []).append((solid, uvs))
    names = {"towel": "Towels", "second": "Other_Towels"}
    return tuple(
        Part(names[slot], joined([solid for solid, _ in made]), slot, "boundingCube",
             uvs=np.concatenate([uvs for _, uvs in made]))
        for slot, made in parts.items()
    )  # fmt: skip


def _folded(
    length: float, width: float, height: float, rng: np.random.Generator
) -> tuple[Solid, FloatArray]:
    """One towel, folded to three layers that show as rounded bends at its front."""
    layers, half = 3, height / 6
    outline = []
    for layer in range(layers):
        z = half * (2 * layer + 1)
        bend = [(-width / 2 + half - half * math.cos(a), z + half * math.sin(a))
                for a in np.radians(np.linspace(-78, 78, 7))]  # fmt: skip
        outline += bend
    top = height
    outline += [(y, top) for y in np.linspace(-width / 2 + half, width / 2 - half, 6)[1:]]
    outline += [(width / 2 - half + half * math.sin(a), top - half + half * math.cos(a))
                for a in np.radians(np.linspace(20, 90, 4))]  # fmt: skip
    outline += [(width / 2, half)]
    outline += [(width / 2 - half + half * math.cos(a), half - half * math.sin(a))
                for a in np.radians(np.linspace(20, 90, 4))]  # fmt: skip
    outline += [(y, 0.0) for y in np.linspace(width / 2 - half, -width / 2 + half, 6)[1:-1]]
    flat = np.array(outline)
    return _swept(flat, length, half, rng)


def _swept(
    outline: FloatArray, length: float, round_m: float, rng: np.random.Generator
) -> tuple[Solid, FloatArray]:
    """An outline (y, z) drawn along x, its ends drawn in a little, gently uneven."""
    x = length / 2 * np.array([-1, -0.985, -0.93, -0.6, -0.2, 0.2, 0.6, 0.93, 0.985, 1.0])
    inset = round_m * np.array([0.8, 0.25, 0, 0, 0, 0, 0, 0, 0.25, 0.8])
    centre = (outline.min(axis=0) + outline.max(axis=0)) / 2
    half = np.ptp(outline, axis=0) / 2
    sag = np.interp(x, np.linspace(-length / 2, length / 2, 5), rng.normal(0, 0.0015, 5))
    rings = []
    for at, drawn, lift in zip(x, inset, sag, strict=True):
        ring = centre + (outline - centre) * (1 - drawn / half)
        up = ring[:, 1] + lift * (ring[:, 1] / (2 * half[1]))
        rings.append(np.column_stack([np.full(len(ring), at), ring[:, 0], up]))
    grid = np.array(rings)
    count, rows = grid.shape[1], grid.shape[0]
    here = np.arange(count)
    after = (here + 1) % count
    faces = []
    for row in range(rows - 1):
        a, b = row * count, (row + 1) * count
        faces.append(np.stack([a + here, b + here, b + after], -1))
        faces.append(np.stack([a + here, b + after, a + after], -1))
    ends = [grid[0].mean(axis=0), grid[-1].mean(axis=0)]
    last = rows * count
    faces.append(np.stack([here, after, np.full(count, last)], -1))
    faces.append(np.stack([(rows - 1) * count + after, (rows - 1) * count + here,
                           np.full(count, last + 1)], -1))  # fmt: skip
    points = np.concatenate([grid.reshape(-1, 3), np.array(ends)])
    made = np.concatenate(faces)
    a, b, c = (points[made[:, corner]] for corner in range(3))
    if float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) < 0.0:
        made = made[:, ::-1].copy()
    around = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(outline, axis=0), axis=1))])
    uv = np.stack(np.broadcast_arrays(x[:, None], around[None, :]), -1).reshape(-1, 2)
    uv = np.concatenate([uv, [[x[0], 0.0], [x[-1], 0.0]]])
    solid = Solid(frozen_array(points), frozen_array(made, np.int64))
    return solid, uv[made.reshape(-1)]
