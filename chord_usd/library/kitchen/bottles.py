"""Bottles of kitchens and bathrooms: wine, oil, water, shampoo."""

from __future__ import annotations

import numpy as np

from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    cylinder,
    lathe,
    rounded_profile,
    tube,
)
from chord_usd.library.kitchen.vessels import vessel


def _bottle(radius: float, tall: float, neck: float, shoulder: float, sides: int = 24) -> Solid:
    """A closed bottle: body, round shoulder that begins at this share of the height, neck."""
    z = tall * shoulder
    rise = min(radius * 1.5, tall * (0.92 - shoulder))
    body = [(radius * 0.9, 0.0), (radius, 0.006), (radius, z)]
    arc = [
        (neck + (radius - neck) * np.cos(a) ** 1.2, z + rise * np.sin(a) ** 1.1)
        for a in np.radians((18, 36, 54, 72, 88))
    ]
    top = [
        (neck, tall - 0.016),
        (neck + 0.0025, tall - 0.014),
        (neck + 0.0025, tall - 0.004),
        (neck, tall),
    ]
    return lathe([*body, *arc, *top], sides)


def _label(radius: float, low: float, high: float, sides: int = 24) -> Solid:
    """A band of paper around a bottle."""
    outer, inner = radius + 0.0004, radius - 0.001
    return lathe([(inner, low), (outer, low), (outer, high), (inner, high)], sides, loop=True)


def wine(size_m: Size) -> tuple[Part, ...]:
    """A bottle of wine."""
    radius, tall = size_m[0] / 2, size_m[2]
    capsule = cylinder(0.0165, 0.055, 0.002, 20).moved(z=tall - 0.0545)
    return (
        Part("Bottle", _bottle(radius, tall - 0.001, 0.0145, 0.6), "glass"),
        Part("Label", _label(radius, tall * 0.16, tall * 0.45), "label", collider=None),
        Part("Capsule", capsule, "cap", collider=None),
    )


def oil(size_m: Size) -> tuple[Part, ...]:
    """A slim bottle of oil with a pourer."""
    radius, tall = size_m[0] / 2, size_m[2]
    body, cap = _oil_bottle(radius, tall)
    return (
        Part("Bottle", body, "oil"),
        Part("Label", _label(radius, tall * 0.2, tall * 0.42), "label", collider=None),
        Part("Pourer", cap, "cap", collider=None),
    )


def _oil_bottle(radius: float, tall: float) -> tuple[Solid, Solid]:
    body = _bottle(radius, tall - 0.035, 0.012, 0.56)
    stop = cylinder(0.0135, 0.014, 0.002, 16).moved(z=tall - 0.04)
    spout = tube(
        [[0, 0, tall - 0.03], [0.002, 0, tall - 0.014], [0.012, 0, tall - 0.001]], 0.0035, 8
    )
    return body, stop + spout


def oil_pair(size_m: Size) -> tuple[Part, ...]:
    """Oil and vinegar beside each other, a mill between them and the wall."""
    length, width, tall = size_m
    radius = 0.031
    x = length / 2 - radius
    first, first_cap = _oil_bottle(radius, tall)
    second, second_cap = _oil_bottle(radius * 0.94, tall * 0.84)
    mill = lathe(
        rounded_profile(
            [
                (0.024, 0),
                (0.026, 0.004),
                (0.026, 0.02),
                (0.017, 0.055),
                (0.022, 0.085),
                (0.024, 0.1),
                (0.012, 0.108),
                (0.018, 0.122),
                (0.012, 0.14),
                (0, 0.145),
            ],
            1,
        ),
        22,
    )
    at_y = -width / 2 + 0.033
    return (
        Part("Oil", first.moved(-x, at_y), "oil"),
        Part("Vinegar", second.moved(x - 0.002, at_y), "vinegar"),
        Part(
            "Pourers",
            first_cap.moved(-x, at_y) + second_cap.moved(x - 0.002, at_y),
            "cap",
            collider=None,
        ),
        Part(
            "Labels",
            _label(radius, 0.06, 0.12).moved(-x, at_y)
            + _label(radius * 0.94, 0.05, 0.1).moved(x - 0.002, at_y),
            "label",
            collider=None,
        ),
        Part("Mill", mill.moved(0.004, width / 2 - 0.026), "wood"),
    )


