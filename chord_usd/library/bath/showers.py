"""Showers: tray, glass, profiles, riser and rose."""

from __future__ import annotations

from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.bath.rims import bowl_colliders
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
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
    tube,
)


def shower(
    size_m: Size, *, kind: Literal["walk_in", "cabin", "corner", "gridded"] = "walk_in"
) -> tuple[Part, ...]:
    """A shower: tray with drain, glass in metal profiles, riser rail with head at the back wall."""
    length, width, height = size_m
    glass_h = min(2.0, height - 0.06)
    if kind == "corner":
        panes, frame = _quadrant(length, width, glass_h)
        tray, line = _quadrant_tray(length, width), _quadrant_line(length, width, 0.0)
    else:
        panes, frame = (
            _cabin(length, width, glass_h)
            if kind == "cabin"
            else _walk_in(length, width, glass_h, gridded=kind == "gridded")
        )
        tray, line = _tray(length, width), ring(length, width, 0.0, 0.0, 0)[:, :2]
    x = -length * 0.18 if kind == "corner" else 0.0
    drain_y = 0.12 if kind == "corner" else -0.05
    rim = lathe([(0.06, 0), (0.06, 0.004), (0.052, 0.006), (0.05, 0.0045), (0, 0.0045)], 32)
    cover = lathe([(0.046, 0.004), (0.046, 0.0075), (0.042, 0.009), (0, 0.009)], 32)
    drain = rim + cover
    return (
        Part("Tray", tray, "ceramic", colliders=_tray_colliders(line)),
        Part("Drain", drain.moved(x, drain_y, 0.022), "metal", collider=None),
        Part("Glass", joined(panes), "glass", colliders=panes),
        Part("Profiles", frame, "metal", collider=None),
        *_riser(x, width / 2, height),
    )


_TRAY_M, _RIM_M = 0.07, 0.05


def _tray_colliders(line: FloatArray) -> tuple[Solid, ...]:
    """Rim and floor of a tray with this outline, (N, 2)."""
    rim = line * (1.0 - _RIM_M / 2 / np.abs(line).max(axis=0))
    return bowl_colliders(rim, _RIM_M, 0.0, 0.03, _TRAY_M)


def _tray(length: float, width: float) -> Solid:
    rim, corner = _RIM_M, 0.01
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


def _walk_in(
    length: float, width: float, height: float, *, gridded: bool = False
) -> tuple[tuple[Solid, ...], Solid]:
    """One fixed screen over two thirds of the front and one along the right side.

    gridded: crossed by slim bars, as windows of workshops are.
    """
    wide, y = length * 0.62, -width / 2 + 0.025
    front_x, side_x = (length - wide) / 2 - 0.02, length / 2 - 0.025
    panes = (
        _pane(wide, front_x, y, height),
        _pane(width - 0.05, side_x, 0.0, height, sideways=True),
    )
    post = block((0.02, 0.02, height + 0.004), 0.002)
    posts = [
        post.moved(side_x, y, _TRAY_M - 0.003),
        post.moved(side_x, width / 2 - 0.012, _TRAY_M - 0.003),
        post.moved(front_x - wide / 2, y, _TRAY_M - 0.003),
    ]
    z = _TRAY_M + height - 0.02
    left = front_x - wide / 2
    posts += [
        tube([[left, y, z], [left, width / 2 - 0.002, z]], 0.009, 8),
        block((wide, 0.016, 0.016), 0.002).moved(front_x, y, _TRAY_M - 0.006),
        block((0.016, width - 0.05, 0.016), 0.002).moved(side_x, 0.0, _TRAY_M - 0.006),
    ]
    if gridded:
        posts += _grid_bars(wide, front_x, y, height)
    return panes, joined(posts)


def _grid_bars(wide: float, x: float, y: float, height: float) -> list[Solid]:
    """Two upright and three lying bars over a screen, and its upper rail."""
    upright = block((0.018, 0.022, height), 0.002)
    lying = block((wide - 0.006, 0.0205, 0.018), 0.002)
    columns = max(2, round(wide / 0.3))
    bars = [
        upright.moved(x - wide / 2 + wide * n / columns, y, _TRAY_M - 0.002)
        for n in range(1, columns)
    ]
    return bars + [
        lying.moved(x, y, _TRAY_M + height * share - 0.019) for share in (0.27, 0.52, 0.77, 1.0)
    ]


def _cabin(length: float, width: float, height: float) -> tuple[tuple[Solid, ...], Solid]:
    """Glass on the front and both sides, a sliding door with a grip, rails top and bottom."""
    y, side_x = -width / 2 + 0.025, length / 2 - 0.025
    half = (length - 0.05) / 2
    panes = (
        _pane(half + 0.02, -half / 2, y, height),
        _pane(half + 0.02, half / 2, y + 0.02, height),
        _pane(width - 0.05, side_x, 0.0, height, sideways=True),
        _pane(width - 0.05, -side_x, 0.0, height, sideways=True),
    )
    post = block((0.028, 0.028, height + 0.007), 0.003)
    frame = [
        mirrored_pair(post.moved(side_x, at, _TRAY_M - 0.0045)) for at in (y, width / 2 - 0.016)
    ]
    for z in (_TRAY_M - 0.006, _TRAY_M + height - 0.025):
        frame.append(block((length - 0.05, 0.045, 0.03), 0.003).moved(y=y + 0.01, z=z))
        frame.append(
            mirrored_pair(block((0.026, width - 0.06, 0.028), 0.003).moved(side_x, 0, z + 0.001))
        )
    grip = bent_path(
        [[0.0, 0.0, 0.85], [0, -0.022, 0.85], [0, -0.022, 1.25], [0, 0, 1.25]], 0.02, 2
    )
    frame.append(tube(grip, 0.006, 8).moved(0.02, y - 0.002))
    return panes, joined(frame)


