"""Lamps at ceilings: flush discs, drums, globes, spots, lattices; the top is at the ceiling."""

from __future__ import annotations

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
    block,
    cylinder,
    joined,
    lathe,
    pair,
    ring_of,
    rounded_slab,
    tube,
)


def disc(size_m: Size) -> tuple[Part, ...]:
    """A flat opal drum in a slim ring, close to the ceiling."""
    radius, height = size_m[0] / 2, size_m[2]
    rim = [(radius, height * 0.3), (radius, height), (radius - 0.012, height)]
    ring = hollow([(radius, height * 0.28), (radius, height - 0.001)], 0.008, 48)
    opal = [
        (0.0, 0.0),
        *arc((radius * 0.6, 0.0), (radius - 0.01, 0.0), (radius - 0.01, 0.035), 5),
        (radius - 0.01, height - 0.004),
        (0.0, height - 0.004),
    ]
    plate = cylinder(rim[1][0] - 0.004, 0.006, 0.0, 48).moved(z=height - 0.006)
    return (
        Part("Ring", ring, "metal", None),
        Part("Diffuser", outward(lathe(opal, 48)), "opal", None),
        Part("Plate", plate, "metal", None),
    )


def drum(size_m: Size) -> tuple[Part, ...]:
    """A cloth drum with a diffuser below, held off the ceiling by a round rose."""
    radius, height = size_m[0] / 2, size_m[2]
    tall = height - 0.04
    shade = hollow([(radius, 0.0), (radius, tall)], 0.003, 48)
    bands = [
        hollow([(radius + 0.001, z), (radius + 0.001, z + 0.008)], 0.005, 48)
        for z in (-0.0005, tall - 0.0075)
    ]
    under = cylinder(radius - 0.006, 0.004, 0.0, 48).moved(z=0.02)
    rose = lathe([(0.055, 0.0), (0.06, 0.012), (0.06, 0.024)], 28).moved(z=height - 0.024)
    arms = [
        block((radius - 0.002, 0.006, 0.003), 0.001).moved(x=radius / 2).turned("z", turn)
        for turn in (30, 150, 270)
    ]
    stem = cylinder(0.008, 0.07, 0.0, 12).moved(z=height - 0.09)
    return (
        Part("Shade", shade, "shade", None),
        Part("Bands", joined(bands), "trim", None),
        Part("Diffuser", under, "opal", None),
        Part("Rose", rose + stem, "metal", None),
        Part("Arms", joined(arms).moved(z=tall - 0.03), "metal", None),
    )


def bowl(size_m: Size) -> tuple[Part, ...]:
    """A shallow opal bowl under a stepped metal rim, with a finial."""
    radius, height = size_m[0] / 2, size_m[2]
    deep = height - 0.035
    glass = [
        (0.0, 0.016),
        *arc((0.012, 0.016), (radius * 0.9, 0.02), (radius - 0.014, deep), 10),
        (radius - 0.014, deep + 0.012),
        (0.0, deep + 0.012),
    ]
    rim = [
        (radius - 0.03, deep - 0.002),
        (radius - 0.004, deep),
        (radius, deep + 0.008),
        (radius - 0.006, deep + 0.018),
        (radius - 0.012, height),
        (radius - 0.03, height),
    ]
    finial = lathe(
        [(0.0, 0.0), (0.006, 0.003), (0.009, 0.01), (0.004, 0.015), (0.016, 0.019), (0.016, 0.022)],
        16,
    )
    return (
        Part("Glass", outward(lathe(glass, 40)), "opal", None),
        Part("Rim", outward(lathe([*rim, (0.0, height)], 40)), "metal", None),
        Part("Finial", finial, "metal", None),
    )


def globe(size_m: Size) -> tuple[Part, ...]:
    """An opal ball on a short turned neck."""
    radius, height = size_m[0] / 2, size_m[2]
    middle = radius
    collar = [(0.05, 0.0), (0.056, 0.008), (0.056, 0.03), (0.075, 0.034), (0.08, 0.045)]
    low = height - 0.045
    top_share = min((low + 0.004 - middle) / radius, 0.96)
    ball = sphere_profile(radius, -1.0, top_share, 16, middle)
    return (
        Part("Globe", outward(lathe([*ball, (0.0, ball[-1][1])], 36)), "opal", None),
        Part("Neck", lathe(collar, 32).moved(z=low), "metal", None),
    )


def spots(size_m: Size, *, count: int = 3) -> tuple[Part, ...]:
    """A bar with tilting spots: two at its ends, the others between."""
    length, width, height = size_m
    bar = block((length, min(0.06, width), 0.028), 0.006).moved(z=height - 0.028)
    heads: list[Solid] = []
    glows: list[Solid] = []
    joints: list[Solid] = []
    can_r, can_h = 0.034, 0.1
    for index in range(count):
        x = (index / (count - 1) - 0.5) * (length - 0.12)
        tilt = (18.0, -14.0, 20.0, -18.0)[index % 4]
        can = outward(
            lathe(
                [
                    (0.0, 0.03),
                    (can_r - 0.004, 0.03),
                    (can_r - 0.003, 0.0),
                    (can_r, 0.0),
                    (can_r, can_h - 0.012),
                    (can_r * 0.75, can_h),
                    (0.0, can_h),
                ],
                24,
            )
        )
        lens = cylinder(can_r - 0.006, 0.004, 0.0, 24).moved(z=0.018)
        low = height - 0.028 - can_h - 0.028
        for solid, group in ((can, heads), (lens, glows)):
            group.append(
                solid.moved(z=-can_h)
                .turned("y", tilt * 0.7)
                .turned("x", tilt)
                .moved(x, 0.0, low + can_h + 0.004)
            )
        joints.append(cylinder(0.007, 0.04, 0.0, 10).moved(x, 0.0, height - 0.062))
    return (
        Part("Bar", bar, "metal", None),
        Part("Heads", joined(heads), "metal", None),
        Part("Joints", joined(joints), "trim", None),
        Part("Lenses", joined(glows), "bulb", None),
    )


