"""Pulls the outlines of rooms together: walls get their exact thickness, touching rooms touch.

An edge along an axis is known from its own pixels to half a pixel. Its wall's other face is drawn,
too, and lies a known thickness away, and so does the neighbour's edge beyond: all that is known of
a chain of edges that hang together in this way is intersected, and each takes the middle of what
remains. No edge moves by more than half a pixel.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.scene.types import BoolArray, FloatArray

_HALF_PX = 0.5

_THICKNESS_SLACK_PX = 1.05
"""Two rounded faces are at most one pixel more or less apart than the true ones."""


@dataclass(frozen=True)
class _Edge:
    """An edge along an axis."""

    polygon: int
    corner: int
    """The edge runs from this corner to the next."""
    axis: int
    """Which coordinate is the same all along it: 0 for x, 1 for y."""
    place: float
    """That coordinate."""
    low: float
    high: float
    """Span of the other coordinate."""
    outward: int
    """+1 if the room's outside lies at larger coordinates, else -1."""


def settle(
    polygons: Sequence[FloatArray], solid: BoolArray, thickness_px: float
) -> list[FloatArray]:
    """Move the edges of all rooms, each by half a pixel at most, to where their walls fit.

    polygons: (N, 2) each, clockwise in numbers, as from polygon_from_mask. solid: (H, W) pixels
    of walls and openings, drawn thickness_px thick.
    """
    edges = _all_axis_edges(polygons)
    spans = [_span_of(edge, solid, thickness_px) for edge in edges]
    pairs = _pairs(edges, thickness_px, _THICKNESS_SLACK_PX)
    anchors = [_slants_in_their_walls(polygon, solid, thickness_px) for polygon in polygons]
    return _move_edges(polygons, anchors, edges, _chain(spans, pairs))


def _chain(
    spans: Sequence[tuple[float, float]], pairs: Sequence[tuple[float, int, int, float]]
) -> _Chains:
    """Join pairs of edges, those that face each other longest first."""
    chains = _Chains(spans)
    for _, first, second, distance in sorted(pairs, reverse=True):
        chains.join(first, second, distance)
    return chains


def _move_edges(
    polygons: Sequence[FloatArray],
    anchors: list[FloatArray],
    edges: Sequence[_Edge],
    chains: _Chains,
) -> list[FloatArray]:
    """The polygons with their edges through their anchors, those along an axis in their chains."""
    for index, edge in enumerate(edges):
        anchors[edge.polygon][edge.corner, edge.axis] = chains.place(index)
    return [_through(polygon, anchor) for polygon, anchor in zip(polygons, anchors, strict=True)]


def _all_axis_edges(polygons: Sequence[FloatArray]) -> list[_Edge]:
    return [edge for index, polygon in enumerate(polygons) for edge in _axis_edges(index, polygon)]


def _axis_edges(index: int, polygon: FloatArray) -> list[_Edge]:
    edges = []
    for corner, (start, stop) in enumerate(zip(polygon, np.roll(polygon, -1, axis=0), strict=True)):
        for axis in (0, 1):
            if abs(start[axis] - stop[axis]) < 1e-6:
                low, high = sorted((float(start[1 - axis]), float(stop[1 - axis])))
                # Clockwise in numbers: going up (y grows) the room is to the right (x grows).
                rises = stop[1 - axis] > start[1 - axis]
                outward = -1 if rises == (axis == 0) else 1
                edges.append(_Edge(index, corner, axis, float(start[axis]), low, high, outward))
                break
    return edges


def _span_of(edge: _Edge, solid: BoolArray, thickness_px: float) -> tuple[float, float]:
    """Where the edge can lie, from its own pixels and the pixels of its wall's other face."""
    # An edge drawn through a step of one pixel lies between two pixel borders.
    half = _HALF_PX if edge.place.is_integer() else 2 * _HALF_PX
    low, high = edge.place - half, edge.place + half
    thickness = _wall_behind(edge, solid, thickness_px)
    if thickness is not None and half == _HALF_PX:
        face = edge.place + edge.outward * (thickness - thickness_px)
        both = max(low, face - _HALF_PX), min(high, face + _HALF_PX)
        if both[0] <= both[1]:
            return both
    return low, high


def _wall_behind(edge: _Edge, solid: BoolArray, thickness_px: float) -> int | None:
    """Pixels from the edge to the wall's other face; None where that is not one wall away."""
    turned = solid if edge.axis == 1 else solid.T
    first, last = round(edge.low) + 1, round(edge.high) - 1
    start, reach = round(edge.place), int(thickness_px + 3)
    if edge.outward > 0:
        strip = turned[start : start + reach, first:last]
    else:
        strip = turned[max(start - reach, 0) : start, first:last][::-1]
    if strip.size == 0 or len(strip) < reach:
        return None
    depths = np.where(strip.all(axis=0), reach, np.argmin(strip, axis=0))
    depths = depths[np.abs(depths - thickness_px) < _THICKNESS_SLACK_PX]
    return int(np.bincount(depths).argmax()) if len(depths) else None


