"""Dining chairs: one frame, backs that distinguish the styles."""

from __future__ import annotations

from typing import Literal

import numpy as np

from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    bent_path,
    block,
    cushion,
    joined,
    rounded_slab,
    tube,
)

ChairBack = Literal["slats", "board", "padded", "spindles", "medallion"]


def chair(size_m: Size, *, back: ChairBack = "slats") -> tuple[Part, ...]:
    """A dining chair: seat at 0.45 m, rear legs that run up into the back."""
    length, width, height = size_m
    seat_z, thick = 0.44, 0.036
    seat_depth = width - 0.05
    legs = [
        tube(
            [[s * (length / 2 - 0.025), -width / 2 + 0.025, 0],
             [s * (length / 2 - 0.035), -width / 2 + 0.05, seat_z]], thick / 2, 8,
        )
        for s in (-1, 1)
    ]  # fmt: skip
    legs += [tube(_rear_post(s, length, width, height, seat_z), thick / 2, 8) for s in (-1, 1)]
    names = ("Front_Left", "Front_Right", "Rear_Left", "Rear_Right")
    rails = [
        block((length - 0.08, 0.02, 0.05)).moved(y=y, z=seat_z - 0.055)
        for y in (-width / 2 + 0.05, width / 2 - 0.09)
    ]
    rails.append(block((0.02, width - 0.14, 0.046)).moved(length / 2 - 0.04, -0.02, seat_z - 0.053))
    rails.append(rails[-1].scaled(x=-1.0))
    seat = cushion((length - 0.01, seat_depth, 0.045), 0.06, 0.02, 0.012)
    return (
        *(Part(f"Leg_{name}", leg, "frame") for name, leg in zip(names, legs, strict=True)),
        Part("Rails", joined(rails), "frame", collider=None),
        Part("Seat", seat.moved(y=-width / 2 + seat_depth / 2 + 0.002, z=seat_z - 0.01), "seat"),
        *_chair_back(back, length, width, height),
    )


def _rear_post(side: int, length: float, width: float, height: float, seat_z: float) -> np.ndarray:
    x, back = side * (length / 2 - 0.03), width / 2
    corners = [[x, back - 0.03, 0], [x, back - 0.075, seat_z], [x, back - 0.02, height]]
    return bent_path(corners, 0.1, 4)


def _chair_back(kind: ChairBack, length: float, width: float, height: float) -> tuple[Part, ...]:
    y, inner = width / 2 - 0.035, length - 0.08
    if kind == "slats":
        rails = [
            block((inner + 0.02, 0.02, 0.055), 0.006).moved(y=y + dy, z=height - drop)
            for drop, dy in ((0.075, 0.006), (0.185, -0.006), (0.295, -0.018))
        ]
        return (Part("Back", joined(rails), "frame"),)
    if kind == "spindles":
        comb = block((length - 0.02, 0.022, 0.07), 0.01).moved(y=y + 0.004, z=height - 0.075)
        rods = [
            tube([[0.8 * x, y - 0.03, 0.44], [x, y + 0.006, height - 0.04]], 0.007, 8)
            for x in np.linspace(-0.42, 0.42, 7) * inner
        ]
        return (Part("Back", joined([comb, *rods]), "frame"),)
    if kind == "medallion":
        return _medallion(length, y, height)
    if kind == "board":
        plate = rounded_slab((length - 0.02, 0.2, 0.02), 0.04, 0.006).turned("x", 83)
        low, high = plate.bounds_m()
        at = (0.0, y + 0.01 - float(low[1] + high[1]) / 2, height - 0.012 - float(high[2]))
        return (Part("Back", plate.moved(*at), "back"),)
    pad = cushion((length - 0.03, height - 0.51, 0.055), 0.06, 0.02, 0.012).turned("x", 83)
    low, high = pad.bounds_m()
    at = (0.0, y + 0.012 - float(low[1] + high[1]) / 2, height - 0.005 - float(high[2]))
    return (Part("Back", pad.moved(*at), "seat"),)


def _medallion(length: float, y: float, height: float) -> tuple[Part, ...]:
    """An oval of cloth in a wooden ring, held by two posts."""
    wide, tall, thick = length - 0.03, height - 0.53, 0.03
    rim = rounded_slab((wide, tall, thick), wide, 0.01, 12, 3).turned("x", 83)
    pad = cushion((wide - 0.07, tall - 0.07, thick + 0.024), wide, 0.012, 0.012).turned("x", 83)
    low, high = rim.bounds_m()
    at = (0.0, y + 0.012 - float(low[1] + high[1]) / 2, height - 0.002 - float(high[2]))
    inside = pad.bounds_m().mean(axis=0) - rim.bounds_m().mean(axis=0)
    pad = pad.moved(*(-inside)).moved(*at)
    return (Part("Back", rim.moved(*at), "frame"), Part("Back_Pad", pad, "seat", collider=None))
