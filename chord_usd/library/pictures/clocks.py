"""Clocks on walls; backs at +y."""

from __future__ import annotations

from typing import Literal

from chord_usd.library.kit.forms import (
    hollow,
    outward,
    stood_up,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    cylinder,
    joined,
    lathe,
    rounded_slab,
)


def _hand(long_m: float, wide_m: float, hour: float, lift_m: float) -> Solid:
    """A hand of a clock that points to this hour, lying, pivot at the origin."""
    tail = long_m * 0.18
    plate = block((wide_m, long_m + tail, 0.0016), 0.0005).moved(y=(long_m - tail) / 2, z=lift_m)
    return plate.turned("z", -30.0 * hour)


def clock(
    size_m: Size, *, marks: Literal["bars", "dots", "numerals"] = "bars", rim_m: float = 0.016
) -> tuple[Part, ...]:
    """A round clock: rim, dial, marks, hands at ten past ten."""
    radius, width, back = size_m[0] / 2, size_m[1], size_m[1] / 2
    hoop = [
        (radius - 0.002, 0.0),
        (radius, 0.004),
        (radius, width - 0.004),
        (radius - 0.003, width),
        (radius - rim_m + 0.002, width),
        (radius - rim_m, width - 0.004),
        (radius - rim_m, 0.0),
    ]
    face_z = width * 0.6
    dial = cylinder(radius - rim_m + 0.003, face_z, 0.0, 56)
    inner = radius - rim_m
    pieces = []
    for hour in range(12):
        long = inner * (0.16 if hour % 3 == 0 else 0.09)
        if marks == "dots":
            mark = cylinder(inner * (0.035 if hour % 3 == 0 else 0.02), 0.0012, 0.0, 12)
            mark = mark.moved(y=inner * 0.86)
        elif marks == "numerals":
            strokes = (3, 1, 2, 3, 2, 1, 2, 3, 4, 2, 1, 2)[hour]
            bars = [
                block((inner * 0.022, inner * 0.2, 0.0012), 0.0003).moved(
                    inner * 0.05 * (i - (strokes - 1) / 2), inner * 0.8
                )
                for i in range(strokes)
            ]
            mark = joined(bars)
        else:
            mark = block((inner * 0.03, long, 0.0012), 0.0003).moved(y=inner * 0.92 - long / 2)
        pieces.append(mark.turned("z", -30.0 * hour).moved(z=face_z - 0.0004))
    hands = [
        _hand(inner * 0.52, inner * 0.05, 10.17, face_z + 0.002),
        _hand(inner * 0.78, inner * 0.035, 2.0, face_z + 0.0045),
        cylinder(inner * 0.045, 0.008, 0.001, 16).moved(z=face_z - 0.0005),
    ]
    z = size_m[2] / 2
    return (
        Part("Rim", stood_up(outward(lathe(hoop, 56, loop=True)), back, z), "rim", None),
        Part("Dial", stood_up(dial, back, z), "dial", None),
        Part("Marks", stood_up(joined(pieces), back, z), "mark", None),
        Part("Hands", stood_up(joined(hands), back, z), "hand", None),
    )


def open_clock(size_m: Size) -> tuple[Part, ...]:
    """Two iron rings with bars of numerals between them and the wall seen through."""
    radius, width, back = size_m[0] / 2, size_m[1], size_m[1] / 2
    thick = 0.012
    hoops = [hollow([(r, 0.0), (r, thick)], 0.014, 56) for r in (radius, radius * 0.64)]
    bars = []
    for hour in range(12):
        strokes = (3, 1, 2, 3, 2, 1, 2, 3, 4, 2, 1, 2)[hour]
        for i in range(strokes):
            bar = block((0.012, radius * 0.36, 0.008), 0.001)
            bars.append(
                bar.moved(0.024 * (i - (strokes - 1) / 2), radius * 0.81, 0.002).turned(
                    "z", -30.0 * hour
                )
            )
    spokes = [
        block((0.008, radius * 0.6, 0.006), 0.001).moved(y=radius * 0.33, z=0.003).turned("z", a)
        for a in (45, 135, 225, 315)
    ]
    hub = cylinder(0.04, width - 0.008, 0.003, 28)
    hands = [
        _hand(radius * 0.38, 0.016, 10.17, width - 0.011),
        _hand(radius * 0.56, 0.012, 2.0, width - 0.008),
        cylinder(0.012, 0.01, 0.002, 14).moved(z=width - 0.01),
    ]
    z = size_m[2] / 2
    return (
        Part("Rings", stood_up(joined([*hoops, *spokes]), back, z), "rim", None),
        Part("Marks", stood_up(joined(bars), back, z), "rim", None),
        Part("Hub", stood_up(hub, back, z), "rim", None),
        Part("Hands", stood_up(joined(hands), back, z), "hand", None),
    )


def square_clock(size_m: Size) -> tuple[Part, ...]:
    """A square wooden plate with four marks."""
    length, width, height = size_m
    plate = rounded_slab((length, height, width * 0.6), 0.012, 0.004, 5)
    marks = [
        block((0.008, 0.03, 0.0014), 0.0004).moved(y=0.39 * height).turned("z", a)
        for a in (0, 90, 180, 270)
    ]
    face = width * 0.6
    hands = [
        _hand(length * 0.24, 0.012, 10.17, face + 0.003),
        _hand(length * 0.36, 0.008, 2.0, face + 0.006),
        cylinder(0.009, width - face, 0.001, 16).moved(z=face - 0.0003),
    ]
    back, z = width / 2, height / 2
    return (
        Part("Plate", stood_up(plate, back, z), "rim", None),
        Part("Marks", stood_up(joined(marks).moved(z=face - 0.0005), back, z), "hand", None),
        Part("Hands", stood_up(joined(hands), back, z), "hand", None),
    )
