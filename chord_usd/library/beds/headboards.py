"""Headboards of beds: slats, panels, buttoned and channelled upholstery, metal tubes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Solid,
    block,
    cylinder,
    joined,
    lathe,
    pair,
    rounded_profile,
    rounded_slab,
    tube,
    welded,
)

Headboard = Literal["spindles", "panel", "frame", "channels", "tufted", "tubes", "low"]

THICK_M: dict[str, float] = {
    "spindles": 0.05, "panel": 0.05, "frame": 0.05, "channels": 0.1, "tufted": 0.11, "tubes": 0.044,
    "low": 0.045,
}  # fmt: skip


def headboard(kind: Headboard, length: float, height: float, back: float) -> tuple[Part, ...]:
    """A headboard of this length and height whose back lies in the plane y = back."""
    thick = THICK_M[kind]
    y = back - thick / 2
    if kind == "spindles":
        return (Part("Headboard", _spindles(length, height, thick).moved(y=y), "frame"),)
    if kind == "panel":
        board = _upright(rounded_slab((length, height - 0.1, thick), 0.05, 0.012, 6, 2))
        return (Part("Headboard", board.moved(y=back, z=0.1), "frame"),)
    if kind == "frame":
        return _framed(length, height, thick, y)
    if kind == "low":
        return _low(length, height, thick, back)
    if kind == "tubes":
        return (Part("Headboard", _tubes(length, height, thick).moved(y=y), "frame"),)
    if kind == "channels":
        return _channels(length, height, thick, y)
    return _tufted(length, height, thick, back)


def _spindles(length: float, height: float, thick: float) -> Solid:
    """Turned bars between two rails, the upper one gently bowed."""
    side = (length - 0.045) / 2
    posts = pair(cylinder(0.021, height - 0.03, 0.006, 14, top_m=0.015), x=side)
    x = np.linspace(-length / 2, length / 2, 15)
    bow = 0.03 * (1 - (2 * x / length) ** 2)
    rail = tube(np.stack([x, 0 * x, height - 0.055 + bow], -1), 0.025, 12)
    low = block((length - 0.04, 0.03, 0.06), 0.006).moved(z=0.4)
    count = max(round(length / 0.11), 6)
    places = [(i - (count - 1) / 2) * (length - 0.14) / (count - 1) for i in range(count)]
    bars = [cylinder(0.009, height - 0.5, 0.0, 10).moved(x=at, z=0.44) for at in places]
    made = joined([*posts, rail, low, *bars])
    return made.scaled(y=thick / float(np.ptp(made.points_m[:, 1])))


def _framed(length: float, height: float, thick: float, y: float) -> tuple[Part, ...]:
    """A board in a frame, upholstered between its stiles."""
    rail = 0.06
    side = (length - rail) / 2
    pieces = pair(block((rail, thick, height), 0.005), x=side)
    pieces += [
        block((length - 2 * rail + 0.004, thick - 0.006, rail), 0.004).moved(z=z)
        for z in (0.3, height - rail - 0.004)
    ]
    pad = _relief_board(
        length - 2 * rail + 0.01, height - 0.42, thick * 0.9, (16, 8), lambda x, z: 0.0 * x
    )
    return (
        Part("Headboard", joined(pieces).moved(y=y), "frame"),
        Part("Pad", pad.moved(y=y + thick * 0.4, z=0.35), "pad", None),
    )


def _low(length: float, height: float, thick: float, back: float) -> tuple[Part, ...]:
    """Broad boards, one above the other, with a ledge on top."""
    rise = (height - 0.12) / 3
    boards = [
        block((length - 0.002, thick - 0.012, rise - 0.004), 0.003).moved(z=0.1 + rise * row)
        for row in range(3)
    ]
    ledge = block((length, thick, 0.024), 0.003).moved(z=height - 0.024)
    made = joined([*(one.moved(y=0.004) for one in boards), ledge])
    return (Part("Headboard", made.moved(y=back - thick / 2), "frame"),)


def _tubes(length: float, height: float, thick: float) -> Solid:
    """A bedstead of tubes with thin bars and ball knobs."""
    radius = thick / 2 * 0.8
    side = length / 2 - thick / 2
    posts = pair(cylinder(radius, height - 0.03, 0.0, 14), x=side)
    ball = [(0.008, 0.0), (thick / 2, 0.012), (thick / 2, 0.026), (0.012, 0.04), (0.0, 0.042)]
    knob = lathe(rounded_profile(ball, 2), 14)
    knobs = pair(knob.moved(z=height - 0.042), x=side)
    heights = ((0.42, 0.011), (height - 0.26, 0.009), (height - 0.1, 0.014))
    rails = [tube([[-side, 0, z], [side, 0, z]], r, 12) for z, r in heights]
    count = max(round(length / 0.14), 6)
    places = [(i - (count - 1) / 2) * (length - 0.2) / (count - 1) for i in range(count)]
    bars = [cylinder(0.007, height - 0.52, 0.0, 8).moved(at, z=0.42) for at in places]
    return joined([*posts, *knobs, *rails, *bars])


def _channels(length: float, height: float, thick: float, y: float) -> tuple[Part, ...]:
    """Upright stuffed channels on a plinth that goes down to the floor."""
    count = max(round(length / 0.17), 5)
    wide = length / count
    pads = [
        rounded_slab((wide - 0.001, thick, height - 0.1), 0.045, 0.018, 4).moved(
            -length / 2 + wide * (i + 0.5), y, 0.1
        )
        for i in range(count)
    ]
    return (Part("Headboard", joined(pads), "pad"),)


def _tufted(length: float, height: float, thick: float, back: float) -> tuple[Part, ...]:
    """Deep buttons in lozenges under an arched top."""
    rise = height - 0.12
    columns = max(2 * round(length / 0.44) + 1, 5)
    dx, dz = length / (columns + 1), 0.14
    buttons = [
        (dx * (c + 1) - length / 2, z)
        for row, z in enumerate(np.arange(rise - 0.16, 0.25, -dz))
        for c in range(columns)
        if (c + row) % 2 == 0
    ]
    at = np.array(buttons)

    def sunk(x: FloatArray, z: FloatArray) -> FloatArray:
        u, v = x[..., None] - at[:, 0], z[..., None] - at[:, 1]
        pit = np.exp(-np.hypot(u, v) / 0.028).max(axis=-1)
        seams = 0.35 * np.exp(-np.abs(np.abs(u) / dx - np.abs(v) / dz) / 0.1)
        near = (np.abs(u) < dx) & (np.abs(v) < dz)
        return -0.034 * np.maximum(pit, np.where(near, seams, 0.0).max(axis=-1))

    cells = (4 * (columns + 1), 18)
    board = _relief_board(length, rise, thick, cells, sunk, arch_m=0.1)
    stud = lathe([(0.012, 0.0), (0.012, 0.004), (0.0, 0.009)], 8).turned("x", 90)
    studs = joined([stud.moved(x, back - thick + 0.032, 0.12 + z) for x, z in buttons])
    return (
        Part("Headboard", board.moved(y=back, z=0.12), "pad"),
        Part("Buttons", studs, "pad", None),
    )


def _relief_board(
    length: float,
    rise: float,
    thick: float,
    cells: tuple[int, int],
    sunk: Callable[[FloatArray, FloatArray], FloatArray],
    arch_m: float = 0.0,
) -> Solid:
    """An upright stuffed board, its back in the plane y = 0; sunk says how far its front gives."""
    columns, rows = cells[0] + 1, cells[1] + 1
    ease = np.linspace(-1.0, 1.0, columns)
    x = length / 2 * np.sin(ease * math.pi / 2) ** 1 * 0.35 + length / 2 * ease * 0.65
    up = np.linspace(0.0, 1.0, rows)
    xx, share = np.meshgrid(x, up)
    top = rise - arch_m * (2 * xx / length) ** 2
    zz = share * top
    edge = np.minimum(length / 2 - np.abs(xx), np.minimum(zz, top - zz))
    round_m = 0.045
    swell = np.sqrt(np.clip(1 - (1 - np.clip(edge / round_m, 0, 1)) ** 2, 0, 1))
    front = -0.35 * thick - 0.65 * thick * swell - sunk(xx, zz) * swell * -1.0
    points = np.stack([xx, front, zz], -1).reshape(-1, 3)
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b = index[:-1, :-1].ravel(), index[:-1, 1:].ravel()
    c, d = index[1:, 1:].ravel(), index[1:, :-1].ravel()
    rim = np.concatenate([index[0], index[1:, -1], index[-1, -2::-1], index[-2:0:-1, 0]])
    behind = points[rim] * [1.0, 0.0, 1.0]
    start = len(points)
    back, following = start + np.arange(len(rim)), start + (np.arange(len(rim)) + 1) % len(rim)
    ahead = np.roll(rim, -1)
    middle = start + len(rim)
    faces = np.concatenate([
        np.stack([a, b, c], -1), np.stack([a, c, d], -1),
        np.stack([rim, following, ahead], -1), np.stack([rim, back, following], -1),
        np.stack([following, back, np.full(len(rim), middle)], -1),
    ])  # fmt: skip
    centre = np.array([[0.0, 0.0, rise / 2]])
    return welded(np.concatenate([points, behind, centre]), faces)


def _upright(plate: Solid) -> Solid:
    """A plate drawn lying down, stood up with its underside to the back and its width rising."""
    lifted = plate.turned("x", 90)
    return lifted.moved(z=-float(lifted.bounds_m()[0, 2]))
