"""Lamps on walls; backs at +y."""

from __future__ import annotations

import numpy as np

from chord_usd.library.kit.forms import (
    arc,
    hollow,
    lofted,
    outward,
    sphere_profile,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    block,
    cylinder,
    joined,
    lathe,
    pair,
    rounded_slab,
    tube,
)
from chord_usd.library.lighting.lamp_parts import bulb


def _plate(radius_m: float, back_y_m: float, z_m: float) -> Solid:
    """A round plate on the wall."""
    profile = [
        (radius_m, 0.0),
        (radius_m, 0.008),
        (radius_m * 0.8, 0.016),
        (0.012, 0.02),
        (0.0, 0.02),
    ]
    return outward(lathe(profile, 28)).turned("x", 90).moved(y=back_y_m, z=z_m)


def shaded(size_m: Size) -> tuple[Part, ...]:
    """A cloth shade on a curved arm."""
    length, width, height = size_m
    r = length / 2
    at_y = -width / 2 + r
    tall = r * 1.3
    low = height - tall
    plate_z = 0.05
    arm = bent_path(
        [[0, width / 2 - 0.012, plate_z], [0, at_y, plate_z], [0, at_y, low + 0.05]], 0.04, 6
    )
    shade = hollow([(r, low), (r * 0.66, height)], 0.0025, 32).moved(y=at_y)
    spoke = block((1.3 * r, 0.004, 0.003), 0.001).moved(y=at_y, z=height - 0.02)
    holder = cylinder(0.012, 0.05, 0.002, 14).moved(y=at_y, z=low + 0.02)
    return (
        Part("Plate", _plate(0.05, width / 2, plate_z), "metal", None),
        Part("Arm", tube(arm, 0.0055, 8) + holder, "metal", None),
        Part("Shade", shade, "shade", None),
        Part("Spoke", spoke, "metal", None),
        Part("Bulb", bulb(0.025).moved(y=at_y, z=low + 0.06), "bulb", None),
    )


def opal(size_m: Size) -> tuple[Part, ...]:
    """An opal ball on a short arm."""
    length, width, height = size_m
    r = length / 2
    at_y = -width / 2 + r
    top = height - 2 * r
    ball = outward(lathe(sphere_profile(r, steps=14), 28)).moved(y=at_y, z=top + r)
    plate_z = 0.045
    arm = bent_path(
        [[0, width / 2 - 0.012, plate_z], [0, at_y, plate_z], [0, at_y, top + 0.012]], 0.03, 5
    )
    dish = lathe([(0.01, 0.0), (0.032, 0.014), (0.034, 0.022)], 20).moved(y=at_y, z=top - 0.008)
    return (
        Part("Plate", _plate(0.045, width / 2, plate_z), "metal", None),
        Part("Arm", tube(arm, 0.006, 8) + dish, "metal", None),
        Part("Globe", ball, "opal", None),
    )


def up_down(size_m: Size) -> tuple[Part, ...]:
    """A box open at top and bottom, washing the wall."""
    length, width, height = size_m
    wall = 0.006
    front = block((length, wall, height), 0.002).moved(y=-width / 2 + wall / 2)
    back = block((length, 0.02, height), 0.002).moved(y=width / 2 - 0.01)
    sides = pair(
        block((wall, width - 0.02, height - 0.001), 0.0015).moved(y=-0.007, z=0.0005),
        x=(length - wall) / 2,
    )
    glow = block((length - 0.01, width - 0.024, height - 0.024), 0.003).moved(y=-0.006, z=0.012)
    return (
        Part("Case", joined([front, back, *sides]), "metal", None),
        Part("Diffuser", glow, "opal", None),
    )


def swing(size_m: Size) -> tuple[Part, ...]:
    """A cone on an arm with a hinge, from a workshop."""
    length, width, height = size_m
    r = length / 2
    at_y = -width / 2 + r
    tall = 0.17
    plate = block((0.06, 0.014, 0.12), 0.005).moved(y=width / 2 - 0.007, z=height - 0.12)
    hinge = cylinder(0.012, 0.05, 0.003, 16).moved(y=width / 2 - 0.024, z=height - 0.085)
    arm = bent_path(
        [[0, width / 2 - 0.024, height - 0.06], [0, at_y, height - 0.012], [0, at_y, tall - 0.01]],
        0.03,
        5,
    )
    cone = [(r, 0.0), (0.036, 0.1), (0.03, 0.145), (0.012, 0.155)]
    inner = [(r - 0.004, -0.002), (0.032, 0.096)]
    return (
        Part("Plate", plate + hinge, "metal", None),
        Part("Arm", tube(arm, 0.006, 8), "trim", None),
        Part("Cone", hollow(cone, 0.0025, 30).moved(y=at_y), "metal", None),
        Part("Inside", hollow(inner, 0.0012, 30).moved(y=at_y, z=0.002), "lining", None),
        Part("Bulb", bulb(0.026).turned("x", 180).moved(y=at_y, z=0.09), "bulb", None),
    )


