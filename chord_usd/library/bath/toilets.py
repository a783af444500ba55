"""Toilets: bowl, seat and lid, cistern or frame."""

from __future__ import annotations

from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.leaf_clearance import CLEAR_M
from chord_usd.library.kit.model import Part, moving_part
from chord_usd.library.kit.moves import Hinge, Leaf, Moving, lid
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    cylinder,
    joined,
    lathe,
    loft,
    mirrored_pair,
    pair,
    ring,
    rounded_slab,
    tube,
)

ToiletKind = Literal["coupled", "framed", "classic", "washlet"]

_SEAT_Z_M = 0.4
_LID_DEG = 88.0
_SKIRTED = (
    (0.78, 0.72, 0.0),
    (0.795, 0.735, 0.006),
    (0.8, 0.74, 0.06),
    (0.82, 0.765, 0.14),
    (0.87, 0.83, 0.23),
    (0.935, 0.915, 0.31),
    (0.985, 0.98, 0.36),
    (1.0, 1.0, 0.386),
    (0.985, 0.99, 0.396),
)
_WAISTED = (
    (0.66, 0.68, 0.0),
    (0.67, 0.69, 0.008),
    (0.64, 0.655, 0.025),
    (0.55, 0.58, 0.07),
    (0.54, 0.56, 0.13),
    (0.6, 0.62, 0.2),
    (0.76, 0.76, 0.27),
    (0.92, 0.93, 0.33),
    (0.985, 0.985, 0.362),
    (1.0, 1.0, 0.386),
    (0.98, 0.987, 0.396),
)


_BASIN = (
    (1.0, 0.0, 0.396),
    (0.97, 0.0, 0.388),
    (0.93, 0.0, 0.33),
    (0.75, 0.065, 0.27),
    (0.4, 0.1, 0.205),
    (0.25, 0.1, 0.197),
)
"""Share of the opening, how far it lies further back as a share of the bowl's width, height."""

_SEAT_WIDE_M = (0.066, 0.06, 0.07)
"""Of the ring that one sits on: at the sides, in front, before the hinges."""


def _egg(length: float, width: float, z: float, back: float, sides: int = 44) -> FloatArray:
    """An egg-shaped ring: square-ish at the back (ends at y = back), round at the front."""
    angles = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)
    cos, sin = np.cos(angles), np.sin(angles)
    power = np.where(sin > 0.0, 0.55, 1.0)
    x = np.sign(cos) * np.abs(cos) ** np.where(sin > 0.0, 0.6, 0.92) * length / 2
    split = width * 0.42
    y = np.where(sin > 0.0, np.abs(sin) ** power * split, sin * (width - split))
    return np.stack([x, y + back - split, np.full(sides, z)], axis=-1)


def toilet(size_m: Size, *, kind: ToiletKind = "coupled") -> tuple[Part, ...]:
    """A toilet: bowl, seat and closed lid, cistern or frame with what flushes it.

    framed hides the cistern in a slim tall frame and skirts the bowl. It stands on its foot all
    the same: not every toilet is drawn right at its wall.
    """
    length, width, _ = size_m
    tank_w = 0.12 if kind == "framed" else 0.165
    back = width / 2 - tank_w
    bowl_l, bowl_w = min(length * 0.96, 0.375), width - tank_w
    shape = _WAISTED if kind == "classic" else _SKIRTED
    outside = [_egg(bowl_l * sx, bowl_w * sy, z, back + 0.008) for sx, sy, z in shape]
    bowl = loft([*outside, *_basin(bowl_l, bowl_w, back + 0.008)])
    parts = [Part("Bowl", bowl, "ceramic", collider="convexHull")]
    parts += (
        _washlet_seat(bowl_l, bowl_w, back) if kind == "washlet" else _seat(bowl_l, bowl_w, back)
    )
    make = {"framed": _frame, "classic": _moulded_cistern}.get(kind, _cistern)
    return (*parts, *make(size_m, tank_w))


def _basin(length: float, width: float, back: float) -> list[FloatArray]:
    """Rings from the inner edge of a bowl's rim down to its floor; backwards, as the bowl goes."""
    long, deep = length - 0.1, width - 0.155
    middle = back - 0.09 - deep / 2
    rings = []
    for share, shift, z in _BASIN:
        half = share * deep / 2
        rings.append(_egg(share * long, 2 * half, z, middle + shift * width + half))
    return rings


