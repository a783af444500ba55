"""Windows: outer frame, casements with beads and handles, hinges, sills inside and out."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise

from shapely.geometry import Polygon
from shapely.ops import unary_union

from chord_usd.stage.mesh import Face, prism
from chord_usd.stage.opening_shapes import (
    INTO_WALL_M,
    Part,
    Span,
    bar,
    disc,
    glass,
    inset,
    lengthwise,
    rectangle,
    ring,
    spaced,
    upright_prism,
)

_FRAME_M = (0.045, 0.07)
"""Width and depth of the outer frame and of mullions."""

_LAP_M = 0.007
"""How far a casement laps over its frame."""

_SASH_M = (0.055, 0.062)
"""Width and depth of a casement's rails."""

_SASH_PROUD_M = 0.012
"""How far a casement stands out of its frame, into the room."""

_BEAD_M = 0.012
_PANE_M = 0.9
"""Widest casement; wider windows get mullions."""

_HANDLE_FROM_M = 0.45
"""Casements that are lower have no handle."""

_BOARD_M = (0.022, 0.035)
"""Thickness of a window board, and how far it stands out into the room."""

_DRIP_M = (0.03, 0.06)
"""How far the outer sill stands out of the facade, and the fall over its depth."""


def window_parts(span: Span, inside: int, *, has_board: bool) -> list[Part]:
    """Everything that fills a window's hole; inside: 1 where the room lies to +y, or -1."""
    wide = _FRAME_M[0]
    count = max(1, math.ceil((span.right - span.left - wide) / _PANE_M))
    stops = spaced(span.left, span.right - wide, count)
    holes = [rectangle(a + wide, wide, b, span.height - wide) for a, b in pairwise(stops)]
    y = span.middle
    hole = rectangle(span.left, 0.0, span.right, span.height)
    outer = inset(hole, -INTO_WALL_M).difference(unary_union(holes))
    frame = upright_prism(outer, y - _FRAME_M[1] / 2, y + _FRAME_M[1] / 2)
    panes = [inset(one, _SASH_M[0] - _LAP_M) for one in holes]
    parts = [Part("Frame", frame + _sashes(holes, y, inside), "WindowFrame")]
    parts.append(Part("Glass", [face for pane in panes for face in glass(pane, y)], "Glass"))
    if min(one.bounds[3] - one.bounds[1] for one in holes) >= _HANDLE_FROM_M:
        parts.append(Part("Handles", _furniture(holes, y, inside), "Metal"))
    if has_board:
        parts.append(Part("Board", _board(span, inside), "Trim"))
        parts.append(Part("Outer_Sill", _outer_sill(span, inside), "Metal"))
    return parts


def _sashes(holes: Iterable[Polygon], y: float, inside: int) -> list[Face]:
    """Casements that lap over the frame on the room's side, with beads around their glass."""
    near = y + inside * (_FRAME_M[1] / 2 + _SASH_PROUD_M)
    far = near - inside * _SASH_M[1]
    faces = []
    for hole in holes:
        rails = inset(hole, -_LAP_M)
        faces += upright_prism(ring(rails, _SASH_M[0]), far, near)
        pane = inset(rails, _SASH_M[0])
        bead = ring(inset(pane, -0.001), _BEAD_M)
        faces += upright_prism(bead, far + inside * 0.009, near - inside * 0.012)
    return faces


def _furniture(holes: list[Polygon], y: float, inside: int) -> list[Face]:
    """A handle where a casement opens, two hinges at its other side.

    Casements of a pair open from the middle.
    """
    near = y + inside * (_FRAME_M[1] / 2 + _SASH_PROUD_M)
    faces = []
    for index, hole in enumerate(holes):
        left, low, right, high = hole.bounds
        opens_right = index % 2 == 0
        x = right - _SASH_M[0] / 2 + _LAP_M if opens_right else left + _SASH_M[0] / 2 - _LAP_M
        z = min((low + high) / 2, low + 0.75)
        rose = bar((x, z - 0.024), (x, z + 0.024), 0.014)
        faces += upright_prism(rose, near, near + inside * 0.009)
        faces += upright_prism(disc(x, z, 0.009), near + inside * 0.008, near + inside * 0.036)
        lever = bar((x, z + 0.004), (x, z - 0.105), 0.0085)
        faces += upright_prism(lever, near + inside * 0.028, near + inside * 0.041)
        edge = left - _LAP_M - 0.002 if opens_right else right + _LAP_M + 0.002
        at_y = y + inside * (_FRAME_M[1] / 2 + 0.005)
        for at in (low + 0.09, high - 0.09 - 0.07):
            faces += prism(disc(edge, at_y, 0.0075), at, at + 0.07)
    return faces


def _board(span: Span, inside: int) -> list[Face]:
    """A board on the room's side, rounded at its nose by two steps."""
    thickness, proud = _BOARD_M
    room_face = span.back if inside > 0 else span.front
    start, nose = span.middle + inside * 0.02, room_face + inside * proud
    soft = 0.004
    profile = Polygon([
        (start, -INTO_WALL_M), (room_face, -INTO_WALL_M), (room_face, -0.004),
        (nose - inside * soft, -0.004), (nose, soft - 0.004), (nose, thickness - soft),
        (nose - inside * soft, thickness), (start, thickness),
    ])  # fmt: skip
    return lengthwise(profile, span.left - proud, span.right + proud)


def _outer_sill(span: Span, inside: int) -> list[Face]:
    """A sheet that falls to the outside and stands out of the facade."""
    out = -inside
    face = span.front if inside > 0 else span.back
    start, nose = span.middle + out * 0.02, face + out * _DRIP_M[0]
    high, low = 0.03, 0.012
    profile = Polygon([
        (start, -INTO_WALL_M), (start, high), (nose, low), (nose, low - 0.03),
        (nose - out * 0.003, low - 0.03), (nose - out * 0.003, low - 0.004), (face, low - 0.004),
        (face, -INTO_WALL_M),
    ])  # fmt: skip
    return lengthwise(profile, span.left + 0.001, span.right - 0.001)
