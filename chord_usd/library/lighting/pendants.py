"""Lamps that hang from ceilings over tables; the rose at the top is at the ceiling."""

from __future__ import annotations

import math

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
    cylinder,
    joined,
    lathe,
    ring_of,
    tube,
)


def _bulb(radius_m: float = 0.03) -> Solid:
    """A bulb, its tip at z = 0, its neck 2.4 radii higher."""
    neck = [(0.45 * radius_m, 2.1 * radius_m), (0.42 * radius_m, 2.4 * radius_m)]
    return outward(lathe([*sphere_profile(radius_m, -1.0, 0.7, 7, radius_m), *neck], 14))


def _cord(low_m: float, high_m: float, x_m: float = 0.0, y_m: float = 0.0) -> Solid:
    return cylinder(0.003, high_m - low_m, 0.0, 8).moved(x_m, y_m, low_m)


def _rose(height_m: float, radius_m: float = 0.05) -> Solid:
    """The cap at the ceiling."""
    profile = [(0.006, 0.0), (radius_m * 0.85, 0.006), (radius_m, 0.014), (radius_m, 0.028)]
    return lathe(profile, 28).moved(z=height_m - 0.028)


def _hung(
    shade: tuple[Part, ...], top_m: float, height_m: float, slot: str = "metal"
) -> tuple[Part, ...]:
    """A shade that ends at top_m on a cord from the ceiling."""
    grip = lathe([(0.02, 0.0), (0.022, 0.004), (0.02, 0.045), (0.006, 0.06)], 18)
    return (
        *shade,
        Part("Holder", grip.moved(z=top_m - 0.008), slot, None),
        Part("Cord", _cord(top_m + 0.04, height_m - 0.02), "cord", None),
        Part("Rose", _rose(height_m), slot, None),
    )


def dome(size_m: Size) -> tuple[Part, ...]:
    """A metal dome, pale inside."""
    radius, height = size_m[0] / 2, size_m[2]
    tall = radius * 1.05
    out = [
        *arc((radius, 0.0), (radius * 0.98, tall * 0.72), (radius * 0.36, tall * 0.84), 7),
        *arc((radius * 0.3, tall * 0.86), (radius * 0.15, tall * 0.9), (0.022, tall), 3),
    ]
    rim = [(radius + 0.002, -0.001), (radius + 0.002, 0.011)]
    inner = [(r - 0.0045, z - 0.002) for r, z in out[:8]]
    shade = (
        Part("Shade", hollow(out, 0.003, 32), "metal", None),
        Part("Inside", hollow(inner, 0.0015, 32), "lining", None),
        Part("Rim", hollow(rim, 0.006, 32), "trim", None),
        Part("Bulb", _bulb(0.035).moved(z=tall * 0.35), "bulb", None),
    )
    return _hung(shade, tall, height)


def factory(size_m: Size) -> tuple[Part, ...]:
    """An enamelled factory shade: a wide cone under a cylinder neck."""
    radius, height = size_m[0] / 2, size_m[2]
    tall = radius * 0.95
    out = [
        (radius, 0.0),
        (radius, 0.012),
        *arc((radius * 0.96, 0.02), (radius * 0.5, tall * 0.38), (0.07, tall * 0.6), 7),
        (0.055, tall * 0.66),
        (0.055, tall * 0.95),
        (0.03, tall),
    ]
    inner = [(r - 0.0045, z - 0.002) for r, z in out[1:9]]
    shade = (
        Part("Shade", hollow(out, 0.003, 32), "metal", None),
        Part("Inside", hollow(inner, 0.0015, 32), "lining", None),
        Part("Bulb", _bulb(0.04).moved(z=tall * 0.2), "bulb", None),
    )
    return _hung(shade, tall, height, "trim")


def opal(size_m: Size) -> tuple[Part, ...]:
    """An opal glass ball."""
    radius, height = size_m[0] / 2, size_m[2]
    glass = sphere_profile(radius, -1.0, 0.97, 18, radius)
    cap = lathe([(radius * 0.3, 0.0), (radius * 0.3, 0.012), (0.022, 0.03)], 24)
    shade = (
        Part("Globe", outward(lathe(glass, 36)), "opal", None),
        Part("Cap", cap.moved(z=2 * radius * 0.975), "metal", None),
    )
    return _hung(shade, 2 * radius + 0.018, height)


