"""What frames, leaves and windows are drawn from: parts, leaves, spans, upright prisms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely.geometry import LineString, Point, Polygon, box
from shapely.geometry.base import BaseGeometry

from chord_usd.line.stage.shell.mesh import Face, prism, standing

INTO_WALL_M = 0.01
"""How far hidden edges of frames and sills reach into the wall."""

LEAF_M = 0.04
GAP_M = 0.003
"""Between leaf and frame."""

GLASS_M = 0.008
_FITTED_FROM_M = 0.25
"""Holes that are narrower or lower stay bare."""


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

    @property
    def across_m(self) -> tuple[float, float]:
        """Its edges along x, the hinge at 0."""
        return (-self.width_m, 0.0) if self.hung_right else (0.0, self.width_m)


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

    @property
    def middle(self) -> float:
        """y of the middle of the wall."""
        return (self.front + self.back) / 2


def upright_prism(profile: BaseGeometry, front: float, back: float) -> list[Face]:
    """A solid whose profile is drawn as (x, z) and reaches from y = front to y = back, or back."""
    low, high = sorted((front, back))
    return standing(prism(profile, -high, -low))


def lengthwise(profile: Polygon, left: float, right: float) -> list[Face]:
    """A solid whose profile is drawn as (y, z) and reaches from x = left to x = right."""
    return [Face(face.corners_m[:, [2, 0, 1]], face.uvs_m) for face in prism(profile, left, right)]


def ring(outer: Polygon, width: float) -> Polygon:
    """The rim of a rectangle, so wide, inwards."""
    return outer.difference(inset(outer, width))


def inset(area: Polygon, by: float) -> Polygon:
    """A rectangle smaller by so much on each side; larger where it is negative."""
    return area.buffer(-by, join_style="mitre")


def glass(pane: Polygon, middle: float) -> list[Face]:
    """A pane that reaches into its frame."""
    return upright_prism(inset(pane, -INTO_WALL_M), middle - GLASS_M / 2, middle + GLASS_M / 2)


def disc(x: float, z: float, radius: float) -> Polygon:
    """A circle, 20 corners."""
    return Point(x, z).buffer(radius, quad_segs=5)


def bar(start: tuple[float, float], end: tuple[float, float], radius: float) -> Polygon:
    """A bar with round ends, along a line."""
    return LineString([start, end]).buffer(radius, quad_segs=3)


def rectangle(left: float, low: float, right: float, high: float) -> Polygon:
    """An upright rectangle (x, z)."""
    return box(left, low, right, high)


def spaced(first: float, last: float, count: int) -> list[float]:
    """count + 1 numbers from first to last."""
    return [float(at) for at in np.linspace(first, last, count + 1)]
