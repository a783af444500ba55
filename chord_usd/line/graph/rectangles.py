"""The oriented rectangle that best separates pixels from others, and its front mark.

Everything here lives in upright pixels (base/scene/oriented_rect.py).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from chord_usd.base.scene.oriented_rect import EDGES, Edge, OrientedRect, turn_matrix
from chord_usd.base.scene.palette import FRONT_MARK_LENGTH, FRONT_MARK_WIDTH
from chord_usd.base.scene.types import BoolArray, FloatArray
from chord_usd.base.scene.units import fold_deg

FRONT_EDGES: tuple[Edge, ...] = ("v0", "u1", "v1", "u0")
"""Edge that is the front after 0, 1, 2, 3 counter-clockwise quarter turns."""

_SAME_PX = 1e-6


def canvas_corners(rect: OrientedRect, quarter_turns: int = 0) -> FloatArray:
    """(4, 2) canvas pixels (y down) as in Detection."""
    corners: FloatArray = rect.corners(quarter_turns) * (1.0, -1.0)
    return corners


def front_mark(rect: OrientedRect, quarter_turns: int) -> OrientedRect:
    """The strip a front mark covers when the front is at FRONT_EDGES[quarter_turns]."""
    along, across = (0, 1) if quarter_turns % 2 == 0 else (1, 0)
    low, high = rect.span(along)
    inset = (high - low - max(FRONT_MARK_LENGTH * (high - low), 1.0)) / 2
    near, far = rect.span(across)
    depth = max(FRONT_MARK_WIDTH * (far - near), 1.0)
    mark = rect.moved_edge(EDGES[along][0], low + inset).moved_edge(EDGES[along][1], high - inset)
    if FRONT_EDGES[quarter_turns].endswith("0"):
        return mark.moved_edge(EDGES[across][1], near + depth)
    return mark.moved_edge(EDGES[across][0], far - depth)


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

    def cost(self, rectangle: OrientedRect) -> float:
        """Members left outside plus the weights of outsiders covered."""
        missed = len(self.members) - int(rectangle.covers(self.members).sum())
        return missed + float(self.weights[rectangle.covers(self.outsiders)].sum())


def fit_at_angle(evidence: Evidence, angle_deg: float, rounds: int = 3) -> OrientedRect:
    """The rectangle of this direction that separates members from outsiders at least cost.

    Each edge in turn goes to the middle of the interval of positions that cost least, which on a
    clean raster is within half a pixel of the edge that was drawn.
    """
    turn = turn_matrix(angle_deg)
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
    return OrientedRect(angle_deg, u0, u1, v0, v1)


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


def fit_free(evidence: Evidence) -> OrientedRect:
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


# Pieces that share a patch settle their common edges ---------------------------------------------

# Between two cabinets of one colour there is no edge to see; but each front mark spans the middle
# 0.6 of its piece, and that pins the ends. All edges of a patch are solved for together.

_EDGES = ("u0", "u1", "v0", "v1")
_TOUCH_PX = 2.5
"""Facing edges of neighbours closer than this are one edge."""

_SEEN, _MARK, _SHARED, _KEEP = 1.0, 0.7, 2.0, 0.02
"""Weights: an edge seen in the pixels, a mark's ends, a common edge, the first guess."""


@dataclass(frozen=True)
class Piece:
    """One item of a patch."""

    rectangle: OrientedRect
    quarter_turns: int | None
    """Yaw is rectangle.angle_deg plus these; None without a front mark."""


def settle_edges(
    evidence: Evidence, pieces: Sequence[Piece], marks: Sequence[OrientedRect]
) -> list[Piece]:
    """Move the edges of pieces (all of one angle) so that pixels, marks and neighbours agree.

    marks: the painted front mark of each piece.
    """
    rows: list[tuple[dict[int, float], float, float]] = []
    for index, (piece, mark) in enumerate(zip(pieces, marks, strict=True)):
        rows += _own_equations(evidence, pieces, index, piece, mark)
    rows += [({upper: 1.0, lower: -1.0}, 0.0, _SHARED) for upper, lower in _common_edges(pieces)]
    matrix = np.zeros((len(rows), 4 * len(pieces)))
    target = np.zeros(len(rows))
    for row, (terms, value, weight) in enumerate(rows):
        for column, factor in terms.items():
            matrix[row, column] = factor * weight
        target[row] = value * weight
    solved = np.linalg.lstsq(matrix, target, rcond=None)[0]
    for upper, lower in _common_edges(pieces):
        solved[[upper, lower]] = solved[[upper, lower]].mean()
    solved = solved.reshape(-1, 4)
    return [
        Piece(OrientedRect(piece.rectangle.angle_deg, *map(float, edges)), piece.quarter_turns)
        if edges[1] - edges[0] >= 0.5 and edges[3] - edges[2] >= 0.5
        else piece
        for piece, edges in zip(pieces, solved, strict=True)
    ]


