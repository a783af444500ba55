"""Light switches and sockets; backs at +y."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.library.kit.forms import (
    outward,
    stood_up,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    block,
    box,
    cylinder,
    extruded,
    joined,
    lathe,
    pair,
    ring,
    rounded_slab,
)


def switch(size_m: Size, *, rockers: int = 1) -> tuple[Part, ...]:
    """A plate with rockers, a little tilted as they are."""
    length, width, height = size_m
    back = width / 2
    plate = stood_up(
        rounded_slab((length, height, width * 0.62), 0.006, 0.002, 4), back, height / 2
    )
    wide = (length - 0.022) / rockers
    keys = []
    for index in range(rockers):
        x = -(length - 0.022) / 2 + wide * (index + 0.5)
        key = rounded_slab((wide - 0.0015, height - 0.022, width * 0.62), 0.003, 0.0015, 3)
        keys.append(key.turned("x", 90).turned("x", 2.2).moved(x, back - width * 0.34, height / 2))
    groove = box((length - 0.02, width * 0.2, height - 0.02)).moved(y=back - width * 0.56, z=0.01)
    return (
        Part("Plate", plate, "plate", None),
        Part("Groove", groove, "shadow", None),
        Part("Rocker", joined(keys), "key", None),
    )


def toggle(size_m: Size) -> tuple[Part, ...]:
    """A metal plate with two screws and a little lever."""
    length, width, height = size_m
    back = width / 2
    plate = stood_up(
        rounded_slab((length, height, width * 0.4), 0.004, 0.0015, 3), back, height / 2
    )
    collar = lathe([(0.011, 0.0), (0.012, 0.001), (0.009, 0.003)], 20)
    screws = pair(cylinder(0.0035, 0.0016, 0.0005, 12), y=height * 0.36)
    lift = back - width * 0.4 + 0.0004
    lever = lathe([(0.0028, 0.0), (0.0042, 0.006), (0.0046, 0.0075), (0.0028, 0.009)], 12)
    long = width * 0.6
    return (
        Part("Plate", plate, "plate", None),
        Part("Collar", stood_up(joined([collar, *screws]), lift, height / 2), "key", None),
        Part(
            "Lever",
            lever.scaled(z=long / 0.009)
            .turned("x", 90)
            .turned("x", 14)
            .moved(y=lift, z=height / 2),
            "key",
            None,
        ),
    )


def socket(size_m: Size, *, count: int = 1) -> tuple[Part, ...]:
    """Earthed sockets: round wells with two holes and clips at the sides."""
    length, width, height = size_m
    wide = length / count
    well, deep = 0.0195, width * 0.72
    plates, wells, holes, clips = [], [], [], []
    for index in range(count):
        x = -length / 2 + wide * (index + 0.5)
        turn = np.linspace(0, 2 * math.pi, 20, endpoint=False)
        rim = np.stack([well * np.cos(turn), well * np.sin(turn)], -1)
        outer = ring(wide - 0.0006, height, 0.006, 0.0, 3)[:, :2]
        collar = ring(0.052, 0.052, 0.008, 0.0, 4)[:, :2]
        plates += [
            extruded(outer, width * 0.78, [rim]).moved(x),
            extruded(collar, width * 0.22 + 0.0004, [rim]).moved(x, z=width * 0.78 - 0.0004),
        ]
        cup_ = [
            (well + 0.001, 0.0),
            (well + 0.001, width * 0.7),
            (well - 0.0006, width * 0.7),
            (well - 0.001, width - deep),
            (0.0, width - deep),
        ]
        wells.append(outward(lathe(cup_, 20)).moved(x))
        for s in (-1, 1):
            holes.append(
                cylinder(0.0026, 0.0006, 0.0, 10).moved(x + s * 0.0095, 0.0, width - deep - 0.0002)
            )
            clips.append(
                block((0.005, 0.0022, width * 0.4), 0.0004).moved(
                    x, s * (well - 0.0016), width - deep
                )
            )
    back = width / 2
    parts = (
        (("Plate", plates, "plate")),
        ("Wells", wells, "plate"),
        ("Holes", holes, "shadow"),
        ("Clips", clips, "metal"),
    )
    return tuple(
        Part(name, stood_up(joined(solids), back, height / 2), slot, None)
        for name, solids, slot in parts
    )
