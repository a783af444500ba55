"""Leaves of doors: panelled ones, glass doors, entrance doors; levers, keyholes, hinges.

Everything is drawn in the frame of the hinge: origin at its foot, x along the closed leaf.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

from shapely.geometry import Polygon
from shapely.ops import unary_union

from chord_usd.line.stage.shell.mesh import Face, prism
from chord_usd.line.stage.shell.opening_shapes import (
    GAP_M,
    INTO_WALL_M,
    LEAF_M,
    Leaf,
    Part,
    bar,
    disc,
    glass,
    inset,
    rectangle,
    ring,
    upright_prism,
)

LeafKind = Literal["panel", "flush", "glass", "entrance"]

_STILE_M = 0.11
_PANEL_M, _FIELD_M, _MOULDING_M = 0.018, 0.028, 0.03
"""Thickness of a sunk panel, of its raised field, and of the moulding around it."""

_HANDLE_HEIGHT_M = 1.0
_LEVER_M = 0.12
_SPY_HOLE_M = 1.5
_LIGHT_M = 0.12
"""Width of the strip of glass in an entrance door."""


@lru_cache(maxsize=64)
def leaf_parts(leaf: Leaf, *, kind: LeafKind, opens: int) -> tuple[Part, ...]:
    """Meshes of a leaf, in the frame of its hinge. Most doors of a house are of one size.

    opens: 1 where it swings towards +y, else -1: the knuckles of its hinges show there.
    """
    draw = {
        "panel": _panel_leaf,
        "flush": _flush_leaf,
        "glass": _glass_leaf,
        "entrance": _entrance_leaf,
    }[kind]
    hinges = Part("Hinges", _hinges(leaf, opens), "Metal")
    return (*draw(leaf), hinges)


def _whole(leaf: Leaf) -> Polygon:
    return rectangle(leaf.across_m[0], GAP_M, leaf.across_m[1], leaf.height_m)


def _both(profile: Polygon, thick: float) -> list[Face]:
    """A plate in the middle of the leaf."""
    return upright_prism(profile, -thick / 2, thick / 2)


def _panel_leaf(leaf: Leaf) -> list[Part]:
    """Stiles and rails around two sunk panels with mouldings and raised fields."""
    panels: list[Polygon] = []
    if min(leaf.width_m, leaf.height_m / 3) > 3 * _STILE_M:
        left, right = leaf.across_m[0] + _STILE_M, leaf.across_m[1] - _STILE_M
        split = _handle_height_m(leaf)
        panels = [
            rectangle(left, 2 * _STILE_M, right, split - _STILE_M / 2),
            rectangle(left, split + _STILE_M / 2, right, leaf.height_m - _STILE_M),
        ]
    stiles = _both(_whole(leaf).difference(unary_union(panels)), LEAF_M)
    parts = [Part("Stiles", stiles, "Trim")]
    if panels:
        sunk = [face for panel in panels for face in _sunk_panel(panel)]
        parts.append(Part("Panels", sunk, "Trim"))
    return [*parts, Part("Handles", _levers(leaf), "Metal")]


def _flush_leaf(leaf: Leaf) -> list[Part]:
    """One plain board."""
    board = Part("Board", _both(_whole(leaf), LEAF_M), "Trim")
    return [board, Part("Handles", _levers(leaf), "Metal")]


def _sunk_panel(panel: Polygon) -> list[Face]:
    """A thin board, a moulding along its rim, a raised field in it."""
    faces = _both(inset(panel, -INTO_WALL_M), _PANEL_M)
    faces += _both(ring(inset(panel, -0.001), 0.014), _MOULDING_M)
    field = inset(panel, 0.055)
    return faces + _both(field, _FIELD_M - 0.004) + _both(inset(field, 0.012), _FIELD_M)


def _glass_leaf(leaf: Leaf) -> list[Part]:
    across = leaf.across_m
    stile = min(0.075, leaf.width_m / 5)
    pane = rectangle(across[0] + stile, 2 * stile, across[1] - stile, leaf.height_m - stile)
    bars = _both(_whole(leaf).difference(pane), LEAF_M)
    beads = _both(ring(inset(pane, -0.001), 0.013), LEAF_M - 0.016)
    return [
        Part("Stiles", bars + beads, "WindowFrame"),
        Part("Glass", glass(pane, 0.0), "Glass"),
        Part("Handles", _levers(leaf), "Metal"),
    ]


def _entrance_leaf(leaf: Leaf) -> list[Part]:
    """Broad lying boards with a strip of glass beside the lock, a slot for letters."""
    whole = _whole(leaf)
    edge = _edge(leaf)
    light = rectangle(0.0, 0.0, 0.0, 0.0)
    if leaf.width_m > 6 * _LIGHT_M:
        near = edge * (leaf.width_m - 0.17)
        far = near - edge * _LIGHT_M
        light = rectangle(min(near, far), 0.25 * leaf.height_m, max(near, far), 0.9 * leaf.height_m)
    boards = max(3, round(leaf.height_m / 0.34))
    tall = (leaf.height_m - GAP_M) / boards
    grooves = [
        rectangle(leaf.across_m[0] - 1.0, z - 0.004, leaf.across_m[1] + 1.0, z + 0.004)
        for z in (GAP_M + tall * n for n in range(1, boards))
    ]
    core = _both(inset(whole, 0.001).difference(light), LEAF_M - 0.01)
    planks = whole.difference(unary_union([*grooves, light]))
    faces = [
        face
        for side in (-1.0, 1.0)
        for face in upright_prism(planks, side * (LEAF_M / 2 - 0.008), side * LEAF_M / 2)
    ]
    parts = [Part("Boards", core + faces, "EntranceDoor")]
    if light.area > 0.0:
        rim = _both(ring(inset(light, -0.012), 0.018), LEAF_M + 0.006)
        parts += [Part("Glass", glass(light, 0.0), "Glass"), Part("Rim", rim, "Metal")]
    return [*parts, Part("Handles", _levers(leaf) + _fittings(leaf), "Metal")]


def _edge(leaf: Leaf) -> float:
    """1 where the edge that opens lies towards +x."""
    return -1.0 if leaf.hung_right else 1.0


def _handle_height_m(leaf: Leaf) -> float:
    return min(_HANDLE_HEIGHT_M, leaf.height_m / 2)


def _levers(leaf: Leaf) -> list[Face]:
    """A round rose with a lever and a keyhole below, on either side, near the edge that opens."""
    edge, z = _edge(leaf), _handle_height_m(leaf)
    x = edge * (leaf.width_m - 0.055)
    tip = x - edge * _LEVER_M
    plate = disc(x, z - 0.075, 0.024)
    keyhole = disc(x, z - 0.07, 0.0045).union(rectangle(x - 0.002, z - 0.086, x + 0.002, z - 0.07))
    faces = []
    for side in (-1.0, 1.0):
        face = side * LEAF_M / 2
        rose = disc(x, z, 0.026)
        faces += upright_prism(rose, face, face + side * 0.007)
        faces += upright_prism(disc(x, z, 0.0195), face + side * 0.006, face + side * 0.01)
        faces += upright_prism(disc(x, z, 0.0095), face + side * 0.009, face + side * 0.05)
        lever = bar((x, z), (tip, z), 0.0095)
        faces += upright_prism(lever, face + side * 0.041, face + side * 0.058)
        faces += upright_prism(plate.difference(keyhole), face, face + side * 0.006)
    return faces


def _fittings(leaf: Leaf) -> list[Face]:
    """A spy hole at eye height, and a slot for letters below the middle of the leaf."""
    x = sum(leaf.across_m) / 2
    if leaf.height_m < _SPY_HOLE_M + 0.2:
        return []
    slot = bar((x - 0.11, 0.82), (x + 0.11, 0.82), 0.02)
    faces = []
    for side in (-1.0, 1.0):
        face = side * LEAF_M / 2
        faces += upright_prism(disc(x, _SPY_HOLE_M, 0.011), face - side * 0.01, face + side * 0.004)
        faces += upright_prism(slot, face - side * 0.01, face + side * 0.003)
    return faces


def _hinges(leaf: Leaf, opens: int) -> list[Face]:
    """Three knuckles along the hanging edge, on the side to which it opens."""
    x = -_edge(leaf) * 0.0015
    y = opens * (LEAF_M / 2 + 0.004)
    faces = []
    inset_m = min(0.2, leaf.height_m / 4)
    for z in (inset_m, leaf.height_m / 2, leaf.height_m - inset_m - 0.09):
        knuckle = disc(x, y, 0.0075)
        faces += prism(knuckle, z, z + 0.09)
    return faces
