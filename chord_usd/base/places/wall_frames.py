"""Sides of rooms as frames: places and free spans along them, and openings in them."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry import LineString

from chord_usd.base.places.taken_space import TakenSpace
from chord_usd.base.scene.geometry import Floors, footprint, gaps, room_sides
from chord_usd.base.scene.types import WALL_THICKNESS_M, Box, FloatArray, Opening, Room
from chord_usd.base.scene.units import wrap_deg

BEHIND_M = 0.001
"""Between a wall and the back of what hangs on it."""

Size = tuple[float, float, float]

_LEAST_SIDE_M = 0.05
_TOUCHING_M = 0.02
"""Between rooms that are no farther apart there is no wall."""


@dataclass(frozen=True, eq=False)
class WallFrame:
    """A straight side of a room: u runs along it, v from it into the room."""

    start_m: FloatArray
    """(2,) its end with u = 0."""
    along: FloatArray
    """(2,) unit vector of u."""
    inward: FloatArray
    """(2,) unit vector of v."""
    length_m: float

    @classmethod
    def between(cls, start: FloatArray, end: FloatArray) -> WallFrame:
        """The frame of a side, (2,) each end, of a room whose corners run counter-clockwise."""
        length = math.dist(start, end)
        along = (end - start) / max(length, 1e-6)
        return cls(start, along, np.array([-along[1], along[0]]), length)

    @cached_property
    def yaw_deg(self) -> float:
        """Of a piece with its back on the wall."""
        return round(wrap_deg(float(np.degrees(np.arctan2(self.inward[0], -self.inward[1])))), 6)

    def at(self, u: float, v: float) -> FloatArray:
        """(2,) a point of the frame in the world."""
        point: FloatArray = self.start_m + u * self.along + v * self.inward
        return point

    def local(self, points_m: FloatArray) -> FloatArray:
        """(..., 2) points of the world as u and v."""
        local: FloatArray = (points_m - self.start_m) @ np.stack([self.along, self.inward], axis=1)
        return local

    def extent(self, points_m: FloatArray) -> tuple[float, float, float, float]:
        """Lowest and highest u, lowest and highest v of points (N, 2)."""
        local = self.local(points_m)
        (u0, v0), (u1, v1) = local.min(axis=0), local.max(axis=0)
        return float(u0), float(u1), float(v0), float(v1)

    def box(self, middle_m: float, base_m: float, size_m: Size, v_m: float = BEHIND_M) -> Box:
        """A box with its back v_m from the wall, its middle so far along."""
        x, y = self.at(middle_m, v_m + size_m[1] / 2)
        return Box((float(x), float(y), base_m), size_m, self.yaw_deg)

    def boxes(
        self, size_m: Size, step_m: float, base_m: float = 0.0, gap_m: float = 0.0
    ) -> Iterator[Box]:
        """Boxes along the wall from end to end, no closer than step_m. gap_m: left behind a box
        and beside the outermost."""
        free_m = self.length_m - size_m[0] - 2 * gap_m
        if free_m < 0.0:
            return
        count = max(1, int(free_m / step_m + 1e-6) + 1)
        first = gap_m + size_m[0] / 2
        for middle_m in np.linspace(first, first + free_m, count).tolist():
            yield self.box(middle_m, base_m, size_m, gap_m)


def wall_frames(room: Room, least_m: float = 0.05) -> Iterator[WallFrame]:
    """The sides of a room that are longer than least_m, in its order."""
    for start, end in room_sides(room):
        if math.dist(start, end) > least_m:
            yield WallFrame.between(start, end)


def out_of_walls(box: Box, room: Room, within_m: float = 0.015) -> Box:
    """A box that stands no deeper than within_m in walls, moved out of them."""
    for wall in wall_frames(room):
        low, high, deep, _ = wall.extent(footprint(box))
        if -within_m <= deep < 0.0 and high > within_m and low < wall.length_m - within_m:
            x, y = wall.inward * -deep + box.center_m[:2]
            box = replace(box, center_m=(float(x), float(y), box.center_m[2]))
    return box


@dataclass(frozen=True)
class Hole:
    """An opening in a wall, along the wall and upwards."""

    opening: Opening
    left_m: float
    right_m: float
    low_m: float
    high_m: float

    @property
    def middle_m(self) -> float:
        """Along the wall."""
        return (self.left_m + self.right_m) / 2

    @property
    def width_m(self) -> float:
        """Along the wall."""
        return self.right_m - self.left_m


@dataclass(frozen=True, eq=False)
class WallFace(WallFrame):
    """A side of a room with its openings; u runs to the right as one sees it from within."""

    is_outer: bool = False
    """Whether no room lies behind any part of it."""
    gaps_m: tuple[tuple[float, float], ...] = ()
    """From where to where another room touches, with no wall between."""
    holes: tuple[Hole, ...] = ()

    def span_of(self, box: Box) -> tuple[float, float, float, float]:
        """Lowest and highest u, lowest and highest v of a box."""
        return self.extent(footprint(box))

    def has_back_of(self, box: Box, within_m: float = 0.12) -> bool:
        """Whether a piece stands with its back to this wall, no farther off than within_m."""
        turned = abs((box.yaw_deg - self.yaw_deg + 180.0) % 360.0 - 180.0)
        u0, u1, v0, _ = self.span_of(box)
        middle = (u0 + u1) / 2
        return turned < 10.0 and -0.1 <= v0 <= within_m and 0.0 <= middle <= self.length_m

    def free_spans(
        self,
        taken: TakenSpace,
        base_m: float,
        top_m: float,
        depth_m: float,
        ignoring: Collection[str] = ("rug",),
        from_v_m: float = 0.0,
    ) -> list[tuple[float, float]]:
        """Stretches (from, to) along the wall free between two heights, this deep from it."""
        corners, bounds = taken.corners_m, taken.bounds_m
        meets = (bounds[:, 2] < top_m - BEHIND_M) & (bounds[:, 5] > base_m + BEHIND_M)
        kept = [i for i in np.flatnonzero(meets) if taken.reasons[i] not in ignoring]
        local = self.local(corners[kept])
        low, high = local.min(axis=1), local.max(axis=1)
        near = (low[:, 1] < from_v_m + depth_m - BEHIND_M) & (high[:, 1] > from_v_m + BEHIND_M)
        blocked = zip(low[near, 0].tolist(), high[near, 0].tolist(), strict=True)
        return list(gaps(blocked, self.length_m))


def faces_of(room: Room, openings: Sequence[Opening], floors: Floors) -> tuple[WallFace, ...]:
    """The walls of a room, counter-clockwise as its sides are; slivers are left out.

    floors: of all rooms.
    """
    floor = floors.polygons[floors.index_of[room.id]]
    beside = [
        floors.polygons[index]
        for index in floors.near(floor.buffer(2 * WALL_THICKNESS_M))
        if floors.rooms[index].id != room.id
    ]
    return tuple(
        _face(start, end, beside, openings)
        for start, end in room_sides(room)
        if math.dist(start, end) > _LEAST_SIDE_M
    )


def _face(
    start: FloatArray,
    end: FloatArray,
    beside: Sequence[shapely.Polygon],
    openings: Sequence[Opening],
) -> WallFace:
    length = math.dist(start, end)
    # Seen from within, a side that runs counter-clockwise runs to the left.
    along = (start - end) / length
    inward = np.array([along[1], -along[0]])
    line = LineString([end, start])
    behind = line.buffer(1.5 * WALL_THICKNESS_M, cap_style="flat")
    gaps = []
    for other in beside:
        for part in shapely.get_parts(line.intersection(other.buffer(_TOUCHING_M))):
            if part.length > _LEAST_SIDE_M:
                u = (shapely.get_coordinates(part) - end) @ along
                gaps.append((float(u.min()), float(u.max())))
    is_outer = not any(shapely.area(shapely.intersection(behind, other)) > 0.01 for other in beside)
    face = WallFace(end, along, inward, length, is_outer, tuple(gaps))
    holes = tuple(hole for opening in openings if (hole := _hole(face, opening)) is not None)
    return replace(face, holes=holes)


def _hole(face: WallFace, opening: Opening) -> Hole | None:
    """Where an opening is in a wall; None where it is in another."""
    u0, u1, v0, v1 = face.span_of(opening.box)
    turned = (opening.box.yaw_deg - face.yaw_deg) % 180.0
    is_along = min(turned, 180.0 - turned) < 10.0
    depth_m = max(opening.box.size_m[1], WALL_THICKNESS_M)
    at_wall = -depth_m - 0.05 < (v0 + v1) / 2 < 0.02
    if not is_along or not at_wall or u1 < 0.05 or u0 > face.length_m - 0.05:
        return None
    low = max(opening.box.center_m[2], 0.0)
    return Hole(opening, u0, u1, low, low + opening.box.size_m[2])
