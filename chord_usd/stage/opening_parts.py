"""What fills the hole of an opening: frames, leaves, glass, linings.

Everything is drawn in the opening's own frame: origin at the centre of its sill, x along the wall,
y across it, z up. Frames reach a little into the wall, so that no two faces coincide where one
could see them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon, box
from shapely.ops import unary_union

from chord_usd.scene.types import Box
from chord_usd.scene.units import rotation_2d
from chord_usd.stage.mesh import Face, cuboid, moved, prism, standing
from chord_usd.stage.railings import railing_box, railing_faces
from chord_usd.stage.walls import Tunnel, lining_faces, sill_faces

PointM = tuple[float, float, float]

_INTO_WALL_M = 0.01
"""How far hidden edges of frames and sills reach into the wall."""

CASING_WIDTH_M = 0.055
"""How far a door's frame covers the wall beside its hole."""

_CASING_M = (0.035, CASING_WIDTH_M)
"""Width of a door frame inside the hole and over the wall beside it."""

_CASING_PROUD_M = 0.012
_GAP_M = 0.003
"""Between leaf and frame."""

_LEAF_M = 0.04
_STILE_M = 0.11
_PANEL_M = 0.022
_TWO_LEAVES_FROM_M = 1.2
_GLASS_M = 0.008
_SASH_M = (0.055, 0.06)
"""Width and depth of a window's frame."""

_PANE_M = 0.9
"""Widest window pane; wider windows get mullions."""

_SILL_M = (0.022, 0.035)
"""Thickness of a window board, and how far it stands out into the room."""

_BOARD_FROM_M = 0.3
"""Windows whose sill is lower have no board."""

_FITTED_FROM_M = 0.25
"""Holes that are narrower or lower stay bare."""

_HANDLE_HEIGHT_M = 1.0


@dataclass(frozen=True, eq=False)
class Part:
    """One mesh of an opening."""

    name: str
    """Prim name below the opening or leaf."""
    faces: Sequence[Face]
    surface: str
    """Row of surfaces.PLAIN_SURFACES, or "Wall" or "Floor" for the look of the room."""


@dataclass(frozen=True)
class Leaf:
    """A part of a door, seen from its hinge: it can swing about its left or right edge."""

    width_m: float
    height_m: float
    hung_right: bool


@dataclass(frozen=True)
class Span:
    """The clear hole in the opening's own frame, metres."""

    left: float
    right: float
    front: float
    """Lowest y: the face of the wall towards -y."""
    back: float
    height: float

    @property
    def is_fitted(self) -> bool:
        """Whether the hole is large enough for a frame with something in it."""
        return min(self.right - self.left, self.height) >= _FITTED_FROM_M


def span_of(tunnel: Tunnel) -> Span:
    """The hole as the opening sees it."""
    corners = np.asarray(tunnel.area_m.exterior.coords)[:-1]
    box_ = tunnel.opening.box
    own = (corners - np.array(box_.center_m[:2])) @ rotation_2d(box_.yaw_deg)
    (left, front), (right, back) = own.min(axis=0), own.max(axis=0)
    return Span(left, right, front, back, tunnel.high_m - tunnel.low_m)


def fixed_parts(tunnel: Tunnel, *, inside: int) -> list[Part]:
    """Linings, frame and glass of an opening, in its own frame; all but the leaves of a door.

    inside: 1 where the owning room lies towards +y, else -1.
    """
    span = span_of(tunnel)
    parts = _linings(tunnel)
    if not span.is_fitted:
        return parts
    if tunnel.opening.kind == "door":
        parts.append(Part("Frame", _casing(span), "Trim"))
    elif tunnel.opening.kind == "window":
        parts += _window(span, None if tunnel.low_m < _BOARD_FROM_M else inside)
    return parts


def railing_parts(tunnel: Tunnel) -> list[Part]:
    """Linings of a gap in a balcony's wall, and its railing, in the gap's own frame."""
    span = span_of(tunnel)
    bars = railing_faces(span.left, span.right, (span.front + span.back) / 2)
    return [*_linings(tunnel), Part("Bars", bars, "Metal")]


def railing_guard(tunnel: Tunnel) -> Box:
    """The box of a railing, in the gap's own frame."""
    span = span_of(tunnel)
    return railing_box(span.left, span.right, (span.front + span.back) / 2)


