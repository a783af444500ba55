"""Shelves and hooks on walls; backs at +y."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from chord_usd.library.cloth.stored import stored
from chord_usd.library.kit.forms import (
    arc,
)
from chord_usd.library.kit.model import Draw, Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    cylinder,
    extruded,
    joined,
    tube,
    welded,
)

_BOARD_M = 0.022


def floating(size_m: Size) -> tuple[Part, ...]:
    """One thick board without anything to be seen below it."""
    return (Part("Board", block(size_m, 0.002), "board"),)


def bracketed(size_m: Size) -> tuple[Part, ...]:
    """A board on two or three metal brackets."""
    length, width, height = size_m
    board = block((length, width, _BOARD_M), 0.003).moved(z=height - _BOARD_M)
    low = height - _BOARD_M
    bar, thin = 0.022, 0.005
    count = 2 if length < 1.1 else 3
    brackets = []
    for index in range(count):
        x = (index / (count - 1) - 0.5) * (length - 0.24)
        brackets.append(block((bar, thin, low + 0.001), 0.001).moved(x, (width - thin) / 2))
        brackets.append(block((bar, width - 0.02, thin), 0.001).moved(x, 0.01, low - thin))
        bow = arc((width * 0.36, 0.01), (width * 0.28, low * 0.8), (-width * 0.36, low - 0.004), 5)
        brackets.append(tube(np.array([[x, y, z] for y, z in bow]), 0.004, 6))
    return (
        Part("Board", board, "board"),
        Part("Brackets", joined(brackets), "metal", None),
    )


def corbelled(size_m: Size) -> tuple[Part, ...]:
    """A moulded board on curved wooden corbels."""
    length, width, height = size_m
    low = height - _BOARD_M
    board = block((length, width, _BOARD_M), 0.006).moved(z=low)
    cornice = block((length - 0.03, width - 0.015, 0.014), 0.005).moved(y=0.0075, z=low - 0.013)
    bow = [
        (0.0, 0.0),
        *arc((0.0, 0.0), (-0.03, low * 0.55), (-width * 0.72, low - 0.012), 7)[1:],
        (0.0, low - 0.012),
    ]
    corbel = extruded(np.array([[y, z] for y, z in bow])[::-1], 0.035)
    # Drawn over (y, z) and lying: stood up, its thickness runs along x.
    stood = corbel.turned("x", 90).turned("z", 90).moved(y=width / 2)
    low_x = float(stood.bounds_m().mean(axis=0)[0])
    pair = [stood.moved(x=s * (length / 2 - 0.12) - low_x) for s in (-1, 1)]
    return (
        Part("Board", board, "board"),
        Part("Cornice", cornice, "board", None),
        Part("Corbels", joined(pair), "board", None),
    )


def ladder(size_m: Size) -> tuple[Part, ...]:
    """Three boards between two slim metal sides."""
    length, width, height = size_m
    rod = 0.01
    boards, frames = [], []
    for z in _ladder_boards(height):
        boards.append(block((length - 0.03, width - 0.01, 0.02), 0.002).moved(z=z - 0.02))
    for s in (-1, 1):
        x = s * (length - rod) / 2
        frames.append(block((rod, rod, height), 0.001).moved(x, (width - rod) / 2))
        frames.append(block((rod, rod, height), 0.001).moved(x, -(width - rod) / 2))
        frames += [
            block((rod - 0.001, width - 2 * rod, rod), 0.001).moved(x, z=z - 0.026)
            for z in _ladder_boards(height)
        ]
        frames += [
            block((0.012, width - 0.02, 0.006), 0.001).moved(s * (length / 2 - 0.014), z=z - 0.023)
            for z in _ladder_boards(height)
        ]
    return (
        Part("Boards", joined(boards), "board", colliders=tuple(boards)),
        Part("Sides", joined(frames), "metal", None),
    )


def _ladder_boards(height_m: float) -> tuple[float, float, float]:
    return 0.06, 0.06 + (height_m - 0.2) / 2, height_m - 0.14


def box_shelf(size_m: Size) -> tuple[Part, ...]:
    """An open box with one upright, things stand in and on it."""
    length, width, height = size_m
    side = block((0.018, width - 0.002, height - 0.034), 0.0015)
    boards = [block((length, width, 0.018), 0.002).moved(z=z) for z in (0.0, height - 0.018)]
    back = box((length - 0.01, 0.006, height - 0.02)).moved(y=width / 2 - 0.005, z=0.01)
    uprights = [
        side.moved(x, 0.0, 0.017)
        for x in (-(length - 0.02) / 2, (length - 0.02) / 2, length * 0.12)
    ]
    return (
        Part("Boards", joined(boards), "board", colliders=tuple(boards)),
        Part("Uprights", joined(uprights), "board", colliders=tuple(uprights)),
        Part("Back", back, "back", None),
    )


def peg_rail(size_m: Size) -> tuple[Part, ...]:
    """A board with turned pegs."""
    length, width, height = size_m
    board = block((length, 0.018, height), 0.004).moved(y=width / 2 - 0.009)
    count = max(3, round(length / 0.14))
    pegs = []
    for index in range(count):
        x = ((index + 0.5) / count - 0.5) * (length - 0.04)
        peg = joined(
            [
                cylinder(0.007, width - 0.024, 0.0, 12),
                cylinder(0.011, 0.014, 0.004, 14).moved(z=width - 0.034),
            ]
        )
        pegs.append(peg.turned("x", 100).moved(x, width / 2 - 0.016, height * 0.5))
    return Part("Board", board, "board", None), Part("Pegs", joined(pegs), "board", None)


def _hook(out_m: float, drop_m: float) -> Solid:
    """A double hook before the plane y = 0, its screw plate around the origin."""
    plate = block((0.02, 0.004, 0.06), 0.0015).moved(y=-0.002, z=-0.03)
    low = arc((0.0, -0.014), (-out_m * 0.9, -drop_m * 1.5), (-out_m, -0.002), 6)
    high = arc((0.0, 0.012), (-out_m * 0.7, 0.006), (-out_m * 1.15, 0.05), 5)
    bars = [tube(np.array([[0.0, y - 0.003, z] for y, z in bow]), 0.0038, 7) for bow in (low, high)]
    knobs = [
        cylinder(0.006, 0.008, 0.002, 10).moved(0.0, bow[-1][0] - 0.003, bow[-1][1] - 0.003)
        for bow in (low, high)
    ]
    return joined([plate, *bars, *knobs])


def hooks(size_m: Size) -> tuple[Part, ...]:
    """A board with metal double hooks."""
    length, width, height = size_m
    board = block((length, 0.018, height * 0.75), 0.005).moved(y=width / 2 - 0.009, z=height * 0.1)
    count = max(3, round(length / 0.16))
    hook = _hook((width - 0.022) / 1.2, height * 0.36)
    row = [
        hook.moved(((i + 0.5) / count - 0.5) * length, width / 2 - 0.018, height * 0.52)
        for i in range(count)
    ]
    return Part("Board", board, "board", None), Part("Hooks", joined(row), "metal", None)


def with_coats(size_m: Size, *, rail: Draw) -> tuple[Part, ...]:
    """A rail with coats on it, a long one and a short one in turn."""
    length, width, height = size_m
    back = [
        replace(part, solid=part.solid.moved(y=(width - _RAIL_SIZE_M[0]) / 2, z=height - _RAIL_M))
        for part in rail((length, *_RAIL_SIZE_M))
    ]
    count = max(1, round(length / 0.4))
    coats = []
    for index in range(count):
        cloth = stored("coat_short" if index % 2 else "coat_long")
        low, high = cloth.solid.bounds_m()
        tall = height - 0.05 if index % 2 == 0 else 0.78 * (height - 0.05)
        cloth = cloth.moved(*(-(low + high) / 2 * [1, 1, 0] - high * [0, 0, 1]))
        cloth = cloth.scaled(*(np.array([_COAT_M, width - 0.024, tall]) / (high - low)))
        x = (index + 0.5) / count * length - length / 2
        x = float(np.clip(x, (_COAT_M - length) / 2, (length - _COAT_M) / 2))
        cloth = cloth.moved(x, -0.012, height - 0.05)
        coats.append(
            Part(f"Coat_{index}", _sewn(cloth.solid), f"coat_{index % 2}", None,
                 uvs=cloth.corner_uvs_m(), two_sided=True)
        )  # fmt: skip
    return *back, *coats


def _sewn(cloth: Solid) -> Solid:
    """The same faces, the two sides of a seam on the same points."""
    return welded(cloth.points_m, cloth.faces)


_RAIL_M = 0.1
_RAIL_SIZE_M = (0.08, _RAIL_M)
_COAT_M = 0.44
"""Width of a coat on its hook."""