def _seat(length: float, width: float, back: float) -> list[Part]:
    """A seat and its lid, with the shadow between them, on two hinges."""
    long, deep = length * 1.005, width - 0.045
    seat = _seat_ring(long, deep, 0.015, back - 0.036)
    plate = _plate(long * 0.99, deep * 0.99, _SEAT_Z_M + 0.0165, 0.017, back - 0.037, crown=0.006)
    hinge = cylinder(0.011, 0.034, 0.003, 18).moved(length * 0.2, back - 0.022, _SEAT_Z_M - 0.006)
    return [
        Part("Seat", seat, "seat", collider=None),
        moving_part("Lid", [plate], "seat", [lid(plate, opens_deg=_LID_DEG)]),
        Part("Hinges", mirrored_pair(hinge), "metal", collider=None),
    ]


def _washlet_seat(length: float, width: float, back: float) -> list[Part]:
    """A heated seat: its works behind the lid, keys at the side."""
    works_m = 0.13
    levels = ((0.97, 0.0), (1.0, 0.012), (1.0, 0.06), (0.97, 0.085), (0.9, 0.094))
    works = loft(
        [
            ring(length * s, works_m * s, 0.03, _SEAT_Z_M - 0.003 + z, 5)
            + np.array([0.0, back - works_m / 2, 0.0])
            for s, z in levels
        ]
    )
    front = back - works_m + 0.03
    deep = width - works_m - 0.01
    seat = _seat_ring(length * 1.005, deep, 0.02, front)
    plate = _plate(length * 0.985, deep * 0.99, _SEAT_Z_M + 0.021, 0.024, front, crown=0.014)
    buttons = [
        cylinder(0.007, 0.004, 0.001, 12).moved(
            length / 2, back - 0.13 + 0.028 * n, _SEAT_Z_M + 0.049
        )
        for n in range(3)
    ]
    pad = block((0.02, 0.11, 0.03), 0.004).moved(length / 2 - 0.006, back - 0.09, _SEAT_Z_M + 0.018)
    marks = [b.moved(x=-0.006) for b in buttons]
    return [
        Part("Works", works, "seat"),
        Part("Seat", seat, "seat", collider=None),
        _works_lid(plate, back - works_m),
        Part("Pad", pad, "seat", collider=None),
        Part(
            "Hinges",
            joined([m.scaled(1, 1, 1).moved(z=-0.002) for m in marks]),
            "metal",
            collider=None,
        ),
    ]


def _works_lid(plate: Solid, works_y: float) -> Part:
    """A lid that turns about its upper face where it reaches the works, and goes on into them."""
    low, high = plate.bounds_m()
    works_y -= CLEAR_M
    leaf = Leaf("Lid", Hinge((0.0, works_y, float(high[2])), "x", -_LID_DEG), inside="nothing")
    deep = works_y - float(low[1])
    collider = box((float(high[0] - low[0]), deep, float(high[2] - low[2])))
    collider = collider.moved(y=float(low[1]) + deep / 2, z=float(low[2]))
    return Part("Lid", plate, "seat", moves=(Moving(leaf, plate, (collider,)),))


def _seat_ring(length: float, width: float, thick: float, back: float) -> Solid:
    """A seat with its hole, soft at all edges."""
    soft = thick / 3
    side, front, rear = _SEAT_WIDE_M

    def outer(inset: float, level: float) -> FloatArray:
        z = _SEAT_Z_M - 0.002 + level
        return _egg(length - 2 * inset, width - 2 * inset, z, back - inset)

    def inner(grow: float, level: float) -> FloatArray:
        long, deep = length - 2 * side, width - front - rear
        z = _SEAT_Z_M - 0.002 + level
        return _egg(long + 2 * grow, deep + 2 * grow, z, back - rear + grow)

    edge = ((soft, 0.0), (soft * 0.3, soft * 0.4), (0.0, soft))
    up = [*edge, *((inset, thick - level) for inset, level in reversed(edge))]
    return loft([*(outer(*at) for at in up), *(inner(*at) for at in reversed(up))], loop=True)


def _plate(
    length: float, width: float, z: float, thick: float, back: float, crown: float = 0.0
) -> Solid:
    """A lid: the egg with soft edges, perhaps a little arched."""
    soft = min(0.006, thick / 3)
    rings = []
    for inset, level in (
        (soft, 0.0),
        (soft * 0.3, soft * 0.4),
        (0.0, soft),
        (0.0, thick - soft - crown),
        (soft * 0.3, thick - soft * 0.4 - crown),
        (soft, thick - crown),
    ):
        rings.append(_egg(length - 2 * inset, width - 2 * inset, z + level, back - inset))
    if crown:
        last = rings[-1]
        middle = last.mean(axis=0)
        for share in (0.7, 0.35):
            rings.append((last - middle) * share + middle + [0.0, 0.0, crown * (1.0 - share**2)])
    return loft(rings)


