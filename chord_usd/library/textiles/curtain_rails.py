"""What curtains hang from: metal rods with finials, flat tracks, wooden poles."""

from __future__ import annotations

from typing import Literal

from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    block,
    circle,
    cylinder,
    joined,
    lathe,
    loft,
    mirrored_pair,
    rounded_profile,
    tube,
)

Finial = Literal["ball", "cap", "urn", "none"]

_RING_EACH_M = 0.11


def rod(size_m: Size, *, finial: Finial, radius_m: float, rings: bool = False) -> tuple[Part, ...]:
    """A rod on brackets with a finial at each end; its middle hangs over the curtains."""
    length, width, height = size_m
    z, y = height / 2, -width / 2 + height / 2
    end = _finial(finial, radius_m, height / 2)
    reach = float(end.bounds_m()[1, 2])
    bar = cylinder(radius_m, length - 2 * reach + 0.004, 0.0, 20).turned("y", 90)
    bar = bar.moved(-length / 2 + reach - 0.002, y, z)
    ends = mirrored_pair(end.turned("y", 90).moved(length / 2 - reach, y, z))
    parts = [
        Part("Rod", bar, "rod", None),
        Part("Finials", ends, "rod", None),
        Part("Brackets", _brackets(length, y, z, width / 2, radius_m, height), "bracket", None),
    ]
    if rings:
        hoop = _ring(radius_m)
        count = min(max(round(length / _RING_EACH_M), 4), 30)
        places = [(i - (count - 1) / 2) * (length - 2 * reach - 0.08) / count for i in range(count)]
        parts.append(Part("Rings", joined([hoop.moved(x, y, z) for x in places]), "rod", None))
    return tuple(parts)


def _ring(radius_m: float) -> Solid:
    inner, outer, half = radius_m * 1.25, radius_m * 1.5, 0.003
    rings = [circle(r, h, 12) for r, h in ((inner, -half), (outer, -half), (outer, half),
                                           (inner, half))]  # fmt: skip
    return loft(rings, loop=True).turned("y", 90)


def _finial(kind: Finial, radius: float, most: float) -> Solid:
    """Turned, standing up on its end."""
    if kind == "ball":
        ball = [(radius * 0.8, 0.0), (radius * 0.8, 0.012), (most * 0.8, 0.02), (most, 0.04),
                (most * 0.8, 0.06), (0.0, 0.068)]  # fmt: skip
        return lathe(rounded_profile(ball, 2), 24)
    if kind == "urn":
        urn = [(radius, 0.0), (most, 0.006), (most, 0.014), (radius * 0.7, 0.022), (most, 0.045),
               (most * 0.9, 0.07), (radius * 0.5, 0.09), (radius * 0.6, 0.098),
               (0.0, 0.105)]  # fmt: skip
        return lathe(rounded_profile(urn, 2), 24)
    return lathe([(most, 0.0), (most, 0.024), (most - 0.003, 0.028), (0.0, 0.028)], 24)


def _brackets(
    length: float, y: float, z: float, back: float, radius: float, height: float
) -> Solid:
    """One near each end, and one in the middle of long rods."""
    plate = block((0.03, 0.006, height - 0.004), 0.002).moved(y=back - 0.003, z=0.002)
    arm = tube(bent_path([[0, back - 0.004, z], [0, y - radius * 0.2, z]], 0.01), 0.006, 10)
    cup = cylinder(radius * 1.25, 0.016, 0.003, 16).moved(z=-0.008).turned("y", 90)
    bracket = plate + arm + cup.moved(y=y, z=z)
    side = length / 2 - min(0.14, 0.12 * length)
    places = [-side, side] if length < 2.0 else [-side, 0.0, side]
    return joined([bracket.moved(x) for x in places])


def track(size_m: Size) -> tuple[Part, ...]:
    """A flat track on the wall, with the gliders that the curtain hangs from."""
    length, width, height = size_m
    deep = 0.034
    y = -width / 2 + deep / 2
    bar = block((length, deep, height), 0.004).moved(y=y)
    foot = block((0.04, width - deep + 0.004, height * 0.4), 0.002).moved(
        y=deep / 2 - 0.002, z=height * 0.45
    )
    side = length / 2 - min(0.14, 0.12 * length)
    places = [-side, side] if length < 2.0 else [-side, 0.0, side]
    return (
        Part("Track", bar, "rod", None),
        Part("Brackets", joined([foot.moved(x) for x in places]), "bracket", None),
    )
