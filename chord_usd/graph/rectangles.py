"""Oriented rectangles on the pixel grid, and the one that best separates pixels from others.

Everything here lives in upright pixels: x right, y UP, the centre of pixel (row 0, column 0) at
(0.5, -0.5), so that angles are counter-clockwise as in the world.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import cv2
import numpy as np

from chord_usd.scene.palette import FRONT_MARK_LENGTH, FRONT_MARK_WIDTH
from chord_usd.scene.types import BoolArray, FloatArray
from chord_usd.scene.units import fold_deg, rotation_2d

FRONT_EDGES = ("v0", "u1", "v1", "u0")
"""Edge that is the front after 0, 1, 2, 3 counter-clockwise quarter turns."""

_SAME_PX = 1e-6


@dataclass(frozen=True)
class Rectangle:
    """u0 <= u <= u1, v0 <= v <= v1, where u runs along angle_deg and v a quarter turn further."""

    angle_deg: float
    u0: float
    u1: float
    v0: float
    v1: float

    @property
    def area_px(self) -> float:
        """Square pixels."""
        return (self.u1 - self.u0) * (self.v1 - self.v0)

    @property
    def center(self) -> FloatArray:
        """(2,) upright pixels."""
        middle = np.array([(self.u0 + self.u1) / 2, (self.v0 + self.v1) / 2])
        return _turn(self.angle_deg) @ middle

    def local(self, points: FloatArray) -> FloatArray:
        """(N, 2) own coordinates (u, v) of upright points (N, 2)."""
        return points @ _turn(self.angle_deg)

    def covers(self, points: FloatArray) -> BoolArray:
        """(N,) which upright points lie inside; as in drawing, the lower edges count."""
        u, v = self.local(points).T
        return (u >= self.u0) & (u < self.u1) & (v >= self.v0) & (v < self.v1)

    def corners_px(self, quarter_turns: int = 0) -> FloatArray:
        """(4, 2) canvas pixels (y down) as in Detection: back left, front left, front right,
        back right of an item whose yaw is angle_deg plus these quarter turns."""
        own = [(self.u0, self.v1), (self.u0, self.v0), (self.u1, self.v0), (self.u1, self.v1)]
        first = quarter_turns % 4
        return np.array(own[first:] + own[:first]) @ _to_canvas(self.angle_deg)

    def grown(self, by_px: float) -> Rectangle:
        """The same rectangle with every edge moved outwards."""
        return Rectangle(
            self.angle_deg, self.u0 - by_px, self.u1 + by_px, self.v0 - by_px, self.v1 + by_px
        )

    def mark(self, quarter_turns: int) -> Rectangle:
        """The strip a front mark covers when the front is at FRONT_EDGES[quarter_turns]."""
        along_u = quarter_turns % 2 == 0
        length = self.u1 - self.u0 if along_u else self.v1 - self.v0
        width = self.v1 - self.v0 if along_u else self.u1 - self.u0
        inset = (length - max(FRONT_MARK_LENGTH * length, 1.0)) / 2
        depth = max(FRONT_MARK_WIDTH * width, 1.0)
        if quarter_turns == 0:
            return replace(self, u0=self.u0 + inset, u1=self.u1 - inset, v1=self.v0 + depth)
        if quarter_turns == 1:
            return replace(self, v0=self.v0 + inset, v1=self.v1 - inset, u0=self.u1 - depth)
        if quarter_turns == 2:
            return replace(self, u0=self.u0 + inset, u1=self.u1 - inset, v0=self.v1 - depth)
        return replace(self, v0=self.v0 + inset, v1=self.v1 - inset, u1=self.u0 + depth)


@lru_cache(maxsize=256)
def _turn(angle_deg: float) -> FloatArray:
    """(2, 2) rotation; a house has few directions."""
    matrix = rotation_2d(angle_deg)
    matrix.setflags(write=False)
    return matrix


@lru_cache(maxsize=256)
def _to_canvas(angle_deg: float) -> FloatArray:
    """(2, 2) what turns rows of (u, v) into canvas pixels, y down."""
    matrix: FloatArray = rotation_2d(angle_deg).T * (1.0, -1.0)
    matrix.setflags(write=False)
    return matrix


def upright_points(mask: BoolArray, top: int = 0, left: int = 0) -> FloatArray:
    """(N, 2) upright centres of the set pixels of a window that starts at (top, left)."""
    rows, columns = np.nonzero(mask)
    return np.stack([columns + (left + 0.5), -(rows + (top + 0.5))], axis=1)


@dataclass(frozen=True, eq=False)
class Evidence:
    """What a rectangle should cover and what it should not. Upright pixels."""

    members: FloatArray
    """(N, 2) centres of pixels of the item."""
    outsiders: FloatArray
    """(M, 2) centres of pixels around it that are not."""
    weights: FloatArray
    """(M,) cost of covering each outsider, in members left uncovered."""

    def cost(self, rectangle: Rectangle) -> float:
        """Members left outside plus the weights of outsiders covered."""
        missed = len(self.members) - int(rectangle.covers(self.members).sum())
        return missed + float(self.weights[rectangle.covers(self.outsiders)].sum())


def fit_at_angle(evidence: Evidence, angle_deg: float, rounds: int = 3) -> Rectangle:
    """The rectangle of this direction that separates members from outsiders at least cost.

    Each edge in turn goes to the middle of the interval of positions that cost least, which on a
    clean raster is within half a pixel of the edge that was drawn.
    """
    turn = _turn(angle_deg)
    inside, outside = evidence.members @ turn, evidence.outsiders @ turn
    low, high = _trimmed_span(inside)
    edges = [[low[0] - 0.5, high[0] + 0.5], [low[1] - 0.5, high[1] + 0.5]]
    for _ in range(rounds):
        before = [list(span) for span in edges]
        for axis in (0, 1):
            near, far = edges[1 - axis]
            strip_in = inside[(inside[:, 1 - axis] >= near) & (inside[:, 1 - axis] <= far), axis]
            chosen = (outside[:, 1 - axis] >= near) & (outside[:, 1 - axis] <= far)
            strip_out, weights = outside[chosen, axis], evidence.weights[chosen]
            if not len(strip_in):
                continue
            middle = sum(edges[axis]) / 2
            edges[axis][1] = best_edge(strip_in, strip_out, weights, middle)
            edges[axis][0] = -best_edge(-strip_in, -strip_out, weights, -middle)
        if before == edges:
            break
    (u0, u1), (v0, v1) = edges
    return Rectangle(angle_deg, u0, u1, v0, v1)


def _trimmed_span(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ends (2,) of where all but a few in a hundred of the points lie, along both axes."""
    skipped = len(points) // 25
    ordered = np.partition(points, (skipped, len(points) - 1 - skipped), axis=0)
    return ordered[skipped], ordered[len(points) - 1 - skipped]


