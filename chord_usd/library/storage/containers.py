"""Baskets and bins."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.library.kit.forms import (
    cup,
    hollow,
    lofted,
    open_tub,
    outward,
    rectangles,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    block,
    box,
    cylinder,
    joined,
    lathe,
    pair,
    ring_of,
    rounded_slab,
    tube,
)
from chord_usd.library.plants.leaves import woven_skin


def _ear(wide_m: float, tall_m: float, thick_m: float) -> Solid:
    """A handle that stands up from z = 0, along y."""
    path = bent_path(
        [
            [0, -wide_m / 2, -0.02],
            [0, -wide_m / 2, tall_m],
            [0, wide_m / 2, tall_m],
            [0, wide_m / 2, -0.02],
        ],
        0.4 * wide_m,
        4,
    )
    return tube(path, thick_m, 7)


def _folded(radius_m: float, z_m: float, rise_m: float) -> Solid:
    """A blanket stuffed into a basket: a rumpled dome."""
    sides = 28
    turn = np.linspace(0, 2 * math.pi, sides, endpoint=False)
    rings = []
    for share, lift in (
        (1.0, -0.12),
        (0.98, 0.16),
        (0.84, 0.6),
        (0.56, 0.9),
        (0.26, 1.0),
        (0.0, 0.97),
    ):
        rumple = (
            1.0
            + 0.08 * share * np.sin(3 * turn + 4 * share)
            + 0.05 * share * np.sin(7 * turn - 3 * share)
        )
        z = z_m + rise_m * lift * (1 + 0.18 * np.sin(4 * turn + 6 * share) * share)
        r = radius_m * share * rumple * 0.93
        rings.append(np.stack([r * np.cos(turn), r * np.sin(turn), z], -1))
    return lofted(rings)


def round_basket(size_m: Size, *, has_throw: bool = False, belly: float = 1.0) -> tuple[Part, ...]:
    """A woven basket with two ears; perhaps with a blanket in it."""
    length, _width, height = size_m
    r = length / 2 - 0.008
    top = height - 0.07
    profile = [
        (r * 0.8, 0.0),
        (r * 0.97 * belly, top * 0.4),
        (r * belly, top * 0.62),
        (r * 0.92, top),
    ]
    wall = woven_skin(profile, 0.01, 0.02, strands=38, rows=11)
    rim = hollow([(r * 0.925, top - 0.016), (r * 0.94, top - 0.007), (r * 0.925, top)], 0.016, 40)
    ears = pair(_ear(0.12, 0.066, 0.0075).moved(z=top), x=r * 0.92)
    parts = [
        Part("Wall", wall, "weave", colliders=(cylinder(r * 0.95, top),)),
        Part("Rim", joined([rim, *ears]), "weave", None),
    ]
    if has_throw:
        parts.append(Part("Blanket", _folded(r * 0.9, top - 0.05, 0.11), "cloth", None))
    return tuple(parts)


def laundry(size_m: Size) -> tuple[Part, ...]:
    """A tall basket of slats with a cloth lining turned over its rim."""
    length, width, height = size_m
    count = 14
    slats = []
    for index in range(count):
        x = -length / 2 + 0.03 + (length - 0.06) * index / (count - 1)
        for s in (-1, 1):
            slats.append(
                block((0.016, 0.008, height - 0.02), 0.002).moved(x, s * (width / 2 - 0.006), 0.01)
            )
    deep = max(6, round(width / 0.035))
    for index in range(deep):
        y = -width / 2 + 0.035 + (width - 0.07) * index / (deep - 1)
        for s in (-1, 1):
            slats.append(
                block((0.008, 0.016, height - 0.02), 0.002).moved(s * (length / 2 - 0.006), y, 0.01)
            )
    hoops = [
        lofted(
            rectangles(
                length, width, [(0.0, z), (0.0, z + 0.022), (0.014, z + 0.022), (0.014, z)], 0.01, 2
            ),
            loop=True,
        )
        for z in (0.0, height * 0.5, height - 0.05)
    ]
    bag = open_tub(length - 0.032, width - 0.032, height - 0.02, 0.004, 0.02).moved(z=0.012)
    cuff = lofted(
        rectangles(
            length - 0.004,
            width - 0.004,
            [
                (0.0, height - 0.04),
                (0.0, height - 0.004),
                (0.004, height),
                (0.02, height - 0.002),
                (0.02, height - 0.04),
            ],
            0.016,
            3,
        ),
        loop=True,
    )
    return (
        Part("Slats", joined(slats), "weave", colliders=(box((length, width, height)),)),
        Part("Hoops", joined(hoops), "weave", None),
        Part("Lining", joined([bag, cuff]), "cloth", None),
    )


def wire_basket(size_m: Size) -> tuple[Part, ...]:
    """A basket of steel wire with wooden grips."""
    length, _width, height = size_m
    r, wire = length / 2 - 0.004, 0.0028
    top = height - 0.012
    bow = np.array(
        [[r * 0.7, 0.0, wire], [r * 0.8, 0.0, 0.02], [r * 0.93, 0, top * 0.55], [r, 0, top]]
    )
    ribs = ring_of(tube(bow, wire, 5), 28)
    hoops = [
        hollow([(x + 0.003, z), (x + 0.003, z + 0.006)], 0.006, 36)
        for x, z in ((r * 0.7, 0.0), (r * 0.87, top * 0.3), (r * 0.95, top * 0.64), (r, top))
    ]
    base = [
        tube([[-r * 0.68, y, wire], [r * 0.68, y, wire]], wire, 5)
        for y in np.linspace(-0.4, 0.4, 5) * r
    ]
    grips = [tube([[x, -0.05, top + 0.004], [x, 0.05, top + 0.004]], 0.009, 8) for x in (-r, r)]
    return (
        Part("Wire", joined([*ribs, *hoops, *base]), "weave", colliders=(cylinder(r, top),)),
        Part("Grips", joined(grips), "grip", None),
    )


def pedal_bin(size_m: Size) -> tuple[Part, ...]:
    """A metal cylinder with a domed lid and a pedal."""
    length, width, height = size_m
    r = length / 2
    y = (width - length) / 2
    body = cylinder(r, height - 0.055, 0.003, 40).moved(z=0.016)
    foot = cylinder(r + 0.0, 0.022, 0.004, 40)
    lid = lathe(
        [
            (r - 0.002, 0.0),
            (r, 0.004),
            (r, 0.018),
            (r * 0.86, 0.034),
            (r * 0.4, 0.043),
            (0.0, 0.044),
        ],
        40,
    )
    pedal = block((0.07, 0.05, 0.012), 0.004).moved(y=-width / 2 + 0.025, z=0.006)
    hinge = block((0.06, 0.014, 0.03), 0.004).moved(y=y + r - 0.004, z=height - 0.07)
    return (
        Part("Body", body.moved(y=y), "metal"),
        Part("Foot", foot.moved(y=y), "plastic"),
        Part("Lid", outward(lid).moved(y=y, z=height - 0.044), "metal", None),
        Part("Pedal", pedal, "plastic", None),
        Part("Hinge", hinge, "plastic", None),
    )


def paper_bin(size_m: Size) -> tuple[Part, ...]:
    """An open waste basket, a rolled rim, some paper at its bottom."""
    length, _width, height = size_m
    r = length / 2
    wall = cup(
        [(0.0, 0.0), (r * 0.8, 0.0), (r * 0.82, 0.006), (r - 0.004, height - 0.004)],
        0.004,
        0.01,
        40,
    )
    rim = tube(
        [
            [(r - 0.005) * math.cos(a), (r - 0.005) * math.sin(a), height - 0.005]
            for a in np.linspace(0, 2 * math.pi * 0.985, 41)
        ],
        0.005,
        6,
    )
    balls = []
    for index, (x, y) in enumerate(((-0.3, 0.2), (0.35, 0.1), (0.0, -0.35))):
        crumple = lathe([(0.0, 0.0), (0.026, 0.01), (0.036, 0.032), (0.024, 0.056), (0.0, 0.06)], 9)
        balls.append(outward(crumple.turned("x", 40.0 * index)).moved(x * r, y * r, 0.03))
    return (
        Part("Wall", wall, "metal", colliders=(cylinder(r * 0.95, height),)),
        Part("Rim", rim, "metal", None),
        Part("Paper", joined(balls), "paper", None),
    )


def swing_bin(size_m: Size) -> tuple[Part, ...]:
    """A tall rectangular bin with a sloping lid flap."""
    length, width, height = size_m
    body = lofted(
        rectangles(length, width, [(0.015, 0.0), (0.012, 0.004), (0.0, height - 0.09)], 0.03)
    )
    collar = lofted(
        rectangles(
            length, width, [(0.0, height - 0.088), (0.0, height - 0.06), (0.02, height)], 0.03
        )
    )
    flap = (
        rounded_slab((length - 0.09, width - 0.1, 0.01), 0.012, 0.003, 4)
        .turned("x", -4)
        .moved(z=height - 0.005)
    )
    return (
        Part("Body", body, "metal"),
        Part("Collar", collar, "plastic", None),
        Part("Flap", flap.moved(z=-0.004), "metal", None),
    )


def slat_bin(size_m: Size) -> tuple[Part, ...]:
    """A bin of upright wooden slats around a dark pail."""
    length, _width, height = size_m
    r, count = length / 2, 30
    slat = block((0.008, 2 * math.pi * r / count * 0.8, height), 0.002).moved(x=r - 0.004)
    slats = ring_of(slat, count)
    pail = cup([(0.0, 0.0), (r - 0.012, 0.0), (r - 0.0085, height - 0.012)], 0.003, 0.01, 36).moved(
        z=0.004
    )
    hoops = [
        hollow([(r - 0.007, z), (r - 0.007, z + 0.016)], 0.004, 36)
        for z in (height * 0.15, height * 0.8)
    ]
    return (
        Part("Slats", joined(slats), "wood", colliders=(cylinder(r, height),)),
        Part("Pail", pail, "plastic", None),
        Part("Hoops", joined(hoops), "plastic", None),
    )
