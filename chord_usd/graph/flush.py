"""The last half pixel: items stand flush with walls and beside each other, not inside.

A raster gives edges to half a pixel, about three centimetres. An edge that close to a wall of its
room is on it. Boxes around torn patches stand out farther, into walls and neighbours; there they
are cut back. Metres, world axes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Polygon

from chord_usd.graph.rectangles import Rectangle, covered_share
from chord_usd.scene.types import Box, FloatArray
from chord_usd.scene.units import fold_deg, wrap_deg

ALIGN_DEG = 4.0
"""Items this close to the direction of the nearest side of their room are along it."""

ALIGN_BUILT_IN_DEG = 15.0
"""The same for kitchen units, which are screwed to their wall: other turns are torn edges."""

OVERLAP_SHARE = 0.35
"""Neighbours that overlap by less than this share of their smaller sides are moved apart: pixels
belong to one item only. Deeper overlaps are meant, as of a chair pushed under a table."""

_ROUNDING_SHARE = 0.7
"""So much of a thin panel may overlap by rounding alone."""

_OUT_SHARE = 0.005
"""Share of a footprint that may lie out of its room..."""
_OUT_M = 0.004
"""...and how deep: a corner of a slanted piece is a small share and in the wall all the same."""
_STEPS = 24
_GRID_M = 1e-9
"""Without a grid GEOS errs now and then where edges lie on each other, as these do."""

_PARALLEL_DEG = 0.2
_TOUCH_M2 = 1e-5
_TURN_EPSILON_DEG = 1e-6


@dataclass(frozen=True)
class Standing:
    """An item's footprint in the world."""

    rectangle: Rectangle
    """Metres; angle_deg in [-45, 45)."""
    quarter_turns: int
    """Yaw is rectangle.angle_deg plus these."""

    @classmethod
    def of(cls, box: Box) -> Standing:
        """The footprint of a box."""
        angle = fold_deg(box.yaw_deg)
        turns = round((box.yaw_deg - angle) / 90.0) % 4
        length, width = box.size_m[:2] if turns % 2 == 0 else box.size_m[1::-1]
        flat = Rectangle(angle, 0.0, 0.0, 0.0, 0.0)
        u, v = flat.local(np.array([box.center_m[:2]]))[0]
        spans = (u - length / 2, u + length / 2, v - width / 2, v + width / 2)
        return cls(Rectangle(angle, *map(float, spans)), turns)

    def on(self, box: Box) -> Box:
        """The box moved to this footprint; heights stay."""
        rectangle = self.rectangle
        length, width = rectangle.u1 - rectangle.u0, rectangle.v1 - rectangle.v0
        if self.quarter_turns % 2:
            length, width = width, length
        x, y = map(float, rectangle.center)
        yaw_deg = wrap_deg(rectangle.angle_deg + 90.0 * self.quarter_turns)
        return Box((x, y, box.center_m[2]), (length, width, box.size_m[2]), yaw_deg)


def align(standing: Standing, polygon_m: FloatArray, within_deg: float = ALIGN_DEG) -> Standing:
    """Turn an item about its centre to the direction of the nearest side of its room, if near."""
    sides = np.roll(polygon_m, -1, axis=0) - polygon_m
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    old = standing.rectangle
    place = old.center - polygon_m
    along = np.clip((place * sides).sum(axis=1) / np.maximum(lengths**2, 1e-12), 0.0, 1.0)
    distance = np.hypot(*(place - along[:, None] * sides).T)
    for side in np.argsort(distance, kind="stable"):
        angle = _direction_deg(sides[side])
        turn = fold_deg(old.angle_deg - angle)
        if abs(turn) <= within_deg:
            return _turned(standing, -turn) if turn else standing
    return standing


