"""Washbasins with what they stand on: drawers, a counter with a bowl, a console, a pedestal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from chord_usd.library.bath.rims import bowl_colliders
from chord_usd.library.bath.taps import (
    BasinTap,
    basin_tap,
    plate_tap,
    tall_basin_tap,
)
from chord_usd.library.kit.joinery import FRONT_M, cells, colliders_around
from chord_usd.library.kit.model import Part, hollow_part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    at_corners,
    block,
    box,
    cylinder,
    extruded,
    joined,
    lathe,
    loft,
    pair,
    ring,
    rounded_profile,
    tube,
)
from chord_usd.library.kitchen.kitchen_fronts import (
    FrontForm,
    kitchen_fronts,
    reach_m,
)

_SLAB_M = 0.045
_BOWL_DEEP_M = 0.115
_PLINTH_M = 0.16
_TWO_BOWLS_FROM_M = 1.15
_TAP_M = 0.078
"""From the back to the middle of a tap: a window board may stand out of the wall behind it."""

VesselKind = Literal["round", "oblong", "stone"]


def _drain(x: float, y: float, z: float) -> Solid:
    """A round waste with a domed plug."""
    return lathe(
        [(0.024, 0), (0.024, 0.003), (0.019, 0.0035), (0.017, 0.0015), (0.015, 0.005), (0, 0.007)],
        22,
    ).moved(x, y, z)


def sunk_bowl(length: float, width: float, deep: float, corner: float) -> Solid:
    """A smooth bowl below z = 0; its skin laps into the slab so that no seam shows."""
    outline = [
        (0.06, -deep - 0.012),
        (0.0, -deep + 0.02),
        (-0.004, -0.004),
        (-0.001, -0.0006),
        (0.004, -0.003),
        (0.011, -0.016),
        (0.017, -0.045),
        (0.026, -deep * 0.66),
        (0.042, -deep * 0.86),
        (0.07, -deep * 0.97),
        (0.12, -deep),
    ]
    rings = [
        ring(length - 2 * inset, width - 2 * inset, max(corner - inset * 0.4, 0.012), z, 6)
        for inset, z in outline
    ]
    return loft(rings)


def _sunk_colliders(length: float, width: float, deep: float, slab: float) -> tuple[Solid, ...]:
    """Of a sunk bowl: what hangs down below a slab."""
    line = ring(length - 0.02, width - 0.02, 0.06, 0.0, 3)[:, :2]
    return bowl_colliders(line, 0.02, -deep - 0.012, -deep, max(-slab, -deep + 0.01))


def _at_each(
    colliders: Sequence[Solid], places: Sequence[float], y: float, z: float
) -> tuple[Solid, ...]:
    return tuple(solid.moved(x, y, z) for x in places for solid in colliders)


def _open_case(length: float, y: float, back: float, low: float, high: float) -> Part:
    """A carcass with a hollow top, where bowls hang down: low box, cheeks, back, front rail."""
    depth, hollow = back - y, _BOWL_DEEP_M + 0.02
    body = block((length, depth, high - low - hollow), 0.0015).moved(y=y + depth / 2, z=low)
    z = high - hollow - 0.001
    cheek = box((0.018, depth - 0.002, hollow + 0.001))
    wall = box((length - 0.03, 0.016, hollow - 0.0005))
    upper = [
        *pair(cheek.moved(y=y + depth / 2, z=z), x=(length - 0.0184) / 2),
        *(wall.moved(y=at, z=z + 0.0006) for at in (y + 0.0095, back - 0.0095)),
    ]
    return Part(
        "Body", joined([body, *upper]), "body", colliders=(body, *upper), hollow=(body,),
        still=joined(upper), still_colliders=tuple(upper),
    )  # fmt: skip


def vanity(
    size_m: Size, *, form: FrontForm = "handleless", tap: BasinTap = "lever"
) -> tuple[Part, ...]:
    """A slab with one or two bowls on a unit of drawers over a foot that stands far back."""
    length, width, height = size_m
    y = -width / 2 + max(reach_m(form), 0.006) + FRONT_M
    top = height - _SLAB_M
    columns = 1 if length < 0.95 else 2
    face = list(
        cells(length - 0.008, top - _PLINTH_M - 0.004, columns, (1.0, 1.0), _PLINTH_M + 0.002)
    )
    bowls = 1 if length < _TWO_BOWLS_FROM_M else 2
    places = [(i - (bowls - 1) / 2) * length / bowls for i in range(bowls)]
    bowl_l, bowl_w = min(0.52, length / bowls - 0.1), max(width - 0.17, 0.25)
    at_y = -0.035
    holes = [ring(bowl_l, bowl_w, 0.07, 0.0, 6)[:, :2] + [x, at_y] for x in places]
    outline = ring(length, width, 0.006, 0.0, 2)[:, :2]
    plate = extruded(outline, _SLAB_M, holes).moved(z=top)
    sunk = [sunk_bowl(bowl_l, bowl_w, _BOWL_DEEP_M, 0.07).moved(x, at_y, height) for x in places]
    colliders = _sunk_colliders(bowl_l, bowl_w, _BOWL_DEEP_M, _SLAB_M)
    drains = [_drain(x, at_y, height - _BOWL_DEEP_M - 0.001) for x in places]
    taps = [basin_tap(tap).moved(x, width / 2 - _TAP_M, height - 0.001) for x in places]
    foot = block((length * 0.86, width - 0.16, _PLINTH_M + 0.002)).moved(y=0.075)
    return (
        _open_case(length - 0.004, y, width / 2 - 0.001, _PLINTH_M, top),
        *kitchen_fronts(face, y, form, drawers=True),
        Part("Basin", plate, "ceramic", colliders=colliders_around(plate, holes)),
        Part("Bowl", joined(sunk), "ceramic", colliders=_at_each(colliders, places, at_y, height)),
        Part("Drain", joined(drains), "metal", collider=None),
        Part("Tap", joined(taps), "metal", collider=None, above=True),
        Part("Plinth", foot, "plinth"),
    )


def _vessel(kind: VesselKind, radius: float, rise: float) -> Solid:
    """A bowl that stands on a counter."""
    if kind == "oblong":
        long, deep = 2 * radius + 0.1, 2 * radius - 0.02
        outline = [
            (0.05, 0.0),
            (0.035, 0.004),
            (0.012, rise * 0.6),
            (0.0, rise - 0.002),
            (0.0015, rise),
            (0.006, rise),
            (0.0085, rise - 0.003),
            (0.02, rise * 0.55),
            (0.045, 0.02),
            (0.1, 0.014),
        ]
        return loft([ring(long - 2 * i, deep - 2 * i, 0.1 - i * 0.5, z, 7) for i, z in outline])
    wall = 0.006 if kind == "round" else 0.018
    outside = [
        (radius * 0.5, 0.0),
        (radius * 0.66, 0.006),
        (radius * 0.9, rise * 0.5),
        (radius, rise),
    ]
    if kind == "stone":
        outside = [
            (radius * 0.9, 0.0),
            (radius * 0.96, 0.006),
            (radius, rise * 0.5),
            (radius * 0.98, rise),
        ]
    inside = [
        (radius - wall, rise + 0.0005),
        (radius * 0.92 - wall, rise * 0.5),
        (radius * 0.62, 0.022),
        (0.03, 0.014),
    ]
    soft = rounded_profile([*outside, *inside], 2)
    return lathe([*soft, (0.0, 0.014)], 44)


def _vessel_colliders(bowl: Solid) -> tuple[Solid, ...]:
    """Its rim and its floor."""
    low, high = bowl.bounds_m()
    length, width, rise = (float(side) for side in high - low)
    inner = ring(length - 0.024, width - 0.024, min(length, width) / 2 - 0.012, 0.0, 5)[:, :2]
    at = low + (high - low) * (0.5, 0.5, 0.0)
    return tuple(solid.moved(*at) for solid in bowl_colliders(inner, 0.024, 0.0, 0.016, rise))


def vessel_unit(
    size_m: Size, *, form: FrontForm = "slatted", kind: VesselKind = "round", wall_tap: bool = False
) -> tuple[Part, ...]:
    """A bowl on a counter over doors, a tall tap behind it or one out of an upright plate."""
    length, width, height = size_m
    rise, top = 0.12, 0.03
    counter = height - rise
    y = -width / 2 + max(reach_m(form), 0.012) + FRONT_M
    base = 0.12
    depth = width / 2 - y
    case = block((length - 0.004, depth - 0.001, counter - top - base + 0.002), 0.0015)
    columns = 2 if length < 1.0 else 4
    face = list(cells(length - 0.008, counter - top - base - 0.006, columns, z_m=base + 0.003))
    radius = min(0.2, width / 2 - 0.07)
    x = 0.0 if length < 0.85 else length * 0.14
    bowl = _vessel(kind, radius, rise).moved(x, -0.035, counter - 0.0005)
    if wall_tap:
        # Taps stand clear of the board of a window beside them.
        tap = plate_tap(rise + 0.1, rise + 0.2).moved(x, width / 2 - 0.04, counter - 0.001)
    else:
        tap = tall_basin_tap(rise + 0.13, bowed=form != "handleless")
        tap = tap.turned("z", 0.0).moved(x, width / 2 - 0.066, counter - 0.001)
    foot = block((length * 0.88, width - 0.12, base + 0.002)).moved(y=0.05)
    drain = _drain(x, -0.035, counter + 0.0125)
    return (
        Part("Plinth", foot, "plinth"),
        hollow_part("Body", case.moved(y=y + depth / 2, z=base)),
        *kitchen_fronts(face, y, form),
        Part("Counter", block((length, width, top), 0.003).moved(z=counter - top), "counter"),
        Part("Bowl", bowl, "vessel", colliders=_vessel_colliders(bowl)),
        Part("Drain", drain, "metal", collider=None),
        Part("Tap", tap, "metal", collider=None, above=True),
    )


def console(size_m: Size) -> tuple[Part, ...]:
    """A thick ceramic basin on a frame of steel, with a board below it."""
    length, width, height = size_m
    slab = 0.12
    leg_m = 0.024
    bowls = 1 if length < _TWO_BOWLS_FROM_M else 2
    places = [(i - (bowls - 1) / 2) * length / bowls for i in range(bowls)]
    bowl_l, bowl_w, at_y = length / bowls - 0.1, max(width - 0.17, 0.25), -0.035
    holes = [ring(bowl_l, bowl_w, 0.03, 0.0, 4)[:, :2] + [x, at_y] for x in places]
    outline = ring(length, width, 0.01, 0.0, 3)[:, :2]
    plate = extruded(outline, slab, holes).moved(z=height - slab)
    sunk = [sunk_bowl(bowl_l, bowl_w, slab - 0.02, 0.03).moved(x, at_y, height) for x in places]
    colliders = _sunk_colliders(bowl_l, bowl_w, slab - 0.02, slab)
    x, y = length / 2 - leg_m / 2 - 0.004, width / 2 - leg_m / 2 - 0.004
    leg = block((leg_m, leg_m, height - slab + 0.001), 0.002)
    frame = at_corners(leg, x, y)
    for z in (0.2, height - slab - 0.03):
        frame += pair(block((2 * x - leg_m + 0.002, 0.02, 0.02), 0.002).moved(z=z), y=y)
        frame += pair(block((0.0198, 2 * y - leg_m + 0.002, 0.0198), 0.002).moved(z=z), x=x)
    board = block((2 * x - leg_m, 2 * y - leg_m, 0.022), 0.002).moved(z=0.2185)
    taps = [basin_tap("cross", 0.15).moved(at, width / 2 - _TAP_M, height - 0.001) for at in places]
    pipe = [
        tube([[at, 0.02, height - slab - 0.005], [at, 0.02, height - slab - 0.13]], 0.016, 12)
        + cylinder(0.03, 0.07, 0.004, 18).moved(at, 0.02, height - slab - 0.19)
        for at in places
    ]
    return (
        Part("Basin", plate, "ceramic", colliders=colliders_around(plate, holes)),
        Part("Bowl", joined(sunk), "ceramic", colliders=_at_each(colliders, places, at_y, height)),
        Part(
            "Drain",
            joined([_drain(at, at_y, height - slab + 0.019) for at in places]),
            "metal",
            collider=None,
        ),
        Part("Frame", joined(frame), "handle", colliders=tuple(frame)),
        Part("Board", board, "counter"),
        Part("Trap", joined(pipe), "metal", collider=None),
        Part("Tap", joined(taps), "metal", collider=None, above=True),
    )


def pedestal_basin(size_m: Size, *, tap: BasinTap = "lever") -> tuple[Part, ...]:
    """A ceramic basin on a column that widens to its foot."""
    length, width, height = size_m
    deep = 0.19
    outside = [
        (0.4, -deep),
        (0.5, -deep + 0.006),
        (0.68, -deep * 0.78),
        (0.86, -deep * 0.5),
        (0.955, -0.07),
        (0.985, -0.045),
        (1.0, -0.03),
        (1.0, -0.008),
        (0.992, 0.0),
    ]
    body = []
    for share, z in outside:
        at = (1.0 - share) * width * 0.42
        body.append(
            ring(length * share, width * share, min(0.16, width * 0.42) * share, height + z, 8)
            + np.array([0.0, at, 0.0])
        )
    inside = [
        (1.0, -0.001),
        (0.985, -0.008),
        (0.94, -0.05),
        (0.84, -0.095),
        (0.6, -0.125),
        (0.25, -0.135),
    ]
    bowl_l, bowl_w = length * 0.84, width * 0.66
    inner = [
        ring(bowl_l * s, bowl_w * s, bowl_w * 0.46 * s, height + z, 8) - [0.0, width * 0.085, 0.0]
        for s, z in inside
    ]
    at = width * 0.16
    column = [
        ring(long, min(long * 0.9, width * 0.6), 0.09, z, 8) + np.array([0.0, at, 0.0])
        for long, z in (
            (0.235, 0.0),
            (0.24, 0.012),
            (0.215, 0.03),
            (0.17, 0.09),
            (0.145, 0.25),
            (0.142, 0.45),
            (0.16, height - deep - 0.06),
            (0.2, height - deep + 0.02),
        )
    ]
    basin = loft([*body, *inner])
    sunk = box((bowl_l, bowl_w, deep - 0.135)).moved(y=-width * 0.085, z=height - deep)
    return (
        Part(
            "Basin",
            basin,
            "ceramic",
            colliders=(*colliders_around(basin, [inner[0][:, :2]]), sunk),
        ),
        Part("Column", loft(column), "ceramic"),
        Part("Drain", _drain(0.0, -width * 0.085, height - 0.1365), "metal", collider=None),
        Part(
            "Tap",
            basin_tap(tap, 0.11).moved(y=width / 2 - _TAP_M, z=height - 0.002),
            "metal",
            collider=None,
            above=True,
        ),
    )
