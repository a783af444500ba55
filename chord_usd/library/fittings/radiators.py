"""Radiators; backs at +y."""

from __future__ import annotations

import numpy as np

from chord_usd.library.kit.forms import (
    lofted,
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
    ring,
    rounded_slab,
    tube,
)


def _pipes(x_m: float, back_y_m: float, z_m: float, valve_z_m: float) -> Solid:
    """A feed from the wall with its rose, and a valve's head."""
    path = bent_path(
        [[x_m, back_y_m - 0.001, z_m], [x_m, 0.0, z_m], [x_m, 0.0, valve_z_m]], 0.02, 3
    )
    rose = cylinder(0.018, 0.008, 0.002, 16).turned("x", 90).moved(x_m, back_y_m, z_m)
    return tube(path, 0.0075, 8) + rose


def _valve(x_m: float, z_m: float, y_m: float = 0.0) -> Solid:
    head = lathe([(0.014, 0.0), (0.017, 0.004), (0.019, 0.03), (0.017, 0.05), (0.012, 0.054)], 18)
    return head.turned("y", 90 if x_m > 0 else -90).moved(x_m, y_m, z_m)


def panel_radiator(size_m: Size) -> tuple[Part, ...]:
    """A panel with pressed channels, a grille on top, sides and a thermostatic valve."""
    length, width, height = size_m
    wide = length - 0.06
    x0 = -0.03
    depth = width - 0.022
    front_y = -width / 2
    panel = rounded_slab((wide - 0.012, height - 0.02, 0.012), 0.01, 0.004, 3).turned("x", 90)
    panel = panel.moved(x0, front_y + 0.0175, (height - 0.02) / 2 + 0.004)
    count = max(6, round((wide - 0.08) / 0.05))
    step = (wide - 0.06) / count
    rib = block((step * 0.62, 0.007, height - 0.1), 0.003)
    ribs = [
        rib.moved(x0 - (wide - 0.06) / 2 + step * (i + 0.5), front_y + 0.0035, 0.05)
        for i in range(count)
    ]
    back = box((wide - 0.03, depth - 0.026, height - 0.05)).moved(
        x0, front_y + 0.016 + (depth - 0.026) / 2, 0.02
    )
    sides = [
        block((0.006, depth, height - 0.012), 0.002).moved(
            x0 + s * (wide - 0.006) / 2, front_y + 0.004 + depth / 2, 0.004
        )
        for s in (-1, 1)
    ]
    fins = max(10, round(wide / 0.03))
    top = [
        block((wide - 0.008, depth - 0.004, 0.004), 0.001).moved(
            x0, front_y + 0.004 + depth / 2, height - 0.0125
        )
    ]
    slot = [
        box((0.005, depth - 0.03, 0.0025)).moved(
            x0 - wide / 2 + 0.02 + (wide - 0.04) * (i + 0.5) / fins,
            front_y + 0.004 + depth / 2,
            height - 0.0085,
        )
        for i in range(fins)
    ]
    frame = [
        block((wide - 0.014, 0.008, 0.011), 0.002).moved(x0, front_y + 0.0045 + s, height - 0.0115)
        for s in (0.004, depth - 0.004)
    ]
    brackets = [
        box((0.04, 0.024, 0.05)).moved(x0 + s * wide * 0.3, width / 2 - 0.012, z)
        for s in (-1, 1)
        for z in (0.08, height - 0.14)
    ]
    at = length / 2 - 0.058
    valve = _valve(at + 0.004, 0.06)
    return (
        Part("Panel", panel, "paint", None),
        Part("Channels", joined(ribs), "paint", None),
        Part("Body", back, "shadow", None),
        Part("Sides", joined([*sides, *top, *frame]), "paint", None),
        Part("Grille", joined(slot), "shadow", None),
        Part("Brackets", joined(brackets), "paint", None),
        Part("Valve", valve, "valve", None),
        Part(
            "Pipe",
            tube([[at - 0.02, 0.0, 0.06], [at + 0.01, 0.0, 0.06]], 0.009, 8)
            + _pipes(at, width / 2, 0.019, 0.06),
            "metal",
            None,
        ),
    )


def column_radiator(size_m: Size) -> tuple[Part, ...]:
    """Cast columns side by side, three tubes deep, on a feed with a wheel valve."""
    length, width, height = size_m
    wide = length - 0.05
    count = max(5, round(wide / 0.06))
    step = wide / count
    deep = width - 0.03
    columns = []
    r = 0.0135
    for index in range(count):
        x = -length / 2 + step * (index + 0.5)
        outline = ring(deep, height, deep * 0.42, 0.0, 3)[:, :2]
        loop = np.column_stack([np.zeros(len(outline)), outline[:, 0], outline[:, 1] + height / 2])
        hoop_in = 1.0 - 2 * r / np.ptp(loop[:, 1:], axis=0)
        middle = loop.mean(axis=0)[1:]
        rings = []
        for share, side in ((1.0, -0.5), (1.0, 0.5), (0.0, 0.5), (0.0, -0.5)):
            scaled = loop.copy()
            factor = hoop_in + (1.0 - hoop_in) * share
            scaled[:, 1:] = middle + (loop[:, 1:] - middle) * factor
            scaled[:, 0] = x + side * step * 0.72
            scaled[:, 1] -= 0.015
            rings.append(scaled)
        columns.append(lofted(rings, loop=True))
        columns.append(box((step * 0.66, 2 * r * 0.9, height - 2 * r)).moved(x, -0.015, r))
    hubs = [
        tube([[-length / 2 + 0.004, 0.0, z], [length / 2 - 0.052, 0.0, z]], 0.016, 12)
        for z in (0.05, height - 0.05)
    ]
    brackets = pair(
        cylinder(0.008, width / 2, 0.0, 10).turned("x", -90).moved(z=height - 0.09), x=wide * 0.3
    )
    at = length / 2 - 0.04
    wheel = lathe(
        [(0.005, 0.0), (0.006, 0.016), (0.022, 0.018), (0.022, 0.028), (0.008, 0.032)], 18
    )
    return (
        Part("Columns", joined(columns), "paint", None),
        Part("Hubs", joined([*hubs, *brackets]), "paint", None),
        Part(
            "Pipe",
            tube([[at - 0.02, 0.0, 0.05], [at + 0.01, 0.0, 0.05]], 0.012, 10)
            + _pipes(at, width / 2, 0.019, 0.05),
            "metal",
            None,
        ),
        Part("Valve", wheel.turned("y", 90).moved(at + 0.008, 0.0, 0.05), "valve", None),
    )


def tubular_radiator(size_m: Size) -> tuple[Part, ...]:
    """Flat horizontal tubes between two uprights."""
    length, width, height = size_m
    count = round(height / 0.07)
    step = height / count
    bars = [
        rounded_slab((length, 0.016, step * 0.8), 0.004, 0.006, 3).moved(
            y=-width / 2 + 0.008, z=step * (i + 0.1)
        )
        for i in range(count)
    ]
    posts = pair(
        block((0.035, 0.03, height - 0.02), 0.006).moved(y=-width / 2 + 0.03, z=0.01),
        x=length / 2 - 0.08,
    )
    stays = [
        box((0.03, width - 0.04, 0.03)).moved(s * (length / 2 - 0.08), 0.02, z)
        for s in (-1, 1)
        for z in (0.05, height - 0.09)
    ]
    valve = _valve(length / 2 - 0.056, 0.03, -width / 2 + 0.035)
    return (
        Part("Tubes", joined(bars), "paint", None),
        Part("Posts", joined([*posts, *stays]), "paint", None),
        Part("Valve", valve, "valve", None),
    )
