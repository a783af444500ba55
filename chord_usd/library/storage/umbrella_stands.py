"""Stands with umbrellas."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.library.kit.forms import (
    cup,
    hollow,
    lofted,
    open_tub,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    at_corners,
    block,
    box,
    cylinder,
    joined,
    tube,
)


def _umbrella(tall_m: float, *, crook: bool = True) -> tuple[Solid, Solid, Solid]:
    """(folded cloth, shaft, handle) of an umbrella that stands on its tip."""
    sides, folds = 24, 8
    turn = np.linspace(0, 2 * math.pi, sides, endpoint=False)
    rings = []
    for share, radius in (
        (0.07, 0.004),
        (0.12, 0.011),
        (0.4, 0.024),
        (0.62, 0.031),
        (0.68, 0.026),
        (0.7, 0.006),
    ):
        r = radius * (1.0 + 0.22 * np.cos(folds * turn + 5 * share))
        rings.append(
            np.stack([r * np.cos(turn), r * np.sin(turn), np.full(sides, share * tall_m)], -1)
        )
    cloth = lofted(rings)
    shaft = cylinder(0.004, 0.86 * tall_m, 0.0, 8)
    high = 0.82 * tall_m
    if crook:
        top = tall_m - 0.046
        path = [[0, 0, high]] + [
            [0.036 - 0.036 * math.cos(a), 0.0, top + 0.036 * math.sin(a)]
            for a in np.linspace(0, 3.4, 9)
        ]
        handle = tube(path, 0.009, 8)
    else:
        handle = cylinder(0.012, 0.18 * tall_m, 0.004, 12).moved(z=high)
    return cloth, shaft, handle


def umbrella_stand(size_m: Size, *, kind: str = "cylinder") -> tuple[Part, ...]:
    """A tall vessel, or a frame of bars, with two umbrellas leaning in it."""
    length, width, height = size_m
    r = min(length, width) / 2
    tall = height * 0.68
    parts: list[Part] = []
    if kind == "frame":
        bar = 0.012
        side = 2 * r
        posts = at_corners(block((bar, bar, tall), 0.002), (side - bar) / 2, (side - bar) / 2)
        rails = []
        for z in (tall - bar, tall * 0.55, 0.03):
            for s in (-1, 1):
                rails.append(
                    block((side - 2 * bar + 0.002, bar * 0.8, bar), 0.002).moved(
                        y=s * (side - bar) / 2, z=z
                    )
                )
                rails.append(
                    block((bar * 0.8, side - 2 * bar + 0.002, bar), 0.002).moved(
                        x=s * (side - bar) / 2, z=z
                    )
                )
        tray = open_tub(side - 2 * bar + 0.004, side - 2 * bar + 0.004, 0.03, 0.003, 0.006).moved(
            z=0.01
        )
        parts += [
            Part("Frame", joined([*posts, *rails]), "body", colliders=(box((side, side, tall)),)),
            Part("Tray", tray, "tray", None),
        ]
    else:
        profile = {
            "cylinder": [(0.0, 0.0), (r - 0.006, 0.0), (r, 0.008), (r, tall)],
            "vase": [
                (0.0, 0.0),
                (r * 0.7, 0.0),
                (r * 0.74, 0.02),
                (r * 0.96, tall * 0.5),
                (r, tall * 0.66),
                (r * 0.86, tall * 0.92),
                (r * 0.94, tall),
            ],
        }[kind]
        body = cup(profile, 0.007, 0.02, 40)
        parts.append(Part("Body", body, "body", colliders=(cylinder(r, tall),)))
        if kind == "cylinder":
            bands = [
                hollow([(r + 0.0015, z), (r + 0.0015, z + 0.012)], 0.004, 40)
                for z in (tall - 0.03, 0.03)
            ]
            parts.append(Part("Bands", joined(bands), "tray", None))
    reach = r * 0.42
    for name, slot, lean, turn, crook, share in (
        ("Dark", "cloth_a", 5.0, 20.0, True, 1.0),
        ("Light", "cloth_b", -6.0, 130.0, False, 0.94),
    ):
        cloth, shaft, handle = _umbrella((height - 0.022) * share, crook=crook)
        at = (-math.copysign(reach, lean) * 0.7, 0.0, 0.022)
        for part, solid, wear in (
            ("Umbrella", cloth, slot),
            ("Shaft", shaft, "metal"),
            ("Handle", handle, "wood"),
        ):
            parts.append(
                Part(
                    f"{part}_{name}",
                    solid.turned("y", lean).moved(*at).turned("z", turn),
                    wear,
                    None,
                )
            )
    return tuple(parts)