def _own_equations(
    evidence: Evidence, pieces: Sequence[Piece], index: int, piece: Piece, mark: OrientedRect
) -> list[tuple[dict[int, float], float, float]]:
    """(factors by unknown, value, weight): the first guess, seen edges and the mark."""
    base = 4 * index
    rectangle = piece.rectangle
    rows: list[tuple[dict[int, float], float, float]] = []
    for edge, name in enumerate(_EDGES):
        rows.append(({base + edge: 1.0}, getattr(rectangle, name), _KEEP))
        seen = _seen_edge(evidence, rectangle, edge)
        if seen is not None:
            rows.append(({base + edge: 1.0}, seen, _SEEN))
    assert piece.quarter_turns is not None
    first = 0 if piece.quarter_turns % 2 == 0 else 2
    near, far = (1 - FRONT_MARK_LENGTH) / 2, (1 + FRONT_MARK_LENGTH) / 2
    low, high = (getattr(mark, _EDGES[first + side]) for side in (0, 1))
    if high - low > 1.5:
        rows.append(({base + first: 1 - near, base + first + 1: near}, low, _MARK))
        rows.append(({base + first: 1 - far, base + first + 1: far}, high, _MARK))
    front = (2, 1, 3, 0)[piece.quarter_turns]
    rows.append(({base + front: 1.0}, getattr(mark, _EDGES[front]), _SEEN))
    return rows


def _seen_edge(evidence: Evidence, rectangle: OrientedRect, edge: int) -> float | None:
    """Where the patch ends at this edge of a piece; None where it goes on beyond."""
    axis, upper = divmod(edge, 2)
    sign = 1.0 if upper else -1.0
    limit = sign * getattr(rectangle, _EDGES[edge])
    near, far = (rectangle.v0, rectangle.v1) if axis == 0 else (rectangle.u0, rectangle.u1)
    inset = 0.2 * (far - near)
    inside, outside = rectangle.local(evidence.members), rectangle.local(evidence.outsiders)
    strips = []
    for points in (inside, outside):
        chosen = (points[:, 1 - axis] >= near + inset) & (points[:, 1 - axis] <= far - inset)
        strips.append(chosen)
    along_in = sign * inside[strips[0], axis]
    along_out = sign * outside[strips[1], axis]
    beyond_in = ((along_in > limit + 0.5) & (along_in < limit + 2.0)).sum()
    beyond_out = ((along_out > limit + 0.5) & (along_out < limit + 2.0)).sum()
    if beyond_in > 0.5 * (beyond_in + beyond_out):
        return None
    size = rectangle.u1 - rectangle.u0 if axis == 0 else rectangle.v1 - rectangle.v0
    close_in = (along_in > limit - size) & (along_in < limit + 4.0)
    close_out = (along_out > limit - size) & (along_out < limit + 4.0)
    weights = evidence.weights[strips[1]][close_out]
    if not close_in.any():
        return None
    return sign * best_edge(along_in[close_in], along_out[close_out], weights, limit - size / 2)


def _common_edges(pieces: Sequence[Piece]) -> list[tuple[int, int]]:
    """Unknowns that are one edge: the upper of a piece that touches the lower of another."""
    return [
        (4 * i + 2 * axis + 1, 4 * j + 2 * axis)
        for i, first in enumerate(pieces)
        for j, second in enumerate(pieces)
        for axis in (0, 1)
        if i != j and _touch(first.rectangle, second.rectangle, axis)
    ]


def _touch(first: OrientedRect, second: OrientedRect, axis: int) -> bool:
    a, b = _spans(first), _spans(second)
    gap = b[axis][0] - a[axis][1]
    common = min(a[1 - axis][1], b[1 - axis][1]) - max(a[1 - axis][0], b[1 - axis][0])
    least = min(a[1 - axis][1] - a[1 - axis][0], b[1 - axis][1] - b[1 - axis][0])
    return abs(gap) < _TOUCH_PX and common > 0.5 * least


def _spans(rectangle: OrientedRect) -> FloatArray:
    return np.array([[rectangle.u0, rectangle.u1], [rectangle.v0, rectangle.v1]])
