"""Beds: frame, headboard, mattress, pillows and a duvet with the folds of cloth."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray, frozen_array
from chord_usd.library.cloth.bedding import MATTRESS_INSET_M
from chord_usd.library.cloth.stored import Cloth, stored
from chord_usd.library.cloth.stuffed import Filling, stuffed
from chord_usd.library.kit.joinery import four_legs
from chord_usd.library.kit.model import Collider, Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    cylinder,
    joined,
    lathe,
    pair,
    rounded_profile,
    rounded_slab,
    soft_block,
    tube,
    welded,
)

Bedding = Literal["smooth", "rumpled"]
Base = Literal["rails", "box", "platform", "tubes"]

_TOP_M: dict[str, float] = {"rails": 0.5, "box": 0.52, "platform": 0.42, "tubes": 0.5}
"""Upper side of the mattress."""

_HANG_M: dict[str, float] = {"rails": 0.3, "box": 0.3, "platform": 0.17, "tubes": 0.3}
"""How far the duvet may hang down."""

_MATTRESS_M = 0.22
_DOUBLE_FROM_M = 1.3


def bed(
    size_m: Size, *, board: Headboard, bedding: Bedding, base: Base = "rails", rows: int = 2
) -> tuple[Part, ...]:
    """A bed with its head at the back (+y); length runs across the bed, width along it.

    rows: of pillows, where two sleep.
    """
    length, width, height = size_m
    head, top = THICK_M[board], _TOP_M[base]
    foot = -width / 2 + MATTRESS_INSET_M
    lying = width / 2 - head - foot
    wide = length - 2 * MATTRESS_INSET_M
    mattress = soft_block((wide, lying - 0.01, _MATTRESS_M), 0.05, (4, 4, 1))
    mattress = mattress.moved(y=foot + (lying - 0.01) / 2, z=top - _MATTRESS_M)
    return (
        *_base(base, length, width, head),
        *headboard(board, length, height, width / 2),
        Part("Mattress", mattress, "sheet"),
        *_bedding(bedding, length, foot, top, _HANG_M[base]),
        *_pillows(length, width / 2 - head, top, rows, flat=base == "platform"),
    )


def _base(kind: Base, length: float, width: float, head: float) -> tuple[Part, ...]:
    inset = MATTRESS_INSET_M - 0.027
    wide, deep = length - 2 * inset, width - inset - head
    y = (inset - head) / 2
    if kind == "platform":
        deck = block((length - 0.004, width - head - 0.004, 0.05), 0.004).moved(y=-head / 2, z=0.17)
        foot = block((length - 0.3, width - 0.4, 0.17), 0.003)
        return (Part("Rail", deck, "frame"), Part("Plinth", foot, "leg"))
    if kind == "box":
        body = rounded_slab((wide, deep, 0.26), 0.03, 0.014, 4, 2)
        return (
            *four_legs(wide - 0.08, width - 0.14, 0.06, 0.05, "leg"),
            Part("Rail", body.moved(y=y, z=0.05), "pad"),
        )
    if kind == "tubes":
        sides = pair(block((0.035, deep, 0.045), 0.004).moved(y=y, z=0.235), x=(wide - 0.035) / 2)
        ends = block((wide - 0.06, 0.035, 0.045), 0.004)
        slat, step = block((wide - 0.05, 0.06, 0.018), 0.003), (deep - 0.2) / 9
        slats = [slat.moved(y=y + (i - 4.5) * step, z=0.265) for i in range(10)]
        frame = joined([*sides, ends.moved(y=y - (deep - 0.035) / 2, z=0.235), *slats])
        return (
            *four_legs(wide, width - 0.12, 0.24, 0.034, "frame", is_round=True),
            Part("Rail", frame, "frame"),
        )
    rail = rounded_slab((wide, deep, 0.12), 0.02, 0.008, 4, 2).moved(y=y, z=0.18)
    return (
        *four_legs(wide - 0.03, width - 0.12, 0.19, 0.052, "leg", is_round=True, splay_m=0.012),
        Part("Rail", rail, "frame"),
    )


def _bedding(
    kind: Bedding, length: float, foot: float, top: float, hang: float
) -> tuple[Part, ...]:
    """The duvet and, where it is turned back, its end: as they fell on a bed of their size."""
    simulated = 1.6 if length >= _DOUBLE_FROM_M else 1.0
    name = f"{kind}_{100 * simulated:.0f}"
    parts = []
    for part, slot in (("duvet", "duvet"), ("band", "sheet")):
        if part == "band" and kind != "smooth":
            continue
        cloth = _stretched(stored(f"{part}_{name}"), simulated, length, hang)
        cloth = cloth.moved(y=foot, z=top)
        collider: Collider | None = "boundingCube" if part == "duvet" else None
        parts.append(Part(part.capitalize(), cloth.solid, slot, collider, uvs=cloth.corner_uvs_m()))
    return tuple(parts)


def _stretched(cloth: Cloth, simulated: float, length: float, hang: float) -> Cloth:
    """Wider or narrower in its middle; what hangs keeps its folds and ends within the bed."""
    inner = simulated / 2 - MATTRESS_INSET_M
    more = length / 2 - MATTRESS_INSET_M - inner

    def widened(x: np.ndarray) -> np.ndarray:
        return x + more * np.clip(x / (inner - 0.1), -1.0, 1.0)

    points, uvs = cloth.solid.points_m.copy(), cloth.uvs_m.copy()
    points[:, 0], uvs[:, 0] = widened(points[:, 0]), widened(uvs[:, 0])
    edge = length / 2 - MATTRESS_INSET_M
    room = MATTRESS_INSET_M - 0.002
    out = np.abs(points[:, 0]) - edge
    share = room / max(float(out.max()), 1e-6)
    points[:, 0] = np.sign(points[:, 0]) * (edge + np.where(out > 0.0, out * share, out))
    beyond = -points[:, 1]
    share = room / max(float(beyond.max()), 1e-6)
    points[:, 1] = np.where(beyond > 0.0, -beyond * share, points[:, 1])
    below = -points[:, 2] - 0.03
    share = min((hang - 0.03) / max(float(below.max()), 1e-6), 1.0)
    points[:, 2] = np.where(below > 0.0, -0.03 - below * share, points[:, 2])
    return Cloth(replace(cloth.solid, points_m=frozen_array(points)), frozen_array(uvs))


_PILLOWS = (
    Filling(0.19, 5, 0.018, slump=0.15, seed=11),
    Filling(0.16, 5, 0.022, slump=0.3, chop=0.04, seed=12),
)


def _pillows(
    length: float, head_y: float, top: float, rows: int, *, flat: bool
) -> tuple[Part, ...]:
    """Pillows that lean on the headboard, a second row before them; low beds have one, lying."""
    count = 2 if length >= _DOUBLE_FROM_M else 1
    wide = min(0.72, (length - 0.2) / count - 0.02)
    step = (length - 0.16) / count
    leans = (8.0,) if flat else (64.0, 34.0)[: rows if count == 2 else 1]
    if count == 1 and not flat:
        leans = (36.0,)
    parts = []
    back = head_y
    for row, lean in enumerate(leans):
        pieces = []
        for index in range(count):
            x = (index - (count - 1) / 2) * step
            filling = _PILLOWS[(row + index) % 2]
            pieces.append(_leaning(filling, wide * (1.0 - 0.08 * row), x, back, top, lean, index))
        uvs = np.concatenate([uvs for _, uvs in pieces])
        slot = "pillow" if row == 0 and len(leans) > 1 else "sheet"
        name = "Pillows" if row == 0 else "Front_Pillows"
        parts.append(Part(name, joined([solid for solid, _ in pieces]), slot, None, uvs=uvs))
        back -= 0.17
    return tuple(parts)


def _leaning(
    filling: Filling, wide: float, x: float, back: float, top: float, lean: float, index: int
) -> tuple[Solid, np.ndarray]:
    cloth = stuffed(wide, min(0.68 * wide, 0.48), filling, 16)
    solid = cloth.solid.turned("x", lean).turned("z", (-2.0, 2.6)[index % 2])
    low, high = solid.bounds_m()
    solid = solid.moved(x, back + 0.006 - float(high[1]), top - 0.03 - float(low[2]))
    return solid, cloth.corner_uvs_m()


# Headboards of beds: slats, panels, buttoned and channelled upholstery, metal tubes --------------

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
    made = joined([*(board.moved(y=0.004) for board in boards), ledge])
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