@lru_cache(maxsize=64)
def leaf_parts(leaf: Leaf, *, glazed: bool) -> tuple[Part, ...]:
    """Meshes of a leaf, in the frame of its hinge. Most doors of a house are of one size."""
    return tuple(_glass_leaf(leaf) if glazed else _panel_leaf(leaf))


def leaf_box(leaf: Leaf) -> Box:
    """The room a leaf takes, in the frame of its hinge."""
    left, right = _across(leaf)
    size_m = (leaf.width_m, _LEAF_M, leaf.height_m - _GAP_M)
    return Box(((left + right) / 2, 0.0, _GAP_M), size_m, 0.0)


def leaves_of(tunnel: Tunnel) -> list[tuple[PointM, Leaf]]:
    """The leaves that fill the frame of a door, closed; two of them in a wide one.

    Each comes with its hinge in the opening's frame, at the bottom.
    """
    span = span_of(tunnel)
    if tunnel.opening.kind != "door" or not span.is_fitted:
        return []
    left = span.left + _CASING_M[0] + _GAP_M
    right = span.right - _CASING_M[0] - _GAP_M
    height = span.height - _CASING_M[0] - 2 * _GAP_M
    middle = (span.front + span.back) / 2
    if right - left < _TWO_LEAVES_FROM_M:
        return [((left, middle, 0.0), Leaf(round(right - left, 4), height, hung_right=False))]
    half = round((right - left - _GAP_M) / 2, 4)
    return [
        ((left, middle, 0.0), Leaf(half, height, hung_right=False)),
        ((right, middle, 0.0), Leaf(half, height, hung_right=True)),
    ]


def _linings(tunnel: Tunnel) -> list[Part]:
    """Jambs, head and sill; at floor height the sill is the threshold and wears the floor."""
    at_floor = tunnel.low_m == 0.0
    return [
        Part("Lining", _own_frame(lining_faces(tunnel), tunnel), "Wall"),
        Part(
            "Threshold" if at_floor else "Sill",
            _own_frame(sill_faces(tunnel), tunnel),
            "Floor" if at_floor else "Wall",
        ),
    ]


def _own_frame(faces: list[Face], tunnel: Tunnel) -> list[Face]:
    turn = rotation_2d(tunnel.opening.box.yaw_deg).T
    x, y = -(turn @ np.array(tunnel.opening.box.center_m[:2]))
    return moved(faces, turn, (x, y, -tunnel.low_m))


def _upright_prism(profile: Polygon, front: float, back: float) -> list[Face]:
    """A solid whose profile is drawn as (x, z) and reaches from y = front to y = back."""
    return standing(prism(profile, -back, -front))


def _casing(span: Span) -> list[Face]:
    inner, outer = _CASING_M
    around = box(span.left - outer, 0.0, span.right + outer, span.height + outer)
    hole = box(span.left + inner, -1.0, span.right - inner, span.height - inner)
    profile = around.difference(hole)
    return _upright_prism(profile, span.front - _CASING_PROUD_M, span.back + _CASING_PROUD_M)


def _panel_leaf(leaf: Leaf) -> list[Part]:
    """Stiles and rails around two recessed panels, with lever handles."""
    across = _across(leaf)
    whole = box(across[0], _GAP_M, across[1], leaf.height_m)
    width = leaf.width_m
    panels = []
    if min(width, leaf.height_m / 3) > 3 * _STILE_M:
        inner = (across[0] + _STILE_M, across[1] - _STILE_M)
        split = _handle_height_m(leaf)
        panels = [
            box(inner[0], 2 * _STILE_M, inner[1], split - _STILE_M / 2),
            box(inner[0], split + _STILE_M / 2, inner[1], leaf.height_m - _STILE_M),
        ]
    stiles = _upright_prism(whole.difference(unary_union(panels)), -_LEAF_M / 2, _LEAF_M / 2)
    parts = [Part("Stiles", stiles, "Trim")]
    if panels:
        fields = [
            face
            for panel in panels
            for face in _upright_prism(
                panel.buffer(_INTO_WALL_M, join_style="mitre"), -_PANEL_M / 2, _PANEL_M / 2
            )
        ]
        parts.append(Part("Panels", fields, "Trim"))
    return [*parts, Part("Handles", _handles(leaf), "Metal")]