def lattice(size_m: Size) -> tuple[Part, ...]:
    """A low wooden box with paper behind a lattice (kumiko)."""
    length, width, height = size_m
    rail, thin = 0.03, 0.008
    side = np.array([[0, 0], [0, height], [rail * 0.7, height], [rail * 0.7, 0]])
    box_ = pair(block((length, rail * 0.7, height), 0.003), y=(width - rail * 0.7) / 2) + pair(
        block((rail * 0.7, width - 1.4 * rail - 0.0002, height), 0.003), x=(length - side[2, 0]) / 2
    )
    inner_l, inner_w = length - 1.4 * rail, width - 1.4 * rail
    bars = []
    for share in (0.16, 0.5, 0.84):
        bars.append(block((thin, inner_w, 0.012), 0.001).moved((share - 0.5) * inner_l, z=0.004))
        bars.append(block((inner_l, thin, 0.011), 0.001).moved(y=(share - 0.5) * inner_w, z=0.0045))
    paper = block((inner_l, inner_w, 0.004), 0.001).moved(z=0.017)
    plate = block((inner_l + 0.004, inner_w + 0.004, 0.006), 0.001).moved(z=height - 0.007)
    return (
        Part("Frame", joined(box_), "wood", None),
        Part("Lattice", joined(bars), "wood", None),
        Part("Paper", paper, "opal", None),
        Part("Plate", plate, "metal", None),
    )


def cage(size_m: Size) -> tuple[Part, ...]:
    """A bare bulb under a round plate, inside a wire cage."""
    radius, height = size_m[0] / 2, size_m[2]
    plate = lathe([(0.07, 0.0), (0.075, 0.006), (0.075, 0.022), (0.066, 0.026)], 32)
    socket = lathe([(0.026, 0.0), (0.028, 0.004), (0.028, 0.05), (0.036, 0.06)], 24)
    bulb = outward(
        lathe(
            [(0.0, 0.0), *sphere_profile(0.045, -0.99, 0.7, 12, 0.045), (0.022, 0.11), (0.0, 0.11)],
            24,
        )
    )
    low = height - 0.085
    wires = []
    for turn in range(0, 360, 45):
        bow = arc((0.004, 0.003), (radius * 1.25, 0.0), (radius * 0.82, low * 0.62), 6)
        bow += arc(bow[-1], (radius * 0.7, low * 0.85), (0.038, low + 0.03), 4)[1:]
        path = np.array([[x, 0.0, z] for x, z in bow])
        wires.append(tube(path, 0.0028, 6).turned("z", turn))
    at = low * 0.62
    hoop_r = radius * 0.82
    hoops = [
        hollow([(r + 0.0025, z), (r + 0.0025, z + 0.005)], 0.005, 32)
        for r, z in ((hoop_r, at), (radius * 0.62, at * 0.34))
    ]
    return (
        Part("Plate", plate.moved(z=height - 0.026), "metal", None),
        Part("Socket", socket.moved(z=height - 0.08), "trim", None),
        Part("Bulb", bulb.moved(z=height - 0.175), "bulb", None),
        Part("Cage", joined([*wires, *hoops]), "metal", None),
    )


def panel(size_m: Size) -> tuple[Part, ...]:
    """A flat lit panel in a metal frame, for kitchens."""
    length, width, height = size_m
    frame = rounded_slab((length, width, height - 0.008), 0.012, 0.003, 4).moved(z=0.008)
    glow = rounded_slab((length - 0.016, width - 0.016, 0.02), 0.008, 0.004, 4)
    return Part("Frame", frame, "metal", None), Part("Diffuser", glow, "opal", None)


def slats(size_m: Size) -> tuple[Part, ...]:
    """A flush lamp of wooden slats around a glowing core."""
    radius, height = size_m[0] / 2, size_m[2]
    count = 26
    slat = block((0.05, 0.007, height - 0.012), 0.0015).moved(x=radius - 0.025)
    fins = ring_of(slat, count)
    core = cylinder(radius - 0.055, height - 0.03, 0.006, 32).moved(z=0.014)
    hoop = hollow([(radius - 0.012, 0.0), (radius - 0.012, 0.012)], 0.03, 48)
    plate = cylinder(radius, 0.012, 0.002, 48).moved(z=height - 0.012)
    return (
        Part("Slats", joined(fins), "wood", None),
        Part("Hoop", hoop.moved(z=-0.0005), "wood", None),
        Part("Core", core, "opal", None),
        Part("Plate", plate, "wood", None),
    )
