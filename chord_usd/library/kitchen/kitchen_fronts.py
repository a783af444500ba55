"""Doors and drawer fronts of kitchens, floor and wall cabinets alike: four forms, one per kitchen.

bar         flat fronts with long bars
handleless  flat fronts that stop short of a dark channel behind their upper edge
shaker      a frame around a sunk panel, with knobs and cup pulls
slatted     upright slats on a dark ground, opened by the channel
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from chord_usd.library.kit.joinery import FRONT_M, HANDLE_M, Cell, hung, knob
from chord_usd.library.kit.model import Part, moving_part
from chord_usd.library.kit.moves import door, drawer, flap
from chord_usd.library.kit.solids import (
    Solid,
    box,
    cylinder,
    joined,
    loft,
    ring,
)

FrontForm = Literal["bar", "handleless", "shaker", "slatted"]


CHANNEL_M = 0.02
"""Height of the gap into which fingers reach."""

_FALLS_DEG = 88.0

_RAIL_M, _SUNK_M = 0.062, 0.008
_SLAT_M, _SLAT_GAP_M = 0.022, 0.007


def reach_m(form: FrontForm) -> float:
    """How far handles stand out of fronts of this form."""
    return HANDLE_M if form in ("bar", "shaker") else 0.004


def kitchen_fronts(
    face: Sequence[Cell], y_m: float, form: FrontForm, *, drawers: bool = False, low: bool = False,
    name: str = "", falls: bool = False,
) -> tuple[Part, ...]:  # fmt: skip
    """Fronts over these cells, their backs in the plane y_m, with what opens them.

    low: handles at the lower end, as on wall cabinets. falls: they have the handles of drawers and
    fall open about their lower edge. Parts are called Doors or Drawers, or name.
    """
    name = name or ("Drawers" if drawers else "Doors")
    channelled = form in ("handleless", "slatted")
    seen = [_short(cell, low=low) for cell in face] if channelled else list(face)
    panels = [_front(cell, y_m, form) for cell in seen]
    leaves = [
        flap(panel, opens_deg=_FALLS_DEG) if falls
        else drawer(panel) if drawers else door(panel, hung=hung(cell))
        for cell, panel in zip(face, panels, strict=True)
    ]  # fmt: skip
    parts = [moving_part(name, panels, "front", leaves)]
    if channelled:
        strips = [
            box((cell.length_m - 0.004, 0.003, cell.height_m - 0.006)).moved(
                cell.x_m, y_m - 0.0012, cell.z_m + 0.003
            )
            for cell in face
        ]
        return (*parts, moving_part(f"{name}_Channels", strips, "channel", leaves, None))
    grips = [_grip(cell, y_m, form, drawer=drawers or falls, low=low) for cell in face]
    stem = name.removesuffix("s")
    return (*parts, moving_part(f"{stem}_Handles", grips, "handle", leaves, None))


def _short(cell: Cell, *, low: bool) -> Cell:
    """The cell less its channel: at the upper edge, or at the lower one."""
    z_m = cell.z_m + (CHANNEL_M if low else 0.0)
    return Cell(cell.x_m, z_m, cell.length_m, cell.height_m - CHANNEL_M, cell.column, cell.row)


def _front(cell: Cell, y_m: float, form: FrontForm) -> Solid:
    size = (cell.length_m, cell.height_m)
    if form == "shaker" and min(size) > 0.12:
        rail = min(_RAIL_M, min(size) / 4)
        return upright_panel(cell, y_m, (
            (0.0, 0.0), (0.0, FRONT_M - 0.0015), (0.0015, FRONT_M), (rail - 0.001, FRONT_M),
            (rail + 0.001, FRONT_M - 0.002), (rail + 0.004, FRONT_M - _SUNK_M),
        ))  # fmt: skip
    if form == "slatted":
        return _slats(cell, y_m)
    return upright_panel(cell, y_m, ((0.0, 0.0), (0.0, FRONT_M - 0.0015), (0.0015, FRONT_M)))


def upright_panel(cell: Cell, y_m: float, profile_m: Sequence[tuple[float, float]]) -> Solid:
    """A panel over a cell: (inset, out) pairs from the rim of its back to the field of its face."""
    rings = [
        ring(cell.length_m - 2 * inset, cell.height_m - 2 * inset, 0.0, out, 0)
        for inset, out in profile_m
    ]
    lying = loft(rings)
    return lying.turned("x", 90).moved(cell.x_m, y_m, cell.z_m + cell.height_m / 2)


def _slats(cell: Cell, y_m: float) -> Solid:
    """Upright slats over a thin board."""
    count = max(2, round((cell.length_m + _SLAT_GAP_M) / (_SLAT_M + _SLAT_GAP_M)))
    pitch = (cell.length_m + _SLAT_GAP_M) / count
    slat = box((pitch - _SLAT_GAP_M, FRONT_M - 0.006, cell.height_m))
    slats = [
        slat.moved(
            cell.x_m - cell.length_m / 2 + (pitch - _SLAT_GAP_M) / 2 + pitch * index,
            y_m - 0.006 - (FRONT_M - 0.006) / 2,
            cell.z_m,
        )
        for index in range(count)
    ]
    ground = box((cell.length_m - 0.002, 0.0065, cell.height_m - 0.002))
    return joined([ground.moved(cell.x_m, y_m - 0.00325, cell.z_m + 0.001), *slats])


def _grip(cell: Cell, y_m: float, form: FrontForm, *, drawer: bool, low: bool) -> Solid:
    if drawer:
        reach = min(0.32, cell.length_m * 0.55)
        made = _cup_pull() if form == "shaker" else pull_bar(reach)
        at = 0.5 if form == "shaker" else 1.0 - 0.045 / cell.height_m
        return made.moved(cell.x_m, y_m - FRONT_M, cell.z_m + cell.height_m * max(at, 0.5))
    inner = 1.0 if hung(cell) == "left" else -1.0
    x = cell.x_m + inner * (cell.length_m / 2 - 0.031)
    reach = min(0.26, cell.height_m * 0.5) if form == "bar" else 0.03
    away = 0.05 + reach / 2
    near = cell.z_m + (away if low else cell.height_m - away)
    z = near if cell.height_m < 1.0 else min(max(1.0, cell.z_m + 0.3), near)
    made = knob() if form == "shaker" else pull_bar(reach).turned("y", 90)
    return made.moved(x, y_m - FRONT_M, z)


def pull_bar(reach: float) -> Solid:
    """A straight round bar on two posts, its middle at the origin, towards -y."""
    out = HANDLE_M - 0.006
    bar = cylinder(0.006, reach, 0.001, 10).turned("y", 90).moved(-reach / 2, -out)
    post = cylinder(0.0045, out + 0.002, 0.0, 8).turned("x", 90).moved(y=0.002)
    side = reach / 2 - min(0.03, reach / 6)
    return bar + post.moved(x=side) + post.moved(x=-side)


def _cup_pull() -> Solid:
    """A cup to draw by, rounded above and open below, standing out HANDLE_M towards -y."""
    half_m, high_m, out_m = 0.046, 0.026, HANDLE_M - 0.001
    turn = np.linspace(0.0, math.pi, 11)
    rings = []
    for angle in np.radians((0.0, 25.0, 50.0, 72.0, 88.0)):
        across = half_m * math.cos(0.6 * angle) * np.cos(turn)
        rise = high_m * math.cos(angle) * np.sin(turn)
        out = np.full(len(turn), 0.001 - out_m * math.sin(angle))
        rings.append(np.stack([across, out, rise], axis=-1))
    return loft(rings)
