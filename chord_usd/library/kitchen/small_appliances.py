"""Kettles, toasters and coffee machines."""

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
    joined,
    lathe,
    loft,
    pair,
    ring,
    rounded_profile,
    rounded_slab,
    tube,
)
from chord_usd.library.kitchen.vessels import vessel


def kettle(size_m: Size) -> tuple[Part, ...]:
    """An electric kettle on its base: spout to the left, grip to the right."""
    length, width, tall = size_m
    radius = width / 2 - 0.002
    x = -length / 2 + 0.03 + radius
    base = lathe(
        [
            (radius, 0),
            (radius + 0.002, 0.003),
            (radius + 0.001, 0.016),
            (radius - 0.004, 0.02),
            (0, 0.02),
        ],
        36,
    )
    top = tall - 0.02
    profile = rounded_profile(
        [
            (radius - 0.006, 0.021),
            (radius - 0.002, 0.026),
            (radius - 0.003, 0.06),
            (radius * 0.86, tall * 0.62),
            (radius * 0.74, top - 0.006),
            (radius * 0.7, top),
        ],
        2,
    )
    body = lathe([*profile, (0, top + 0.0005)], 36)
    lid = lathe(
        [
            (radius * 0.66, top),
            (radius * 0.64, top + 0.006),
            (radius * 0.2, top + 0.01),
            (0, top + 0.01),
        ],
        30,
    )
    knob = cylinder(0.011, tall - top - 0.008, 0.003, 16).moved(z=top + 0.008)
    spout = _spout(radius, top)
    hand = bent_path(
        [
            [radius * 0.7, 0, top - 0.012],
            [length - 0.03 - radius - 0.012, 0, top - 0.006],
            [length - 0.03 - radius - 0.012, 0, tall * 0.32],
            [radius * 0.86, 0, tall * 0.24],
        ],
        0.03,
        4,
    )
    return (
        Part("Base", base.moved(x), "grip"),
        Part("Body", (body + spout).moved(x), "metal", collider="boundingCube"),
        Part("Lid", (lid + knob).moved(x), "grip", collider=None),
        Part("Handle", tube(hand, 0.0105, 10).moved(x), "grip", collider=None),
    )


def _spout(radius: float, top: float) -> Solid:
    """A beak on the upper edge, towards -x."""
    outline = np.array(
        [
            [0.0, 0.026],
            [-0.02, 0.02],
            [-0.042, 0.006],
            [-0.042, -0.006],
            [-0.02, -0.02],
            [0.0, -0.026],
        ]
    )[::1]
    shift = -radius * 0.66
    low = np.column_stack(
        [outline[:, 0] * 0.35 + shift - 0.006, outline[:, 1] * 0.7, np.full(6, top - 0.06)]
    )
    high = np.column_stack([outline[:, 0] + shift, outline[:, 1], np.full(6, top - 0.002)])
    return loft([low, high])


def stove_kettle(size_m: Size) -> tuple[Part, ...]:
    """A whistling kettle: a low body, a bow handle over it, a short spout."""
    length, width, tall = size_m
    radius = width / 2
    x = -length / 2 + (length - 2 * radius) + radius
    high = tall * 0.56
    body = lathe(
        rounded_profile(
            [
                (radius * 0.84, 0),
                (radius * 0.98, 0.004),
                (radius, high * 0.3),
                (radius * 0.92, high * 0.62),
                (radius * 0.5, high * 0.93),
                (radius * 0.42, high),
                (0, high),
            ],
            2,
        ),
        40,
    )
    lid = lathe(
        [
            (radius * 0.42, high - 0.004),
            (radius * 0.42, high + 0.002),
            (radius * 0.2, high + 0.008),
            (0.005, high + 0.01),
            (0.005, high + 0.018),
            (0.013, high + 0.024),
            (0.012, high + 0.034),
            (0, high + 0.036),
        ],
        28,
    )
    spout = tube(
        [
            [-radius * 0.7, 0, high * 0.5],
            [-radius * 1.02, 0, high * 0.82],
            [-length + radius + 0.012, 0, high * 1.02],
        ],
        0.014,
        12,
    )
    bow = bent_path(
        [
            [-radius * 0.74, 0, high * 0.72],
            [-radius * 0.62, 0, tall - 0.01],
            [radius * 0.62, 0, tall - 0.01],
            [radius * 0.74, 0, high * 0.72],
        ],
        0.05,
        5,
    )
    grip = (
        cylinder(0.0125, radius * 0.8, 0.004, 14)
        .turned("y", 90)
        .moved(-radius * 0.4, 0, tall - 0.0125)
    )
    return (
        Part("Body", (body + spout).moved(x), "metal"),
        Part("Lid", lid.moved(x), "metal", collider=None),
        Part("Bow", tube(bow, 0.005, 8).moved(x), "bow", collider=None),
        Part("Grip", grip.moved(x), "grip", collider=None),
    )


