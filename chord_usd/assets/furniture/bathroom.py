"""Toilets, washbasins, showers, bathtubs."""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np

from chord_usd.assets.furniture.joinery import FRONT_M, HANDLE_M, cells, doors, drawers, plinth
from chord_usd.assets.model import Design, Part
from chord_usd.assets.solids import (
    Size,
    Solid,
    bent_path,
    block,
    box,
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
from chord_usd.types import FloatArray


def _egg(length: float, width: float, z: float, back: float, sides: int = 40) -> FloatArray:
    """An egg-shaped ring: square-ish at the back (ends at y = back), round at the front."""
    angles = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)
    cos, sin = np.cos(angles), np.sin(angles)
    power = np.where(sin > 0.0, 0.55, 1.0)
    x = np.sign(cos) * np.abs(cos) ** np.where(sin > 0.0, 0.6, 1.0) * length / 2
    split = width * 0.4
    y = np.where(sin > 0.0, np.abs(sin) ** power * split, sin * (width - split))
    return np.stack([x, y + back - split, np.full(sides, z)], axis=-1)


def toilet(size_m: Size, *, wall_hung: bool = False) -> tuple[Part, ...]:
    """A toilet: bowl, seat and closed lid, cistern with a button; wall_hung has a slim frame."""
    length, width, height = size_m
    seat_z = 0.4
    back = width / 2
    tank_w = 0.17 if not wall_hung else 0.12
    bowl_w = width - tank_w - 0.01
    bowl_back = back - tank_w + 0.01
    bowl_l = length * (0.95 if not wall_hung else 0.94)
    profile = (
        ((0.62, 0.62, 0.0), (0.6, 0.6, 0.02), (0.58, 0.56, 0.14), (0.74, 0.72, 0.26),
         (0.95, 0.97, 0.35), (1.0, 1.0, 0.385), (0.97, 0.985, 0.395))
        if not wall_hung
        else ((0.5, 0.5, 0.1), (0.72, 0.66, 0.12), (0.9, 0.88, 0.22), (0.98, 0.98, 0.33),
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
    tank_z = 0.38 if not wall_hung else 0.0
    tank = rounded_slab((length, tank_w, height - tank_z - 0.03), 0.03, 0.012, 5, 2)
    cover = rounded_slab((length, tank_w + 0.006, 0.034), 0.03, 0.008, 5, 2)
    button = cylinder(0.026, 0.012, 0.003, 20) if not wall_hung else block((0.2, 0.02, 0.13))
    at = (
        (0.0, back - tank_w / 2, height - 0.009)
        if not wall_hung
        else (0.0, back - tank_w - 0.002, height - 0.2)
    )
    button = button.scaled(z=0.75) if not wall_hung else button
    return (
        Part("Bowl", bowl, "ceramic", collider="convexHull"),
        Part("Seat", seat, "seat", collider=None),
        Part("Lid", lid, "seat"),
        Part("Hinges", hinge, "metal", collider=None),
        Part("Cistern", tank.moved(y=back - tank_w / 2, z=tank_z), "ceramic"),
        Part("Cistern_Lid", cover.moved(y=back - tank_w / 2 - 0.003, z=height - 0.034), "ceramic"),
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
    bowl_l, bowl_w = min(0.5, length / bowls - 0.12), width - 0.2
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
    spout = tube(
        bent_path([[0, 0, rise * 0.7], [0, -0.11, rise * 0.72], [0, -0.12, rise * 0.6]], 0.02),
        0.011,
    )
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
    neck = bent_path([[0, 0, 0.0], [0, 0, rise], [0, -0.14, rise], [0, -0.14, rise - 0.05]], 0.05)
    foot = lathe([(0.024, 0), (0.024, 0.006), (0.016, 0.012), (0, 0.012)], 18)
    lever = tube([[0.0, 0, 0.08], [0.055, 0, 0.095]], 0.006, 8)
    return tube(neck, 0.012, 12) + foot + lever


def _pedestal_basin(size_m: Size) -> tuple[Part, ...]:
    """A ceramic basin on a tapering column."""
    length, width, height = size_m
    body = [
        ring(length * s, width * s, 0.12 * s, height - 0.2 + z, 6)
        for s, z in ((0.45, 0.0), (0.62, 0.02), (0.9, 0.1), (0.985, 0.15), (1.0, 0.18), (0.99, 0.2))
    ]
    inner = [
        ring(length * s, (width - 0.11) * s, 0.11 * s, height + z, 6) - [0.0, 0.03, 0.0]
        for s, z in ((0.9, 0.0), (0.86, -0.012), (0.74, -0.09), (0.45, -0.13), (0.15, -0.14))
    ]
    body = [
        r + [0.0, (1.0 - s) * width * 0.3, 0.0]
        for r, s in zip(body, (0.45, 0.62, 0.9, 0.985, 1.0, 0.99), strict=True)
    ]
    column = [
        ring(l, w, 0.09, z, 6) + [0.0, width * 0.15, 0.0]
        for l, w, z in ((0.22, 0.2, 0.0), (0.2, 0.18, 0.02), (0.15, 0.14, 0.2),
                        (0.15, 0.14, 0.5), (0.2, 0.18, height - 0.17))
    ]  # fmt: skip
    drain = lathe([(0.022, 0), (0.022, 0.005), (0, 0.004)], 20).moved(y=-0.03, z=height - 0.141)
    return (
        Part("Basin", loft([*body, *inner]), "ceramic", collider="none"),
        Part("Column", loft(column), "ceramic"),
        Part("Drain", drain, "metal", collider=None),
        Part("Tap", _basin_tap(0.12).moved(y=width / 2 - 0.06, z=height - 0.004), "metal",
             collider=None, above=True),
    )  # fmt: skip


def shower(
    size_m: Size, *, kind: Literal["walk_in", "cabin", "corner"] = "walk_in"
) -> tuple[Part, ...]:
    """A shower: tray with drain, glass in metal profiles, riser rail with head at the back wall."""
    length, width, height = size_m
    corner = 0.01 if kind != "corner" else 0.0
    tray = _tray(length, width, corner) if kind != "corner" else _quadrant_tray(length, width)
    glass_h = min(2.0, height - 0.06)
    if kind == "walk_in":
        screens, frame = _walk_in(length, width, glass_h)
    elif kind == "cabin":
        screens, frame = _cabin(length, width, glass_h)
    else:
        screens, frame = _quadrant(length, width, glass_h)
    drain = lathe([(0.05, 0), (0.05, 0.006), (0.04, 0.008), (0, 0.008)], 24)
    x = -length * 0.18 if kind == "corner" else 0.0
    drain_y = 0.12 if kind == "corner" else -0.05
    return (
        Part("Tray", tray, "ceramic", collider="none"),
        Part("Drain", drain.moved(x, drain_y, 0.022), "metal", collider=None),
        Part("Glass", screens, "glass", collider="none"),
        Part("Profiles", frame, "metal", collider=None),
        *_riser(x, width / 2, height),
    )


_TRAY_M = 0.07


def _tray(length: float, width: float, corner: float) -> Solid:
    rim = 0.05
    return loft(
        [
            ring(length, width, corner + 0.02, 0.0, 3),
            ring(length, width, corner + 0.02, _TRAY_M - 0.006, 3),
            ring(length - 0.012, width - 0.012, corner + 0.015, _TRAY_M, 3),
            ring(length - 2 * rim, width - 2 * rim, 0.04, _TRAY_M, 3),
            ring(length - 2 * rim - 0.03, width - 2 * rim - 0.03, 0.035, 0.03, 3),
            ring(0.1, 0.1, 0.03, 0.022, 3) - [0.0, 0.05, 0.0],
        ]
    )


def _quadrant_line(length: float, width: float, inset: float) -> FloatArray:
    """(N, 2) counter-clockwise: square at the back left, a quarter round at the front right."""
    half_l, half_w = length / 2 - inset, width / 2 - inset
    radius = 0.62 * min(length, width) - inset
    angles = np.radians(np.linspace(-90.0, 0.0, 11))
    arc = np.stack(
        [half_l - radius + radius * np.cos(angles), -half_w + radius + radius * np.sin(angles)], -1
    )
    return np.concatenate([[[-half_l, half_w], [-half_l, -half_w]], arc, [[half_l, half_w]]])


def _quadrant_tray(length: float, width: float) -> Solid:
    levels = ((0.0, 0.0), (0.0, _TRAY_M - 0.006), (0.006, _TRAY_M), (0.05, _TRAY_M), (0.065, 0.03))
    rings = [
        np.column_stack([line, np.full(len(line), z)])
        for inset, z in levels
        for line in [_quadrant_line(length, width, inset)]
    ]
    middle = rings[-1].mean(axis=0)
    rings.append((rings[-1] - middle) * [0.1, 0.1, 1.0] + middle - [0.0, 0.0, 0.006])
    return loft(rings)


def _pane(length: float, x: float, y: float, height: float, *, sideways: bool = False) -> Solid:
    size = (0.008, length, height) if sideways else (length, 0.008, height)
    return box(size).moved(x, y, _TRAY_M - 0.004)


def _walk_in(length: float, width: float, height: float) -> tuple[Solid, Solid]:
    """One fixed screen over two thirds of the front and one along the right side."""
    wide, y = length * 0.62, -width / 2 + 0.025
    front_x, side_x = (length - wide) / 2 - 0.02, length / 2 - 0.025
    panes = _pane(wide, front_x, y, height) + _pane(
        width - 0.05, side_x, 0.0, height, sideways=True
    )
    post = block((0.02, 0.02, height + 0.004), 0.002)
    posts = [
        post.moved(side_x, y, _TRAY_M - 0.004),
        post.moved(side_x, width / 2 - 0.012, _TRAY_M - 0.004),
        post.moved(front_x - wide / 2, y, _TRAY_M - 0.004),
    ]
    z = _TRAY_M + height - 0.02
    left = front_x - wide / 2
    posts += [
        tube([[left, y, z], [left, width / 2 - 0.002, z]], 0.009, 8),
        block((wide, 0.016, 0.016), 0.002).moved(front_x, y, _TRAY_M - 0.006),
        block((0.016, width - 0.05, 0.016), 0.002).moved(side_x, 0.0, _TRAY_M - 0.006),
    ]
    return panes, joined(posts)  # fmt: skip


def _cabin(length: float, width: float, height: float) -> tuple[Solid, Solid]:
    """Glass on the front and both sides, a sliding door with a grip, rails top and bottom."""
    y, side_x = -width / 2 + 0.025, length / 2 - 0.025
    half = (length - 0.05) / 2
    panes = [
        _pane(half + 0.02, -half / 2, y, height),
        _pane(half + 0.02, half / 2, y + 0.02, height),
        _pane(width - 0.05, side_x, 0.0, height, sideways=True),
        _pane(width - 0.05, -side_x, 0.0, height, sideways=True),
    ]
    post = block((0.028, 0.028, height + 0.01), 0.003)
    frame = [
        mirrored_pair(post.moved(side_x, at, _TRAY_M - 0.005)) for at in (y, width / 2 - 0.016)
    ]
    for z in (_TRAY_M - 0.006, _TRAY_M + height - 0.025):
        frame.append(block((length - 0.05, 0.045, 0.03), 0.003).moved(y=y + 0.01, z=z))
        frame.append(
            mirrored_pair(block((0.026, width - 0.06, 0.028), 0.003).moved(side_x, 0, z + 0.001))
        )
    grip = bent_path([[0, 0, 0.85], [0, -0.022, 0.85], [0, -0.022, 1.25], [0, 0, 1.25]], 0.02, 2)
    frame.append(tube(grip, 0.006, 8).moved(0.02, y - 0.002))
    return joined(panes), joined(frame)


def _quadrant(length: float, width: float, height: float) -> tuple[Solid, Solid]:
    """Curved glass over the round corner."""
    line = _quadrant_line(length, width, 0.025)[1:]
    inner = _quadrant_line(length, width, 0.033)[1:]
    glass = extruded(np.concatenate([line, inner[::-1]]), height).moved(z=_TRAY_M - 0.004)
    outer, inmost = (
        _quadrant_line(length, width, 0.014)[1:],
        _quadrant_line(length, width, 0.044)[1:],
    )
    strip = extruded(np.concatenate([outer, inmost[::-1]]), 0.028)
    post = block((0.026, 0.026, height), 0.003)
    frame = [
        strip.moved(z=_TRAY_M - 0.006),
        strip.moved(z=_TRAY_M + height - 0.026),
        post.moved(*line[0], _TRAY_M),
        post.moved(line[-1, 0], line[-1, 1] + 0.012, _TRAY_M),
    ]
    middle = line[6] * 1.02
    grip = tube([[*middle, 0.85], [*middle, 1.25]], 0.008, 8)
    return glass, joined([*frame, grip])


def _riser(x: float, back: float, height: float) -> tuple[Part, ...]:
    """Mixer, riser and a large overhead rose, fixed to the back wall."""
    y = back - 0.05
    riser = bent_path([[x, y, 1.05], [x, y, height - 0.06], [x, y - 0.3, height - 0.06]], 0.06, 5)
    arm_end = y - 0.3
    rose = lathe([(0.11, 0), (0.115, 0.006), (0.11, 0.012), (0.02, 0.02), (0.012, 0.05)], 32)
    mixer = cylinder(0.022, 0.26, 0.004, 16).turned("y", 90).moved(x - 0.13, y, 1.05)
    holds = [
        cylinder(0.012, 0.05, 0, 12).turned("x", -90).moved(x + dx, y, z)
        for dx, z in ((-0.075, 1.05), (0.075, 1.05), (0.0, 1.75))
    ]
    hand = tube([[x + 0.07, y - 0.02, 1.35], [x + 0.07, y - 0.06, 1.58]], 0.013, 10)
    hose = bent_path(
        [[x + 0.07, y - 0.02, 1.36], [x + 0.15, y, 0.75], [x - 0.02, y, 0.72], [x, y, 1.04]], 0.12
    )
    crown = cylinder(0.012, 0.02, 0, 12).moved(x, arm_end, height - 0.066)
    return (
        Part("Riser", tube(riser, 0.011, 10) + joined(holds), "metal", collider=None),
        Part("Rose", rose.moved(x, arm_end, height - 0.115) + crown.moved(z=0.066 - 0.02), "metal",
             collider=None),
        Part("Mixer", mixer, "metal", collider=None),
        Part("Hand_Shower", hand + tube(hose, 0.006, 8), "metal", collider=None),
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
        bent_path([[0, 0, 0], [0, 0, 0.14], [0, -0.15, 0.14], [0, -0.15, 0.1]], 0.04), 0.014, 12
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
_SHOWER = {
    "chrome": {"ceramic": "ceramic", "glass": "glass", "metal": "chrome"},
    "black": {"ceramic": "ceramic", "glass": "glass", "metal": "black_metal"},
    "brass": {"ceramic": "ceramic_grey", "glass": "glass", "metal": "brass"},
}

DESIGNS = (
    Design("Toilet_Compact", "toilet", (0.37, 0.64, 0.78), toilet, _CERAMIC),
    Design("Toilet_Classic", "toilet", (0.41, 0.7, 0.8), toilet, _CERAMIC),
    Design("Toilet_Wall_Frame", "toilet", (0.44, 0.75, 0.85), partial(toilet, wall_hung=True),
           _CERAMIC),
    Design("Washbasin_Pedestal", "washbasin", (0.5, 0.42, 0.85), partial(washbasin,
           kind="pedestal"), _VANITY),
    Design("Washbasin_Drawers", "washbasin", (0.7, 0.47, 0.86), washbasin, _VANITY),
    Design("Washbasin_Vessel", "washbasin", (0.95, 0.5, 0.92), partial(washbasin, kind="vessel"),
           _VANITY),
    Design("Washbasin_Double", "washbasin", (1.2, 0.52, 0.86), washbasin, _VANITY),
    Design("Shower_Quadrant", "shower", (0.85, 0.85, 2.15), partial(shower, kind="corner"),
           _SHOWER),
    Design("Shower_Cabin", "shower", (0.95, 0.9, 2.15), partial(shower, kind="cabin"), _SHOWER),
    Design("Shower_Walk_In", "shower", (1.25, 0.95, 2.15), shower, _SHOWER),
    Design("Bathtub_Short", "bathtub", (1.4, 0.7, 0.55), bathtub, _CERAMIC),
    Design("Bathtub_Built_In", "bathtub", (1.65, 0.75, 0.56), bathtub, _CERAMIC),
    Design("Bathtub_Oval", "bathtub", (1.75, 0.85, 0.58), partial(bathtub, freestanding=True),
           _CERAMIC),
)  # fmt: skip