def woven(size_m: Size) -> tuple[Part, ...]:
    """A rattan bell: close ribs over hoops."""
    radius, height = size_m[0] / 2, size_m[2]
    tall = radius * 1.05
    bell = [
        *arc((radius * 0.9, 0.0), (radius * 1.12, tall * 0.36), (radius * 0.78, tall * 0.62), 6),
        *arc((radius * 0.7, tall * 0.69), (radius * 0.4, tall * 0.94), (0.03, tall), 4),
    ]
    path = np.array([[r, 0.0, z] for r, z in bell])
    ribs = ring_of(tube(path[::2], 0.003, 4), 36)
    rings = [
        hollow([(r + 0.006, z - 0.005), (r + 0.006, z + 0.005)], 0.012, 28)
        for r, z in (bell[0], bell[3], bell[6], bell[9])
    ]
    shade = (
        Part("Ribs", joined(ribs), "weave", None),
        Part("Hoops", joined(rings), "weave", None),
        Part("Bulb", _bulb(0.04).moved(z=tall * 0.42), "bulb", None),
    )
    return _hung(shade, tall, height)


def paper(size_m: Size) -> tuple[Part, ...]:
    """A paper lantern, ribbed, a little flattened."""
    radius, height = size_m[0] / 2, size_m[2]
    ribs, tall = 9, radius * 1.8
    out = []
    for index in range(2 * ribs + 1):
        angle = math.asin(-0.97 + 1.94 * index / (2 * ribs))
        swell = 1.0 if index % 2 == 0 else 0.985
        out.append((radius * math.cos(angle) * swell, tall / 2 * (1 + math.sin(angle) / 0.97)))
    rings = [
        hollow([(radius * 0.245, z), (radius * 0.245, z + 0.006)], 0.006, 24)
        for z in (0.0, tall - 0.006)
    ]
    bow = [[-radius * 0.24, 0, tall - 0.004], [0, 0, tall + 0.03], [radius * 0.24, 0, tall - 0.004]]
    shade = (
        Part("Paper", hollow(out, 0.002, 30), "paper", None),
        Part("Wire", joined([*rings, tube(bow, 0.002, 6)]), "cord", None),
        Part("Bulb", _bulb(0.05).moved(z=tall * 0.42), "bulb", None),
    )
    return _hung(shade, tall + 0.03, height)


def layers(size_m: Size) -> tuple[Part, ...]:
    """Three curved shades above each other that hide the bulb."""
    radius, height = size_m[0] / 2, size_m[2]
    tall = radius * 1.0
    tiers = []
    for low, high, wide, narrow in (
        (0.0, 0.42, 0.52, 0.3),
        (0.28, 0.6, 0.78, 0.36),
        (0.5, 0.9, 1.0, 0.3),
    ):
        bow = arc(
            (wide * radius, low * tall),
            (wide * radius * 0.9, high * tall * 0.9),
            (narrow * radius, high * tall),
            5,
        )
        tiers.append(hollow(bow, 0.003, 36))
    struts = [
        tube(
            np.array(
                [
                    [0.3 * radius, 0, 0.41 * tall],
                    [0.34 * radius, 0, 0.6 * tall],
                    [0.31 * radius, 0, 0.9 * tall],
                ]
            ),
            0.003,
            6,
        ).turned("z", turn)
        for turn in (90, 210, 330)
    ]
    crown = lathe(
        [(0.31 * radius, 0.0), (0.31 * radius, 0.012), (0.1 * radius, 0.06), (0.02, 0.08)], 28
    ).moved(z=0.89 * tall)
    shade = (
        Part("Tiers", joined(tiers), "metal", None),
        Part("Struts", joined(struts), "trim", None),
        Part("Crown", crown, "trim", None),
        Part("Bulb", _bulb(0.045).moved(z=0.24 * tall), "bulb", None),
    )
    return _hung(shade, 0.89 * tall + 0.08, height, "trim")


def chandelier(size_m: Size) -> tuple[Part, ...]:
    """Six curved arms with candles and little shades around a turned stem."""
    radius, height = size_m[0] / 2, size_m[2]
    shade_r = radius * 0.17
    reach = radius - shade_r
    stem = [
        (0.0, 0.0),
        (0.012, 0.006),
        (0.018, 0.02),
        (0.008, 0.034),
        (0.03, 0.05),
        (0.045, 0.075),
        (0.03, 0.1),
        (0.012, 0.12),
        (0.012, 0.18),
        (0.026, 0.2),
        (0.034, 0.23),
        (0.014, 0.26),
        (0.008, 0.34),
        (0.008, 0.36),
    ]
    arms, pans, candles, shades = [], [], [], []
    for turn in range(0, 360, 60):
        bow = arc((0.03, 0.09), (reach * 0.55, -0.06), (reach, 0.1), 9)
        arms.append(tube(np.array([[x, 0.0, z] for x, z in bow]), 0.0055, 6).turned("z", turn))
        pan = lathe([(0.008, 0.0), (0.03, 0.01), (0.032, 0.013)], 10).moved(reach, z=0.098)
        pans.append(pan.turned("z", turn))
        candles.append(cylinder(0.01, 0.07, 0.0, 8).moved(reach, z=0.11).turned("z", turn))
        cone = hollow([(shade_r, 0.0), (shade_r * 0.55, shade_r * 1.35)], 0.002, 16)
        shades.append(cone.moved(reach, z=0.16).turned("z", turn))
    links = [
        tube(
            np.array(
                [
                    [0.011 * math.cos(a), 0.0, 0.02 * math.sin(a)]
                    for a in np.linspace(0, 2 * math.pi * 0.97, 7)
                ]
            ),
            0.0025,
            4,
        )
        .turned("z", 90.0 * i)
        .moved(z=0.375 + 0.036 * i)
        for i in range(max(1, int((height - 0.03 - 0.375) / 0.036)))
    ]
    return (
        Part("Stem", outward(lathe(stem, 20)), "metal", None),
        Part("Arms", joined(arms), "metal", None),
        Part("Pans", joined(pans), "metal", None),
        Part("Candles", joined(candles), "wax", None),
        Part("Shades", joined(shades), "shade", None),
        Part("Chain", joined(links), "metal", None),
        Part("Cord", _cord(0.34, height - 0.02), "cord", None),
        Part("Rose", _rose(height, 0.06), "metal", None),
    )


