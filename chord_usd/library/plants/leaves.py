"""What plants are made of: leaves as curved sheets, stems, pots, soil."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray, frozen_array
from chord_usd.library.kit.forms import arc, cup, hollow, outward, sheet
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Solid,
    block,
    cylinder,
    joined,
    lathe,
    loft,
    pair,
    rounded_slab,
    tube,
)

PotKind = Literal["taper", "cylinder", "stand", "basket", "cube", "rim", "belly", "fluted"]

OVAL = (0.06, 0.62, 0.96, 1.0, 0.8, 0.42, 0.0)
FIDDLE = (0.1, 0.52, 0.6, 0.7, 1.0, 0.98, 0.62, 0.0)
LANCE = (0.1, 0.7, 1.0, 0.85, 0.5, 0.0)
HEART = (0.3, 0.95, 1.0, 0.86, 0.62, 0.32, 0.0)
SWORD = (0.62, 0.86, 1.0, 0.96, 0.8, 0.5, 0.0)

_APART_M = 4e-6
"""From leaf to leaf: sheets that meet in a point alone are no surface."""


def leaf(
    long_m: float,
    wide_m: float,
    outline: Sequence[float],
    *,
    pitch_deg: float,
    droop_deg: float,
    fold: float = 0.18,
    rows: int = 0,
    columns: int = 3,
    twist_deg: float = 0.0,
    slits: int = 0,
) -> FloatArray:
    """(rows, columns, 3) grid of a leaf that grows from the origin towards +x.

    outline: half widths, shares of wide_m / 2, at even steps from stalk to tip. It starts at
    pitch_deg above the horizon and has sunk by droop_deg at the tip. fold: how far the halves rise
    beside the middle rib, a share of the width. slits: cuts a side, as a monstera's.
    """
    count = rows or len(outline)
    share = np.linspace(0.0, 1.0, count)
    angle = np.radians(pitch_deg - droop_deg * (0.5 * (share[:-1] + share[1:])) ** 1.2)
    step = long_m / (count - 1)
    x = np.concatenate([[0.0], np.cumsum(step * np.cos(angle))])
    z = np.concatenate([[0.0], np.cumsum(step * np.sin(angle))])
    spread = np.linspace(-1.0, 1.0, columns)
    half = np.interp(share, np.linspace(0, 1, len(outline)), outline) * wide_m / 2
    reach = half[:, None] * spread[None, :]
    if slits:
        wave = np.abs(np.sin(math.pi * slits * np.clip(share - 0.12, 0, 1) / 0.8))
        cut = np.where((share > 0.14) & (share < 0.9), 0.42 + 0.58 * wave**0.6, 1.0)
        reach = np.where(np.abs(spread) > 0.9, reach * cut[:, None], reach)
    twist = np.radians(twist_deg) * share[:, None]
    lift = fold * np.abs(reach) * np.cos(0.5 * math.pi * share)[:, None] + reach * np.sin(twist)
    slope = np.gradient(z, x + 1e-9 * np.arange(count)) if long_m > 0 else np.zeros(count)
    tilt = np.arctan(slope)
    grid = np.stack(
        [
            x[:, None] - lift * np.sin(tilt)[:, None],
            reach * np.cos(twist),
            z[:, None] + lift * np.cos(tilt)[:, None],
        ],
        axis=-1,
    )
    return grid


def turned(grid: FloatArray, yaw_deg: float, at: Sequence[float] | FloatArray) -> FloatArray:
    """A grid turned about z and moved."""
    cos, sin = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    matrix = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return grid @ matrix.T + np.asarray(at, dtype=np.float64)


def foliage(grids: Sequence[FloatArray]) -> Solid:
    """All leaves in one open mesh; none shares a point with another, even on one stalk."""
    return joined([sheet(grid).moved(z=_APART_M * n) for n, grid in enumerate(grids)])


def bow(
    foot: Sequence[float],
    yaw_deg: float,
    out_m: float,
    rise_m: float,
    sag: float = 0.0,
    steps: int = 6,
) -> FloatArray:
    """(N, 3) path of a stem that rises first and leans out later; sag bends its end down."""
    t = np.linspace(0.0, 1.0, steps + 1)
    out, up = out_m * t**1.7, rise_m * (t - sag * t**3) / (1.0 - sag)
    cos, sin = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    return np.stack([out * cos, out * sin, up], axis=-1) + np.asarray(foot, dtype=np.float64)


def tapered(path: FloatArray, thick_m: float, tip_m: float, sides: int = 7) -> Solid:
    """A stem along a path that thins towards its end."""
    stem = tube(path, 1.0, sides)
    return _thinned(stem, path, thick_m, tip_m)


def _thinned(stem: Solid, path: FloatArray, thick_m: float, tip_m: float) -> Solid:
    """A tube of radius 1 with its sections drawn to their own radius."""
    # Which point of the path a vertex belongs to: tube lays its rings down in order.
    count = len(path)
    sides = (len(stem.points_m) - 2) // count
    owner = np.minimum(np.arange(len(stem.points_m)) // sides, count - 1)
    owner[-2:] = (0, count - 1)
    radius = np.linspace(thick_m, tip_m, count)[owner]
    points = path[owner] + (stem.points_m - path[owner]) * radius[:, None]
    return Solid(frozen_array(points), stem.faces)


def reaching(
    solid: Solid,
    length_m: float,
    width_m: float,
    low_m: float,
    high_m: float,
    bounds_m: FloatArray,
) -> Solid:
    """A plant drawn out so that bounds_m would fill its box; what is on the axis stays there."""
    low, high = bounds_m
    points = solid.points_m.copy()
    for axis, side in ((0, length_m / 2), (1, width_m / 2)):
        ahead = points[:, axis] > 0
        points[:, axis] *= np.where(ahead, side / high[axis], side / -low[axis])
    above = points[:, 2] > low_m
    points[above, 2] = low_m + (points[above, 2] - low_m) * (high_m - low_m) / (high[2] - low_m)
    return Solid(frozen_array(points), solid.faces)


def grown(
    named: Sequence[tuple[str, Solid, str, bool]],
    length_m: float,
    width_m: float,
    low_m: float,
    high_m: float,
) -> tuple[Part, ...]:
    """Parts of the plant above its pot: (name, solid, slot, two-sided), brought to its box."""
    corners = np.array([solid.bounds_m() for _, solid, _, _ in named])
    bounds = np.array([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])
    return tuple(
        Part(
            name,
            reaching(solid, length_m, width_m, low_m, high_m, bounds),
            slot,
            None,
            two_sided=two_sided,
        )
        for name, solid, slot, two_sided in named
    )


@dataclass(frozen=True)
class Pot:
    """A pot with its soil."""

    parts: tuple[Part, ...]
    soil_m: float
    """Height of the soil."""
    radius_m: float
    """Of the soil."""


def pot(kind: PotKind, radius_m: float, height_m: float) -> Pot:
    """A pot of this outer radius and height, filled up to a finger below its rim."""
    r, h = radius_m, height_m
    draw = {"basket": _basket, "stand": _on_stand, "cube": _cube}.get(kind)
    if draw is not None:
        return draw(r, h)
    thick = 0.008 if r > 0.06 else 0.005
    profile = {
        "taper": [(0.0, 0.0), (0.68 * r, 0.0), (0.72 * r, 0.012), (r, h)],
        "cylinder": [(0.0, 0.0), (r - 0.008, 0.0), (r, 0.008), (r, h)],
        "rim": [(0.0, 0.0), (0.66 * r, 0.0), (0.9 * r, 0.8 * h), (r, 0.8 * h), (r, h)],
        "belly": [
            (0.0, 0.0),
            (0.6 * r, 0.0),
            *arc((0.62 * r, 0.01), (1.2 * r, 0.55 * h), (0.82 * r, h), 9),
        ],
        "fluted": [(0.0, 0.0), (0.8 * r, 0.0), (0.84 * r, 0.01), (r, h)],
    }[kind]
    floor = h - min(0.03, 0.18 * h) - 0.012
    body = cup(profile, thick, floor, 40 if kind == "fluted" else 32)
    if kind == "fluted":
        body = _fluted(body, r)
    top = np.interp(h - 0.03, [z for _, z in profile[1:]], [x for x, _ in profile[1:]]) - thick
    soil = _soil(float(top) - 0.001, floor)
    return Pot((Part("Pot", body, "pot"), soil), floor + 0.012, float(top))


def _soil(radius_m: float, floor_m: float) -> Part:
    crumbs = lathe(
        [
            (radius_m, 0.0),
            (radius_m, 0.008),
            (radius_m * 0.6, 0.012),
            (radius_m * 0.3, 0.009),
            (0.0, 0.013),
        ],
        20,
    )
    return Part("Soil", crumbs.moved(z=floor_m + 0.0005), "soil", None)


def _fluted(body: Solid, radius_m: float) -> Solid:
    """Hollows around the outside."""
    points = body.points_m.copy()
    flat = np.hypot(points[:, 0], points[:, 1])
    angle = np.arctan2(points[:, 1], points[:, 0])
    outside = flat > 0.7 * radius_m
    points[:, :2] *= np.where(outside, 1.0 - 0.03 * (np.round(angle * 20 / math.pi) % 2), 1.0)[
        :, None
    ]
    return Solid(frozen_array(points), body.faces)


def _cube(r: float, h: float) -> Pot:
    side = 1.72 * r
    outer = rounded_slab((side, side, h - 0.0), 0.012, 0.004, 3)
    inner = block((side - 0.03, side - 0.03, 0.02), 0.002).moved(z=h - 0.014)
    # A low wall around the soil: four boards rather than a hollow cube.
    walls = pair(block((side, 0.016, 0.03), 0.003).moved(z=h - 0.028), y=(side - 0.016) / 2) + pair(
        block((0.016, side - 0.03, 0.0295), 0.003).moved(z=h - 0.028), x=(side - 0.016) / 2
    )
    body = outer.scaled(1.0, 1.0, (h - 0.022) / h)
    soil = Part("Soil", inner.moved(z=-0.014), "soil", None)
    return Pot(
        (Part("Pot", body, "pot"), Part("Rim", joined(walls), "pot", None), soil),
        h - 0.008,
        side / 2 - 0.02,
    )


def _on_stand(r: float, h: float) -> Pot:
    """A round pot hung between four wooden legs."""
    inner = 0.9 * r
    low = 0.3 * h
    profile = [(0.0, low), (inner - 0.01, low), (inner, low + 0.01), (inner, h)]
    floor = h - 0.05
    body = cup(profile, 0.008, floor, 32)
    leg = block((0.026, 0.026, 0.82 * h), 0.005)
    at = inner + 0.012
    legs = [leg.moved(x=at).turned("z", turn) for turn in (45, 135, 225, 315)]
    bars = [
        block((2 * at, 0.022, 0.022), 0.003).turned("z", turn).moved(z=low - 0.0215 - i * 0.001)
        for i, turn in enumerate((45, 135))
    ]
    colliders = (cylinder(inner, h - low).moved(z=low), cylinder(0.7 * inner, low))
    return Pot(
        (
            Part("Pot", body, "pot", colliders=colliders),
            Part("Stand", joined([*legs, *bars]), "stand", None),
            _soil(inner - 0.01, floor),
        ),
        floor + 0.012,
        inner - 0.01,
    )


def woven_skin(
    profile_m: Sequence[tuple[float, float]],
    thick_m: float,
    floor_m: float,
    *,
    strands: int = 36,
    depth_m: float = 0.004,
    rows: int = 11,
) -> Solid:
    """A basket's wall: strands that go over and under upright rods, row by row.

    profile_m: (radius, z) of the outside from the foot to the rim.
    """
    heights = np.array([z for _, z in profile_m])
    radii = np.array([r for r, _ in profile_m])
    levels = np.linspace(heights[0], heights[-1], rows + 1)
    rings = [np.zeros((strands, 3)) + np.array([0.0, 0.0, heights[0]])]
    turn = np.linspace(0, 2 * math.pi, strands, endpoint=False)
    over = np.where(np.arange(strands) % 2 == 0, 1.0, -1.0)
    for row, (low, high) in enumerate(itertools.pairwise(levels)):
        for share, push in ((0.04, -0.7), (0.5, 1.0)):
            z = low + share * (high - low)
            weave = over * (1 if row % 2 == 0 else -1) if push > 0 else 0.0
            radius = np.interp(z, heights, radii) + depth_m * (push * 0.4 + 0.8 * weave) - depth_m
            rings.append(
                np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(strands, z)], -1)
            )
    rim = np.interp(heights[-1], heights, radii)
    for radius, z in ((rim, heights[-1] - 0.004), (rim - thick_m, heights[-1] - 0.004)):
        rings.append(
            np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(strands, z)], -1)
        )
    for share in (0.66, 0.33, 0.0):
        z = floor_m + share * (heights[-1] - floor_m)
        radius = np.interp(z, heights, radii) - thick_m - depth_m
        rings.append(
            np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(strands, z)], -1)
        )
    rings.append(np.zeros((strands, 3)) + np.array([0.0, 0.0, floor_m]))
    return outward(loft(rings))


def _basket(r: float, h: float) -> Pot:
    profile = [(0.82 * r, 0.0), (0.97 * r, 0.4 * h), (r, 0.6 * h), (0.93 * r, h)]
    floor = h - 0.05
    wall = woven_skin(profile, 0.01, floor, strands=36, rows=10)
    rim = hollow([(0.935 * r, h - 0.014), (0.945 * r, h - 0.006), (0.935 * r, h)], 0.014, 36)
    ears = []
    for s in (-1, 1):
        path = np.array(
            [
                [0.03 * c, 0.0, 0.03 * d]
                for c, d in ((-1, -0.2), (-0.9, 0.7), (0, 1.1), (0.9, 0.7), (1, -0.2))
            ]
        )
        ears.append(tube(path, 0.005, 6).turned("z", 90).moved(s * 0.93 * r, 0.0, h - 0.01))
    return Pot(
        (
            Part("Pot", wall, "basket"),
            Part("Rim", joined([rim, *ears]), "basket", None),
            _soil(0.9 * r - 0.012, floor),
        ),
        floor + 0.012,
        0.85 * r,
    )