def _glass_leaf(leaf: Leaf) -> list[Part]:
    across = _across(leaf)
    stile = min(0.07, leaf.width_m / 5)
    whole = box(across[0], _GAP_M, across[1], leaf.height_m)
    pane = box(across[0] + stile, 2 * stile, across[1] - stile, leaf.height_m - stile)
    bars = _upright_prism(whole.difference(pane), -_LEAF_M / 2, _LEAF_M / 2)
    return [
        Part("Stiles", bars, "WindowFrame"),
        Part("Glass", _glass(pane, 0.0), "Glass"),
        Part("Handles", _handles(leaf), "Metal"),
    ]


def _across(leaf: Leaf) -> tuple[float, float]:
    return (-leaf.width_m, 0.0) if leaf.hung_right else (0.0, leaf.width_m)


def _handle_height_m(leaf: Leaf) -> float:
    return min(_HANDLE_HEIGHT_M, leaf.height_m / 2)


def _handles(leaf: Leaf) -> list[Face]:
    """A rose and a lever on either side, near the edge that opens."""
    towards_edge = -1.0 if leaf.hung_right else 1.0
    x = towards_edge * (leaf.width_m - 0.055)
    z = _handle_height_m(leaf)
    faces = []
    for side in (-1.0, 1.0):
        rose = sorted((side * _LEAF_M / 2, side * (_LEAF_M / 2 + 0.008)))
        neck = sorted((side * (_LEAF_M / 2 + 0.008), side * (_LEAF_M / 2 + 0.045)))
        lever = sorted((side * (_LEAF_M / 2 + 0.045), side * (_LEAF_M / 2 + 0.06)))
        tip = sorted((x + towards_edge * 0.01, x - towards_edge * 0.115))
        faces += cuboid((x - 0.026, rose[0], z - 0.026), (x + 0.026, rose[1], z + 0.026))
        faces += cuboid((x - 0.008, neck[0], z - 0.008), (x + 0.008, neck[1], z + 0.008))
        faces += cuboid((tip[0], lever[0], z - 0.009), (tip[1], lever[1], z + 0.009))
    return faces


def _glass(pane: Polygon, middle: float) -> list[Face]:
    """A pane that reaches into its frame."""
    grown = pane.buffer(_INTO_WALL_M, join_style="mitre")
    return _upright_prism(grown, middle - _GLASS_M / 2, middle + _GLASS_M / 2)


def _window(span: Span, board_side: int | None) -> list[Part]:
    """Frame with mullions in the middle of the wall, panes, and a board on the room's side."""
    width, depth = _SASH_M
    middle = (span.front + span.back) / 2
    count = max(1, math.ceil((span.right - span.left - width) / _PANE_M))
    stops = np.linspace(span.left, span.right - width, count + 1)
    panes = [
        box(first + width, width, last, span.height - width) for first, last in pairwise(stops)
    ]
    grown = box(span.left, 0.0, span.right, span.height).buffer(_INTO_WALL_M, join_style="mitre")
    frame = grown.difference(unary_union(panes))
    glass = [face for pane in panes for face in _glass(pane, middle)]
    bars = _upright_prism(frame, middle - depth / 2, middle + depth / 2)
    parts = [Part("Frame", bars, "WindowFrame"), Part("Glass", glass, "Glass")]
    if board_side is not None:
        parts.append(Part("Board", _window_board(span, board_side, middle), "Trim"))
    return parts


def _window_board(span: Span, inside: int, middle: float) -> list[Face]:
    thickness, proud = _SILL_M
    room_face = span.back if inside > 0 else span.front
    y = sorted((middle + inside * 0.02, room_face + inside * proud))
    return cuboid((span.left - proud, y[0], -_INTO_WALL_M), (span.right + proud, y[1], thickness))


def side_of(point_m: npt.ArrayLike, tunnel: Tunnel) -> int:
    """1 where the point lies towards the opening's own +y, else -1."""
    offset = np.asarray(point_m) - np.array(tunnel.opening.box.center_m[:2])
    return 1 if float(offset @ rotation_2d(tunnel.opening.box.yaw_deg)[:, 1]) > 0 else -1