def flush_with_walls(
    standing: Standing,
    polygon_m: FloatArray,
    reach_m: float,
    others: Sequence[Standing] = (),
) -> Standing:
    """Move each edge within reach_m of a parallel side of the room onto it.

    Not where one of the others stands in between, as a headboard panel behind a bed.
    """
    moved = standing.rectangle
    for name, place in _walls_near(moved, polygon_m, reach_m):
        trial = replace(moved, **{name: place})
        if min(trial.u1 - trial.u0, trial.v1 - trial.v0) < reach_m / 2:
            continue
        gained = _gained(moved, name, place)
        if not any(_shared_m2(gained, other.rectangle) > _TOUCH_M2 for other in others):
            moved = trial
    return replace(standing, rectangle=moved)


def _gained(rectangle: Rectangle, name: str, place: float) -> Rectangle:
    """The strip that a rectangle gains where an edge moves out; none where it moves in."""
    edge = getattr(rectangle, name)
    if name in ("u0", "v0"):
        return replace(rectangle, **{name: min(place, edge), name[0] + "1": edge})
    return replace(rectangle, **{name: max(place, edge), name[0] + "0": edge})


def _shared_m2(first: Rectangle, second: Rectangle) -> float:
    if first.area_px <= _TOUCH_M2:
        return 0.0
    if first.angle_deg == second.angle_deg:
        across = min(first.u1, second.u1) - max(first.u0, second.u0)
        along = min(first.v1, second.v1) - max(first.v0, second.v0)
        return max(across, 0.0) * max(along, 0.0)
    return covered_share(first, second) * first.area_px


def kept_deep(before: Standing, after: Standing) -> Standing:
    """After its back has moved to a wall, a panel is as deep as before: its front moves along.

    The depth of what is painted a pixel thick is known better than where it stands.
    """
    lower, upper = (("v0", "v1"), ("u0", "u1"))[before.quarter_turns % 2]
    depth = getattr(before.rectangle, upper) - getattr(before.rectangle, lower)
    low, high = getattr(after.rectangle, lower), getattr(after.rectangle, upper)
    # The back is the upper edge after no and three quarter turns of the front at v0, u1, v1, u0.
    if before.quarter_turns in (0, 3):
        low = high - depth
    else:
        high = low + depth
    return replace(after, rectangle=replace(after.rectangle, **{lower: low, upper: high}))


def _walls_near(
    rectangle: Rectangle, polygon_m: FloatArray, reach_m: float
) -> Iterator[tuple[str, float]]:
    """Edges of a rectangle and the places of parallel sides of the room that they nearly lie on."""
    local = rectangle.local(polygon_m)
    for start, stop in zip(local, np.roll(local, -1, axis=0), strict=True):
        for axis, names in ((0, ("u0", "u1")), (1, ("v0", "v1"))):
            slope, span = abs(stop - start)[[axis, 1 - axis]]
            low, high = sorted((start[1 - axis], stop[1 - axis]))
            near, far = _span(rectangle, 1 - axis)
            is_parallel = slope <= span * np.tan(np.radians(_PARALLEL_DEG))
            if not is_parallel or min(high, far) - max(low, near) < 0.3 * (far - near):
                continue
            # Counter-clockwise: the room lies to the left of its sides.
            upper = (stop[1 - axis] > start[1 - axis]) == (axis == 0)
            name = names[int(upper)]
            place = float(start[axis] + stop[axis]) / 2
            if abs(place - getattr(rectangle, name)) <= reach_m:
                yield name, place


def _outline(rectangle: Rectangle) -> Polygon:
    return Polygon(rectangle.corners_px() * (1.0, -1.0))


def pull_into(standing: Standing, room: Polygon) -> Standing:
    """Cut off what stands out of the room, edge by edge, each time the cut that costs least."""
    rectangle = standing.rectangle
    for _ in range(4):
        if _fits(rectangle, room):
            break
        cuts = [_cut(rectangle, name, room) for name in ("u0", "u1", "v0", "v1")]
        rectangle = max(cuts, key=lambda cut: (cut[0], cut[1].area_px))[1]
    return replace(standing, rectangle=rectangle)


