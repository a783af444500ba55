"""What fills the hole of an opening: frames, leaves, glass, linings.

Everything is drawn in the opening's own frame: origin at the centre of its sill, x along the wall,
y across it, z up. Frames reach a little into the wall, so that no two faces coincide where one
could see them.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon

from chord_usd.base.scene.trim import BOARD_FROM_M, CASING_M
from chord_usd.base.scene.tunnels import Tunnel
from chord_usd.base.scene.types import Box
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.shell.mesh import Face, flat, moved, upright
from chord_usd.line.stage.shell.opening_shapes import (
    GAP_M,
    LEAF_M,
    Leaf,
    Part,
    Span,
    rectangle,
    upright_prism,
)
from chord_usd.line.stage.shell.railings import railing_box, railing_faces
from chord_usd.line.stage.shell.window_parts import Sash, sashes_of, window_parts

PointM = tuple[float, float, float]

_JAMB_M = 0.035
"""Thickness of a door frame inside the hole."""

_STOP_M = (0.012, 0.02)
"""How far the stop that a leaf closes against stands out of the frame, and its depth."""

_TWO_LEAVES_FROM_M = 1.2


def span_of(tunnel: Tunnel) -> Span:
    """The hole as the opening sees it."""
    corners = np.asarray(tunnel.area_m.exterior.coords)[:-1]
    box_ = tunnel.opening.box
    local = (corners - np.array(box_.center_m[:2])) @ rotation_2d(box_.yaw_deg)
    (left, front), (right, back) = local.min(axis=0), local.max(axis=0)
    return Span(left, right, front, back, tunnel.high_m - tunnel.low_m)


def fixed_parts(tunnel: Tunnel, *, inside: int, opens: int) -> list[Part]:
    """Linings and frame of an opening, in its own frame; all but the leaves of doors and windows.

    inside: 1 where the owning room lies towards +y, else -1. opens: 1 where the leaves of a door
    swing towards +y, else -1.
    """
    span = span_of(tunnel)
    parts = _linings(tunnel)
    if not span.is_fitted:
        return parts
    if tunnel.opening.kind == "door":
        parts.append(Part("Frame", _casing(span, opens), "Trim"))
    elif tunnel.opening.kind == "window":
        parts += window_parts(span, inside, has_board=tunnel.low_m >= BOARD_FROM_M)
    return parts


def railing_parts(tunnel: Tunnel) -> list[Part]:
    """Linings of a gap in a balcony's wall, and its railing, in the gap's own frame."""
    span = span_of(tunnel)
    bars = railing_faces(span.left, span.right, span.middle)
    return [*_linings(tunnel), Part("Bars", bars, "Metal")]


def railing_guard(tunnel: Tunnel) -> Box:
    """The box of a railing, in the gap's own frame."""
    span = span_of(tunnel)
    return railing_box(span.left, span.right, span.middle)


def leaf_box(leaf: Leaf) -> Box:
    """The room a leaf takes, in the frame of its hinge."""
    left, right = leaf.across_m
    size_m = (leaf.width_m, LEAF_M, leaf.height_m - GAP_M)
    return Box(((left + right) / 2, 0.0, GAP_M), size_m, 0.0)


def leaves_of(tunnel: Tunnel) -> list[tuple[PointM, Leaf]]:
    """The leaves that fill the frame of a door, closed; two of them in a wide one.

    Each comes with its hinge in the opening's frame, at the bottom.
    """
    span = span_of(tunnel)
    if tunnel.opening.kind != "door" or not span.is_fitted:
        return []
    left = span.left + _JAMB_M + GAP_M
    right = span.right - _JAMB_M - GAP_M
    height = span.height - _JAMB_M - 2 * GAP_M
    middle = span.middle
    if right - left < _TWO_LEAVES_FROM_M:
        return [((left, middle, 0.0), Leaf(round(right - left, 4), height, hung_right=False))]
    half = round((right - left - GAP_M) / 2, 4)
    return [
        ((left, middle, 0.0), Leaf(half, height, hung_right=False)),
        ((right, middle, 0.0), Leaf(half, height, hung_right=True)),
    ]


def sashes_in(tunnel: Tunnel, inside: int) -> list[Sash]:
    """The casements of a window; none in a small hole, or a door. inside: as fixed_parts has it."""
    span = span_of(tunnel)
    if tunnel.opening.kind != "window" or not span.is_fitted:
        return []
    return sashes_of(span, inside)


def _linings(tunnel: Tunnel) -> list[Part]:
    """Jambs, head and sill; at floor height the sill is the threshold and has the floor's
    material."""
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


def _casing(span: Span, opens: int) -> list[Face]:
    """Jambs and head, an architrave with two steps on both faces of the wall, the leaf's stop."""
    inner, (outer, proud) = _JAMB_M, CASING_M
    clear = rectangle(span.left + inner, -1.0, span.right - inner, span.height - inner)

    def around(by: float) -> Polygon:
        """The hole with so much around it, less the way through."""
        whole = rectangle(span.left - by, 0.0, span.right + by, span.height + by)
        return whole.difference(clear)

    faces = upright_prism(around(outer - 0.012), span.front - 0.009, span.back + 0.009)
    bead = around(outer).difference(rectangle(
        span.left - outer + 0.02, -1.0, span.right + outer - 0.02, span.height + outer - 0.02
    ))  # fmt: skip
    for face, side in ((span.front, -1.0), (span.back, 1.0)):
        faces += upright_prism(bead, face - side * 0.01, face + side * proud)
    edge = span.middle - opens * (LEAF_M / 2 + 0.001)
    return faces + upright_prism(_stop(span), edge, edge - opens * _STOP_M[1])


def _stop(span: Span) -> Polygon:
    """The strip around the way through that a closed leaf leans against."""
    left, right, high = span.left + _JAMB_M, span.right - _JAMB_M, span.height - _JAMB_M
    hidden, out = 0.004, _STOP_M[0]
    whole = rectangle(left - hidden, 0.0, right + hidden, high + hidden)
    return whole.difference(rectangle(left + out, -1.0, right - out, high - out))


def side_of(point_m: npt.ArrayLike, tunnel: Tunnel) -> int:
    """1 where the point lies towards the opening's own +y, else -1."""
    offset = np.asarray(point_m) - np.array(tunnel.opening.box.center_m[:2])
    return 1 if float(offset @ rotation_2d(tunnel.opening.box.yaw_deg)[:, 1]) > 0 else -1


def lining_faces(tunnel: Tunnel) -> list[Face]:
    """Jambs and head of a tunnel, facing into it."""
    jambs = [
        upright(end, start, tunnel.low_m, tunnel.high_m)
        for (start, end), is_end in zip(tunnel.edges_m(), tunnel.is_end, strict=True)
        if not is_end
    ]
    return jambs + flat(tunnel.area_m, tunnel.high_m, up=False)


def sill_faces(tunnel: Tunnel) -> list[Face]:
    """Bottom of a tunnel, facing up: the threshold of a door, the sill of a window."""
    return flat(tunnel.area_m, tunnel.low_m, up=True)
