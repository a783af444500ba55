"""Bathtubs."""

from __future__ import annotations

from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.bath.rims import bowl_colliders
from chord_usd.library.bath.taps import tub_tap
from chord_usd.library.kit.joinery import colliders_around
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    lathe,
    loft,
    ring,
    tube,
)

TubKind = Literal["built_in", "oval", "claw_foot"]


def bathtub(size_m: Size, *, kind: TubKind = "built_in") -> tuple[Part, ...]:
    """A hollow tub with drain, overflow and tap: with an apron, oval, or on four claws."""
    length, width, height = size_m
    rim = {"built_in": 0.065, "oval": 0.028, "claw_foot": 0.06}[kind]
    inner_l, inner_w = length - 2 * rim, width - 2 * rim
    corner = min(inner_w / 2, 0.2) if kind == "built_in" else inner_w / 2
    floor = 0.1 if kind != "claw_foot" else 0.17
    shape = (
        (0.0, 1.0),
        (0.006, 0.994),
        (0.016, 0.96),
        (0.045, 0.62),
        (0.085, 0.3),
        (0.12, 0.1),
        (0.19, 0.02),
        (0.28, 0.0),
    )
    hollow = [
        ring(
            inner_l - 2.6 * i,
            inner_w - 2 * i,
            max(corner - 0.6 * i, 0.02),
            floor + (height - 0.001 - floor) * share,
            10,
        )
        for i, share in shape
    ]
    drain = lathe([(0.03, 0), (0.03, 0.004), (0.022, 0.005), (0.02, 0.008), (0, 0.009)], 26)
    overflow = lathe([(0.033, 0), (0.033, 0.006), (0.028, 0.012), (0, 0.013)], 26).turned("y", 90)
    at = -inner_l / 2 + 0.036
    tub = loft([*_tub_skin(size_m, kind), *hollow])
    parts = [
        Part(
            "Tub", tub, "ceramic", colliders=_tub_colliders(tub, hollow[0][:, :2], rim, floor, kind)
        ),
        Part("Drain", drain.moved(-inner_l * 0.27, 0.0, floor + 0.0005), "metal", collider=None),
        Part(
            "Overflow",
            overflow.moved(at, 0.0, floor + (height - floor) * 0.74),
            "metal",
            collider=None,
        ),
    ]
    if kind == "built_in":
        inset = 0.03
        panel = block((length - 0.05, 0.012, height - 0.11), 0.003).moved(
            y=-width / 2 + 0.0065 + inset * 0.0 + 0.004, z=0.03
        )
        parts.append(Part("Panel", panel, "ceramic", collider=None))
    if kind == "claw_foot":
        parts += _claws(size_m)
    if kind == "oval":
        return (*parts, *_deck_tap(size_m))
    tap = tub_tap(cross=kind == "claw_foot").moved(
        0.0, width / 2 - rim / 2 - (0.011 if kind == "claw_foot" else 0.003), height - 0.003
    )
    return (*parts, Part("Tap", tap, "metal", collider=None, above=True))


def _tub_colliders(
    tub: Solid, mouth: FloatArray, rim: float, floor: float, kind: TubKind
) -> tuple[Solid, ...]:
    """Its sides and its floor. mouth: (N, 2) where the hollow begins; rim: width around it."""
    if kind == "built_in":
        length, width = (float(side) for side in np.ptp(mouth, axis=0))
        return (*colliders_around(tub, [mouth]), box((length, width, floor)))
    low_m, height = (float(corner[2]) for corner in tub.bounds_m())
    middles = mouth * (1.0 + rim / np.abs(mouth).max(axis=0))
    return bowl_colliders(middles, rim, low_m, floor, height)


def _tub_skin(size_m: Size, kind: TubKind) -> list[FloatArray]:
    """Rings of a tub's outside from its foot to the rim."""
    length, width, height = size_m
    if kind == "built_in":
        return [
            ring(length - 0.024, width - 0.024, 0.012, 0.0, 10),
            ring(length - 0.024, width - 0.024, 0.012, height - 0.045, 10),
            ring(length, width, 0.02, height - 0.043, 10),
            ring(length, width, 0.02, height - 0.008, 10),
            ring(length - 0.005, width - 0.005, 0.022, height - 0.002, 10),
            ring(length - 0.016, width - 0.016, 0.025, height, 10),
        ]
    foot = 0.0 if kind == "oval" else 0.12
    outer = (
        (
            (0.8, 0.72, 0.0),
            (0.815, 0.735, 0.012),
            (0.85, 0.8, 0.2),
            (0.9, 0.88, 0.48),
            (0.95, 0.945, 0.76),
            (0.99, 0.988, 0.95),
            (1.0, 1.0, 0.985),
            (0.998, 0.996, 1.0),
        )
        if kind == "oval"
        else (
            (0.5, 0.36, 0.0),
            (0.66, 0.56, 0.02),
            (0.78, 0.74, 0.12),
            (0.86, 0.84, 0.35),
            (0.91, 0.89, 0.7),
            (0.925, 0.905, 0.9),
            (0.945, 0.925, 0.94),
            (0.985, 0.97, 0.955),
            (1.0, 1.0, 0.97),
            (0.998, 0.995, 0.99),
            (0.985, 0.97, 1.0),
        )
    )
    return [
        ring(length * a, width * b, width * b * 0.5, foot + (height - foot) * z, 10)
        for a, b, z in outer
    ]


def _claws(size_m: Size) -> list[Part]:
    """Four bent feet under a tub."""
    length, width, _ = size_m
    profile = [
        [0.0, 0.05, 0.155],
        [0.0, 0.012, 0.14],
        [0.0, -0.012, 0.105],
        [0.0, 0.012, 0.06],
        [0.0, 0.008, 0.03],
        [0.0, -0.018, 0.016],
    ]
    leg = tube(profile, 0.016, 12)
    ball = lathe([(0, 0), (0.016, 0.002), (0.023, 0.014), (0.018, 0.028), (0, 0.034)], 18).moved(
        y=-0.018
    )
    feet = []
    for sx in (-1, 1):
        for sy, turn in ((-1, 24.0 * sx), (1, 180.0 - 24.0 * sx)):
            feet.append((leg + ball).turned("z", turn).moved(sx * length * 0.3, sy * width * 0.27))
    return [Part(f"Foot_{n}", foot, "metal") for n, foot in enumerate(feet, start=1)]


def _deck_tap(size_m: Size) -> list[Part]:
    """A slender column that stands behind the tub on its rim, spout over the water."""
    from chord_usd.library.bath.taps import tall_basin_tap

    _, width, height = size_m
    tap = tall_basin_tap(0.2).moved(0.0, width / 2 - 0.0285, height - 0.004)
    return [Part("Tap", tap, "metal", collider=None, above=True)]