def _quadrant(length: float, width: float, height: float) -> tuple[tuple[Solid, ...], Solid]:
    """Curved glass over the round corner, in flat panes."""
    line = _quadrant_line(length, width, 0.025)[1:]
    inner = _quadrant_line(length, width, 0.033)[1:]
    panes = tuple(
        extruded(_apart(np.array([*line[n : n + 2], *inner[n : n + 2][::-1]])), height).moved(
            z=_TRAY_M - 0.004
        )
        for n in range(len(line) - 1)
    )
    outer, inmost = (
        _quadrant_line(length, width, 0.014)[1:],
        _quadrant_line(length, width, 0.044)[1:],
    )
    strip = extruded(np.concatenate([outer, inmost[::-1]]), 0.028)
    post = block((0.026, 0.026, height), 0.003)
    frame = [
        strip.moved(z=_TRAY_M - 0.006),
        strip.moved(z=_TRAY_M + height - 0.026),
        post.moved(line[0, 0], line[0, 1], _TRAY_M),
        post.moved(line[-1, 0], line[-1, 1] + 0.012, _TRAY_M),
    ]
    middle = line[6] * 1.02
    grip = tube([[*middle, 0.85], [*middle, 1.25]], 0.008, 8)
    return panes, joined([*frame, grip])


def _apart(pane: FloatArray) -> FloatArray:
    """A pane's outline (4, 2) that shares no point with the next pane's."""
    return pane + (pane[[1, 0, 3, 2]] - pane) * 1e-4


def _riser(x: float, back: float, height: float) -> tuple[Part, ...]:
    """Thermostat, riser with a large overhead rose, a hand shower on its slide."""
    y, top, reach = back - 0.055, height - 0.05, 0.34
    path = [[x, y, 1.08], [x, y, top], [x, y - reach, top]]
    riser = tube(bent_path(path, 0.07, 6), 0.0105, 14)
    holds = [
        cylinder(0.011, 0.055, 0.0, 14).turned("x", -90).moved(x, y, z) for z in (1.32, top - 0.24)
    ]
    plates = [
        cylinder(0.024, 0.008, 0.002, 22).turned("x", 90).moved(x, back - 0.0005, z)
        for z in (1.32, top - 0.24)
    ]
    end = y - reach
    rose = lathe(
        [
            (0.116, 0),
            (0.125, 0.002),
            (0.125, 0.006),
            (0.118, 0.009),
            (0.03, 0.012),
            (0.018, 0.03),
            (0.014, 0.034),
            (0.0105, 0.05),
        ],
        40,
    )
    hand, hose = _hand_shower(x, y)
    return (
        Part("Riser", joined([riser, *holds, *plates]), "metal", collider=None),
        Part("Rose", rose.moved(x, end, top - 0.052), "metal", collider=None),
        Part("Mixer", _thermostat().moved(x, y, 1.06), "metal", collider=None),
        Part("Hand_Shower", hand, "metal", collider=None),
        Part("Hose", hose, "metal", collider=None),
    )


def _thermostat() -> Solid:
    """A bar with a control at either end, its middle at the origin, 0.055 m before the wall."""
    bar = cylinder(0.021, 0.2, 0.003, 24).turned("y", 90).moved(-0.1)
    knob = lathe([(0.0235, 0), (0.0235, 0.03), (0.022, 0.045), (0.018, 0.048), (0, 0.048)], 24)
    tab = block((0.012, 0.006, 0.026), 0.002).moved(0.125, -0.0255, -0.013)
    knobs = mirrored_pair(knob.turned("y", 90).moved(0.102) + tab)
    elbows = mirrored_pair(
        cylinder(0.014, 0.048, 0.0, 16).turned("x", -90).moved(0.075)
        + cylinder(0.031, 0.01, 0.003, 24).turned("x", 90).moved(0.075, 0.0545)
    )
    return joined([bar, knobs, elbows])


def _hand_shower(x: float, y: float) -> tuple[Solid, Solid]:
    """A flat head on its handle in a slide on the riser, and the hose down to the thermostat."""
    z = 1.62
    slide = cylinder(0.019, 0.05, 0.003, 18).moved(x, y, z - 0.025)
    arm = cylinder(0.013, 0.05, 0.002, 16).turned("x", 90).moved(x, y - 0.005, z)
    at_y = y - 0.062
    stem = [[x, at_y + 0.02, z - 0.11], [x, at_y, z], [x, at_y - 0.028, z + 0.1]]
    handle = tube(bent_path(stem, 0.12, 4), 0.0115, 14)
    head = lathe([(0.048, 0), (0.054, 0.004), (0.052, 0.012), (0.03, 0.021), (0, 0.023)], 30)
    head = head.turned("x", -62).moved(x, at_y - 0.062, z + 0.105)
    low = 0.62
    loop = bent_path(
        [
            [x, at_y + 0.02, z - 0.105],
            [x + 0.005, at_y + 0.03, 1.2],
            [x + 0.1, y - 0.005, low + 0.12],
            [x + 0.075, y + 0.005, low],
            [x + 0.03, y + 0.005, low + 0.02],
            [x, y - 0.002, 1.042],
        ],
        0.2,
        5,
    )
    return joined([slide, arm, handle, head]), tube(loop, 0.0065, 10)
