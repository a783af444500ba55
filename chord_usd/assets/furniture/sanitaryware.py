"""Toilets, washbasins, bathtubs."""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np

from chord_usd.assets.furniture.joinery import FRONT_M, HANDLE_M, cells, doors, drawers, plinth
from chord_usd.assets.model import Part, Style, editions, steps
from chord_usd.assets.solids import (
    Size,
    Solid,
    bent_path,
    block,
    cylinder,
    extruded,
    joined,
    lathe,
    loft,
    mirrored_pair,
    ring,
    rounded_slab,
    tube,
)
from chord_usd.scene.types import FloatArray


def _egg(length: float, width: float, z: float, back: float, sides: int = 40) -> FloatArray:
    """An egg-shaped ring: square-ish at the back (ends at y = back), round at the front."""
    angles = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)
    cos, sin = np.cos(angles), np.sin(angles)
    power = np.where(sin > 0.0, 0.55, 1.0)
    x = np.sign(cos) * np.abs(cos) ** np.where(sin > 0.0, 0.6, 1.0) * length / 2
    split = width * 0.4
    y = np.where(sin > 0.0, np.abs(sin) ** power * split, sin * (width - split))
    return np.stack([x, y + back - split, np.full(sides, z)], axis=-1)


def toilet(size_m: Size, *, framed: bool = False) -> tuple[Part, ...]:
    """A toilet: bowl, seat and closed lid, cistern with a button.

    framed hides the cistern in a slim tall frame and skirts the bowl. It stands on its foot all
    the same: not every toilet is drawn right at its wall.
    """
    length, width, height = size_m
    seat_z = 0.4
    back = width / 2
    tank_w = 0.17 if not framed else 0.12
    bowl_w = width - tank_w - 0.01
    bowl_back = back - tank_w + 0.01
    bowl_l = length * (0.95 if not framed else 0.94)
    profile = (
        ((0.62, 0.62, 0.0), (0.6, 0.6, 0.02), (0.58, 0.56, 0.14), (0.74, 0.72, 0.26),
         (0.95, 0.97, 0.35), (1.0, 1.0, 0.385), (0.97, 0.985, 0.395))
        if not framed
        else ((0.8, 0.76, 0.0), (0.82, 0.78, 0.015), (0.84, 0.8, 0.14), (0.92, 0.89, 0.27),
              (1.0, 1.0, 0.385), (0.97, 0.985, 0.395))
    )  # fmt: skip
    bowl = loft([_egg(bowl_l * sx, bowl_w * sy, z, bowl_back) for sx, sy, z in profile])
    seat_l, seat_w = bowl_l * 1.0, bowl_w - 0.01
    seat = _lidded(seat_l, seat_w, seat_z - 0.005, 0.018, bowl_back - 0.035)
    lid = _lidded(seat_l * 0.985, seat_w * 0.985, seat_z + 0.0145, 0.02, bowl_back - 0.038)
    hinge = mirrored_pair(
        cylinder(0.012, 0.05, 0.002, 12)
        .turned("y", 90)
        .moved(0.05, bowl_back - 0.03, seat_z + 0.008)
    )
    tank_z = 0.38 if not framed else 0.0
    tank = rounded_slab((length, tank_w, height - tank_z - 0.03), 0.03, 0.012, 5, 2)
    cover = rounded_slab((length, tank_w + 0.006, 0.034), 0.03, 0.008, 5, 2)
    button = cylinder(0.026, 0.012, 0.003, 20) if not framed else block((0.2, 0.02, 0.13))
    at = (
        (0.0, back - tank_w / 2, height - 0.009)
        if not framed
        else (0.0, back - tank_w - 0.002, height - 0.2)
    )
    button = button.scaled(z=0.75) if not framed else button
    return (
        Part("Bowl", bowl, "ceramic", collider="convexHull"),
        Part("Seat", seat, "seat", collider=None),
        Part("Lid", lid, "seat"),
        Part("Hinges", hinge, "metal", collider=None),
        Part("Cistern", tank.moved(y=back - tank_w / 2, z=tank_z), "ceramic"),
        Part("Cistern_Lid", cover.moved(y=back - tank_w / 2 - 0.003, z=height - 0.036), "ceramic"),
        Part("Flush_Button", button.moved(*at), "metal", collider=None),
    )


def _lidded(length: float, width: float, z: float, thick: float, back: float) -> Solid:
    """A seat or lid: the egg with soft edges."""
    soft = 0.007
    inner, rings = (length - 2 * soft, width - 2 * soft, back - soft), []
    for size, level in (
        (inner, 0.0),
        ((length, width, back), soft),
        ((length, width, back), thick - soft),
        (inner, thick),
    ):
        rings.append(_egg(size[0], size[1], z + level, size[2]))
    return loft(rings)  # fmt: skip


