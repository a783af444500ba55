"""Bottles, jars, bowls, plates: turned things that stand on worktops, boards and sills."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from chord_usd.assets.dressing.kitchen_finishes import FINISHES
from chord_usd.assets.model import Design, Draw, Part
from chord_usd.assets.solids import (
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


def hollow(outside: Profile, wall_m: float, floor_m: float, sides: int = 26) -> Solid:
    """A vessel turned from its outside, foot first, to the rim; the inside is wall_m further in."""
    rim = [(outside[-1][0] - 0.4 * wall_m, outside[-1][1] + 0.3 * wall_m)]
    inside = [(max(r - wall_m, 0.002), z) for r, z in reversed(outside) if z > floor_m]
    return lathe([*outside, *rim, *inside, (0.0, floor_m)], sides)


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
    mill = lathe(rounded_profile([(0.024, 0), (0.026, 0.004), (0.026, 0.02), (0.017, 0.055), (0.022, 0.085),
                                  (0.024, 0.1), (0.012, 0.108), (0.018, 0.122), (0.012, 0.14), (0, 0.145)], 1), 22)  # fmt: skip
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
    profile = rounded_profile([(radius * 0.8, 0), (radius, 0.01), (radius, tall * 0.34), (radius * 0.42, tall * 0.66),
                               (radius * 0.42, tall * 0.76), (radius * 0.58, tall * 0.93)], 2)  # fmt: skip
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
        Part("Carafe", hollow(profile, 0.0025, 0.006), "clear"),
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
    body = lathe(rounded_profile([(radius * 0.94, 0), (radius, 0.003), (radius, 0.01), (radius, body_h - 0.022),
                                  (radius * 0.96, body_h - 0.008), (radius * 0.5, body_h - 0.001), (radius * 0.45, body_h)], 1), 24)  # fmt: skip
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
    body = lathe(rounded_profile([(radius * 0.56, cap_h - 0.001), (radius * 0.8, cap_h + 0.012), (radius, tall * 0.4),
                                  (radius, tall * 0.75), (radius * 0.9, tall - 0.012), (radius * 0.6, tall - 0.001), (0, tall)], 1), 24)  # fmt: skip
    return body.scaled(1.0, flat, 1.0), cap


def shampoo(size_m: Size, *, count: int) -> tuple[Part, ...]:
    """Bottles of shampoo and soap in a row, each a little different."""
    tall = size_m[2]
    pitch, radius = 0.079, 0.0335
    parts: list[Part] = []
    for index in range(count):
        x = pitch * (index - (count - 1) / 2)
        share = (1.0, 0.86, 0.93)[index % 3]
        if index % 2 == 0:
            body, cap = pump_bottle(radius, tall * share)
        else:
            body, cap = flip_bottle(radius * 1.08, tall * share)
        y = 0.004 if index % 2 == 0 else 0.008
        turn = (12.0, -8.0, -20.0)[index % 3]
        name = f"{index + 1}"
        slot = ("first", "second", "third")[index % 3]
        parts += [
            Part(f"Bottle_{name}", body.turned("z", turn).moved(x, y), slot),
            Part(f"Cap_{name}", cap.turned("z", turn).moved(x, y), "cap", collider=None),
        ]
        if index % 2 == 0:
            mark = _label(radius, tall * 0.2, tall * 0.5)
            parts.append(Part(f"Label_{name}", mark.moved(x, y), "label", collider=None))
    return tuple(parts)


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
    glass = hollow(outside, 0.003, 0.006, sides)
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
    ]  # fmt: skip


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
    profile = [(radius * 0.42, 0.0), (radius * 0.42, 0.006), (radius * 0.5, 0.01), (radius * 0.76, tall * 0.35),
               (radius * 0.93, tall * 0.68), (radius, tall - 0.002)]  # fmt: skip
    rounded = rounded_profile(profile, 1)
    return hollow(rounded[:1] + rounded[2:], 0.006, 0.014, 28)


def fruit_bowl(size_m: Size) -> tuple[Part, ...]:
    """A wide bowl of fruit."""
    radius, tall = size_m[0] / 2, size_m[2]
    rim = tall * 0.68
    dish = _bowl(radius, rim)
    places = [(0.0, 0.0)] + [
        (0.62 * radius * np.cos(a), 0.62 * radius * np.sin(a))
        for a in np.radians((20, 92, 164, 236, 308))
    ]
    lemons, apples, pears = [], [], []
    size = radius * 0.3
    for index, (x, y) in enumerate(places):
        z = rim * 0.3 if index else rim * 0.16
        if index % 3 == 0:
            apples.append(_apple(size).turned("x", 14.0 * index).moved(x, y, z))
        elif index % 3 == 1:
            lemons.append(_orange(size * 0.95).moved(x, y, z))
        else:
            pears.append(
                _pear(size).turned("x", 64).turned("z", 70.0 * index).moved(x, y, z + size * 0.7)
            )
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
    profile = [(0, 0.1 * radius), (0.35 * radius, 0), (0.8 * radius, 0.4 * radius), (radius, 1.0 * radius),
               (0.85 * radius, 1.55 * radius), (0.45 * radius, 1.78 * radius), (0.12 * radius, 1.6 * radius), (0, 1.5 * radius)]  # fmt: skip
    stem = cylinder(0.0016, radius * 0.5, 0.0, 6).moved(0.0003, 0.0, 1.49 * radius)
    return lathe(rounded_profile(profile, 1)[::2] + [(0.0, profile[-1][1])], 14) + stem


def _pear(radius: float) -> Solid:
    profile = [(0, 0), (0.6 * radius, 0.06 * radius), (0.95 * radius, 0.6 * radius), (0.9 * radius, 1.1 * radius),
               (0.5 * radius, 1.75 * radius), (0.3 * radius, 2.1 * radius), (0, 2.2 * radius)]  # fmt: skip
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
    return lathe([(radius * 0.6, 0), (radius * 0.62, 0.003), (radius * 0.72, 0.006), (radius, 0.018), (radius - 0.002, 0.019),
                  (radius * 0.72, 0.0095), (0, 0.006)], 32)  # fmt: skip


def _design(
    name: str, category: str, size: Size, draw: Draw, looks: Mapping[str, Mapping[str, str]],
    styles: tuple[str, ...] = (),
) -> Design:  # fmt: skip
    return Design(name, category, size, draw, looks, FINISHES, styles)


_WINES = {
    "red": {"glass": "bottle_green", "label": "label", "cap": "wine"},
    "dark": {"glass": "black_glass", "label": "label_dark", "cap": "brass"},
}
_OILS = {
    "oak": {"oil": "oil", "vinegar": "vinegar", "label": "label", "cap": "steel", "wood": "oak"},
    "walnut": {
        "oil": "bottle_green",
        "vinegar": "vinegar",
        "label": "label",
        "cap": "black",
        "wood": "walnut",
    },
}
_CARAFES = {
    "cork": {"clear": "clear_glass", "water": "water", "cork": "cork"},
    "oak": {"clear": "clear_glass", "water": "water", "cork": "oak"},
}
_SHAMPOOS = {
    "white": {"first": "plastic_white", "second": "plastic_sage", "third": "sand", "cap": "plastic_white", "label": "label_dark"},
    "amber": {"first": "amber_glass", "second": "amber_glass", "third": "amber_glass", "cap": "black", "label": "label"},
    "blush": {"first": "plastic_blush", "second": "plastic_white", "third": "plastic_blue", "cap": "plastic_white", "label": "label"},
}  # fmt: skip
_JARS = {
    "oak": {"clear": "clear_glass", "content": "pasta", "second": "rice", "third": "lentils", "lid": "oak", "metal": "steel"},
    "walnut": {"clear": "clear_glass", "content": "beans", "second": "oats", "third": "sugar", "lid": "walnut", "metal": "brass"},
    "birch": {"clear": "clear_glass", "content": "oats", "second": "pasta", "third": "beans", "lid": "birch", "metal": "black_metal"},
}  # fmt: skip
_WARE = {
    "white": {"ware": "ceramic", "second": "stoneware_blue", "lid": "oak", "apple": "apple", "orange": "orange", "pear": "pear"},
    "stoneware": {"ware": "stoneware", "second": "stoneware", "lid": "walnut", "apple": "apple", "orange": "lemon", "pear": "pear"},
    "dark": {"ware": "stoneware_dark", "second": "ceramic", "lid": "oak", "apple": "apple", "orange": "orange", "pear": "pear"},
}  # fmt: skip
_WOODEN = {
    "oak": {"ware": "oak", "apple": "apple", "orange": "orange", "pear": "pear"},
    "walnut": {"ware": "walnut", "apple": "apple", "orange": "lemon", "pear": "pear"},
}

DESIGNS = (
    _design("Bottle_Kitchen_Wine", "bottle", (0.076, 0.076, 0.31), wine, _WINES),
    _design("Bottle_Kitchen_Oil", "bottle", (0.062, 0.062, 0.28), oil, _OILS),
    _design("Bottle_Kitchen_Oil_And_Vinegar", "bottle", (0.15, 0.11, 0.27), oil_pair, _OILS),
    _design("Bottle_Kitchen_Carafe", "bottle", (0.1, 0.1, 0.27), carafe, _CARAFES),
    _design("Bottle_Bath_Pair", "bottle", (0.15, 0.076, 0.2), partial(shampoo, count=2), _SHAMPOOS),
    _design(
        "Bottle_Bath_Three", "bottle", (0.225, 0.076, 0.21), partial(shampoo, count=3), _SHAMPOOS
    ),
    _design(
        "Bottle_Bath_Single", "bottle", (0.067, 0.075, 0.19), partial(shampoo, count=1), _SHAMPOOS
    ),
    _design("Jar_Single_Wood", "jar", (0.1, 0.1, 0.2), jar, _JARS),
    _design(
        "Jar_Single_Clip", "jar", (0.105, 0.11, 0.16), partial(jar, clip=True, fill=0.7), _JARS
    ),
    _design("Jar_Row_Wood", "jar", (0.34, 0.105, 0.23), jar_row, _JARS),
    _design("Jar_Row_Clip", "jar", (0.36, 0.115, 0.22), partial(jar_row, clip=True), _JARS),
    _design("Jar_Row_Canisters", "jar", (0.4, 0.125, 0.2), canister_row, _WARE),
    _design("Bowl_Empty", "bowl", (0.26, 0.26, 0.1), bowl, _WARE),
    _design("Bowl_Empty_Small", "bowl", (0.16, 0.16, 0.075), bowl, _WARE),
    _design("Bowl_Fruit", "bowl", (0.3, 0.3, 0.14), fruit_bowl, _WARE),
    _design("Bowl_Fruit_Wood", "bowl", (0.34, 0.34, 0.15), fruit_bowl, _WOODEN),
    _design("Plate_Stack", "plate_stack", (0.27, 0.27, 0.06), plate_stack, _WARE),
    _design(
        "Plate_Stack_Bowls",
        "plate_stack",
        (0.26, 0.26, 0.1),
        partial(plate_stack, with_bowls=True),
        _WARE,
    ),
    _design("Plate_Stack_Small", "plate_stack", (0.2, 0.2, 0.05), plate_stack, _WARE),
)
