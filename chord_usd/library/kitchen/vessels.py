"""Jars, bowls and plates: turned things that stand on worktops, boards and sills."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from chord_usd.library.kit.forms import cup
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    cylinder,
    joined,
    lathe,
    rounded_profile,
    tube,
)

Profile = Sequence[tuple[float, float]]


def vessel(outside: Profile, wall_m: float, floor_m: float, sides: int = 26) -> Solid:
    """A vessel with a rounded rim, turned from its outside, foot first."""
    return cup(outside, wall_m, floor_m, sides, lip=True)


def jar(size_m: Size, *, fill: float = 0.8, clip: bool = False) -> tuple[Part, ...]:
    """A storage jar of glass and what is in it, with a wooden lid or a wire clip."""
    radius, tall = size_m[0] / 2, size_m[2]
    return tuple(_jar(radius, tall, fill, clip=clip))


def _jar(
    radius: float,
    tall: float,
    fill: float,
    *,
    clip: bool = False,
    x: float = 0.0,
    mark: str = "",
    slot: str = "content",
    sides: int = 26,
) -> list[Part]:
    lid_h = 0.022
    rim = tall - lid_h + (0.004 if not clip else 0.0)
    outside = [
        (radius * 0.92, 0.0),
        (radius, 0.005),
        (radius, rim - 0.02),
        (radius * 0.96, rim - 0.006),
        (radius * 0.93, rim),
    ]
    glass = vessel(outside, 0.003, 0.006, sides)
    top = 0.0065 + (rim - 0.02) * fill
    inner = radius - 0.0036
    stuff = lathe(
        [
            (inner * 0.95, 0.0065),
            (inner, 0.01),
            (inner, top - 0.004),
            (inner * 0.7, top),
            (0, top - 0.001),
        ],
        sides,
    )
    if clip:
        lid = lathe(
            [
                (radius * 0.9, rim - 0.002),
                (radius * 0.95, rim + 0.001),
                (radius * 0.95, rim + 0.008),
                (radius * 0.7, tall),
                (0, tall),
            ],
            26,
        )
        wire = tube(
            bent_path(
                [
                    [-0.008, -radius - 0.001, rim - 0.045],
                    [-0.008, -radius - 0.004, rim + 0.006],
                    [0.008, -radius - 0.004, rim + 0.006],
                    [0.008, -radius - 0.001, rim - 0.045],
                ],
                0.004,
                2,
            ),
            0.0014,
            6,
        )
        band = lathe(
            [
                (radius * 0.975, rim - 0.016),
                (radius * 1.0, rim - 0.016),
                (radius * 1.0, rim - 0.012),
                (radius * 0.975, rim - 0.012),
            ],
            20,
            loop=True,
        )
        trim = Part(f"Wire{mark}", (wire + band).moved(x), "metal", collider=None)
        top_parts = [Part(f"Lid{mark}", lid.moved(x), "clear", collider=None), trim]
    else:
        lid = cylinder(radius * 0.99, lid_h - 0.004, 0.003, 26).moved(z=tall - lid_h + 0.004)
        plug = cylinder(radius * 0.88, 0.012, 0.0, 26).moved(z=tall - lid_h - 0.006)
        top_parts = [Part(f"Lid{mark}", (lid + plug).moved(x), "lid", collider=None)]
    return [
        Part(f"Jar{mark}", glass.moved(x), "clear"),
        Part(f"Content{mark}", stuff.moved(x), slot, collider=None),
        *top_parts,
    ]


def jar_row(size_m: Size, *, clip: bool = False) -> tuple[Part, ...]:
    """Three jars beside each other, filled differently high."""
    length, width, tall = size_m
    radius = min(width / 2, length / 6 - 0.004)
    pitch = (length - 2 * radius) / 2
    parts = []
    for index, (share, fill) in enumerate(((1.0, 0.86), (0.84, 0.6), (0.7, 0.75))):
        slot = ("content", "second", "third")[index]
        parts += _jar(
            radius,
            tall * share,
            fill,
            clip=clip,
            x=(index - 1) * pitch,
            sides=18,
            mark=f"_{index + 1}",
            slot=slot,
        )
    return tuple(parts)


def canister_row(size_m: Size) -> tuple[Part, ...]:
    """Three canisters of stoneware with wooden lids."""
    length, width, tall = size_m
    radius = min(width / 2, length / 6 - 0.004)
    pitch = (length - 2 * radius) / 2
    parts = []
    for index, share in enumerate((1.0, 0.82, 0.66)):
        x, high = (index - 1) * pitch, tall * share
        body = lathe(
            rounded_profile(
                [
                    (radius * 0.9, 0),
                    (radius, 0.006),
                    (radius, 0.02),
                    (radius, high - 0.034),
                    (radius * 0.95, high - 0.022),
                ],
                1,
            ),
            28,
        )
        lid = cylinder(radius * 0.99, 0.02, 0.004, 28).moved(z=high - 0.0225)
        knob = (
            lathe(
                [
                    (0.006, high - 0.004),
                    (0.005, high - 0.002),
                    (0.009, high - 0.001),
                    (0.008, high),
                    (0, high),
                ],
                14,
            )
            if index == 0
            else None
        )
        parts.append(Part(f"Canister_{index + 1}", body.moved(x), "ware"))
        parts.append(
            Part(
                f"Lid_{index + 1}",
                (lid if knob is None else lid + knob).moved(x),
                "lid",
                collider=None,
            )
        )
    return tuple(parts)


def bowl(size_m: Size) -> tuple[Part, ...]:
    """An empty bowl on a foot."""
    radius, tall = size_m[0] / 2, size_m[2]
    return (Part("Bowl", _bowl(radius, tall), "ware"),)


def _bowl(radius: float, tall: float) -> Solid:
    profile = [
        (radius * 0.42, 0.0),
        (radius * 0.42, 0.006),
        (radius * 0.5, 0.01),
        (radius * 0.76, tall * 0.35),
        (radius * 0.93, tall * 0.68),
        (radius, tall - 0.002),
    ]
    rounded = rounded_profile(profile, 1)
    return vessel(rounded[:1] + rounded[2:], 0.006, 0.014, 28)


def fruit_bowl(size_m: Size) -> tuple[Part, ...]:
    """A wide bowl of fruit."""
    radius, tall = size_m[0] / 2, size_m[2]
    rim = tall * 0.68
    dish = _bowl(radius, rim)
    places = [(0.0, 0.0)] + [
        (0.55 * radius * np.cos(a), 0.55 * radius * np.sin(a))
        for a in np.radians((20, 92, 164, 236, 308))
    ]
    lemons: list[Solid] = []
    apples: list[Solid] = []
    pears: list[Solid] = []
    size = radius * 0.3
    for index, (x, y) in enumerate(places):
        z = rim * 0.36 if index else rim * 0.16
        if index % 3 == 0:
            apples.append(_apple(size).turned("x", 14.0 * index).moved(x, y, z))
        elif index % 3 == 1:
            lemons.append(_orange(size * 0.95).moved(x, y, z))
        else:
            # Along the rim: across it they would come through the bowl.
            along = float(np.degrees(np.arctan2(y, x)))
            lying = _pear(0.88 * size).turned("x", 76).turned("z", along)
            pears.append(lying.moved(0.88 * x, 0.88 * y, z + size))
    for index, (x, y) in enumerate(
        ((0.3 * radius, 0.16 * radius), (-0.28 * radius, -0.14 * radius))
    ):
        fruit = _apple(size * 0.95) if index else _orange(size)
        (apples if index else lemons).append(fruit.moved(x, y, tall - 1.95 * size))
    return (
        Part("Bowl", dish, "ware"),
        Part("Apples", joined(apples), "apple", collider=None),
        Part("Oranges", joined(lemons), "orange", collider=None),
        Part("Pears", joined(pears), "pear", collider=None),
    )


def _orange(radius: float) -> Solid:
    profile = [(radius * np.sin(a), radius * (1 - np.cos(a))) for a in np.linspace(0.0, np.pi, 9)]
    return lathe(profile, 14)


def _apple(radius: float) -> Solid:
    profile = [
        (0, 0.1 * radius),
        (0.35 * radius, 0),
        (0.8 * radius, 0.4 * radius),
        (radius, 1.0 * radius),
        (0.85 * radius, 1.55 * radius),
        (0.45 * radius, 1.78 * radius),
        (0.12 * radius, 1.6 * radius),
        (0, 1.5 * radius),
    ]
    stem = cylinder(0.0016, radius * 0.5, 0.0, 6).moved(0.0003, 0.0, 1.49 * radius)
    return lathe([*rounded_profile(profile, 1)[::2], (0.0, profile[-1][1])], 14) + stem


def _pear(radius: float) -> Solid:
    profile = [
        (0, 0),
        (0.6 * radius, 0.06 * radius),
        (0.95 * radius, 0.6 * radius),
        (0.9 * radius, 1.1 * radius),
        (0.5 * radius, 1.75 * radius),
        (0.3 * radius, 2.1 * radius),
        (0, 2.2 * radius),
    ]
    stem = tube(
        [[0, 0, 2.15 * radius], [0.002, 0, 2.35 * radius], [0.006, 0, 2.5 * radius]], 0.0015, 6
    )
    return lathe(profile, 14).moved(z=-radius) + stem.moved(z=-radius)


def plate_stack(size_m: Size, *, with_bowls: bool = False) -> tuple[Part, ...]:
    """Plates on top of each other, perhaps smaller bowls upon them."""
    radius, tall = size_m[0] / 2, size_m[2]
    step, plates = 0.0085, 6 if not with_bowls else 3
    step = step if with_bowls else (tall - 0.019) / (plates - 1)
    stack = [
        _plate(radius).moved(0.0012 * ((n * 7) % 3 - 1), 0.0012 * ((n * 5) % 3 - 1), n * step)
        for n in range(plates)
    ]
    parts = [Part("Plates", joined(stack), "ware")]
    if with_bowls:
        z = step * (plates - 1) + 0.006
        high = 0.055
        rise = tall - z - high
        bowls = [
            _bowl(radius * 0.6, high).moved(0.001 * n, -0.001 * n, z + rise * n) for n in range(2)
        ]
        parts.append(Part("Bowls", joined(bowls), "second"))
    return tuple(parts)


def _plate(radius: float) -> Solid:
    return lathe(
        [
            (radius * 0.6, 0),
            (radius * 0.62, 0.003),
            (radius * 0.72, 0.006),
            (radius, 0.018),
            (radius - 0.002, 0.019),
            (radius * 0.72, 0.0095),
            (0, 0.006),
        ],
        32,
    )
