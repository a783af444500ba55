"""An oriented rectangle and an item's footprint: one box, on the raster and in the world.

A rectangle's unit is its maker's: upright pixels (x right, y UP, the centre of pixel (row 0,
column 0) at (0.5, -0.5)) where a raster is read, metres where a room is arranged. Angles are
counter-clockwise in both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import cv2
import numpy as np
import shapely

from chord_usd.base.scene.types import BoolArray, Box, FloatArray
from chord_usd.base.scene.units import fold_deg, rotation_2d, wrap_deg

Edge = Literal["u0", "u1", "v0", "v1"]
"""Of a rectangle: the lower and the upper one along each of its axes."""

EDGES: tuple[tuple[Edge, Edge], tuple[Edge, Edge]] = (("u0", "u1"), ("v0", "v1"))
"""By axis."""


@dataclass(frozen=True)
class OrientedRect:
    """u0 <= u <= u1, v0 <= v <= v1, where u runs along angle_deg and v a quarter turn further."""

    angle_deg: float
    u0: float
    u1: float
    v0: float
    v1: float

    @classmethod
    def around(
        cls, center: Sequence[float] | FloatArray, angle_deg: float, along: float, across: float
    ) -> OrientedRect:
        """One so long along angle_deg and so long across it."""
        u, v = map(float, (np.array([center]) @ turn_matrix(angle_deg))[0])
        spans = (u - along / 2, u + along / 2, v - across / 2, v + across / 2)
        return cls(angle_deg, *map(float, spans))

    @property
    def area(self) -> float:
        """In its unit, squared."""
        return (self.u1 - self.u0) * (self.v1 - self.v0)

    @property
    def center(self) -> FloatArray:
        """(2,)."""
        middle = np.array([(self.u0 + self.u1) / 2, (self.v0 + self.v1) / 2])
        return turn_matrix(self.angle_deg) @ middle

    @property
    def polygon(self) -> shapely.Polygon:
        """The same as a polygon."""
        return shapely.Polygon(self.corners())

    def span(self, axis: int) -> tuple[float, float]:
        """From where to where along u (0) or v (1)."""
        return (self.u0, self.u1) if axis == 0 else (self.v0, self.v1)

    def moved_edge(self, edge: Edge, place: float) -> OrientedRect:
        """The same with one edge elsewhere."""
        return replace(self, **{edge: place})

    def local(self, points: FloatArray) -> FloatArray:
        """(N, 2) own coordinates (u, v) of points (N, 2)."""
        return points @ turn_matrix(self.angle_deg)

    def covers(self, points: FloatArray) -> BoolArray:
        """(N,) which points lie inside; as in drawing, the lower edges count."""
        u, v = self.local(points).T
        return (u >= self.u0) & (u < self.u1) & (v >= self.v0) & (v < self.v1)

    def corners(self, quarter_turns: int = 0) -> FloatArray:
        """(4, 2) back left, front left, front right, back right of an item whose yaw is angle_deg
        plus these quarter turns."""
        local = [(self.u0, self.v1), (self.u0, self.v0), (self.u1, self.v0), (self.u1, self.v1)]
        first = quarter_turns % 4
        return np.array(local[first:] + local[:first]) @ turn_matrix(self.angle_deg).T

    def grown(self, by: float) -> OrientedRect:
        """The same with every edge moved outwards."""
        return OrientedRect(self.angle_deg, self.u0 - by, self.u1 + by, self.v0 - by, self.v1 + by)

    def covered_by(self, other: OrientedRect) -> float:
        """Share of its area that lies within another one."""
        both, _ = cv2.intersectConvexConvex(
            self.corners().astype(np.float32), other.corners().astype(np.float32)
        )
        return float(both) / max(self.area, 1e-9)


@lru_cache(maxsize=256)
def turn_matrix(angle_deg: float) -> FloatArray:
    """(2, 2) rotation; a house has few directions."""
    matrix = rotation_2d(angle_deg)
    matrix.setflags(write=False)
    return matrix


@dataclass(frozen=True)
class Footprint:
    """The floor that an item's box covers."""

    rect: OrientedRect
    """Metres, world axes; angle_deg in [-45, 45)."""
    quarter_turns: int
    """Yaw is rect.angle_deg plus these."""

    @classmethod
    def of(cls, box: Box) -> Footprint:
        """That of a box."""
        angle = fold_deg(box.yaw_deg)
        turns = round((box.yaw_deg - angle) / 90.0) % 4
        length, width = box.size_m[:2] if turns % 2 == 0 else box.size_m[1::-1]
        return cls(OrientedRect.around(box.center_m[:2], angle, length, width), turns)

    def on(self, box: Box) -> Box:
        """The box moved here; heights stay."""
        length, width = self.rect.u1 - self.rect.u0, self.rect.v1 - self.rect.v0
        if self.quarter_turns % 2:
            length, width = width, length
        x, y = map(float, self.rect.center)
        yaw_deg = wrap_deg(self.rect.angle_deg + 90.0 * self.quarter_turns)
        return Box((x, y, box.center_m[2]), (length, width, box.size_m[2]), yaw_deg)

    def turned(self, by_deg: float) -> Footprint:
        """Turned about its own centre."""
        angle = self.rect.angle_deg + by_deg
        folded = fold_deg(angle)
        quarters = round((angle - folded) / 90.0)
        length, width = self.rect.u1 - self.rect.u0, self.rect.v1 - self.rect.v0
        if quarters % 2:
            length, width = width, length
        rect = OrientedRect.around(self.rect.center, folded, length, width)
        return Footprint(rect, (self.quarter_turns + quarters) % 4)

    def moved_edge(self, edge: Edge, place: float) -> Footprint:
        """The same with one edge elsewhere."""
        return replace(self, rect=self.rect.moved_edge(edge, place))