def _cut(rectangle: Rectangle, name: str, room: Polygon) -> tuple[bool, Rectangle]:
    """One edge moved in by the least that puts the rest into the room, half way at most.

    Also whether that does it.
    """
    opposite = name[0] + ("1" if name[1] == "0" else "0")
    start, limit = getattr(rectangle, name), getattr(rectangle, opposite)
    for step in range(1, _STEPS + 1):
        place = start + (limit - start) * 0.5 * step / _STEPS
        cut = replace(rectangle, **{name: place})
        if _fits(cut, room):
            return True, cut
    return False, cut


def _fits(rectangle: Rectangle, room: Polygon) -> bool:
    """Whether next to nothing lies out of the room, and that nowhere deep."""
    shape = _outline(rectangle)
    out = shape.difference(room, grid_size=_GRID_M)
    if out.area > _OUT_SHARE * shape.area:
        return False
    return bool(out.buffer(-_OUT_M / 2).is_empty)


def part(
    standings: Sequence[Standing], rounding_m: float = 0.0, share: float = OVERLAP_SHARE
) -> list[Standing]:
    """Neighbours of one direction that overlap a little share the overlap and touch.

    rounding_m: overlaps up to here may come from drawing in pixels, however thin the piece.
    share: of the smaller piece's side, overlaps up to which come from torn edges.
    """
    result = list(standings)
    for i in range(len(result)):
        for j in range(i + 1, len(result)):
            turns = fold_deg(result[i].rectangle.angle_deg - result[j].rectangle.angle_deg)
            if abs(turns) < _TURN_EPSILON_DEG:
                result[i], result[j] = _parted(result[i], result[j], rounding_m, share)
    return result


def _parted(
    first: Standing, second: Standing, rounding_m: float, share: float
) -> tuple[Standing, Standing]:
    depths = []
    for axis in (0, 1):
        (a0, a1), (b0, b1) = _span(first.rectangle, axis), _span(second.rectangle, axis)
        depths += [(a1 - b0, axis, True), (b1 - a0, axis, False)]
    depth, axis, first_below = min(depths)
    lower, upper = (first, second) if first_below else (second, first)
    below, above = _span(lower.rectangle, axis), _span(upper.rectangle, axis)
    thinner = min(below[1] - below[0], above[1] - above[0])
    reach = max(share * thinner, min(rounding_m, _ROUNDING_SHARE * thinner))
    if not 0.0 < depth <= reach:
        return first, second
    names = (("u0", "u1"), ("v0", "v1"))[axis]
    middle = (below[1] + above[0]) / 2
    lower = replace(lower, rectangle=replace(lower.rectangle, **{names[1]: middle}))
    upper = replace(upper, rectangle=replace(upper.rectangle, **{names[0]: middle}))
    return (lower, upper) if first_below else (upper, lower)


def _span(rectangle: Rectangle, axis: int) -> tuple[float, float]:
    if axis == 0:
        return rectangle.u0, rectangle.u1
    return rectangle.v0, rectangle.v1


def _direction_deg(side: FloatArray) -> float:
    dx, dy = side
    if abs(dx) < 1e-9 or abs(dy) < 1e-9:
        return 0.0
    return fold_deg(float(np.degrees(np.arctan2(dy, dx))))


def _turned(standing: Standing, by_deg: float) -> Standing:
    """Turned about its own centre."""
    old = standing.rectangle
    angle, turns = old.angle_deg + by_deg, standing.quarter_turns
    folded = fold_deg(angle)
    quarters = round((angle - folded) / 90.0)
    length, width = old.u1 - old.u0, old.v1 - old.v0
    if quarters % 2:
        length, width = width, length
    u, v = Rectangle(folded, 0.0, 0.0, 0.0, 0.0).local(old.center[None])[0]
    spans = (u - length / 2, u + length / 2, v - width / 2, v + width / 2)
    return Standing(Rectangle(folded, *map(float, spans)), (turns + quarters) % 4)
