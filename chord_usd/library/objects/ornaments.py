"""Sculptures and candles for shelves and sills."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.library.kit.forms import (
    ball,
    cup,
    hollow,
    lofted,
    outward,
    rng_of,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    at_corners,
    block,
    box,
    cylinder,
    joined,
    lathe,
    pair,
    rounded_slab,
    tube,
)


def _stand(length: float, width: float, height: float, slot: str = "stone") -> Part:
    return Part("Plinth", block((length, width, height), 0.003), slot)


def knot(size_m: Size) -> tuple[Part, ...]:
    """A band that winds through itself (a trefoil), on a plinth."""
    length, width, height = size_m
    foot = height * 0.14
    t = np.linspace(0, 2 * math.pi, 61)[:-1]
    path = np.stack(
        [np.sin(t) + 2 * np.sin(2 * t), 0.9 * -np.sin(3 * t), np.cos(t) - 2 * np.cos(2 * t)], -1
    )
    tangent = np.roll(path, -1, 0) - np.roll(path, 1, 0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    section = np.linspace(0, 2 * math.pi, 10, endpoint=False)
    rings = []
    for p, d in zip(path, tangent, strict=True):
        side = np.cross(d, [0.0, 1.0, 0.0])
        side /= np.linalg.norm(side)
        up = np.cross(d, side)
        rings.append(p + 0.62 * (np.cos(section)[:, None] * side + np.sin(section)[:, None] * up))
    solid = lofted(rings, loop=True)
    low, high = solid.bounds_m()
    tall = height - foot + 0.006
    solid = solid.moved(*(-(low + high) / 2)).scaled(
        *(np.array([length, width, tall]) / (high - low))
    )
    return (
        _stand(length * 0.5, width * 0.8, foot),
        Part("Knot", solid.moved(z=foot - 0.006 + tall / 2), "body", collider="convexHull"),
    )


def arch_stack(size_m: Size) -> tuple[Part, ...]:
    """Arches set into each other, each a little lower."""
    length, width, height = size_m
    parts = []
    for index, share in enumerate((1.0, 0.62)):
        half = length / 2 * share
        thick = length * 0.14
        top = height * (1.0 if index == 0 else 0.64)
        turn = np.linspace(0, math.pi, 17)
        outer = np.concatenate(
            [
                [[half, 0.0]],
                np.stack([half * np.cos(turn), top - half + half * np.sin(turn)], -1),
                [[-half, 0.0]],
            ]
        )
        inner_r = half - thick
        inner = np.concatenate(
            [
                [[inner_r, 0.0]],
                np.stack([inner_r * np.cos(turn), top - half + inner_r * np.sin(turn)], -1),
                [[-inner_r, 0.0]],
            ]
        )
        deep = width * (1.0 - 0.12 * index) / 2
        rings = [
            np.column_stack([loop[:, 0], np.full(len(loop), y), loop[:, 1]])
            for loop, y in (
                (outer, -deep + 0.003),
                (outer * [0.985, 0.995], -deep),
                (inner * [1.02, 1.0], -deep),
                (inner, -deep + 0.003),
                (inner, deep - 0.003),
                (inner * [1.02, 1.0], deep),
                (outer * [0.985, 0.995], deep),
                (outer, deep - 0.003),
            )
        ]
        # Sections across the arch, one after another along it.
        across = np.stack(rings, axis=1)
        parts.append(Part(f"Arch_{index + 1}", lofted(list(across)), ("body", "stone")[index]))
    return tuple(parts)


def pebbles(size_m: Size) -> tuple[Part, ...]:
    """Stones balanced on each other."""
    length, width, height = size_m
    rng = rng_of(f"pebbles/{size_m}")
    stones: dict[str, list[Solid]] = {"body": [], "stone": []}
    shares = np.array([0.34, 0.27, 0.22, 0.2])
    shares = shares / shares.sum()
    z = 0.0
    for index, share in enumerate(shares):
        tall = height * share * 1.03
        wide = (1.0, 0.78, 0.6, 0.42)[index]
        stone = ball(0.5, 10, 18)
        points = stone.points_m.copy()
        points[:, :2] *= (
            1.0 + 0.08 * np.sin(2 * np.arctan2(points[:, 1], points[:, 0]) + index)[:, None]
        )
        points[:, 2] = np.sign(points[:, 2]) * np.abs(points[:, 2] * 2) ** 0.8 / 2
        solid = Solid(points, stone.faces).scaled(length * wide * 0.93, width * wide * 0.93, tall)
        shift = float(rng.uniform(-0.03, 0.03)) * length * (index > 0)
        stones["body" if index % 2 == 0 else "stone"].append(solid.moved(shift, 0.0, z + tall / 2))
        z += height * share * 0.99
    return (
        Part(
            "Stones",
            joined(stones["body"]),
            "body",
            colliders=(box((length * 0.6, width * 0.6, height)),),
        ),
        Part("Stones_Between", joined(stones["stone"]), "stone", None),
    )


def bust(size_m: Size) -> tuple[Part, ...]:
    """A head without features on a neck and a plinth."""
    length, width, height = size_m
    foot = height * 0.16
    sides = 24
    turn = np.linspace(0, 2 * math.pi, sides, endpoint=False)
    rings = []
    # share of height, half width, half depth, forward shift, chin
    for z, wide, deep, ahead in (
        (0.0, 0.3, 0.26, 0.02),
        (0.1, 0.24, 0.25, 0.0),
        (0.2, 0.22, 0.24, -0.03),
        (0.27, 0.25, 0.3, -0.09),
        (0.33, 0.33, 0.4, -0.1),
        (0.45, 0.42, 0.46, -0.06),
        (0.6, 0.47, 0.49, -0.02),
        (0.75, 0.48, 0.5, 0.01),
        (0.88, 0.4, 0.43, 0.02),
        (0.96, 0.24, 0.27, 0.02),
        (1.0, 0.0, 0.0, 0.02),
    ):
        x, y = wide * np.cos(turn), deep * np.sin(turn) + ahead
        if 0.4 < z < 0.7:
            nose = np.exp(-(((turn - 1.5 * math.pi) / 0.24) ** 2)) * (0.1 if z == 0.45 else 0.06)
            y = y - nose
        rings.append(
            np.stack(
                [
                    x * length,
                    0.88 * y * width,
                    np.full(sides, foot - 0.004 + z * (height - foot + 0.004)),
                ],
                -1,
            )
        )
    plinth = rounded_slab((length * 0.62, width * 0.62, foot), 0.004, 0.003, 3)
    return Part("Plinth", plinth, "stone"), Part(
        "Head", lofted(rings), "body", collider="convexHull"
    )


def discs(size_m: Size) -> tuple[Part, ...]:
    """Two discs that lean through each other, on a bar."""
    length, width, height = size_m
    foot = height * 0.1
    r = (height - foot) / 2
    thick = width * 0.3
    big = (
        cylinder(r * 0.98, thick, 0.004, 40)
        .turned("x", 90)
        .moved(-length / 2 + r * 0.98, thick / 2, foot + r * 0.98 - 0.005)
    )
    small_r = min(length - 1.55 * r, r * 1.1) * 0.62
    small = hollow([(small_r, 0.0), (small_r, thick * 0.8)], small_r * 0.4, 32).turned("x", 90)
    small = small.moved(
        length / 2 - small_r, -width / 2 + thick * 0.8 + 0.003, foot + small_r - 0.005
    )
    return (
        _stand(length * 0.8, width, foot),
        Part("Disc", big, "body", collider="convexHull"),
        Part("Hoop", small, "accent", None),
    )


def pillars(size_m: Size) -> tuple[Part, ...]:
    """Three candles of unlike height on a tray."""
    length, width, height = size_m
    tray = rounded_slab((length, width, 0.012), min(length, width) / 2, 0.004, 8)
    r = min(length * 0.16, width * 0.3)
    spots = ((-0.27, 0.12, 1.0), (0.06, -0.2, 0.55), (0.28, 0.14, 0.76))
    candles, wicks = [], []
    for x, y, share in spots:
        tall = (height - 0.024) * share
        profile = [
            (r - 0.002, 0.0),
            (r, 0.003),
            (r, tall - 0.003),
            (r - 0.002, tall),
            (r * 0.7, tall - 0.004),
            (0.0, tall - 0.006),
        ]
        candles.append(outward(lathe(profile, 24)).moved(x * length, y * width, 0.0115))
        wicks.append(
            tube([[0.0, 0.0, 0.0], [0.001, 0.0, 0.008], [0.003, 0.001, 0.016]], 0.0012, 6).moved(
                x * length, y * width, tall + 0.004
            )
        )
    return (
        Part("Tray", tray, "holder"),
        Part("Candles", joined(candles), "wax"),
        Part("Wicks", joined(wicks), "wick", None),
    )


def tapers(size_m: Size) -> tuple[Part, ...]:
    """Slim candles in turned holders of unlike height."""
    length, width, height = size_m
    holders, candles, wicks = [], [], []
    for x, share in ((-0.5, 0.62), (0.5, 1.0)):
        r = width / 2 * 0.98
        at = x * (length - 2 * r)
        tall = (height - 0.012) * share
        stem = tall * 0.42
        profile = [
            (0.0, 0.0),
            (r, 0.0),
            (r, 0.006),
            (r * 0.35, 0.016),
            (0.006, 0.026),
            (0.006, stem - 0.022),
            (0.016, stem - 0.012),
            (0.014, stem),
            (0.0, stem),
        ]
        holders.append(outward(lathe(profile, 28)).moved(at))
        candles.append(
            cylinder(0.0105, tall - stem + 0.006, 0.003, 14, top_m=0.008).moved(
                at, 0.0, stem - 0.006
            )
        )
        wicks.append(cylinder(0.001, 0.013, 0.0, 6).moved(at, 0.0, tall - 0.001))
    colliders = tuple(
        box((width * 0.98, width * 0.98, height * 0.9)).moved(x * (length - width * 0.98))
        for x in (-0.5, 0.5)
    )
    return (
        Part("Holders", joined(holders), "holder", colliders=colliders),
        Part("Candles", joined(candles), "wax", None),
        Part("Wicks", joined(wicks), "wick", None),
    )


def lantern(size_m: Size) -> tuple[Part, ...]:
    """A glazed lantern with a candle."""
    length, width, height = size_m
    bar, foot = 0.009, 0.012
    top = height * 0.78
    posts = at_corners(
        block((bar, bar, top - foot), 0.001).moved(z=foot - 0.001),
        length / 2 - bar,
        width / 2 - bar,
    )
    base = block((length, width, foot), 0.002)
    roof = lofted(
        [
            np.array(
                [
                    [sx * length / 2 * s, sy * width / 2 * s, z]
                    for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))
                ]
            )
            for s, z in (
                (1.0, top - 0.012),
                (1.0, top),
                (0.34, top + height * 0.1),
                (0.34, top + height * 0.12),
            )
        ]
    )
    loop = tube(
        [
            [0.02 * math.cos(a), 0.0, top + height * 0.12 + 0.02 * math.sin(a)]
            for a in np.linspace(-0.2, math.pi + 0.2, 11)
        ],
        0.0025,
        6,
    )
    scale = (height - top - height * 0.12) / 0.0225
    loop = loop.moved(z=-(top + height * 0.12)).scaled(1.0, 1.0, scale).moved(z=top + height * 0.12)
    panes = pair(
        box((length - 2 * bar, 0.002, top - foot - 0.01)).moved(z=foot - 0.001), y=width / 2 - bar
    )
    panes += pair(
        box((0.002, width - 2 * bar, top - foot - 0.01)).moved(z=foot - 0.001), x=length / 2 - bar
    )
    wax = cylinder(length * 0.24, height * 0.3, 0.003, 24).moved(z=foot - 0.001)
    return (
        Part(
            "Frame",
            joined([base, *posts, roof, loop]),
            "holder",
            colliders=(box((length, width, height * 0.8)),),
        ),
        Part("Glass", joined(panes), "glass", None),
        Part("Candle", wax, "wax", None),
        Part(
            "Wick",
            cylinder(0.0012, 0.014, 0.0, 6).moved(z=foot + height * 0.3 - 0.002),
            "wick",
            None,
        ),
    )


def jar_candle(size_m: Size) -> tuple[Part, ...]:
    """A scented candle in a glass with a label."""
    length, _width, height = size_m
    r = length / 2
    glass = cup([(0.0, 0.0), (r - 0.003, 0.0), (r, 0.004), (r, height)], 0.003, 0.006, 32)
    wax = cylinder(r - 0.0036, height * 0.66, 0.0, 32).moved(z=0.0065)
    label = hollow([(r + 0.0006, height * 0.24), (r + 0.0006, height * 0.6)], 0.0004, 32)
    return (
        Part("Glass", glass.scaled(0.985, 0.985, 1.0), "glass"),
        Part("Wax", wax.scaled(0.98, 0.98, 1.0), "wax", None),
        Part("Label", label, "label", None),
        Part("Wick", cylinder(0.0012, 0.012, 0.0, 6).moved(z=height * 0.66), "wick", None),
    )