def toaster(size_m: Size, *, retro: bool = False) -> tuple[Part, ...]:
    """A toaster for two slices, its lever at the right end."""
    length, width, tall = size_m
    feet, lever = 0.012, 0.016
    body_l = length - lever
    x = -lever / 2
    corner = 0.05 if retro else 0.03
    rings = []
    high = tall - feet
    levels = (
        (
            (0.93, 0.9, 0.0),
            (1.0, 1.0, 0.1),
            (1.0, 1.0, 0.62),
            (0.985, 0.96, 0.82),
            (0.94, 0.88, 0.94),
            (0.86, 0.74, 1.0),
        )
        if retro
        else (
            (0.97, 0.95, 0.0),
            (1.0, 1.0, 0.05),
            (1.0, 1.0, 0.86),
            (0.985, 0.97, 0.95),
            (0.95, 0.9, 1.0),
        )
    )
    for a, b, z in levels:
        rings.append(
            ring(body_l * a, width * b, corner * a, feet + high * z, 5) + np.array([x, 0.0, 0.0])
        )
    body = loft(rings)
    slots = joined(pair(box((body_l * 0.66, 0.026, 0.003)).moved(x=x, z=tall - 0.0015), y=0.026))
    knob = (
        cylinder(0.013, 0.012, 0.003, 18)
        .turned("y", 90)
        .moved(x + body_l / 2 - 0.003, 0.0, feet + 0.045)
    )
    handle = block((lever + 0.006, 0.04, 0.014), 0.004).moved(
        x + body_l / 2 + lever / 2 - 0.004, 0.0, tall * 0.66
    )
    track = box((0.003, 0.008, high * 0.5)).moved(x + body_l / 2, 0.0, feet + high * 0.26)
    base = rounded_slab((body_l * 0.92, width * 0.86, feet + 0.006), 0.03, 0.003, 4).moved(x)
    return (
        Part("Base", base, "trim"),
        Part("Body", body, "metal"),
        Part("Slots", slots + track, "dark", collider=None),
        Part("Lever", handle + knob, "trim", collider=None),
    )


def espresso_machine(size_m: Size) -> tuple[Part, ...]:
    """A machine for espresso: head with group and portafilter, drip tray, cups on top."""
    length, width, tall = size_m
    back = width / 2
    high = tall - 0.06
    tray_h = 0.065
    body_w = width * 0.56
    body = rounded_slab((length - 0.003, body_w, high), 0.02, 0.006, 4).moved(
        y=back - body_w / 2 - 0.001
    )
    tray = rounded_slab((length - 0.006, width - 0.02, tray_h), 0.02, 0.006, 4).moved(y=-0.01 + 0.0)
    grid = joined(
        [
            box((length * 0.8, 0.006, 0.004)).moved(
                y=-width / 2 + 0.035 + 0.014 * n, z=tray_h - 0.001
            )
            for n in range(8)
        ]
    )
    head = rounded_slab((length, width * 0.84, 0.11), 0.02, 0.006, 4).moved(
        y=back - width * 0.42, z=high - 0.1105
    )
    group_y = back - width * 0.66
    group = cylinder(0.036, 0.03, 0.003, 28).moved(y=group_y, z=high - 0.138)
    filter_ = cylinder(0.033, 0.026, 0.003, 28).moved(y=group_y, z=high - 0.162)
    spouts = joined(
        [
            tube(
                [
                    [s * 0.002, group_y, high - 0.158],
                    [s * 0.012, group_y, high - 0.172],
                    [s * 0.012, group_y, high - 0.188],
                ],
                0.005,
                8,
            )
            for s in (-1, 1)
        ]
    )
    grip = tube([[0, group_y - 0.03, high - 0.15], [0, group_y - 0.13, high - 0.156]], 0.011, 12)
    front = back - width * 0.84
    dials = joined(
        [
            cylinder(0.017, 0.016, 0.003, 20).turned("x", 90).moved(x, front + 0.001, high - 0.055)
            for x in (-0.07, 0.07)
        ]
    )
    gauge = (
        cylinder(0.024, 0.006, 0.002, 24).turned("x", 90).moved(0.0, front + 0.001, high - 0.055)
    )
    wand = tube(
        bent_path(
            [
                [length * 0.38, group_y, high - 0.108],
                [length * 0.38, group_y, high - 0.19],
                [length * 0.42, group_y - 0.02, high - 0.23],
            ],
            0.03,
            3,
        ),
        0.005,
        8,
    )
    cup = vessel([(0.022, 0), (0.03, 0.02), (0.033, 0.06)], 0.003, 0.005, 18)
    cups = joined(
        [
            cup.moved(x, back - 0.06 - 0.06 * (n % 2), high - 0.0005)
            for n, x in enumerate((-0.07, -0.0053, 0.0618))
        ]
    )
    return (
        Part("Body", body, "metal"),
        Part("Tray", tray, "metal"),
        Part("Head", head, "metal", collider=None),
        Part("Grid", grid, "dark", collider=None),
        Part("Group", joined([group, filter_, spouts, wand]), "chrome", collider=None),
        Part("Handle", joined([grip, dials]), "grip", collider=None),
        Part("Gauge", gauge, "face", collider=None),
        Part("Cups", cups, "cup", collider=None),
    )