def carafe(size_m: Size) -> tuple[Part, ...]:
    """A carafe of water with a stopper."""
    radius, tall = size_m[0] / 2, size_m[2]
    profile = rounded_profile(
        [
            (radius * 0.8, 0),
            (radius, 0.01),
            (radius, tall * 0.34),
            (radius * 0.42, tall * 0.66),
            (radius * 0.42, tall * 0.76),
            (radius * 0.58, tall * 0.93),
        ],
        2,
    )
    water = [(max(r - 0.0035, 0.004), z) for r, z in profile if 0.008 < z < tall * 0.5]
    stop = lathe(
        [
            (radius * 0.36, tall * 0.86),
            (radius * 0.46, tall * 0.93),
            (radius * 0.5, tall * 0.955),
            (radius * 0.4, tall),
            (0, tall),
        ],
        20,
    )
    return (
        Part("Carafe", vessel(profile, 0.0025, 0.006), "clear"),
        Part(
            "Water",
            lathe([(water[0][0] * 0.96, 0.0065), *water, (0, water[-1][1])], 28),
            "water",
            collider=None,
        ),
        Part("Stopper", stop, "cork", collider=None),
    )


def pump_bottle(radius: float, tall: float) -> tuple[Solid, Solid]:
    """A bottle with a pump; (bottle, pump)."""
    body_h = tall - 0.055
    body = lathe(
        rounded_profile(
            [
                (radius * 0.94, 0),
                (radius, 0.003),
                (radius, 0.01),
                (radius, body_h - 0.022),
                (radius * 0.96, body_h - 0.008),
                (radius * 0.5, body_h - 0.001),
                (radius * 0.45, body_h),
            ],
            1,
        ),
        24,
    )
    z = body_h - 0.003
    collar = cylinder(min(0.015, radius * 0.5), 0.016, 0.002, 18).moved(z=z)
    stem = cylinder(0.004, 0.034, 0.0, 10).moved(z=z + 0.012)
    head = cylinder(0.0085, 0.014, 0.002, 12).moved(z=tall - 0.0145)
    spout = tube(
        bent_path(
            [
                [0, 0, tall - 0.0065],
                [0, -radius - 0.002, tall - 0.0065],
                [0, -radius - 0.007, tall - 0.013],
            ],
            0.006,
            2,
        ),
        0.0036,
        8,
    )
    return body, collar + stem + head + spout


def flip_bottle(radius: float, tall: float, flat: float = 0.66) -> tuple[Solid, Solid]:
    """An oval bottle of shampoo on its cap; (bottle, cap)."""
    cap_h = 0.028
    cap = lathe([(radius * 0.6, 0), (radius * 0.62, 0.002), (radius * 0.58, cap_h)], 24).scaled(
        1.0, 0.9, 1.0
    )
    body = lathe(
        rounded_profile(
            [
                (radius * 0.56, cap_h - 0.001),
                (radius * 0.8, cap_h + 0.012),
                (radius, tall * 0.4),
                (radius, tall * 0.75),
                (radius * 0.9, tall - 0.012),
                (radius * 0.6, tall - 0.001),
                (0, tall),
            ],
            1,
        ),
        24,
    )
    return body.scaled(1.0, flat, 1.0), cap


def shampoo(size_m: Size, *, count: int) -> tuple[Part, ...]:
    """Bottles of shampoo and soap in a row, each a little different."""
    tall = size_m[2]
    pitch, radius = 0.079, 0.0335
    parts: list[Part] = []
    for index in range(count):
        x = pitch * (index - (count - 1) / 2)
        share = (1.0, 0.86, 0.93)[index % 3]
        stands_on_cap = index % 2 == 1
        if not stands_on_cap:
            body, cap = pump_bottle(radius, tall * share)
        else:
            body, cap = flip_bottle(radius * 1.08, tall * share)
        y = 0.008 if stands_on_cap else 0.004
        turn = (12.0, -8.0, -20.0)[index % 3]
        name = f"{index + 1}"
        slot = ("first", "second", "third")[index % 3]
        parts += [
            Part(f"Bottle_{name}", body.turned("z", turn).moved(x, y), slot),
            Part(
                f"Cap_{name}",
                cap.turned("z", turn).moved(x, y),
                "cap",
                collider="boundingCube" if stands_on_cap else None,
            ),
        ]
        if not stands_on_cap:
            mark = _label(radius, tall * 0.2, tall * 0.5)
            parts.append(Part(f"Label_{name}", mark.moved(x, y), "label", collider=None))
    return tuple(parts)