def bar(size_m: Size) -> tuple[Part, ...]:
    """A glowing tube over a mirror, on two arms."""
    length, width, height = size_m
    r = 0.018
    at_y = -width / 2 + r + 0.002
    glow = (
        cylinder(r, length - 0.03, 0.003, 20)
        .turned("y", 90)
        .moved(-(length - 0.03) / 2, at_y, height / 2)
    )
    caps = [
        cylinder(r + 0.002, 0.02, 0.003, 20).turned("y", 90).moved(x, at_y, height / 2)
        for x in (-length / 2, length / 2 - 0.02)
    ]
    plate = (
        rounded_slab((0.14, height, 0.02), 0.012, 0.004, 4)
        .turned("x", 90)
        .moved(y=width / 2, z=height / 2)
    )
    arm = [
        tube([[x, width / 2 - 0.012, height / 2], [x, at_y + r - 0.004, height / 2]], 0.006, 8)
        for x in (-0.04, 0.04)
    ]
    return (
        Part("Tube", glow, "opal", None),
        Part("Caps", joined(caps), "metal", None),
        Part("Plate", plate, "metal", None),
        Part("Arms", joined(arm), "metal", None),
    )


def washi(size_m: Size) -> tuple[Part, ...]:
    """Paper behind a wooden lattice, a low box on the wall."""
    length, width, height = size_m
    rail = 0.016
    frame = pair(block((rail, width, height), 0.002), x=(length - rail) / 2)
    frame += [
        block((length - 2 * rail + 0.002, width - 0.002, rail), 0.002).moved(z=z)
        for z in (0.0, height - rail)
    ]
    thin = [
        block((0.006, 0.01, height - 2 * rail + 0.002), 0.001).moved(
            x, -width / 2 + 0.007, rail - 0.001
        )
        for x in (-length / 6, length / 6)
    ]
    thin += [
        block((length - 2 * rail + 0.002, 0.0095, 0.006), 0.001).moved(
            y=-width / 2 + 0.007, z=height * s
        )
        for s in (0.25, 0.5, 0.75)
    ]
    paper = block((length - 2 * rail + 0.004, 0.003, height - 2 * rail + 0.004), 0.001).moved(
        y=-width / 2 + 0.014, z=rail - 0.002
    )
    back = block((length - 2 * rail + 0.004, 0.008, height - 2 * rail + 0.004), 0.001).moved(
        y=width / 2 - 0.005, z=rail - 0.002
    )
    return (
        Part("Frame", joined([*frame, *thin]), "wood", None),
        Part("Paper", paper, "paper", None),
        Part("Back", back, "wood", None),
    )


def candles(size_m: Size) -> tuple[Part, ...]:
    """Two curved arms with candles and small shades."""
    length, width, height = size_m
    r = length * 0.19
    at_y = -width / 2 + r
    low = height - 1.35 * r
    spread = length / 2 - r
    backplate = lathe([(0.03, 0.0), (0.034, 0.006), (0.024, 0.016), (0.0, 0.02)], 24).scaled(
        1.0, 2.0, 1.0
    )
    arms, cups_, wax, shades, bulbs = [], [], [], [], []
    for s in (-1, 1):
        bend = [
            (s * 0.001, width / 2 - 0.012, 0.055),
            (s * spread * 0.5, 0.0, -0.02),
            (s * spread, at_y, 0.0),
            (s * spread, at_y, low - 0.07),
        ]
        t = np.linspace(0, 1, 12)[:, None]
        p = np.array(bend)
        path = (
            (1 - t) ** 3 * p[0]
            + 3 * t * (1 - t) ** 2 * p[1]
            + 3 * t**2 * (1 - t) * p[2]
            + t**3 * p[3]
        )
        arms.append(tube(path, 0.005, 8))
        cups_.append(
            lathe([(0.006, 0.0), (0.024, 0.01), (0.026, 0.014)], 18).moved(
                s * spread, at_y, low - 0.072
            )
        )
        wax.append(cylinder(0.0095, 0.07, 0.0, 12).moved(s * spread, at_y, low - 0.06))
        shades.append(hollow([(r, low), (r * 0.6, height)], 0.0022, 28).moved(s * spread, at_y))
        bulbs.append(bulb(0.016).moved(s * spread, at_y, low + 0.008))
    return (
        Part("Plate", backplate.turned("x", 90).moved(y=width / 2, z=0.07), "metal", None),
        Part("Arms", joined([*arms, *cups_]), "metal", None),
        Part("Candles", joined(wax), "wax", None),
        Part("Shades", joined(shades), "shade", None),
        Part("Bulbs", joined(bulbs), "bulb", None),
    )


def dish(size_m: Size) -> tuple[Part, ...]:
    """A half dish of plaster that shines upwards."""
    length, width, height = size_m
    profile = arc((0.012, 0.0), (length * 0.46, 0.0), (length / 2, height), 9)
    turn = np.linspace(np.pi, 2 * np.pi, 25)
    rings = []
    for radius, z in [*profile, *[(r - 0.008, z + 0.006) for r, z in reversed(profile)]]:
        radius = max(radius, 0.004)
        x, y = radius * np.cos(turn), radius * np.sin(turn) * (width / (length / 2))
        ring_ = np.stack([x, y + width / 2 - 0.0, np.full_like(x, min(z, height))], -1)
        rings.append(ring_)
    bowl = lofted(rings)
    glow = block((length * 0.5, width * 0.36, 0.008), 0.002).moved(
        y=width / 2 - width * 0.3, z=height * 0.72
    )
    back = block((length * 0.6, 0.01, height * 0.8), 0.003).moved(
        y=width / 2 - 0.0055, z=height * 0.16
    )
    return (
        Part("Dish", bowl, "plaster", None),
        Part("Back", back, "plaster", None),
        Part("Diffuser", glow, "opal", None),
    )