def filter_machine(size_m: Size) -> tuple[Part, ...]:
    """A filter coffee machine: tank, filter, glass jug on a hot plate."""
    length, width, tall = size_m
    back = width / 2
    plate_h = 0.035
    base = rounded_slab((length, width, plate_h), 0.03, 0.006, 4)
    tower_w = width * 0.38
    tower = rounded_slab((length - 0.004, tower_w, tall), 0.025, 0.006, 4).moved(
        y=back - tower_w / 2 - 0.001
    )
    head = rounded_slab((length * 0.96, width * 0.66, tall * 0.3), 0.03, 0.008, 4).moved(
        y=back - tower_w - width * 0.66 / 2 + 0.08, z=tall * 0.7 - 0.0005
    )
    y = -width / 2 + 0.085
    radius = min(0.065, length * 0.4)
    top = tall * 0.7 - 0.02
    jug_profile = rounded_profile(
        [
            (radius * 0.86, plate_h + 0.004),
            (radius, plate_h + 0.014),
            (radius, plate_h + 0.06),
            (radius * 0.72, top - 0.01),
            (radius * 0.74, top),
        ],
        1,
    )
    jug = vessel(jug_profile, 0.0025, plate_h + 0.007, 28).moved(y=y)
    level = plate_h + 0.066
    brew = lathe(
        [
            (radius * 0.82, plate_h + 0.0075),
            (radius - 0.0035, plate_h + 0.016),
            (radius - 0.0035, level - 0.004),
            (0, level),
        ],
        28,
    ).moved(y=y)
    grip = tube(
        bent_path(
            [
                [radius * 0.72, y, top - 0.004],
                [radius + 0.03, y, top - 0.006],
                [radius + 0.03, y, plate_h + 0.035],
                [radius * 0.96, y, plate_h + 0.03],
            ],
            0.02,
            3,
        ).tolist(),
        0.007,
        8,
    ).turned("z", 0)
    hot = cylinder(radius + 0.004, 0.004, 0.001, 28).moved(y=y, z=plate_h - 0.0005)
    switch = block((0.03, 0.004, 0.014), 0.001).moved(0.0, -width / 2, 0.012)
    return (
        Part("Base", base, "metal"),
        Part("Tower", tower, "metal"),
        Part("Head", head, "metal", collider=None),
        Part("Plate", hot, "dark", collider=None),
        Part("Jug", jug, "clear", collider=None),
        Part("Coffee", brew, "coffee", collider=None),
        Part("Grip", _before(grip, y) + switch, "grip", collider=None),
    )


def _before(solid: Solid, y: float) -> Solid:
    """Turned about the upright axis of the jug, so that the grip shows to the front right."""
    return solid.moved(y=-y).turned("z", -50).moved(y=y)
