"""What is fixed to the wall over a worktop: tiles, plates of stone and glass, rails with tools."""

from __future__ import annotations

import numpy as np

from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    cylinder,
    joined,
    lathe,
    ring,
    tube,
)
from chord_usd.library.kitchen.utensils import whisk_head

_GROUT_M = 0.0028


def tiles(
    size_m: Size, *, long: float, tall: float, shift: float = 0.5, lean_deg: float = 0.0
) -> tuple[Part, ...]:
    """Tiles with slanted edges on a bed of grout; rows shifted by a share of a tile.

    lean_deg: how far hand-made tiles lean out of the plane.
    """
    length, depth, height = size_m
    rows, columns = max(1, round(height / tall)), max(1, round(length / long))
    high, wide = height / rows, length / columns
    random = np.random.default_rng(7)
    made = []
    for row in range(rows):
        start = -length / 2 - (row * shift % 1.0) * wide
        for column in range(columns + 1):
            left = max(start + column * wide, -length / 2)
            right = min(start + (column + 1) * wide, length / 2)
            if right - left > 0.012:
                tilt = random.uniform(-lean_deg, lean_deg, 2)
                made.append(_tile(left, right, row * high, (row + 1) * high, depth, tilt))
    bed = box((length, depth - 0.004, height)).moved(y=0.002)
    return (
        Part("Bed", bed, "grout", collider=None),
        Part("Tiles", joined(made), "tile", collider=None),
    )


def _tile(
    left: float, right: float, low: float, high: float, depth: float, tilt: np.ndarray
) -> Solid:
    wide, tall = right - left - _GROUT_M, high - low - _GROUT_M
    soft = 0.0022
    rings = [ring(wide, tall, 0.0, 0.0, 0), ring(wide - soft, tall - soft, 0.0, 0.0045, 0)]
    slope = np.tan(np.radians(tilt))
    rings[1][:, 2] += np.minimum(rings[1][:, 0] * slope[0] + rings[1][:, 1] * slope[1], 0.0)
    plate = loft_flat(rings)
    return plate.turned("x", 90).moved((left + right) / 2, -depth / 2 + 0.0045, (low + high) / 2)


def loft_flat(rings: list[np.ndarray]) -> Solid:
    """A loft of two rectangles, each closed by two triangles."""
    from chord_usd.library.kit.solids import welded

    low, high = rings
    faces = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]]
    for i in range(4):
        j = (i + 1) % 4
        faces += [[i, j, j + 4], [i, j + 4, i + 4]]
    return welded(np.concatenate([low, high]), faces)


def slab(size_m: Size) -> tuple[Part, ...]:
    """One plate: stone, glass, steel."""
    length, depth, height = size_m
    return (Part("Plate", block((length, depth, height), 0.002), "plate", collider=None),)


def utensil_rail(size_m: Size) -> tuple[Part, ...]:
    """A bar with hooks, and tools that hang on them."""
    length, depth, height = size_m
    back, z = depth / 2, height - 0.012
    y = back - 0.04
    bar = cylinder(0.008, length, 0.002, 14).turned("y", 90).moved(-length / 2, y, z)
    holds = [
        tube(
            [[s * (length / 2 - 0.05), back - 0.001, z], [s * (length / 2 - 0.05), y, z]], 0.006, 8
        )
        + cylinder(0.014, 0.004, 0.001, 14).turned("x", 90).moved(s * (length / 2 - 0.05), back, z)
        for s in (-1, 1)
    ]
    count = max(3, round((length - 0.14) / 0.095))
    spread = np.linspace(-(length - 0.16) / 2, (length - 0.16) / 2, count)
    hooks, tools, grips = [], [], []
    for index, x in enumerate(spread):
        hooks.append(_hook(float(x), y, z))
        tool, grip = _tool(index % 4, height - 0.045)
        tools.append(tool.moved(float(x), y - 0.0155))
        grips.append(grip.moved(float(x), y - 0.0155))
    return (
        Part("Rail", joined([bar, *holds]), "metal", collider=None),
        Part("Hooks", joined(hooks), "metal", collider=None),
        Part("Tools", joined(tools), "steel", collider=None),
        Part("Grips", joined(grips), "grip", collider=None),
    )


def _hook(x: float, y: float, z: float) -> Solid:
    path = [
        [x, y + 0.011, z - 0.006],
        [x, y + 0.006, z + 0.0105],
        [x, y - 0.006, z + 0.0105],
        [x, y - 0.011, z - 0.006],
        [x, y - 0.013, z - 0.034],
        [x, y - 0.024, z - 0.03],
    ]
    return tube(path, 0.0022, 6)


def _tool(kind: int, top: float) -> tuple[Solid, Solid]:
    """Head and grip of a spoon, slice, ladle or whisk that hangs from z = top."""
    grip_l = 0.11
    grip = block((0.018, 0.009, grip_l), 0.004).moved(z=top - grip_l)
    eye = top - grip_l
    low = 0.004
    if kind == 0:
        head = lathe(
            [(0.0, 0.0), (0.02, 0.006), (0.03, 0.022), (0.028, 0.022), (0.018, 0.01), (0.0, 0.006)],
            16,
        )
        head = head.scaled(1.0, 1.0, 1.0).turned("x", 62).moved(y=0.004, z=low + 0.036)
    elif kind == 1:
        head = block((0.07, 0.003, 0.085), 0.001).moved(z=low)
    elif kind == 2:
        bowl = lathe(
            [
                (0.0, 0.0),
                (0.026, 0.006),
                (0.036, 0.028),
                (0.033, 0.028),
                (0.022, 0.01),
                (0.0, 0.005),
            ],
            18,
        )
        head = bowl.moved(y=-0.03, z=low + 0.001)
    else:
        head = whisk_head(low, 0.11)
    stem_low = {0: low + 0.04, 1: low + 0.08, 2: low + 0.026, 3: low + 0.1}[kind]
    stem = cylinder(0.0035, eye - stem_low + 0.01, 0.0, 8).moved(z=stem_low)
    return head + stem, grip
