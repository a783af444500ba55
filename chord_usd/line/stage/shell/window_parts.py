"""Windows: outer frame, casements with beads and handles, hinges, sills inside and out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from shapely.geometry import Polygon
from shapely.ops import unary_union

from chord_usd.base.scene.trim import BOARD_M, DRIP_M, HANDLE_M
from chord_usd.base.scene.types import Box
from chord_usd.line.stage.shell.mesh import Face, moved, prism
from chord_usd.line.stage.shell.opening_shapes import (
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


@dataclass(frozen=True, eq=False)
class Sash:
    """A casement that opens into the room, drawn in the frame of its hinge."""

    hinge_m: tuple[float, float, float]
    """The foot of the axis, in the frame of the window."""
    box: Box
    """What it fills, in its own frame."""
    parts: tuple[Part, ...]
    hung_right: bool


def window_parts(span: Span, inside: int, *, has_board: bool) -> list[Part]:
    """What of a window stands still; inside: 1 where the room lies to +y, or -1."""
    y = span.middle
    hole = rectangle(span.left, 0.0, span.right, span.height)
    outer = inset(hole, -INTO_WALL_M).difference(unary_union(_lights(span)))
    frame = upright_prism(outer, y - _FRAME_M[1] / 2, y + _FRAME_M[1] / 2)
    parts = [Part("Frame", frame, "WindowFrame")]
    if has_board:
        parts.append(Part("Board", _board(span, inside), "Trim"))
        parts.append(Part("Outer_Sill", _outer_sill(span, inside), "Metal"))
    return parts


def sashes_of(span: Span, inside: int) -> list[Sash]:
    """The casements of a window, shut; a pair opens from the middle."""
    near = span.middle + inside * (_FRAME_M[1] / 2 + _SASH_PROUD_M)
    far = near - inside * _SASH_M[1]
    sashes = []
    for index, light in enumerate(_lights(span)):
        hung_right = index % 2 == 1
        rails = inset(light, -_LAP_M)
        left, low, right, high = rails.bounds
        # The axis is the outer edge of its face, so that it turns within its own width.
        hinge = (right if hung_right else left, near, low)
        pane = inset(light, _SASH_M[0] - _LAP_M)
        frame = upright_prism(ring(rails, _SASH_M[0]), far, near)
        bead = ring(inset(inset(rails, _SASH_M[0]), -0.001), _BEAD_M)
        frame += upright_prism(bead, far + inside * 0.009, near - inside * 0.012)
        parts = [
            Part("Frame", frame, "WindowFrame"),
            Part("Glass", glass(pane, span.middle), "Glass"),
        ]
        if light.bounds[3] - light.bounds[1] >= _HANDLE_FROM_M:
            parts.append(
                Part("Handles", _fittings(light, span.middle, inside, hung_right), "Metal")
            )
        back = tuple(-at for at in hinge)
        placed = tuple(Part(p.name, moved(p.faces, np.eye(2), back), p.surface) for p in parts)
        middle = (-1 if hung_right else 1) * (right - left) / 2, (far - near) / 2, 0.0
        box = Box(middle, (right - left, abs(far - near), high - low), 0.0)
        sashes.append(Sash(hinge, box, placed, hung_right))
    return sashes


def _lights(span: Span) -> list[Polygon]:
    """The openings between frame and mullions."""
    wide = _FRAME_M[0]
    count = max(1, math.ceil((span.right - span.left - wide) / _PANE_M))
    stops = spaced(span.left, span.right - wide, count)
    return [rectangle(a + wide, wide, b, span.height - wide) for a, b in pairwise(stops)]


def _fittings(light: Polygon, y: float, inside: int, hung_right: bool) -> list[Face]:
    """A handle where a casement opens, two hinges at its other side."""
    near = y + inside * (_FRAME_M[1] / 2 + _SASH_PROUD_M)
    left, low, right, high = light.bounds
    x = left + _SASH_M[0] / 2 - _LAP_M if hung_right else right - _SASH_M[0] / 2 + _LAP_M
    z = min((low + high) / 2, low + 0.75)
    rose = bar((x, z - 0.024), (x, z + 0.024), 0.014)
    faces = upright_prism(rose, near, near + inside * 0.009)
    faces += upright_prism(disc(x, z, 0.009), near + inside * 0.008, near + inside * 0.036)
    lever = bar((x, z + 0.004), (x, z - 0.105), 0.0085)
    faces += upright_prism(lever, near + inside * 0.028, y + inside * HANDLE_M)
    edge = right + _LAP_M + 0.002 if hung_right else left - _LAP_M - 0.002
    at_y = y + inside * (_FRAME_M[1] / 2 + 0.005)
    for at in (low + 0.09, high - 0.09 - 0.07):
        faces += prism(disc(edge, at_y, 0.0075), at, at + 0.07)
    return faces


def _board(span: Span, inside: int) -> list[Face]:
    """A board on the room's side, rounded at its nose by two steps."""
    thickness, proud = BOARD_M
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
    start, nose = span.middle + out * 0.02, face + out * DRIP_M[0]
    high, low = 0.03, 0.012
    profile = Polygon([
        (start, -INTO_WALL_M), (start, high), (nose, low), (nose, -DRIP_M[1]),
        (nose - out * 0.003, -DRIP_M[1]), (nose - out * 0.003, low - 0.004), (face, low - 0.004),
        (face, -INTO_WALL_M),
    ])  # fmt: skip
    return lengthwise(profile, span.left + 0.001, span.right - 0.001)
