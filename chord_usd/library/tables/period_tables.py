"""Tables that distinguish the styles: turned legs, slab ends, welded steel, low thick tops."""

from __future__ import annotations

from chord_usd.library.kit.joinery import four_legs, round_colliders
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    cylinder,
    joined,
    lathe,
    mirrored_pair,
    rounded_profile,
    rounded_slab,
)

_TURNED = (
    (0.30, 0.0), (0.38, 0.01), (0.36, 0.06), (0.22, 0.09), (0.34, 0.12), (0.24, 0.15), (0.30, 0.3),
    (0.46, 0.55), (0.48, 0.62), (0.30, 0.7), (0.46, 0.72), (0.30, 0.75), (0.44, 0.78), (0.44, 0.8),
)  # fmt: skip
"""Radius and height of a baluster, in widths of the leg and shares of its height."""


def turned_leg(thick_m: float, height_m: float) -> Solid:
    """A leg turned below, square where the apron meets it."""
    profile = [(radius * thick_m, share * height_m) for radius, share in _TURNED]
    square = block((thick_m, thick_m, 0.22 * height_m), 0.004).moved(z=0.78 * height_m)
    return lathe(rounded_profile(profile, 1), 16) + square


def turned_table(
    size_m: Size, *, leg_m: float = 0.075, has_shelf: bool = False
) -> tuple[Part, ...]:
    """A moulded top over a beaded apron on turned legs; perhaps a shelf between them."""
    length, width, height = size_m
    top_m, out = 0.03, 0.035
    tall = height - top_m
    top = rounded_slab((length, width, top_m * 0.6), 0.02, 0.008, 4, 3).moved(z=tall + top_m * 0.4)
    lip = rounded_slab((length - 0.02, width - 0.02, top_m * 0.4 + 0.001), 0.015, 0.005, 4, 2)
    apron_m = min(0.1, tall * 0.2)
    x, y = length / 2 - out - leg_m / 2, width / 2 - out - leg_m / 2
    ends = block((0.022, 2 * y, apron_m - 0.002)).moved(x, z=0.001)
    sides = block((2 * x, 0.022, apron_m)).moved(y=y)
    bead = block((2 * x, 0.008, 0.012), 0.003).moved(y=-y - 0.013)
    rails = joined([mirrored_pair(ends), sides, sides.scaled(y=-1.0), bead])
    leg = turned_leg(leg_m, tall + 0.001)
    places = ((-x, y), (-x, -y), (x, -y), (x, y))
    parts = [
        Part("Top", top + lip.moved(z=tall), "top"),
        Part("Apron", rails.moved(z=tall - apron_m), "leg", collider=None),
        *(Part(f"Leg_{i}", leg.moved(*at), "leg") for i, at in enumerate(places, start=1)),
    ]
    if has_shelf:
        shelf = rounded_slab((2 * x + 0.02, 2 * y + 0.02, 0.02), 0.01, 0.004, 2, 2)
        parts.append(Part("Shelf", shelf.moved(z=0.12 * tall), "top"))
    return tuple(parts)


def panel_table(size_m: Size) -> tuple[Part, ...]:
    """A thin top on two closed slab ends, a beam between them: nothing but planes."""
    length, width, height = size_m
    top_m, end_m = 0.024, 0.045
    tall = height - top_m
    top = rounded_slab((length, width, top_m), 0.004, 0.003, 2, 1).moved(z=tall)
    inset = min(0.2, 0.13 * length)
    end = block((end_m, width - 0.14, tall + 0.001), 0.003).moved(length / 2 - inset)
    beam_m = min(0.1, 0.3 * tall)
    beam = block((length - 2 * inset, 0.03, beam_m)).moved(z=tall - beam_m - 0.001)
    return (
        Part("Top", top, "top"),
        Part("Ends", mirrored_pair(end), "leg", colliders=(end, end.scaled(x=-1.0))),
        Part("Beam", beam, "leg", collider=None),
    )


