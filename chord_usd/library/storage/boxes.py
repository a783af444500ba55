"""Boxes for shelves."""

from __future__ import annotations

import numpy as np

from chord_usd.library.kit.forms import (
    open_tub,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    cylinder,
    extruded,
    joined,
    pair,
    tube,
)
from chord_usd.library.plants.leaves import woven_skin


def lidded_box(size_m: Size) -> tuple[Part, ...]:
    """A cloth-covered box with an overlapping lid and a label holder."""
    length, width, height = size_m
    lid_h = min(0.05, height * 0.3)
    body = block((length - 0.006, width - 0.009, height - 0.004), 0.003).moved(y=0.0015)
    lid = block((length, width - 0.003, lid_h), 0.004).moved(y=0.0015, z=height - lid_h)
    y = -width / 2
    label_z = (height - lid_h) * 0.42
    frame = block((0.075, 0.003, 0.045), 0.001).moved(y=y + 0.0045, z=label_z)
    card = block((0.064, 0.0036, 0.034), 0.0008).moved(y=y + 0.0042, z=label_z + 0.0055)
    return (
        Part("Body", body, "cloth"),
        Part("Lid", lid, "cloth"),
        Part("Label_Frame", frame, "metal", None),
        Part("Card", card.moved(y=-0.0022), "card", None),
    )


def open_box(size_m: Size) -> tuple[Part, ...]:
    """An open box of felt or cloth with a leather grip."""
    length, width, height = size_m
    tub = open_tub(length, width - 0.008, height, 0.006, 0.02, 0.008).moved(y=0.004)
    y = -width / 2
    z = height * 0.62
    strap = tube(
        [
            [-0.04, y + 0.009, z],
            [-0.028, y + 0.0035, z - 0.012],
            [0.028, y + 0.0035, z - 0.012],
            [0.04, y + 0.009, z],
        ],
        0.0035,
        7,
    )
    studs = [
        cylinder(0.007, 0.005, 0.0015, 14).turned("x", 90).moved(x, y + 0.0095, z)
        for x in (-0.04, 0.04)
    ]
    return (
        Part("Tub", tub, "cloth", colliders=(box((length, width - 0.01, height)),)),
        Part("Strap", strap, "grip", None),
        Part("Studs", joined(studs), "metal", None),
    )


def wooden_box(size_m: Size) -> tuple[Part, ...]:
    """A box of boards with finger holes at its ends and open above."""
    length, width, height = size_m
    t = 0.012
    long = block((length, t, height), 0.0015)
    hole = np.stack(
        [0.035 * np.cos(a := np.linspace(0, 2 * np.pi, 20, endpoint=False)), 0.011 * np.sin(a)], -1
    )
    half = (width - 2 * t) / 2
    outline = np.array(
        [[-half, 0.0], [half, 0.0], [half, height - 0.0015], [-half, height - 0.0015]]
    )
    end = (
        extruded(outline, t, [hole + np.array([0.0, height * 0.74])])
        .turned("x", 90)
        .turned("z", 90)
    )
    x0 = float(end.bounds_m().mean(axis=0)[0])
    ends = [end.moved(x=s * (length - t) / 2 - x0) for s in (-1, 1)]
    floor = block((length - 2 * t + 0.002, width - 2 * t + 0.002, 0.008), 0.001).moved(z=0.004)
    sides = pair(long, y=(width - t) / 2)
    return (
        Part(
            "Boards",
            joined([*sides, *ends, floor]),
            "wood",
            colliders=(box((length, width, height)),),
        ),
    )


def woven_box(size_m: Size) -> tuple[Part, ...]:
    """A rectangular woven tray with round corners."""
    length, width, height = size_m
    round_ = woven_skin(
        [(0.47, 0.0), (0.5, height * 0.5), (0.49, height - 0.006)],
        0.03,
        0.012,
        strands=48,
        rows=7,
        depth_m=0.012,
    )
    points = round_.points_m.copy()
    # A circle drawn out to a squircle, then to the box.
    flat = points[:, :2]
    norm = np.maximum((np.abs(flat) ** 4).sum(axis=1) ** 0.25, 1e-9)
    radius = np.hypot(flat[:, 0], flat[:, 1])
    points[:, :2] = flat / norm[:, None] * radius[:, None] * [length * 0.99, width * 0.99]
    skin = Solid(points, round_.faces)
    return (Part("Wall", skin, "weave", colliders=(box((length * 0.98, width * 0.98, height)),)),)
