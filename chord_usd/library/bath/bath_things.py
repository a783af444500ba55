"""Small things of bathrooms: paper holders, screens on tubs, brushes, soap, toothbrushes."""

from __future__ import annotations

import numpy as np

from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    block,
    box,
    cylinder,
    extruded,
    joined,
    lathe,
    rounded_profile,
    rounded_slab,
    tube,
)
from chord_usd.library.kitchen.bottles import pump_bottle
from chord_usd.library.kitchen.vessels import vessel

_ROLL_M, _CORE_M, _ROLL_LENGTH_M = 0.052, 0.02, 0.098


def _roll() -> Solid:
    """A roll of paper along x, its middle at the origin, and a sheet that hangs from it."""
    roll = lathe(
        [
            (_CORE_M, 0),
            (_ROLL_M - 0.002, 0),
            (_ROLL_M, 0.002),
            (_ROLL_M, _ROLL_LENGTH_M - 0.002),
            (_ROLL_M - 0.002, _ROLL_LENGTH_M),
            (_CORE_M, _ROLL_LENGTH_M),
        ],
        32,
        loop=True,
    )
    return roll.turned("y", 90).moved(-_ROLL_LENGTH_M / 2)


def _sheet(y: float, top: float, long: float) -> Solid:
    return box((_ROLL_LENGTH_M - 0.001, 0.0008, long)).moved(y=y, z=top - long)


def paper_holder(size_m: Size) -> tuple[Part, ...]:
    """A roll on a bar that is bent out of one rod, a plate on the wall."""
    length, depth, height = size_m
    back = depth / 2
    y = -depth / 2 + _ROLL_M
    z = height - 0.02
    z - _CORE_M + 0.007
    rose = (
        rounded_slab((0.05, 0.05, 0.01), 0.008, 0.002, 4)
        .turned("x", 90)
        .moved(length / 2 - 0.025, back, z - 0.01)
    )
    rod = bent_path(
        [
            [length / 2 - 0.025, back - 0.008, z - 0.01],
            [length / 2 - 0.025, y, z - 0.01],
            [-length / 2 + 0.002, y, z - 0.01],
        ],
        0.016,
        4,
    )
    tip = cylinder(0.009, 0.012, 0.002, 14).turned("y", 90).moved(-length / 2, y, z - 0.01)
    roll_x = -length / 2 + 0.016 + _ROLL_LENGTH_M / 2
    roll_z = z - 0.01 - _CORE_M + 0.0065
    return (
        Part("Holder", joined([rose, tube(rod, 0.0065, 10), tip]), "metal", collider=None),
        Part(
            "Roll",
            _roll().moved(roll_x, y, roll_z)
            + _sheet(y - _ROLL_M + 0.0004, roll_z, roll_z - 0.001).moved(roll_x),
            "paper",
            collider=None,
        ),
    )


def covered_holder(size_m: Size) -> tuple[Part, ...]:
    """A roll below a small board on which a telephone can lie."""
    length, depth, height = size_m
    back = depth / 2
    board = rounded_slab((length, depth, 0.014), 0.01, 0.003, 4).moved(z=height - 0.014)
    y = back - depth / 2 - 0.004
    z = height - 0.014 - _ROLL_M - 0.012
    rod = bent_path(
        [
            [length / 2 - 0.03, y, height - 0.012],
            [length / 2 - 0.03, y, z],
            [-length / 2 + 0.03, y, z],
        ],
        0.014,
        4,
    )
    return (
        Part("Board", board, "board", collider=None),
        Part("Rod", tube(rod, 0.006, 10), "metal", collider=None),
        Part(
            "Roll",
            _roll().moved(0.0, y, z - _CORE_M + 0.0065)
            + _sheet(y - _ROLL_M + 0.0004, z - 0.014, z - 0.0145),
            "paper",
            collider=None,
        ),
    )


def shower_screen(size_m: Size, *, panes: int = 1) -> tuple[Part, ...]:
    """A pane of glass on a tub's edge, hinged at the wall at its left end; one or two leaves."""
    length, depth, height = size_m
    glass, frame = [], []
    post = block((0.028, depth, height), 0.003).moved(-length / 2 + 0.014)
    frame.append(post)
    wide = (length - 0.03) / panes
    for index in range(panes):
        x = -length / 2 + 0.03 + wide * (index + 0.5)
        corner = 0.12 if index == panes - 1 else 0.002
        outline = _screen_outline(wide - 0.004, height - 0.016, corner)
        pane = extruded(outline, 0.006).turned("x", 90).moved(x, 0.003, 0.012)
        glass.append(pane)
        frame.append(block((wide - 0.01, 0.012, 0.014), 0.002).moved(x, 0.0, 0.001))
        if index:
            for share in (0.12, 0.86):
                frame.append(
                    cylinder(0.007, 0.07, 0.002, 12).moved(x - wide / 2, 0.0, height * share)
                )
    for share in (0.1, 0.84):
        frame.append(
            block((0.05, 0.016, 0.06), 0.003).moved(-length / 2 + 0.046, 0.0, height * share)
        )
    knob = (
        cylinder(0.014, depth - 0.002, 0.002, 18)
        .turned("x", 90)
        .moved(length / 2 - 0.06, depth / 2 - 0.001, height * 0.45)
    )
    return (
        Part("Glass", joined(glass), "glass"),
        Part("Profiles", joined([*frame, knob]), "metal", collider=None),
    )