def _cistern(size_m: Size, tank_w: float) -> list[Part]:
    """A tank that widens upwards under a flat lid, two buttons in it."""
    length, width, height = size_m
    y, low, top = width / 2 - tank_w / 2, 0.385, height - 0.034
    levels = (
        (0.9, 0.94, low),
        (0.92, 0.96, low + 0.008),
        (0.96, 0.985, low + 0.16),
        (0.985, 0.99, top),
    )
    tank = loft(
        [ring(length * a, tank_w * b, 0.035, z, 6) + np.array([0.0, y, 0.0]) for a, b, z in levels]
    )
    cover = rounded_slab((length, tank_w, 0.032), 0.036, 0.01, 6, 3).moved(y=y, z=top + 0.002)
    rim = lathe([(0.032, 0), (0.032, 0.004), (0.028, 0.0055), (0, 0.0055)], 26)
    halves = pair(block((0.022, 0.044, 0.003), 0.001).moved(z=0.005), x=0.0115)
    button = joined([rim, *halves]).moved(0.0, y, height - 0.0035)
    return [
        Part("Cistern", tank, "ceramic"),
        Part("Cistern_Lid", cover, "ceramic"),
        Part("Flush_Button", button.scaled(1.0, 1.0, 1.0), "metal", collider=None, above=True),
    ]


def _moulded_cistern(size_m: Size, tank_w: float) -> list[Part]:
    """A tank with a profiled lid and a lever at its side."""
    length, width, height = size_m
    y, low, top = width / 2 - tank_w / 2, 0.385, height - 0.06
    levels = (
        (0.86, 0.84, low),
        (0.88, 0.86, low + 0.012),
        (0.9, 0.9, top - 0.01),
        (0.9, 0.9, top + 0.001),
    )
    tank = loft(
        [
            ring(length * a, tank_w * b, 0.02, z, 4)
            + np.array([0.0, y + tank_w * (1 - b) / 2 * 0.9, 0.0])
            for a, b, z in levels
        ]
    )
    lid = (
        (0.91, 0.9, 0.0),
        (0.93, 0.92, 0.006),
        (0.945, 0.94, 0.016),
        (0.99, 0.985, 0.022),
        (1.0, 1.0, 0.026),
        (1.0, 1.0, 0.04),
        (0.97, 0.97, 0.047),
        (0.88, 0.86, 0.055),
        (0.84, 0.8, 0.06),
    )
    cover = loft(
        [
            ring(length * a, tank_w * b, 0.02, top + z, 4) + np.array([0.0, y, 0.0])
            for a, b, z in lid
        ]
    )
    front = y - tank_w * 0.405
    hub = (
        cylinder(0.017, 0.02, 0.003, 20)
        .turned("x", 90)
        .moved(-length * 0.3, front + 0.004, top - 0.06)
    )
    arm = tube(
        [
            [-length * 0.3, front - 0.012, top - 0.06],
            [-length * 0.3 + 0.085, front - 0.016, top - 0.068],
        ],
        0.006,
        10,
    )
    return [
        Part("Cistern", tank, "ceramic"),
        Part("Cistern_Lid", cover, "ceramic"),
        Part("Flush_Lever", hub + arm, "metal", collider=None),
    ]


def _frame(size_m: Size, tank_w: float) -> list[Part]:
    """A panel as high as the piece that hides the cistern, with a plate of two buttons."""
    length, width, height = size_m
    y = width / 2 - tank_w / 2
    panel = block((length, tank_w, height - 0.02), 0.003).moved(y=y)
    cap = block((length, tank_w, 0.02), 0.003).moved(y=y, z=height - 0.02)
    front = width / 2 - tank_w
    plate = (
        rounded_slab((0.23, 0.15, 0.008), 0.006, 0.002, 3)
        .turned("x", 90)
        .moved(0.0, front + 0.001, height - 0.15)
    )
    keys = [
        rounded_slab((wide, 0.1, 0.004), 0.004, 0.001, 3)
        .turned("x", 90)
        .moved(x, front - 0.0055, height - 0.15)
        for wide, x in ((0.115, -0.0365), (0.062, 0.0575))
    ]
    return [
        Part("Cistern", panel, "ceramic"),
        Part("Cistern_Lid", cap, "cap"),
        Part("Flush_Button", joined([plate, *keys]), "metal", collider=None),
    ]
