"""Lamps that stand on tables; they shine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from chord_usd.library.kit.forms import (
    arc,
    hollow,
    outward,
    sphere_profile,
)
from chord_usd.library.kit.joinery import round_colliders
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    block,
    cylinder,
    joined,
    lathe,
    rounded_profile,
)
from chord_usd.library.lighting.lamp_parts import (
    TABLE_SHADE,
    bulb,
    cloth_shade,
    metal_shade,
    paper_box,
    two_rods,
)

Draw = Callable[[Size], tuple[Part, ...]]


def _shade(low: float, high: float, wide: float, narrow: float) -> tuple[Part, ...]:
    # Nothing stands on a shade, and what is flat goes under it.
    colliders = round_colliders(cylinder(narrow * 0.9, high - low).moved(z=low))
    return cloth_shade(low, high, wide, narrow, TABLE_SHADE, colliders)


def ball(size_m: Size) -> tuple[Part, ...]:
    """A glazed ball under a drum."""
    radius, height = size_m[0] / 2, size_m[2]
    low = height * 0.54
    r = min(radius * 0.72, low * 0.44)
    neck = low + height * 0.05
    profile = [
        (r * 0.5, 0.0),
        (r * 0.56, 0.006),
        (r * 0.5, 0.014),
        *sphere_profile(r, -0.82, 0.94, 14, 0.012 + 0.82 * r),
    ]
    top = profile[-1][1]
    body = outward(
        lathe([*profile, (0.014, top + 0.004), (0.014, top + 0.014), (0.0, top + 0.014)], 32)
    )
    stem = cylinder(0.007, max(neck - top, 0.02), 0.0, 12).moved(z=top + 0.008)
    return (
        Part("Foot", body, "ceramic"),
        Part("Stem", stem, "metal", collider=None),
        *_shade(low, height, radius, radius * 0.86),
        Part("Bulb", bulb(0.024).moved(z=low + height * 0.08), "bulb", collider=None),
    )


def turned(size_m: Size) -> tuple[Part, ...]:
    """A turned column on a stepped foot under an empire shade."""
    radius, height = size_m[0] / 2, size_m[2]
    low, r = height * 0.55, radius * 0.56
    h = low
    profile = [
        (r, 0.0),
        (r, 0.01),
        (r * 0.86, 0.016),
        (r * 0.82, 0.024),
        (r * 0.4, 0.034),
        (r * 0.24, 0.05),
        (r * 0.44, h * 0.24),
        (r * 0.6, h * 0.42),
        (r * 0.5, h * 0.58),
        (r * 0.2, h * 0.72),
        (r * 0.28, h * 0.76),
        (r * 0.16, h * 0.82),
    ]
    body = [
        *profile[:4],
        *rounded_profile(profile[3:], 1)[1:],
        (0.007, h * 0.9),
        (0.007, h * 1.14),
        (0.0, h * 1.14),
    ]
    finial = lathe([(0.003, 0.0), (0.007, 0.006), (0.003, 0.011), (0.0, 0.018)], 12)
    return (
        Part("Foot", outward(lathe(body, 32)), "ceramic"),
        *_shade(low, height - 0.014, radius, radius * 0.6),
        Part(
            "Harp",
            cylinder(0.002, height - h * 1.1 - 0.016, 0.0, 8).moved(z=h * 1.1),
            "metal",
            collider=None,
        ),
        Part("Finial", finial.moved(z=height - 0.018), "metal", collider=None),
        Part("Bulb", bulb(0.026).moved(z=low + height * 0.07), "bulb", collider=None),
    )


def mushroom(size_m: Size) -> tuple[Part, ...]:
    """A dome on a stem, of one colour, its light below."""
    radius, height = size_m[0] / 2, size_m[2]
    low = height * 0.56
    tall = height - low
    foot = [
        (radius * 0.62, 0.0),
        (radius * 0.62, 0.006),
        *arc((radius * 0.58, 0.016), (radius * 0.2, 0.03), (radius * 0.17, height * 0.3), 6),
        (radius * 0.15, low + tall * 0.4),
        (0.0, low + tall * 0.4),
    ]
    dome = arc((radius, low), (radius, height * 0.99), (0.012, height), 10)
    inner = [(r - 0.003, z - 0.0015) for r, z in dome[:-1]]
    colliders = round_colliders(cylinder(radius * 0.75, tall * 0.9).moved(z=low))
    return (
        Part("Foot", outward(lathe(foot, 32)), "metal"),
        Part("Dome", hollow(dome, 0.0022, 36), "metal", colliders=colliders),
        Part("Inside", hollow(inner, 0.001, 36), "lining", collider=None),
        Part(
            "Knob",
            lathe([(0.009, 0.0), (0.011, 0.004), (0.0, 0.009)], 16).moved(z=height - 0.007),
            "trim",
            collider=None,
        ),
        Part("Bulb", bulb(0.024).moved(z=low + tall * 0.3), "bulb", collider=None),
    )


def globe(size_m: Size) -> tuple[Part, ...]:
    """An opal ball on a low wooden block."""
    radius, height = size_m[0] / 2, size_m[2]
    base_h = height - 2 * radius * 0.97
    base = [
        (0.0, 0.0),
        (radius * 0.5, 0.0),
        (radius * 0.52, 0.004),
        (radius * 0.46, base_h),
        (radius * 0.44, base_h + 0.006),
        (0.0, base_h + 0.006),
    ]
    glass = sphere_profile(radius, -0.94, 1.0, 14, height - radius)
    return (
        Part("Foot", outward(lathe(base, 32)), "wood"),
        Part(
            "Globe",
            outward(lathe([(0.0, glass[0][1]), *glass], 32)),
            "opal",
            colliders=round_colliders(
                cylinder(radius * 0.8, radius).moved(z=height - 1.5 * radius)
            ),
        ),
        Part(
            "Collar",
            hollow([(radius * 0.44, base_h - 0.002), (radius * 0.43, base_h + 0.012)], 0.004, 32),
            "metal",
            collider=None,
        ),
    )


def andon(size_m: Size) -> tuple[Part, ...]:
    """A paper box in a wooden frame."""
    length, width, height = size_m
    post = 0.012
    frame, paper = paper_box(
        size_m, (0.1, 0.52, 0.9), post_m=post, deep_m=0.007, tall_m=0.008, paper_m=0.0016,
        long_m=0.8 * height,
    )  # fmt: skip
    base = block((length - post, width - post, 0.01), 0.001).moved(z=0.1 * height - 0.006)
    return (
        Part("Frame", joined(frame), "wood"),
        Part("Base", base, "wood", collider=None),
        Part("Paper", paper, "paper", collider=None),
        Part("Bulb", bulb(0.026).moved(z=height * 0.3), "bulb", collider=None),
    )


def desk_lamp(size_m: Size) -> tuple[Part, ...]:
    """A jointed arm with springs of two rods and a cone; the foot is below its centroid."""
    length, width, height = size_m
    foot_r = min(length * 0.26, width * 0.5)
    foot_x = length / 2 - foot_r - 0.06
    head_r = width * 0.36
    waist = np.array([foot_x, 0.0, 0.05])
    elbow = np.array([length / 2 - 0.011, 0.0, height * 0.62])
    hand = np.array([-length / 2 + head_r + 0.03, 0.0, height - 0.05])
    foot = lathe(
        [(foot_r, 0.0), (foot_r, 0.008), (foot_r - 0.006, 0.016), (0.02, 0.02), (0.012, 0.05)], 36
    ).moved(foot_x)
    rods = two_rods(waist, elbow, 0.009, 0.0036) + two_rods(elbow, hand, 0.0085, 0.0036)
    knuckle = cylinder(0.011, 0.028, 0.002, 16).moved(z=-0.014).turned("x", 90)
    joints = [knuckle.moved(*map(float, spot)) for spot in (waist, elbow, hand)]
    cone = [
        (head_r, 0.0),
        (head_r - 0.002, 0.008),
        (0.03, head_r * 1.25),
        (0.024, head_r * 1.7),
        (0.012, head_r * 1.8),
    ]
    inner = [(r - 0.0035, z - 0.001) for r, z in cone[:3]]
    light = bulb(0.022).turned("x", 180).moved(z=head_r * 1.15)
    head = metal_shade(cone, inner, light, thick_m=0.002, name="Head", collider="convexHull")
    return (
        Part("Foot", foot, "metal"),
        Part("Arm", rods, "metal", collider=None),
        Part("Joints", joined(joints), "trim", collider=None),
        *(
            replace(part, solid=part.solid.moved(z=-head_r * 1.6).turned("y", 24.0).moved(*hand))
            for part in head
        ),
    )