def beam(size_m: Size) -> tuple[Part, ...]:
    """A long slim bar with its light below, on two wires."""
    length, width, height = size_m
    case = block((length, 0.036, 0.06), 0.006).moved(z=0.006)
    glow = block((length - 0.02, 0.026, 0.012), 0.003)
    wires = [_cord(0.06, height - 0.02, x) for x in (-0.32 * length, 0.32 * length)]
    plate = block((0.72 * length, min(width, 0.07), 0.024), 0.004).moved(z=height - 0.024)
    wide = cylinder(width / 2, 0.02, 0.003, 32).moved(z=height - 0.022)
    return (
        Part("Case", case, "metal", None),
        Part("Diffuser", glow, "opal", None),
        Part("Wires", joined(wires), "cord", None),
        Part("Plate", plate + wide, "trim", None),
    )


def cluster(size_m: Size) -> tuple[Part, ...]:
    """Five bulbs of clear glass at unlike heights from one plate."""
    radius, height = size_m[0] / 2, size_m[2]
    glasses, bulbs, cords, caps = [], [], [], []
    ball_r = min(0.075, radius * 0.45)
    spots = [(0.0, 0.0)] + [
        ((radius - ball_r) * math.cos(a), (radius - ball_r) * math.sin(a))
        for a in np.radians((20, 110, 200, 290))
    ]
    for index, (x, y) in enumerate(spots):
        z = (0.0, 0.26, 0.09, 0.34, 0.18)[index] * height * 0.8
        skin = sphere_profile(ball_r, -0.98, 0.94, 7, ball_r)
        glasses.append(hollow(skin, 0.002, 14).moved(x, y, z))
        bulbs.append(_bulb(0.022).moved(x, y, z + ball_r * 0.9))
        caps.append(
            lathe([(0.018, 0.0), (0.028, 0.004), (0.024, 0.05), (0.006, 0.06)], 16).moved(
                x, y, z + 1.9 * ball_r
            )
        )
        top = height - 0.02
        bend = [[x, y, z + 1.9 * ball_r + 0.05], [x, y, top - 0.06], [x * 0.4, y * 0.4, top]]
        cords.append(tube(bent_path(bend, 0.05, 3), 0.003, 6))
    return (
        Part("Glasses", joined(glasses), "glass", None),
        Part("Bulbs", joined(bulbs), "bulb", None),
        Part("Caps", joined(caps), "metal", None),
        Part("Cords", joined(cords), "cord", None),
        Part("Rose", _rose(height, radius * 0.55), "metal", None),
    )


def slatted(size_m: Size) -> tuple[Part, ...]:
    """A drum of upright wooden slats around paper."""
    radius, height = size_m[0] / 2, size_m[2]
    tall, count = radius * 1.25, 30
    slat = block((0.008, 0.006, tall), 0.0015).moved(x=radius - 0.006)
    fins = ring_of(slat, count)
    hoops = [
        hollow([(radius - 0.01, z), (radius - 0.01, z + 0.012)], 0.008, 40)
        for z in (tall * 0.08, tall * 0.92 - 0.012)
    ]
    paper_ = hollow([(radius - 0.02, 0.012), (radius - 0.02, tall - 0.012)], 0.002, 40)
    spider = block((2 * radius - 0.02, 0.008, 0.004), 0.001).moved(z=tall * 0.9)
    shade = (
        Part("Slats", joined(fins), "wood", None),
        Part("Hoops", joined(hoops), "wood", None),
        Part("Paper", paper_, "paper", None),
        Part("Spider", spider, "metal", None),
        Part("Bulb", _bulb(0.04).moved(z=tall * 0.4), "bulb", None),
    )
    return _hung(shade, tall * 0.9 + 0.01, height)
