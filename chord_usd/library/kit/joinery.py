"""What a joiner repeats: legs, door and drawer fronts, handles, plinths."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.model import Part, moving_part
from chord_usd.library.kit.moves import Leaf, door, drawer
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    block,
    box,
    cylinder,
    joined,
    lathe,
    tube,
)

FRONT_M = 0.018
"""Thickness of a door or drawer front."""

GAP_M = 0.004
"""Gap between fronts: thin, yet visible as a shadow line."""

HANDLE_M = 0.03
"""How far a bar handle stands out of its front."""

_UPRIGHT_M, _LEAN_BLOCKS = 0.02, 4
"""A leg that leans by more collides as so many blocks."""

_LEAST_COLLIDER_M, _LEAST_CORNER_M = 0.002, 0.02

_RIM_M, _ROUND_BLOCKS = 0.025, (3, 12)
"""Most of a round rim that its colliders leave out, and the least and most number of blocks."""

_Solids = tuple[Solid, ...]
HandleKind = Literal["bar", "knob", "none"]


@dataclass(frozen=True)
class Cell:
    """Where one front goes, seen from the front."""

    x_m: float
    """Centre."""
    z_m: float
    """Lower edge."""
    length_m: float
    height_m: float
    column: int
    row: int


def cells(
    length_m: float, height_m: float, columns: int, rows: Sequence[float] = (1.0,), z_m: float = 0.0
) -> Iterator[Cell]:
    """A grid of fronts over a face, gaps taken off; rows are shares of the height, lowest first."""
    total, low = sum(rows), z_m
    for row, share in enumerate(rows):
        high = low + height_m * share / total
        for column in range(columns):
            wide = length_m / columns
            x = -length_m / 2 + wide * (column + 0.5)
            yield Cell(x, low + GAP_M / 2, wide - GAP_M, high - low - GAP_M, column, row)
        low = high


def shifted(face: Iterable[Cell], x_m: float) -> list[Cell]:
    """The same fronts, moved along the face."""
    return [replace(cell, x_m=cell.x_m + x_m) for cell in face]


def front(cell: Cell, y_m: float, *, framed: bool = False) -> Solid:
    """A door or drawer front whose back lies in the plane y_m; framed gives a shaker door."""
    size = (cell.length_m, FRONT_M, cell.height_m)
    at = {"x": cell.x_m, "y": y_m - FRONT_M / 2, "z": cell.z_m}
    if not framed or min(cell.length_m, cell.height_m) < 0.22:
        return block(size, 0.0025).moved(**at)
    rail, sunk = 0.06, 0.006
    panel = block((cell.length_m - rail, FRONT_M - 2 * sunk, cell.height_m - rail), 0.001)
    stile = block((rail, FRONT_M, cell.height_m), 0.002)
    bar = block((cell.length_m - 2 * rail + 0.002, FRONT_M, rail), 0.002)
    side = (cell.length_m - rail) / 2
    pieces = [
        panel.moved(z=rail / 2),
        stile.moved(x=side),
        stile.moved(x=-side),
        bar,
        bar.moved(z=cell.height_m - rail),
    ]
    return joined(pieces).moved(**at)


def bar_handle(reach_m: float, *, upright: bool) -> Solid:
    """A bow handle, its middle at the origin, standing out HANDLE_M towards -y."""
    out, radius, half = HANDLE_M - 0.005, 0.005, reach_m / 2
    path = [[-half, 0.004, 0], [-half, -out, 0], [half, -out, 0], [half, 0.004, 0]]
    bow = tube(bent_path(path, 0.012, 2), radius, 6)
    return bow.turned("y", 90) if upright else bow


def knob() -> Solid:
    """A turned knob, its foot at the origin, standing out HANDLE_M towards -y."""
    profile = [(0.006, -0.003), (0.006, 0.012), (0.014, 0.02), (0.012, HANDLE_M)]
    return lathe(profile, 12).turned("x", 90)


def hung(cell: Cell) -> Literal["left", "right"]:
    """At which side a door hangs: doors open in pairs, a single last door to the left."""
    return "left" if cell.column % 2 == 0 else "right"


def door_handle(cell: Cell, y_m: float, kind: HandleKind, *, low: bool = False) -> Solid:
    """A handle beside the edge that opens."""
    inner = 1.0 if hung(cell) == "left" else -1.0
    x = cell.x_m + inner * (cell.length_m / 2 - 0.035)
    reach = min(0.16 if cell.height_m < 1.0 else 0.32, cell.height_m * 0.6)
    near = cell.z_m + (cell.height_m - 0.12 - reach / 2 if not low else 0.12 + reach / 2)
    # Tall doors are opened standing up: about elbow height.
    z = near if cell.height_m < 1.0 else min(max(1.0, cell.z_m + 0.3), near)
    made = knob() if kind == "knob" else bar_handle(reach, upright=True)
    return made.moved(x, y_m - FRONT_M, z)


def drawer_handle(cell: Cell, y_m: float, kind: HandleKind) -> Solid:
    """A handle in the middle of a drawer front."""
    made = knob() if kind == "knob" else bar_handle(min(0.16, cell.length_m * 0.5), upright=False)
    return made.moved(cell.x_m, y_m - FRONT_M, cell.z_m + cell.height_m / 2)


def doors(
    face: Sequence[Cell], y_m: float, kind: HandleKind, *, framed: bool = False, low: bool = False
) -> tuple[Part, ...]:
    """Doors over these cells, with their handles; the handles touch the plane y_m - FRONT_M."""
    panels = [front(cell, y_m, framed=framed) for cell in face]
    leaves = [door(panel, hung=hung(cell)) for cell, panel in zip(face, panels, strict=True)]
    parts = (moving_part("Doors", panels, "front", leaves),)
    if kind == "none":
        return parts
    grips = [door_handle(cell, y_m, kind, low=low) for cell in face]
    return (*parts, moving_part("Door_Handles", grips, "handle", leaves, None))


def drawers(
    face: Sequence[Cell], y_m: float, kind: HandleKind, *, framed: bool = False,
    leaf: Callable[[Solid], Leaf] = drawer,
) -> tuple[Part, ...]:  # fmt: skip
    """Drawer fronts over these cells, with their handles; leaf: how one opens."""
    panels = [front(cell, y_m, framed=framed) for cell in face]
    leaves = [leaf(panel) for panel in panels]
    parts = (moving_part("Drawers", panels, "front", leaves),)
    if kind == "none":
        return parts
    grips = [drawer_handle(cell, y_m, kind) for cell in face]
    return (*parts, moving_part("Drawer_Handles", grips, "handle", leaves, None))


def four_legs(
    length_m: float,
    width_m: float,
    height_m: float,
    thick_m: float,
    slot: str = "leg",
    *,
    is_round: bool = False,
    splay_m: float = 0.0,
) -> tuple[Part, ...]:
    """Four legs, each a part of its own so that a chair still fits between their colliders.

    length_m and width_m reach over the feet; splay_m is how far the tops stand further in.
    """
    parts = []
    for index, (sx, sy) in enumerate(((-1, 1), (-1, -1), (1, -1), (1, 1)), start=1):
        foot = np.array([sx * (length_m - thick_m) / 2, sy * (width_m - thick_m) / 2])
        top = foot - np.array([sx, sy]) * splay_m
        if is_round:
            leg = cylinder(thick_m * 0.35, height_m, 0.002, 12, top_m=thick_m / 2)
        else:
            leg = block((thick_m, thick_m, height_m), 0.003)
        lean = leg.points_m.copy()
        share = lean[:, 2:3] / height_m
        lean[:, :2] += (1.0 - share) * foot + share * top
        colliders = _leaning_colliders(foot, top, height_m, thick_m) if splay_m > _UPRIGHT_M else ()
        parts.append(Part(f"Leg_{index}", Solid(lean, leg.faces), slot, colliders=colliders))
    return tuple(parts)


def _leaning_colliders(
    foot: FloatArray, top: FloatArray, height_m: float, thick_m: float
) -> _Solids:
    """Blocks on top of each other along a leaning leg, which collide in its place.

    A box around all of it is as wide as it leans, where legs of chairs go.
    """
    rise_m = height_m / _LEAN_BLOCKS
    brick = box((thick_m, thick_m, rise_m))
    blocks = []
    for index in range(_LEAN_BLOCKS):
        at = foot + (index + 0.5) / _LEAN_BLOCKS * (top - foot)
        blocks.append(brick.moved(float(at[0]), float(at[1]), index * rise_m))
    return tuple(blocks)


def round_colliders(solid: Solid) -> _Solids:
    """Blocks within an upright cylinder around a solid, which collide in its place.

    A box around a round table top has corners that reach to the chairs beside it. The blocks cross,
    and leave out no more of the rim than a cup can stand on; large tops get more of them.
    """
    low, high = solid.bounds_m()
    size, at = high - low, (low + high) / 2
    # Between corners that lie a step apart on the circle, the blocks are half a step short of it.
    steps = math.pi / 4 * float(size[:2].max()) / 2 / _RIM_M
    count = min(max(math.ceil(steps) - 1, _ROUND_BLOCKS[0]), _ROUND_BLOCKS[1])
    blocks = []
    for turn in np.linspace(0.0, math.pi / 2, count + 2)[1:-1]:
        length, width = size[0] * math.cos(turn), size[1] * math.sin(turn)
        within = box((float(length), float(width), float(size[2])))
        blocks.append(within.moved(float(at[0]), float(at[1]), float(low[2])))
    return tuple(blocks)


def colliders_around(plate: Solid, holes: Sequence[FloatArray]) -> _Solids:
    """Blocks around the holes of a plate, which lie in a row along x; they collide in its place.

    holes: (N, 2) outlines; one may reach to the edge. Solvers make a hull of a plate with holes,
    on which small things rock.
    """
    low, high = plate.bounds_m()
    rims = sorted(((hole.min(axis=0), hole.max(axis=0)) for hole in holes), key=lambda r: r[0][0])
    front = min(float(rim[0][1]) for rim in rims)
    back = max(float(rim[1][1]) for rim in rims)
    rights = [*(float(rim[0][0]) for rim in rims), float(high[0])]
    lefts = [float(low[0]), *(float(rim[1][0]) for rim in rims)]
    spans = [(low[0], high[0], low[1], front), (low[0], high[0], back, high[1])]
    spans += [(left, right, front, back) for left, right in zip(lefts, rights, strict=True)]
    spans += [span for hole in holes for span in _round_corners(hole)]
    return tuple(
        box((float(x1 - x0), float(y1 - y0), float(high[2] - low[2]))).moved(
            float(x0 + x1) / 2, float(y0 + y1) / 2, float(low[2])
        )
        for x0, x1, y0, y1 in spans
        if min(x1 - x0, y1 - y0) > _LEAST_COLLIDER_M
    )


def _round_corners(hole: FloatArray) -> Iterator[tuple[float, float, float, float]]:
    """Squares between the round corners of an outline, (N, 2), and the corners of its bounds:
    lowest and highest x, lowest and highest y."""
    low, high = hole.min(axis=0), hole.max(axis=0)
    for x, y in product((low[0], high[0]), (low[1], high[1])):
        side = float(np.abs(hole - (x, y)).max(axis=1).min())
        if side > _LEAST_CORNER_M:
            to_x = x + math.copysign(side, low[0] + high[0] - 2 * x)
            to_y = y + math.copysign(side, low[1] + high[1] - 2 * y)
            yield min(x, to_x), max(x, to_x), min(y, to_y), max(y, to_y)


def plinth(size_m: Size, height_m: float, inset_m: float = 0.05) -> Part:
    """A recessed base under a cabinet of this size."""
    length, width, _ = size_m
    base = block((length - 0.01, width - inset_m - 0.005, height_m), 0.002)
    return Part("Plinth", base.moved(y=inset_m / 2), "plinth")