def best_edge(inside: FloatArray, outside: FloatArray, weights: FloatArray, middle: float) -> float:
    """Where beyond middle an upper edge leaves fewest members out and outsiders in."""
    beyond = outside > middle
    inner, outer = inside[inside > middle], outside[beyond]
    positions = np.concatenate([inner, outer])
    count = len(positions)
    if not count:
        return middle + 0.5
    steps = np.empty(count)
    steps[: len(inner)] = -1.0
    steps[len(inner) :] = weights[beyond]
    order = positions.argsort()
    positions = positions[order]
    cost = steps[order].cumsum()
    gaps = np.empty(count)
    gaps[:-1] = positions[1:] - positions[:-1]
    gaps[-1] = 1.0
    cost[gaps <= _SAME_PX] = np.inf
    # Of the positions that cost least, the middle of the widest interval.
    best = int(np.where(cost <= cost.min() + 1e-9, gaps, -1.0).argmax())
    return float(positions[best] + gaps[best] / 2)


def fit_free(evidence: Evidence) -> Rectangle:
    """The rectangle of any direction that separates members from outsiders at least cost.

    The direction is the middle of the interval that costs least, in [-45, 45) degrees.
    """
    start = cv2.minAreaRect((evidence.members * (1.0, -1.0)).astype(np.float32))
    angle = fold_deg(-start[2])
    reach = math.degrees(math.atan2(1.5, max(*start[1], 2.0)))
    for step in (reach / 2, reach / 8):
        angles = angle + step * np.arange(-2, 3)
        costs = [evidence.cost(fit_at_angle(evidence, float(a), rounds=2)) for a in angles]
        angle = float(angles[np.flatnonzero(np.array(costs) <= min(costs) + 1e-9)].mean())
    return fit_at_angle(evidence, fold_deg(angle))


def covered_share(inner: Rectangle, outer: Rectangle) -> float:
    """Share of inner's area that lies within outer."""
    both, _ = cv2.intersectConvexConvex(
        inner.corners_px().astype(np.float32), outer.corners_px().astype(np.float32)
    )
    return float(both) / max(inner.area_px, 1e-9)