def steel_table(size_m: Size, *, has_wheels: bool = True) -> tuple[Part, ...]:
    """Old planks in a welded steel frame, above and below; perhaps on iron wheels."""
    length, width, height = size_m
    bar, plank_m, foot = 0.032, 0.04, 0.075 if has_wheels else 0.0
    tall = height - plank_m
    x, y = (length - bar) / 2, (width - bar) / 2
    along = block((length - 0.004, bar, bar), 0.002)
    across = block((bar, width - 2 * bar, bar - 0.002), 0.002).moved(z=0.001)
    hoop = joined(
        [along.moved(y=y - 0.002), along.moved(y=0.002 - y), mirrored_pair(across.moved(x - 0.004))]
    )
    low_z = foot + 0.02
    frame = hoop.moved(z=tall - bar) + hoop.moved(z=low_z)
    upright = block((bar + 0.004, bar + 0.004, tall - foot - 0.001), 0.002).moved(z=foot)
    # It collides as if it stood on its posts.
    stand = block((bar, bar, tall - 0.001))
    px, py = x - 0.002, y - 0.002
    places = ((-px, py), (-px, -py), (px, -py), (px, py))
    parts = [
        Part("Top", _planks(length, width, plank_m).moved(z=tall), "top"),
        Part("Frame", frame, "leg", collider=None),
        *(Part(f"Post_{i}", upright.moved(*at), "leg", colliders=(stand.moved(*at),))
          for i, at in enumerate(places, start=1)),
        Part("Shelf", _planks(length - 2 * bar, width - 2 * bar, 0.024).moved(z=low_z + 0.004),
             "top"),
    ]  # fmt: skip
    if has_wheels:
        tyre = cylinder(foot / 2, 0.024, 0.004, 20).moved(z=-0.012).turned("x", 90)
        wheels = [tyre.moved(0.94 * at_x, 0.94 * at_y, foot / 2) for at_x, at_y in places]
        parts.append(Part("Wheels", joined(wheels), "leg", colliders=tuple(wheels)))
    return tuple(parts)


def _planks(length: float, width: float, thick: float) -> Solid:
    """Boards side by side, hardly a gap between."""
    count = max(2, round(width / 0.16))
    wide = width / count
    board = block((length, wide - 0.002, thick), 0.004)
    return joined([board.moved(y=-width / 2 + wide * (i + 0.5)) for i in range(count)])


def low_slab_table(size_m: Size) -> tuple[Part, ...]:
    """A thick top with soft edges on stout legs that stand well inside."""
    length, width, height = size_m
    top_m = 0.05
    top = rounded_slab((length, width, top_m), 0.05, 0.02, 6, 4).moved(z=height - top_m)
    tall = height - top_m
    rail = block((0.72 * length, 0.03, 0.05), 0.004).moved(z=tall - 0.049)
    return (
        Part("Top", top, "top"),
        *four_legs(0.86 * length, 0.82 * width, tall + 0.002, 0.08),
        Part("Rails", rail.moved(y=0.3 * width) + rail.moved(y=-0.3 * width), "leg", None),
    )


def turned_pedestal(size_m: Size) -> tuple[Part, ...]:
    """A round top with a moulded rim on a baluster with a spreading foot."""
    length, width, height = size_m
    side = min(length, width)
    top = rounded_slab((length, width, 0.028), max(length, width), 0.01, 12, 3)
    top = top.moved(z=height - 0.028)
    foot = 0.32 * side
    profile = [
        (foot, 0.0), (foot, 0.014), (0.8 * foot, 0.03), (0.4 * foot, 0.06), (0.3 * foot, 0.09),
        (0.036, 0.3 * height), (0.05, 0.45 * height), (0.03, 0.62 * height), (0.034, 0.8 * height),
        (0.07, height - 0.05), (0.07, height - 0.026),
    ]  # fmt: skip
    colliders = (
        *round_colliders(cylinder(foot, 0.022)),
        cylinder(0.05, height - 0.05).moved(z=0.02),
    )
    return (
        Part("Top", top, "top", colliders=round_colliders(top)),
        Part("Column", lathe(rounded_profile(profile, 1), 28), "leg", colliders=colliders),
    )