def _pairs(
    edges: Sequence[_Edge], thickness_px: float, slack_px: float
) -> list[tuple[float, int, int, float]]:
    """(overlap, first, second, distance): edges that face each other and how far apart they lie.

    The distance is exact: one wall, or nothing between rooms that touch.
    """
    pairs = []
    for first, edge in enumerate(edges):
        if edge.outward < 0:
            continue
        for second, other in enumerate(edges):
            if other.outward > 0 or other.axis != edge.axis:
                continue
            overlap = min(edge.high, other.high) - max(edge.low, other.low)
            if overlap <= 1.0:
                continue
            apart = other.place - edge.place
            if abs(apart) < 1e-6:
                pairs.append((overlap, first, second, 0.0))
            elif abs(apart - thickness_px) < slack_px:
                pairs.append((overlap, first, second, thickness_px))
    return pairs


class _Chains:
    """Union-find over edges: chains of known distances, and where each chain can lie."""

    def __init__(self, spans: Sequence[tuple[float, float]]) -> None:
        self._spans = list(spans)
        self._parents = list(range(len(spans)))
        self._offsets = [0.0] * len(spans)

    def join(self, first: int, second: int, distance: float) -> None:
        """Fix second at first + distance, unless that contradicts what is known."""
        (root, first_offset), (other, second_offset) = self._root(first), self._root(second)
        if root == other:
            return
        shift = first_offset + distance - second_offset
        low, high = self._spans[other]
        low, high = max(self._spans[root][0], low - shift), min(self._spans[root][1], high - shift)
        if low <= high:
            self._parents[other], self._offsets[other] = root, shift
            self._spans[root] = low, high

    def place(self, index: int) -> float:
        """The middle of where this edge can lie."""
        root, offset = self._root(index)
        return sum(self._spans[root]) / 2 + offset

    def _root(self, index: int) -> tuple[int, float]:
        """The chain's first edge, and this one's place relative to it."""
        offset = 0.0
        while self._parents[index] != index:
            offset += self._offsets[index]
            index = self._parents[index]
        return index, offset


def _slants_in_their_walls(
    polygon: FloatArray, solid: BoolArray, thickness_px: float
) -> FloatArray:
    """(N, 2) a point of each edge; of slanted ones, moved to where both faces of the wall fit."""
    anchors = polygon.copy()
    edges = np.roll(polygon, -1, axis=0) - polygon
    for corner in np.flatnonzero(np.abs(edges).min(axis=1) > 1e-6):
        length = float(np.hypot(*edges[corner]))
        along = edges[corner] / length
        # Clockwise in numbers: outside lies to the left.
        outward = np.array([-along[1], along[0]])
        ends = polygon[corner], polygon[corner] + edges[corner]
        window, points = _pixels_near(ends, thickness_px + 3.0, solid.shape)
        places = points - polygon[corner]
        beside = np.abs(places @ along - length / 2) < length / 2 - thickness_px / 2
        depth, wall = (places @ outward)[beside], solid[window][beside]
        spans = [_face(depth, wall), _face(thickness_px - depth, wall)]
        low = max(spans[0][0], -spans[1][1])
        high = min(spans[0][1], -spans[1][0])
        if -math.inf < low < high < math.inf:
            anchors[corner] += outward * (low + high) / 2
    return anchors


def _face(depth: FloatArray, wall: BoolArray) -> tuple[float, float]:
    """Where the face of a wall lies, which begins near depth 0: (from, to).

    depth: of pixel centres; wall: which of them are wall.
    """
    near = np.abs(depth) < 1.5
    floor_depth, wall_depth = depth[near & ~wall], depth[near & wall]
    low = float(floor_depth.max()) if len(floor_depth) else -math.inf
    high = float(wall_depth.min()) if len(wall_depth) else math.inf
    return (low, high) if low < high else (-math.inf, math.inf)


def _pixels_near(
    ends: tuple[FloatArray, FloatArray], reach_px: float, shape: tuple[int, ...]
) -> tuple[tuple[slice, slice], FloatArray]:
    """The window of an image round a segment, and the centres of its pixels (H, W, 2)."""
    low = np.floor(np.minimum(*ends) - reach_px).astype(int).clip(0)
    high = np.ceil(np.maximum(*ends) + reach_px).astype(int).clip(0, shape[::-1])
    window = slice(low[1], high[1]), slice(low[0], high[0])
    rows, columns = np.mgrid[window]
    return window, np.stack([columns, rows], axis=-1) + 0.5


def _through(polygon: FloatArray, anchors: FloatArray) -> FloatArray:
    """The polygon with each edge moved in parallel through its anchor, if that leaves it valid."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    corners = np.empty_like(polygon)
    for corner in range(len(polygon)):
        (ux, uy), (vx, vy) = edges[corner - 1], edges[corner]
        turn = ux * vy - uy * vx
        if abs(turn) < 1e-9:
            return polygon
        x, y = anchors[corner] - anchors[corner - 1]
        corners[corner] = anchors[corner - 1] + (x * vy - y * vx) / turn * edges[corner - 1]
    return corners if Polygon(corners).is_valid else polygon
