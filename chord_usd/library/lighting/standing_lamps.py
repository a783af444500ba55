"""Lamps that stand on floors."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from chord_usd.library.kit.forms import (
    arc,
    hollow,
    outward,
    sphere_profile,
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
    tube,
)
from chord_usd.library.lighting.lamp_parts import (
    FLOOR_SHADE,
    bulb,
    cloth_shade,
    metal_shade,
    paper_box,
    two_rods,
)


def _disc_foot(radius_m: float) -> Solid:
    r = radius_m
    return lathe(
        [(r, 0.0), (r, 0.014), (r - 0.006, 0.02), (0.03, 0.026), (0.012, 0.034), (0.0105, 0.05)], 36
    )


def _post_colliders(foot: Solid, height_m: float) -> tuple[Solid, ...]:
    """The foot, and a post over it: what stands beside the lamp goes under its shade."""
    return foot, box((0.03, 0.03, height_m))


def drum(size_m: Size) -> tuple[Part, ...]:
    """A straight post on a disc, under a wide drum."""
    radius, height = size_m[0] / 2, size_m[2]
    low = height - 0.3
    foot = _disc_foot(0.14)
    pole = cylinder(0.01, low + 0.08, 0.0, 14).moved(z=0.03)
    return (
        Part("Foot", foot + pole, "metal", colliders=_post_colliders(cylinder(0.14, 0.03), low)),
        *cloth_shade(low, height, radius, radius, FLOOR_SHADE),
        Part("Bulb", bulb(0.032).moved(z=low + 0.1), "bulb", None),
    )


def classic(size_m: Size) -> tuple[Part, ...]:
    """A turned column under an empire shade."""
    radius, height = size_m[0] / 2, size_m[2]
    low = height - 0.3
    profile = [
        (0.15, 0.0),
        (0.15, 0.016),
        (0.13, 0.03),
        (0.06, 0.05),
        (0.03, 0.09),
        (0.045, 0.12),
        (0.022, 0.16),
        (0.016, 0.3),
        (0.015, low * 0.55),
        (0.03, low * 0.58),
        (0.034, low * 0.61),
        (0.015, low * 0.65),
        (0.012, low - 0.05),
        (0.024, low - 0.02),
        (0.012, low + 0.01),
        (0.01, low + 0.12),
        (0.0, low + 0.12),
    ]
    finial = lathe([(0.004, 0.0), (0.009, 0.008), (0.004, 0.014), (0.0, 0.024)], 12)
    return (
        Part(
            "Column",
            outward(lathe(profile, 28)),
            "metal",
            colliders=_post_colliders(cylinder(0.15, 0.03), low),
        ),
        *cloth_shade(low, height - 0.02, radius, radius * 0.62, FLOOR_SHADE),
        Part("Harp", cylinder(0.003, 0.22, 0.0, 8).moved(z=low + 0.07), "metal", None),
        Part("Finial", finial.moved(z=height - 0.024), "metal", None),
        Part("Bulb", bulb(0.032).moved(z=low + 0.11), "bulb", None),
    )


def tripod(size_m: Size) -> tuple[Part, ...]:
    """Three wooden legs that meet under a drum."""
    radius, height = size_m[0] / 2, size_m[2]
    low = height - 0.28
    reach, top = radius * 0.98, 0.03
    legs, colliders = [], []
    for turn in (90, 210, 330):
        a = math.radians(turn)
        foot = np.array([reach * math.cos(a), reach * math.sin(a), 0.0])
        head = np.array([top * math.cos(a), top * math.sin(a), low - 0.02])
        t = np.linspace(0, 1, 3)[:, None]
        leg = tube(foot + t * (head - foot), 0.014, 10)
        points = leg.points_m.copy()
        points[:, 2] = np.maximum(points[:, 2], 0.0)
        legs.append(Solid(points, leg.faces))
        for share in (0.15, 0.5, 0.85):
            at = foot + share * (head - foot)
            colliders.append(
                box((0.05, 0.05, 0.3 * low)).moved(
                    float(at[0]), float(at[1]), max(share - 0.15, 0.0) * low
                )
            )
    hub = lathe(
        [(0.03, 0.0), (0.045, 0.008), (0.045, 0.04), (0.02, 0.05), (0.01, 0.07), (0.01, 0.16)], 24
    )
    return (
        Part("Legs", joined(legs), "wood", colliders=tuple(colliders)),
        Part("Hub", hub.moved(z=low - 0.055), "metal", None),
        *cloth_shade(low, height, radius, radius * 0.84, FLOOR_SHADE),
        Part("Bulb", bulb(0.032).moved(z=low + 0.1), "bulb", None),
    )


def bow_lamp(size_m: Size) -> tuple[Part, ...]:
    """A post that bows over and carries a small dome."""
    length, width, height = size_m
    dome_r = width / 2
    foot_r = min(0.13, dome_r)
    foot_x, head_x = length / 2 - foot_r, -length / 2 + dome_r
    foot = _disc_foot(foot_r).moved(foot_x)
    low = height - 0.3
    path = bent_path(
        [
            [foot_x, 0, 0.03],
            [foot_x, 0, height - 0.008],
            [head_x, 0, height - 0.008],
            [head_x, 0, low + 0.19],
        ],
        0.28,
        9,
    )
    out = arc((dome_r, 0.0), (dome_r, dome_r * 0.95), (0.02, dome_r * 0.98), 7)
    inner = [(r - 0.004, z - 0.002) for r, z in out[:-1]]
    dome_z = low + 0.19 - dome_r * 0.98
    light = bulb(0.03).turned("x", 180).moved(z=low + 0.16 - dome_z)
    dome = metal_shade(out, inner, light, sides=30, name="Dome")
    colliders = (
        cylinder(foot_r, 0.03).moved(foot_x),
        box((0.03, 0.03, height * 0.8)).moved(foot_x),
    )
    return (
        Part("Post", foot + tube(path, 0.0085, 10), "metal", colliders=colliders),
        *(replace(part, solid=part.solid.moved(head_x, z=dome_z)) for part in dome),
    )


def reader(size_m: Size) -> tuple[Part, ...]:
    """A jointed arm with a cone, on a heavy foot: from a workshop."""
    length, width, height = size_m
    foot_r = width * 0.42
    foot_x = length / 2 - foot_r
    foot = _disc_foot(foot_r).moved(foot_x)
    head_r = width / 2
    elbow = np.array([foot_x - 0.04, 0.0, height - 0.02])
    hand = np.array([-length / 2 + head_r + 0.02, 0.0, height - 0.2])
    waist = np.array([foot_x, 0.0, height * 0.42])
    rods = [
        tube([[foot_x, 0, 0.03], waist.tolist()], 0.011, 10),
        two_rods(waist, elbow, 0.014, 0.005),
        two_rods(elbow, hand, 0.0145, 0.005),
    ]
    knuckle = cylinder(0.018, 0.044, 0.003, 18).moved(z=-0.022).turned("x", 90)
    joints = [
        knuckle.moved(*map(float, spot)) for spot in (waist, elbow - [0, 0, 0.018 - 0.02], hand)
    ]
    cone = [(head_r, 0.0), (0.04, 0.13), (0.034, 0.18), (0.02, 0.19)]
    inner = [(head_r - 0.004, -0.002), (0.036, 0.126)]
    head = metal_shade(cone, inner, bulb(0.03).turned("x", 180).moved(z=0.12))
    colliders = (
        cylinder(foot_r, 0.03).moved(foot_x),
        box((0.03, 0.03, height * 0.9)).moved(foot_x),
    )
    return (
        Part("Post", joined([foot, *rods]), "metal", colliders=colliders),
        Part("Joints", joined(joints), "trim", None),
        *(
            replace(part, solid=part.solid.moved(z=-0.17).turned("y", 16.0).moved(*hand))
            for part in head
        ),
    )


def column(size_m: Size) -> tuple[Part, ...]:
    """A paper column in a wooden frame."""
    length, width, height = size_m
    post = 0.018
    frame, paper = paper_box(
        size_m, (0.1, 0.36, 0.62, 0.88), post_m=post, deep_m=0.008, tall_m=0.012, paper_m=0.002,
        long_m=0.78 * height,
    )  # fmt: skip
    batten = block((0.007, 0.007, 0.78 * height), 0.001).moved(z=0.1 * height + 0.002)
    frame += [*pair(batten, y=(width - post) / 2), *pair(batten, x=(length - post) / 2)]
    base = block((length - post, width - post, 0.014), 0.002).moved(z=0.1 * height - 0.004)
    return (
        Part("Frame", joined(frame), "wood"),
        Part("Paper", paper, "paper", None),
        Part("Bulb", bulb(0.04).moved(z=height * 0.45), "bulb", None),
        Part("Base", base, "wood", None),
    )


def lantern(size_m: Size) -> tuple[Part, ...]:
    """A tall crumpled paper lantern on three wire feet."""
    radius, height = size_m[0] / 2, size_m[2]
    ribs, low = 11, 0.1
    out = []
    for index in range(2 * ribs + 1):
        share = index / (2 * ribs)
        swell = (
            radius
            * (0.62 + 0.38 * math.sin(math.pi * (0.1 + 0.8 * share)))
            * (1.0 if index % 2 == 0 else 0.96)
        )
        out.append((swell, low + share * (height - low)))
    peak = max(r for r, _ in out)
    out = [(r * radius / peak, z) for r, z in out]
    feet = [
        tube([[out[0][0] * 0.9, 0, 0.004], [out[0][0] * 0.9, 0, low + 0.02]], 0.004, 8).turned(
            "z", a
        )
        for a in (30, 150, 270)
    ]
    ring_ = hollow([(out[0][0] * 0.93, 0.0), (out[0][0] * 0.93, 0.008)], 0.008, 32)
    return (
        Part("Paper", hollow(out, 0.002, 28), "paper", None),
        Part("Feet", joined([*feet, ring_]), "metal", colliders=(cylinder(radius * 0.9, height),)),
        Part("Bulb", bulb(0.05).moved(z=height * 0.45), "bulb", None),
    )


def globes(size_m: Size) -> tuple[Part, ...]:
    """A slim post with an opal ball at its top and one on an arm."""
    length, width, height = size_m
    r = 0.11
    foot = _disc_foot(min(width, length) / 2)
    high = height - r * 0.9
    arm_z, arm_x = height * 0.66, length / 2 - 0.085
    bend = bent_path(
        [[0, 0, arm_z - 0.16], [arm_x, 0, arm_z - 0.16], [arm_x, 0, arm_z - 0.05]], 0.07, 5
    )
    post = cylinder(0.009, high - r - 0.02, 0.0, 12).moved(z=0.03)
    cups = [
        lathe([(0.012, 0.0), (0.034, 0.012), (0.036, 0.02)], 20).moved(x, z=z)
        for x, z in ((0.0, high - r - 0.01), (arm_x, arm_z - 0.06))
    ]
    balls = [
        outward(lathe(sphere_profile(radius, steps=14), 28)).moved(x, z=z)
        for radius, x, z in ((r * 0.9, 0.0, high), (0.085, arm_x, arm_z + 0.035))
    ]
    return (
        Part(
            "Post",
            joined([foot, post, tube(bend, 0.007, 10), *cups]),
            "metal",
            colliders=_post_colliders(cylinder(width * 0.45, 0.03), high - r),
        ),
        Part("Globes", joined(balls), "opal", None),
    )