def washbasin(
    size_m: Size, *, kind: Literal["inset", "vessel", "pedestal"] = "inset"
) -> tuple[Part, ...]:
    """A washbasin with its tap: on a drawer unit, as a bowl on a counter, or on a pedestal.

    size_m ends at the rim or, for a vessel, at the rim of the bowl; the tap rises above.
    """
    if kind == "pedestal":
        return _pedestal_basin(size_m)
    if kind == "vessel":
        return _vessel_basin(size_m)
    length, width, height = size_m
    y = -width / 2 + 0.012 + FRONT_M
    base, slab = 0.14, 0.11
    depth = width / 2 - y
    tall = height - base - slab
    case = block((length - 0.02, depth, tall + 0.002)).moved(y=y + depth / 2, z=base)
    rows = (1.0, 1.0)
    columns = 1 if length < 0.95 else 2
    face = list(cells(length - 0.02, tall - 0.004, columns, rows, base + 0.002))
    fronts = drawers(face, y, "none")
    grips = [
        block((min(0.2, c.length_m * 0.5), 0.012, 0.008), 0.001).moved(
            c.x_m, y - FRONT_M - 0.006, c.z_m + c.height_m - 0.03
        )
        for c in face
    ]
    bowls = 1 if length < 1.15 else 2
    places = [(i - (bowls - 1) / 2) * length / bowls for i in range(bowls)]
    bowl_l, bowl_w = min(0.5, length / bowls - 0.12), max(width - 0.2, 0.26)
    taps = joined([_basin_tap(0.15).moved(x, width / 2 - 0.06, height - 0.002) for x in places])
    return (
        Part("Body", case, "body"),
        *fronts,
        Part("Grips", joined(grips), "metal", collider=None),
        *_basin_slab(length, width, height, slab, bowl_l, bowl_w, places),
        Part("Tap", taps, "metal", collider=None, above=True),
        plinth(size_m, base + 0.002, inset_m=0.12),
    )


def _basin_slab(
    length: float,
    width: float,
    height: float,
    slab: float,
    bowl_l: float,
    bowl_w: float,
    places: list[float],
) -> tuple[Part, ...]:
    """A ceramic slab with bowls let in."""
    at_y = -0.035
    outline = ring(length, width, 0.02, 0.0, 3)[:, :2]
    holes = [ring(bowl_l, bowl_w, 0.09, 0.0, 6)[:, :2] + [x, at_y] for x in places]
    plate = extruded(outline, slab, holes).moved(z=height - slab)
    bowls = [_sunk_bowl(bowl_l, bowl_w, slab - 0.004).moved(x, at_y, height) for x in places]
    drains = [
        lathe([(0.022, 0), (0.022, 0.006), (0.016, 0.006), (0, 0.004)], 20).moved(
            x, at_y, height - slab + 0.014
        )
        for x in places
    ]
    return (
        Part("Basin", plate, "ceramic", collider="none"),
        Part("Bowl", joined(bowls), "ceramic", collider=None),
        Part("Drain", joined(drains), "metal", collider=None),
    )


def _sunk_bowl(length: float, width: float, deep: float) -> Solid:
    """A smooth bowl below z = 0; its skin laps into the slab so that no seam shows."""
    outline = [
        (0.06, -deep), (0.004, -deep + 0.03), (-0.003, -0.004), (0.0, -0.001), (0.006, -0.006),
        (0.018, -deep * 0.55), (0.05, -deep + 0.02), (0.11, -deep + 0.012),
    ]  # fmt: skip
    rings = [
        ring(length - 2 * inset, width - 2 * inset, 0.09 - inset * 0.4, z, 6)
        for inset, z in outline
    ]
    return loft(rings)


def _basin_tap(rise: float) -> Solid:
    """A single-lever mixer, spout to the front."""
    body = cylinder(0.022, rise, 0.004, 18)
    reach = [[0, 0, rise * 0.7], [0, -0.11, rise * 0.72], [0, -0.12, rise * 0.6]]
    spout = tube(bent_path(reach, 0.02), 0.011)
    lever = block((0.018, 0.08, 0.008), 0.003).turned("x", -14).moved(y=0.015, z=rise + 0.008)
    return body + spout + lever + cylinder(0.018, 0.02, 0.003, 16).moved(z=rise - 0.004)


