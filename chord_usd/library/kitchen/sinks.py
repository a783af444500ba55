"""Sinks of kitchens and laundries: pressed steel, undermounted, ceramic with an apron."""

from __future__ import annotations

import numpy as np

from chord_usd.library.kit.solids import (
    Solid,
    extruded,
    joined,
    lathe,
    loft,
    ring,
    tube,
)


def _drain(deep: float) -> Solid:
    """A strainer in the floor of a bowl."""
    rim = lathe([(0.04, 0), (0.04, 0.003), (0.033, 0.003), (0.03, 0.0012), (0, 0.0012)], 24)
    pin = lathe([(0.008, 0.001), (0.008, 0.006), (0, 0.008)], 12)
    return (rim + pin).moved(z=-deep + 0.0036)


def sink_bowl(length: float, width: float, deep: float) -> Solid:
    """A pressed steel bowl hanging from z = 0, with a rim that laps over the worktop."""
    rim = 0.014
    outline = [
        (0.03, 0.045, -deep),
        (0.006, 0.05, -deep + 0.02),
        (0.0, 0.055, 0.0),
        (-rim, 0.065, 0.0005),
        (-rim, 0.065, 0.002),
        (-rim + 0.003, 0.063, 0.0035),
        (0.002, 0.055, 0.0035),
        (0.006, 0.054, 0.0),
        (0.012, 0.05, -deep + 0.03),
        (0.02, 0.047, -deep + 0.013),
        (0.034, 0.042, -deep + 0.006),
        (0.1, 0.03, -deep + 0.004),
    ]
    rings = [ring(length - 2 * i, width - 2 * i, corner, z, 5) for i, corner, z in outline]
    return loft(rings) + _drain(deep)


def undermount_bowl(length: float, width: float, deep: float, top: float) -> Solid:
    """A bowl with tight corners whose rim hides under the worktop, top below z = 0."""
    outline = [
        (0.012, 0.02, -deep - 0.004),
        (-0.012, 0.026, -deep + 0.01),
        (-0.012, 0.026, -top - 0.001),
        (0.002, 0.022, -top - 0.0012),
        (0.006, 0.02, -top - 0.006),
        (0.008, 0.02, -deep + 0.02),
        (0.013, 0.02, -deep + 0.006),
        (0.03, 0.018, -deep + 0.001),
        (0.1, 0.015, -deep),
    ]
    rings = [ring(length - 2 * i, width - 2 * i, corner, z, 4) for i, corner, z in outline]
    return loft(rings) + _drain(deep + 0.0035)


def drainer_sink(length: float, width: float, bowl_l: float, bowl_w: float, deep: float) -> Solid:
    """A sheet of steel: a bowl to the left, a ribbed drainer to the right; the worktop is z = 0."""
    x, sheet = -length / 2 + bowl_l / 2 + 0.045, 0.004
    outline = ring(length, width, 0.03, 0.0, 4)[:, :2]
    hole = ring(bowl_l, bowl_w, 0.055, 0.0, 5)[:, :2] + [x, 0.0]
    plate = extruded(outline, sheet, [hole])
    rings = [
        ring(bowl_l - 2 * i, bowl_w - 2 * i, corner, z, 5) + np.array([x, 0.0, 0.0])
        for i, corner, z in (
            (0.03, 0.045, -deep),
            (0.004, 0.05, -deep + 0.02),
            (-0.004, 0.056, 0.001),
            (-0.004, 0.056, sheet + 0.0012),
            (0.001, 0.054, sheet + 0.0012),
            (0.006, 0.052, -0.002),
            (0.012, 0.048, -deep + 0.03),
            (0.022, 0.045, -deep + 0.012),
            (0.1, 0.03, -deep + 0.005),
        )
    ]
    left = x + bowl_l / 2 + 0.05
    right = length / 2 - 0.035
    ribs = [
        tube([[left, y, sheet + 0.0005], [right, y, sheet + 0.0005]], 0.0032, 6)
        for y in [0.042 * n for n in range(-4, 5)]
        if abs(y) < width / 2 - 0.04
    ]
    profile = ((-0.0006, 0.001), (-0.0006, 0.0062), (0.006, 0.0066), (0.009, 0.0035))
    rim = loft([ring(length - 2 * i, width - 2 * i, 0.03, z, 4) for i, z in profile], loop=True)
    return joined([plate, loft(rings), _drain(deep).moved(x), *ribs, rim])


def apron_sink(length: float, width: float, tall: float) -> Solid:
    """A thick-walled ceramic sink that shows its front; z = 0 is its upper rim."""
    wall, deep = 0.028, tall - 0.03
    outline = [
        (0.004, 0.012, -tall),
        (0.0, 0.014, -tall + 0.004),
        (0.0, 0.014, -0.008),
        (0.003, 0.014, -0.002),
        (0.009, 0.014, 0.0),
        (wall - 0.008, 0.02, 0.0),
        (wall - 0.002, 0.025, -0.003),
        (wall, 0.03, -0.012),
        (wall + 0.006, 0.035, -deep + 0.03),
        (wall + 0.016, 0.04, -deep + 0.008),
        (wall + 0.035, 0.035, -deep),
        (wall + 0.1, 0.02, -deep),
    ]
    rings = [ring(length - 2 * i, width - 2 * i, corner, z, 5) for i, corner, z in outline]
    return loft(rings) + _drain(deep + 0.0035)
