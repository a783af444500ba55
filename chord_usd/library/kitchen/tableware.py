"""What stands on tables: plants, ornaments, crockery, food, drinks."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    block,
    cylinder,
    joined,
    lathe,
    loft,
    pair,
    rounded_profile,
    rounded_slab,
    tube,
)

OrnamentKind = Literal["vase", "ring", "bowl", "candles"]


def ornament(size_m: Size, *, kind: OrnamentKind = "vase") -> tuple[Part, ...]:
    """A small vase, a shallow bowl, three candles, or an abstract ring on a plinth."""
    length, width, height = size_m
    if kind == "bowl":
        section = [(0.2, 0), (0.24, 0.06), (0.4, 0.3), (0.5, 1.0), (0.475, 1.0), (0.36, 0.34),
                   (0.15, 0.12), (0.0, 0.1)]  # fmt: skip
        bowl = lathe(rounded_profile(section), 36)
        return (Part("Bowl", bowl.scaled(length, width, height), "ceramic"),)
    if kind == "candles":
        return _candles(length, width, height)
    if kind == "vase":
        profile = [
            (0.26, 0), (0.3, 0.02), (0.5, 0.35), (0.44, 0.6), (0.2, 0.82), (0.19, 0.9), (0.26, 1.0),
            (0.22, 1.0), (0.15, 0.9), (0.15, 0.8), (0.0, 0.78),
        ]  # fmt: skip
        vase = lathe(rounded_profile(profile), 32)
        return (Part("Vase", vase.scaled(length, width, height), "ceramic"),)
    foot_h = height * 0.18
    bar = min(width, length * 0.3) / 2
    radius = min((height - foot_h) / 2, length / 2) - bar
    turn = np.linspace(-0.49 * np.pi, 1.49 * np.pi, 33)
    path = np.stack([radius * np.cos(turn), 0 * turn, radius * np.sin(turn)], axis=-1)
    hoop = tube(path, bar, 12)
    low, high = hoop.bounds_m()
    fit = (length / float(np.ptp([low[0], high[0]])), 1.0,
           (height - foot_h + 0.004) / float(high[2] - low[2]))  # fmt: skip
    hoop = hoop.moved(z=-float(low[2])).scaled(*fit).moved(z=foot_h - 0.004)
    return (
        Part("Plinth", block((length * 0.7, width, foot_h), 0.003), "stone"),
        Part("Ring", hoop, "metal", collider="convexHull"),
    )


def _candles(length: float, width: float, height: float) -> tuple[Part, ...]:
    """Three candles of unlike height on a tray."""
    tray = rounded_slab((length, width, 0.012), min(length, width) / 2, 0.004, 8)
    radius = min(length * 0.13, width * 0.3)
    candles, wicks = [], []
    for index, share in enumerate((1.0, 0.62, 0.8)):
        tall, x = height * share - 0.022, (index - 1) * length * 0.29
        candles.append(cylinder(radius, tall, 0.003, 20).moved(x, 0.0, 0.011))
        wicks.append(cylinder(0.0015, 0.014, 0, 6).moved(x, 0.0, 0.008 + tall))
    return (
        Part("Tray", tray, "metal"),
        Part("Candles", joined(candles), "wax"),
        Part("Wicks", joined(wicks), "wick", collider=None),
    )


def coffee_cup(size_m: Size) -> tuple[Part, ...]:
    """A cup with handle and coffee on a saucer."""
    length, width, height = size_m
    plate_r = width / 2
    saucer = lathe(
        [(0.5, 0), (0.55, 0.003), (1.0, 0.014), (0.99, 0.016), (0.55, 0.006), (0, 0.006)], 32
    ).scaled(length / 2, plate_r, 1.0)  # fmt: skip
    r, z = plate_r * 0.55, 0.006
    tall = height - z
    outside = rounded_profile([(r * 0.6, 0), (r * 0.92, tall * 0.3), (r, tall)])
    inside = rounded_profile([(r - 0.003, tall), (r * 0.88, tall * 0.3), (r * 0.5, 0.006)])
    cup = lathe([*outside, *inside, (0.0, 0.006)], 32).moved(z=z)
    coffee = cylinder(r * 0.94, 0.004, 0, 28).moved(z=z + tall * 0.76)
    ear = bent_path(
        [
            [r * 0.9, 0, z + tall * 0.85],
            [r * 1.55, 0, z + tall * 0.8],
            [r * 1.5, 0, z + tall * 0.3],
            [r * 0.88, 0, z + tall * 0.35],
        ],
        0.012,
    )
    return (
        Part("Saucer", saucer, "ceramic"),
        Part("Cup", cup + tube(ear, 0.003, 8), "ceramic", collider="convexHull"),
        Part("Coffee", coffee, "coffee", collider=None),
    )  # fmt: skip


def fruit_bowl(size_m: Size) -> tuple[Part, ...]:
    """A bowl of apples, oranges and pears."""
    length, width, height = size_m
    bowl_h = height * 0.55
    bowl = lathe(
        [(0.45, 0), (0.5, 0.06), (0.85, 0.5), (1.0, 1.0), (0.96, 1.0), (0.78, 0.5), (0.4, 0.14),
         (0, 0.12)], 36,
    ).scaled(length / 2, width / 2, bowl_h)  # fmt: skip
    size = min(length, width) * 0.17
    size = min(size, (height - bowl_h * 0.35) / 2.4)
    spots = [(0.44 * math.cos(a), 0.44 * math.sin(a)) for a in np.radians((20, 92, 164, 236, 308))]
    kinds = ("apple", "orange", "pear", "apple", "orange")
    fruits: dict[str, list[Solid]] = {"apple": [], "orange": [], "pear": []}
    for (x, y), kind in zip(spots, kinds, strict=True):
        at = (x * length / 2, y * width / 2, bowl_h * 0.45)
        fruits[kind].append(_fruit(kind, size).moved(*at))
    top = _fruit("apple", size).moved(z=height - 2 * size)
    fruits["apple"].append(top)
    return (
        Part("Bowl", bowl, "ceramic"),
        *(Part(f"{kind.capitalize()}s", joined(solids), kind, collider=None)
          for kind, solids in fruits.items()),
    )  # fmt: skip


def _fruit(kind: str, radius: float) -> Solid:
    profiles = {
        "apple": ((0, 0.12), (0.4, 0.0), (0.86, 0.4), (1.0, 1.1), (0.8, 1.7), (0.4, 2.0), (0, 1.8)),
        "orange": ((0, 0.0), (0.6, 0.2), (0.96, 0.7), (0.96, 1.3), (0.6, 1.8), (0, 2.0)),
        "pear": ((0, 0.05), (0.5, 0.0), (0.92, 0.5), (0.8, 1.1), (0.45, 1.6), (0.3, 2.1), (0, 2.2)),
    }
    profile = [(r * radius, z * radius) for r, z in profiles[kind]]
    return lathe(rounded_profile(profile, 1), 18)


def bread_board(size_m: Size) -> tuple[Part, ...]:
    """A loaf on a board, two slices cut off."""
    length, width, height = size_m
    board = rounded_slab((length, width, 0.016), 0.03, 0.004, 5)
    rise = height - 0.015
    deep = min(width * 0.6, rise * 1.5)
    angles = np.linspace(-0.15 * np.pi, 1.15 * np.pi, 17)
    arch = np.stack([0.5 * deep * np.cos(angles), 0.55 * rise + 0.45 * rise * np.sin(angles)], -1)
    arch = np.concatenate([[[-deep * 0.4, 0.0], [deep * 0.4, 0.0]], arch])
    loaf_l = length * 0.52
    rings = [
        np.column_stack([np.full(len(arch), x), arch * s + [0, rise * (1 - s) * 0.4]])
        for x, s in (
            (0, 0.7),
            (loaf_l * 0.05, 0.87),
            (loaf_l * 0.1, 0.95),
            (loaf_l * 0.2, 1),
            (loaf_l, 1),
        )
    ]
    loaf = loft(rings).moved(-length / 2 + 0.02, 0, 0.015)
    slices = [
        loft([rings[3] * [0, 1, 0.97], rings[3] * [0, 1, 0.97] + [0.014, 0, 0]]).moved(
            -length / 2 + 0.05 + loaf_l + step, 0, 0.015
        )
        for step in (0.0, 0.035)
    ]
    return (
        Part("Board", board, "wood"),
        Part("Loaf", loaf, "crust"),
        Part("Slices", joined(slices), "crumb", collider=None),
    )  # fmt: skip


def dinner_set(size_m: Size, *, has_bowl: bool = True) -> tuple[Part, ...]:
    """Plate (and bowl) on a mat with knife, fork and glass."""
    length, width, height = size_m
    mat = rounded_slab((length, width, 0.003), 0.01, 0.001)
    plate_r = min(width * 0.44, length * 0.32)
    plate = lathe(
        [(0.6, 0), (1.0, 0.014), (1.0, 0.017), (0.66, 0.006), (0, 0.006)], 36
    ).scaled(plate_r, plate_r, 1.0).moved(z=0.0025)  # fmt: skip
    parts = [
        Part("Mat", mat, "cloth"),
        Part("Plate", plate, "ceramic", collider="convexHull"),
        Part("Cutlery", _cutlery(plate_r, width).moved(z=0.0028), "metal", collider=None),
    ]
    if has_bowl:
        bowl_h, r = min(0.06, height * 0.7), plate_r * 0.6
        bowl = lathe(
            [(r * 0.5, 0), (r, bowl_h), (r - 0.003, bowl_h), (r * 0.45, 0.006), (0, 0.006)], 32
        )
        parts.append(Part("Bowl", bowl.moved(z=0.0085), "ceramic", collider="convexHull"))
    if height > 0.05:
        glass_h, r = height - 0.003, min(0.032, length * 0.09)
        glass = lathe(
            [(r * 0.8, 0), (r, glass_h), (r - 0.002, glass_h), (r * 0.76, 0.008), (0, 0.008)], 24
        )
        at = (length / 2 - r - 0.005, width / 2 - r - 0.005, 0.003)
        parts.append(Part("Glass", glass.moved(*at), "glass", collider="convexHull"))
    return tuple(parts)


def _cutlery(plate_r: float, width: float) -> Solid:
    long = min(0.2, width * 0.8)
    grip = block((0.012, long * 0.5, 0.004), 0.001)
    blade = block((0.016, long * 0.5, 0.002), 0.0005).moved(y=long * 0.49)
    knife = (grip + blade).moved(plate_r + 0.025, -long * 0.45)
    tines = [block((0.003, long * 0.24, 0.002)).moved(0.006 * i, long * 0.56) for i in (-1, 0, 1)]
    head = block((0.018, long * 0.2, 0.003), 0.001).moved(y=long * 0.36)
    fork = joined([grip, head, *tines]).moved(-plate_r - 0.025, -long * 0.45)
    return knife + fork


def drinks(size_m: Size, *, kind: Literal["bottle", "carafe"] = "bottle") -> tuple[Part, ...]:
    """A wine bottle, alone or with two glasses."""
    length, width, height = size_m
    r = min(width / 2, 0.042) if kind == "carafe" else min(length, width) / 2
    shoulder = rounded_profile(
        [(r, height * 0.56), (r * 0.94, height * 0.64), (r * 0.4, height * 0.7),
         (r * 0.34, height * 0.93)]
    )  # fmt: skip
    bottle = lathe(
        [(r * 0.94, 0), (r, 0.006), *shoulder, (r * 0.4, height * 0.94),
         (r * 0.4, height * 0.985), (0, height * 0.985)], 28,
    )  # fmt: skip
    label = lathe(
        [(r + 0.0008, 0), (r + 0.0008, height * 0.24), (r, height * 0.24), (r, 0)], 28, loop=True
    )
    cork = cylinder(r * 0.3, height * 0.03, 0, 16).moved(z=height * 0.97)
    x = 0.0 if kind == "bottle" else -length / 2 + r + 0.001
    parts = [
        Part("Bottle", bottle.moved(x), "bottle"),
        Part("Label", label.moved(x, 0, height * 0.16), "paper", collider=None),
        Part("Cork", cork.moved(x), "cork", collider=None),
    ]
    if kind == "carafe":
        tall = height * 0.68
        g = min(length * 0.13, width * 0.24)
        glass = lathe(
            [(g * 0.9, 0), (g * 0.85, 0.003), (0.004, 0.008), (0.004, tall * 0.45),
             (g, tall * 0.68),
             (g * 0.82, tall), (g * 0.8, tall), (g * 0.95, tall * 0.68), (0, tall * 0.5)], 24,
        )  # fmt: skip
        glasses = pair(glass.moved(x=length / 2 - g), y=width / 2 - g)
        parts.append(Part("Glasses", joined(glasses), "glass", colliders=tuple(glasses)))
    return tuple(parts)