def _vessel_basin(size_m: Size) -> tuple[Part, ...]:
    """A round bowl standing on a wooden counter over doors."""
    length, width, height = size_m
    rise, top = 0.12, 0.035
    counter = height - rise
    y, base = -width / 2 + HANDLE_M + FRONT_M, 0.1
    depth = width / 2 - y
    case = block((length - 0.01, depth, counter - top - base + 0.002))
    face = list(cells(length - 0.014, counter - top - base - 0.006, 2, z_m=base + 0.003))
    radius = min(0.21, width / 2 - 0.06)
    bowl = lathe(
        [(0.09, 0), (0.12, 0.006), (radius * 0.9, rise * 0.6), (radius, rise),
         (radius - 0.008, rise), (radius * 0.85, rise * 0.62), (0.1, 0.022), (0.03, 0.016),
         (0.0, 0.016)], 40,
    )  # fmt: skip
    tap_x = -length / 2 + (length / 2 - radius) * 0.55 if length > 0.75 else 0.0
    tap_y = width / 2 - 0.05 if tap_x == 0.0 else 0.08
    mixer = _tall_tap(rise + 0.14)
    mixer = mixer.turned("z", 60) if tap_x < 0.0 else mixer
    return (
        plinth(size_m, base, inset_m=0.1),
        Part("Body", case.moved(y=y + depth / 2, z=base), "body"),
        *doors(face, y, "bar"),
        Part("Counter", block((length, width, top), 0.004).moved(z=counter - top), "counter"),
        Part("Bowl", bowl.moved(y=-0.02, z=counter - 0.001), "ceramic", collider="none"),
        Part("Tap", mixer.moved(tap_x, tap_y, counter - 0.002), "metal", collider=None, above=True),
    )


def _tall_tap(rise: float) -> Solid:
    neck = bent_path(
        [[0.0, 0.0, 0.004], [0.0, 0.0, rise], [0.0, -0.14, rise], [0.0, -0.14, rise - 0.05]], 0.05
    )
    foot = lathe([(0.024, 0), (0.024, 0.006), (0.016, 0.012), (0, 0.012)], 18)
    lever = tube([[0.0, 0, 0.08], [0.055, 0, 0.095]], 0.006, 8)
    return tube(neck, 0.012, 12) + foot + lever


def _pedestal_basin(size_m: Size) -> tuple[Part, ...]:
    """A ceramic basin on a tapering column."""
    length, width, height = size_m
    back = np.array([0.0, width, 0.0])
    outside = ((0.45, 0.0), (0.62, 0.02), (0.9, 0.1), (0.985, 0.15), (1.0, 0.18), (0.99, 0.2))
    body = [
        ring(length * s, width * s, 0.12 * s, height - 0.2 + z, 6) + back * (1.0 - s) * 0.3
        for s, z in outside
    ]
    inside = ((0.9, 0.0), (0.86, -0.012), (0.74, -0.09), (0.45, -0.13), (0.15, -0.14))
    inner = [
        ring(length * s, (width - 0.11) * s, 0.11 * s, height + z, 6) - [0.0, 0.03, 0.0]
        for s, z in inside
    ]
    foot = ((0.22, 0.2, 0.0), (0.2, 0.18, 0.02), (0.15, 0.14, 0.2), (0.15, 0.14, 0.5))
    column = [
        ring(long, deep, 0.09, z, 6) + back * 0.15
        for long, deep, z in (*foot, (0.2, 0.18, height - 0.17))
    ]
    drain = lathe([(0.022, 0), (0.022, 0.005), (0, 0.004)], 20).moved(y=-0.03, z=height - 0.141)
    return (
        Part("Basin", loft([*body, *inner]), "ceramic", collider="none"),
        Part("Column", loft(column), "ceramic"),
        Part("Drain", drain, "metal", collider=None),
        Part("Tap", _basin_tap(0.12).moved(y=width / 2 - 0.06, z=height - 0.004), "metal",
             collider=None, above=True),
    )  # fmt: skip


