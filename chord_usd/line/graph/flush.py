"""The last half pixel: edges that close to a wall, or to each other, lie on it.

A raster gives edges to half a pixel, about three centimetres. Metres, world axes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from chord_usd.base.scene.oriented_rect import EDGES, Edge, Footprint, OrientedRect
from chord_usd.base.scene.types import FloatArray
from chord_usd.base.scene.units import fold_deg

ALIGN_DEG = 4.0
"""Items this close to the direction of the nearest side of their room are along it."""

ALIGN_BUILT_IN_DEG = 15.0
"""The same for kitchen units, which are screwed to their wall: other turns are torn edges."""

OVERLAP_SHARE = 0.35
"""Neighbours that overlap by less than this share of their smaller sides are moved apart: pixels
belong to one item only. Deeper overlaps are meant, as of a chair pushed under a table."""

_ROUNDING_SHARE = 0.7
"""So much of a thin panel may overlap by rounding alone."""

_TURN_EPSILON_DEG = 1e-6

_PARALLEL_DEG = 0.2
_TOUCH_M2 = 1e-5


def align(footprint: Footprint, polygon_m: FloatArray, within_deg: float = ALIGN_DEG) -> Footprint:
    """Turn an item about its centre to the direction of the nearest side of its room, if near."""
    sides = np.roll(polygon_m, -1, axis=0) - polygon_m
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    old = footprint.rect
    place = old.center - polygon_m
    along = np.clip((place * sides).sum(axis=1) / np.maximum(lengths**2, 1e-12), 0.0, 1.0)
    distance = np.hypot(*(place - along[:, None] * sides).T)
    for side in np.argsort(distance, kind="stable"):
        angle = _direction_deg(sides[side])
        turn = fold_deg(old.angle_deg - angle)
        if abs(turn) <= within_deg:
            return footprint.turned(-turn) if turn else footprint
    return footprint


def flush_with_walls(
    footprint: Footprint,
    polygon_m: FloatArray,
    reach_m: float,
    others: Sequence[Footprint] = (),
) -> Footprint:
    """Move each edge within reach_m of a parallel side of the room onto it.

    Not where one of the others stands in between, as a headboard panel behind a bed.
    """
    moved = footprint.rect
    for edge, place in _walls_near(moved, polygon_m, reach_m):
        trial = moved.moved_edge(edge, place)
        if min(trial.u1 - trial.u0, trial.v1 - trial.v0) < reach_m / 2:
            continue
        gained = _gained(moved, edge, place)
        if not any(_shared_m2(gained, other.rect) > _TOUCH_M2 for other in others):
            moved = trial
    return replace(footprint, rect=moved)


def _gained(rect: OrientedRect, edge: Edge, place: float) -> OrientedRect:
    """The strip that a rectangle gains where an edge moves out; none where it moves in."""
    lower, upper = next(pair for pair in EDGES if edge in pair)
    old: float = getattr(rect, edge)
    if edge == lower:
        return rect.moved_edge(lower, min(place, old)).moved_edge(upper, old)
    return rect.moved_edge(upper, max(place, old)).moved_edge(lower, old)


def _shared_m2(first: OrientedRect, second: OrientedRect) -> float:
    if first.area <= _TOUCH_M2:
        return 0.0
    if first.angle_deg == second.angle_deg:
        across = min(first.u1, second.u1) - max(first.u0, second.u0)
        along = min(first.v1, second.v1) - max(first.v0, second.v0)
        return max(across, 0.0) * max(along, 0.0)
    return first.covered_by(second) * first.area


def kept_deep(before: Footprint, after: Footprint) -> Footprint:
    """After its back has moved to a wall, a panel is as deep as before: its front moves along.

    The depth of what is painted a pixel thick is known better than where it stands.
    """
    axis = 1 - before.quarter_turns % 2
    shallow, deep = before.rect.span(axis)
    low, high = after.rect.span(axis)
    # The back is the upper edge after no and three quarter turns of the front at v0, u1, v1, u0.
    if before.quarter_turns in (0, 3):
        return after.moved_edge(EDGES[axis][0], high - (deep - shallow))
    return after.moved_edge(EDGES[axis][1], low + (deep - shallow))


def _walls_near(
    rect: OrientedRect, polygon_m: FloatArray, reach_m: float
) -> Iterator[tuple[Edge, float]]:
    """Edges of a rect and the places of parallel sides of the room that they nearly lie on."""
    local = rect.local(polygon_m)
    for start, stop in zip(local, np.roll(local, -1, axis=0), strict=True):
        for axis, edges in enumerate(EDGES):
            slope, span = abs(stop - start)[[axis, 1 - axis]]
            low, high = sorted((start[1 - axis], stop[1 - axis]))
            near, far = rect.span(1 - axis)
            is_parallel = slope <= span * np.tan(np.radians(_PARALLEL_DEG))
            if not is_parallel or min(high, far) - max(low, near) < 0.3 * (far - near):
                continue
            # Counter-clockwise: the room lies to the left of its sides.
            upper = (stop[1 - axis] > start[1 - axis]) == (axis == 0)
            edge = edges[int(upper)]
            place = float(start[axis] + stop[axis]) / 2
            if abs(place - getattr(rect, edge)) <= reach_m:
                yield edge, place


def parted(
    footprints: Sequence[Footprint], rounding_m: float = 0.0, share: float = OVERLAP_SHARE
) -> list[Footprint]:
    """Neighbours of one direction that overlap a little share the overlap and touch.

    rounding_m: overlaps up to here may come from drawing in pixels, however thin the piece.
    share: of the smaller piece's side, overlaps up to which come from torn edges.
    """
    result = list(footprints)
    for i in range(len(result)):
        for j in range(i + 1, len(result)):
            turns = fold_deg(result[i].rect.angle_deg - result[j].rect.angle_deg)
            if abs(turns) < _TURN_EPSILON_DEG:
                result[i], result[j] = _apart(result[i], result[j], rounding_m, share)
    return result


def _apart(
    first: Footprint, second: Footprint, rounding_m: float, share: float
) -> tuple[Footprint, Footprint]:
    depths = []
    for axis in (0, 1):
        (a0, a1), (b0, b1) = first.rect.span(axis), second.rect.span(axis)
        depths += [(a1 - b0, axis, True), (b1 - a0, axis, False)]
    depth, axis, first_below = min(depths)
    lower, upper = (first, second) if first_below else (second, first)
    below, above = lower.rect.span(axis), upper.rect.span(axis)
    thinner = min(below[1] - below[0], above[1] - above[0])
    reach = max(share * thinner, min(rounding_m, _ROUNDING_SHARE * thinner))
    if not 0.0 < depth <= reach:
        return first, second
    middle = (below[1] + above[0]) / 2
    lower = lower.moved_edge(EDGES[axis][1], middle)
    upper = upper.moved_edge(EDGES[axis][0], middle)
    return (lower, upper) if first_below else (upper, lower)


def _direction_deg(side: FloatArray) -> float:
    dx, dy = side
    if abs(dx) < 1e-9 or abs(dy) < 1e-9:
        return 0.0
    return fold_deg(float(np.degrees(np.arctan2(dy, dx))))