def _screen_outline(wide: float, tall: float, corner: float) -> np.ndarray:
    """(x, z) counter-clockwise; the upper right corner is round."""
    half = wide / 2
    angles = np.radians(np.linspace(0.0, 90.0, 9))
    arc = np.stack(
        [half - corner + corner * np.cos(angles), tall - corner + corner * np.sin(angles)], -1
    )
    return np.concatenate([[[-half, 0.0], [half, 0.0]], arc, [[-half, tall]]])


def toilet_brush(size_m: Size, *, square: bool = False) -> tuple[Part, ...]:
    """A brush in its pot: the handle stands out."""
    radius, tall = size_m[0] / 2, size_m[2]
    high = tall * 0.36 if not square else tall * 0.42
    if square:
        side = 2 * radius
        pot = rounded_slab((side, side, high), 0.012, 0.003, 4)
    else:
        pot = lathe(
            rounded_profile(
                [
                    (radius * 0.96, 0),
                    (radius, 0.003),
                    (radius, 0.014),
                    (radius * 0.97, high - 0.008),
                    (radius * 0.95, high),
                    (0, high),
                ],
                1,
            ),
            30,
        )
    lid = lathe(
        [
            (radius * 0.55, high - 0.002),
            (radius * 0.57, high + 0.004),
            (radius * 0.2, high + 0.012),
            (0, high + 0.012),
        ],
        24,
    )
    stem = cylinder(0.007, tall - high - 0.1, 0.001, 12).moved(z=high + 0.006)
    grip = lathe(
        rounded_profile(
            [
                (0.006, tall - 0.1),
                (0.0095, tall - 0.09),
                (0.011, tall - 0.02),
                (0.0105, tall - 0.006),
                (0.006, tall),
                (0, tall),
            ],
            1,
        ),
        16,
    )
    return (
        Part("Pot", pot, "pot"),
        Part("Brush", joined([lid, stem]), "metal", collider=None),
        Part("Grip", grip, "grip", collider=None),
    )


def soap_dispenser(size_m: Size, *, square: bool = False) -> tuple[Part, ...]:
    """A pump dispenser of soap."""
    length, width, tall = size_m
    radius = length / 2
    body, pump = pump_bottle(radius, tall)
    y = width / 2 - radius
    if square:
        high = tall - 0.055
        side = 2 * radius
        body = rounded_slab((side, side, high - 0.012), 0.008, 0.003, 3) + lathe(
            [(radius * 0.6, high - 0.0125), (radius * 0.42, high)], 20
        )
    return (
        Part("Body", body.moved(y=y), "body"),
        Part("Pump", pump.moved(y=y), "metal", collider=None),
    )


def toothbrush_cup(size_m: Size, *, glass: bool = False) -> tuple[Part, ...]:
    """A cup with two brushes and perhaps a tube of paste."""
    _length, _, tall = size_m
    radius, high = 0.036, 0.105
    cup = vessel(
        rounded_profile([(radius * 0.88, 0), (radius * 0.95, 0.004), (radius, high)], 1)
        if not glass
        else [(radius * 0.84, 0), (radius * 0.86, 0.004), (radius, high)],
        0.003,
        0.006,
        26,
    )
    parts = [Part("Cup", cup, "cup")]
    for index, (about_y, about_x) in enumerate(((12.5, 6.0), (-13.0, 5.0))):
        brush, bristle = _toothbrush(tall - 0.012 - 0.004 * index)
        placed = [
            s.turned("z", 30.0 - 80.0 * index)
            .turned("x", about_x)
            .turned("y", about_y)
            .moved(-0.013 if about_y > 0 else 0.013, -0.006, 0.0075)
            for s in (brush, bristle)
        ]
        parts += [
            Part(f"Brush_{index + 1}", placed[0], f"brush_{index + 1}", collider=None),
            Part(f"Bristles_{index + 1}", placed[1], "bristle", collider=None),
        ]
    return tuple(parts)


def _toothbrush(long: float) -> tuple[Solid, Solid]:
    """Standing on its end: (handle with head, bristles)."""
    handle = rounded_slab((0.012, 0.006, long * 0.6), 0.003, 0.001, 2)
    neck = block((0.006, 0.005, long * 0.26), 0.001).moved(z=long * 0.6 - 0.001)
    head = block((0.012, 0.005, long * 0.15), 0.0015).moved(z=long * 0.85)
    hair = block((0.01, 0.011, long * 0.13), 0.001).moved(y=-0.007, z=long * 0.86)
    return joined([handle, neck, head]), hair