def bathtub(size_m: Size, *, freestanding: bool = False) -> tuple[Part, ...]:
    """A hollow tub: built-in with an apron, or freestanding and oval. Drain, overflow, taps."""
    length, width, height = size_m
    rim = 0.06 if not freestanding else 0.035
    if freestanding:
        outer = [(0.78, 0.72, 0.0), (0.8, 0.75, 0.03), (0.88, 0.87, 0.5), (0.97, 0.96, 0.9),
                 (1.0, 1.0, 0.98), (0.995, 0.99, 1.0)]  # fmt: skip
        skin = [ring(length * a, width * b, width * b * 0.5, height * z, 9) for a, b, z in outer]
    else:
        skin = [
            ring(length, width, 0.02, 0.0, 9),
            ring(length, width, 0.02, height - 0.03, 9),
            ring(length, width, 0.03, height - 0.008, 9),
            ring(length - 0.016, width - 0.016, 0.03, height, 9),
        ]
    inner_l, inner_w = length - 2 * rim, width - 2 * rim
    corner = min(inner_w / 2, 0.26) if not freestanding else inner_w / 2
    floor = 0.1
    hollow = [
        ring(inner_l, inner_w, corner, height, 9),
        ring(inner_l - 0.016, inner_w - 0.016, corner - 0.01, height - 0.01, 9),
        ring(inner_l * 0.93, inner_w * 0.9, corner * 0.9, height * 0.55, 9),
        ring(inner_l * 0.84, inner_w * 0.8, corner * 0.8, floor + 0.06, 9),
        ring(inner_l * 0.76, inner_w * 0.68, corner * 0.65, floor + 0.01, 9),
        ring(inner_l * 0.5, inner_w * 0.4, corner * 0.4, floor, 9),
    ]
    drain = lathe([(0.028, 0), (0.028, 0.006), (0.02, 0.006), (0, 0.004)], 24)
    overflow = cylinder(0.03, 0.016, 0.004, 24).turned("y", 90)
    tap = _bath_tap().moved(0.0, width / 2 - rim / 2 - 0.012, height - 0.004)
    return (
        Part("Tub", loft([*skin, *hollow]), "ceramic", collider="none"),
        Part("Drain", drain.moved(-inner_l * 0.3, 0, floor + 0.0005), "metal", collider=None),
        Part("Overflow", overflow.moved(-inner_l * 0.475, 0, height * 0.72), "metal",
             collider=None),
        Part("Tap", tap, "metal", collider=None, above=True),
    )  # fmt: skip


def _bath_tap() -> Solid:
    """A spout between two cross handles on the rim at the back."""
    spout = tube(
        bent_path([[0.0, 0, 0], [0.0, 0, 0.14], [0.0, -0.15, 0.14], [0.0, -0.15, 0.1]], 0.04),
        0.014,
        12,
    )
    grip = cylinder(0.018, 0.05, 0.003, 16) + block((0.07, 0.012, 0.012), 0.003).moved(z=0.045)
    return spout + mirrored_pair(grip.moved(0.1))


_CERAMIC = {
    "white": {"ceramic": "ceramic", "seat": "plastic_white", "metal": "chrome"},
    "grey": {"ceramic": "ceramic_grey", "seat": "grey", "metal": "black_metal"},
    "brass": {"ceramic": "ceramic", "seat": "black", "metal": "brass"},
}


def _vanity(body: str, counter: str, metal: str, ceramic: str = "ceramic") -> dict[str, str]:
    return {
        "body": body, "front": body, "counter": counter, "ceramic": ceramic, "metal": metal,
        "handle": metal, "plinth": "graphite",
    }  # fmt: skip


_VANITY = {
    "oak": _vanity("oak", "oak", "chrome"),
    "white": _vanity("white", "walnut", "black_metal"),
    "forest": _vanity("forest", "marble", "brass"),
}
_TOILET = Style("Toilet", toilet, _CERAMIC, 0.8)
_WALL_HUNG = Style("Toilet_Wall_Frame", partial(toilet, framed=True), _CERAMIC, 0.85)
_PEDESTAL = Style("Washbasin_Pedestal", partial(washbasin, kind="pedestal"), _VANITY, 0.85)
_DRAWERS = Style("Washbasin_Drawers", washbasin, _VANITY, 0.86)
_VESSEL = Style("Washbasin_Vessel", partial(washbasin, kind="vessel"), _VANITY, 0.87)
_TUB = Style("Bathtub_Built_In", bathtub, _CERAMIC, 0.56)
_OVAL_TUB = Style("Bathtub_Oval", partial(bathtub, freestanding=True), _CERAMIC, 0.58)

DESIGNS = (
    *editions("toilet", (_TOILET,), (0.37,), (0.52, 0.58)),
    *editions("toilet", (_TOILET, _WALL_HUNG), (0.4,), (0.62, 0.65, 0.69, 0.73, 0.77)),
    *editions("washbasin", (_PEDESTAL,), (0.38, 0.45, 0.52), (0.28, 0.36, 0.44)),
    *editions("washbasin", (_DRAWERS, _VESSEL), steps(0.6, 1.3), (0.42, 0.48, 0.54)),
    *editions("bathtub", (_TUB, _OVAL_TUB), (1.33, 1.42, 1.5, 1.6, 1.7, 1.8), (0.72, 0.8, 0.87)),
)
