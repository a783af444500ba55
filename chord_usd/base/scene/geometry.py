"""Plane geometry that more than one step needs: footprints, own frames, walls."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from shapely import STRtree
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.base.errors import ChordError, SceneError
from chord_usd.base.scene.limits import FARTHEST_M
from chord_usd.base.scene.types import WALL_THICKNESS_M, Box, FloatArray, Plan, Room
from chord_usd.base.scene.units import rotation_2d


def refuse_unreachable(points_m: npt.ArrayLike, kind: type[ChordError] = SceneError) -> None:
    """Raises an error of this kind for coordinates of foreign files that are beyond FARTHEST_M or
    no numbers: GEOS computes without an end with some of them."""
    points = np.asarray(points_m, dtype=np.float64)
    within = np.abs(points) <= FARTHEST_M  # False for NaN
    if not within.all():
        raise kind(
            f"has a coordinate of {points[~within][0]:g}", expected=f"at most {FARTHEST_M:g} m"
        )


@lru_cache(maxsize=4096)  # scores, rules and draws ask for the same boxes again and again
def footprint(box: Box) -> FloatArray:
    """(4, 2) corners in metres: back left, front left, front right, back right (own frame).

    The order is counter-clockwise; the front edge runs from corner 1 to corner 2. Read-only.
    """
    half_length, half_width = box.size_m[0] / 2, box.size_m[1] / 2
    local = np.array(
        [
            [-half_length, half_width],
            [-half_length, -half_width],
            [half_length, -half_width],
            [half_length, half_width],
        ]
    )
    corners = to_world(box, local)
    corners.flags.writeable = False
    return corners


def to_world(box: Box, points_m: npt.ArrayLike) -> FloatArray:
    """Points (..., 2) of a box's own frame in the frame that the box is in."""
    turned: FloatArray = np.asarray(points_m, np.float64) @ rotation_2d(box.yaw_deg).T
    return turned + np.array(box.center_m[:2])


def to_own(box: Box, points_m: npt.ArrayLike) -> FloatArray:
    """Points (..., 2) of the frame that a box is in, in its own frame; inverse of to_world."""
    turned: FloatArray = (np.asarray(points_m) - box.center_m[:2]) @ rotation_2d(box.yaw_deg)
    return turned


def in_world(box: Box, parent: Box) -> Box:
    """A child's box in the frame that its parent's box is in."""
    x, y = to_world(parent, box.center_m[:2])
    center_m = (float(x), float(y), parent.center_m[2] + box.center_m[2])
    return Box(center_m, box.size_m, parent.yaw_deg + box.yaw_deg)


def resized(box: Box, sides_m: tuple[float, float], middle_m: tuple[float, float]) -> Box:
    """The box with another length and width, its middle at this point of the frame it had."""
    x_m, y_m = to_world(box, middle_m)
    center_m = (float(x_m), float(y_m), box.center_m[2])
    return replace(box, center_m=center_m, size_m=(*sides_m, box.size_m[2]))


def front_direction(yaw_deg: float) -> FloatArray:
    """(2,) unit vector in the world towards which an item of this yaw faces; -y at yaw 0."""
    return rotation_2d(yaw_deg) @ np.array([0.0, -1.0])


@lru_cache(maxsize=4096)
def footprint_polygon(box: Box) -> Polygon:
    """The footprint as a shapely polygon, metres."""
    return Polygon(footprint(box))


@lru_cache(maxsize=1024)
def room_polygon(room: Room) -> Polygon:
    """The room's floor as a shapely polygon, metres."""
    return Polygon(room.polygon_m)


def extent_m(rooms: Iterable[Room]) -> float:
    """The longer side of the upright rectangle round all rooms, metres; 0 for none."""
    corners = [room.polygon_m for room in rooms]
    return float(np.ptp(np.concatenate(corners), axis=0).max()) if corners else 0.0


def room_sides(room: Room) -> list[tuple[FloatArray, FloatArray]]:
    """Start and end, (2,) metres, of each side of a room, counter-clockwise as its polygon is."""
    return list(zip(room.polygon_m, np.roll(room.polygon_m, -1, axis=0), strict=True))


def wall_area(rooms: Iterable[Room], thickness_m: float = WALL_THICKNESS_M) -> BaseGeometry:
    """Where walls stand: within thickness_m of a room (mitred) and in no room. Metres.

    Rooms thickness_m apart share one solid wall; rooms that touch have none between them.
    """
    floors = unary_union([room_polygon(room) for room in rooms])
    return floors.buffer(thickness_m, join_style="mitre", mitre_limit=3.0).difference(floors)


class Floors:
    """The floors of rooms, found by where they lie, so that not every one is asked each time."""

    def __init__(self, rooms: Iterable[Room]) -> None:
        self.rooms = tuple(rooms)
        self.polygons = [room_polygon(room) for room in self.rooms]
        self.index_of = {room.id: index for index, room in enumerate(self.rooms)}
        self._tree = STRtree(self.polygons)

    def near(self, shape: BaseGeometry) -> list[int]:
        """Indices of the rooms whose bounds meet a shape's bounds, in the rooms' order."""
        return sorted(self._tree.query(shape).tolist())


def rooms_beside(box: Box, rooms: Sequence[Room] | Floors) -> tuple[str, ...]:
    """Ids of the rooms that an opening's box joins: the one on its +y side, then on its -y side.

    A side counts for the room that takes most of the strip, one wall thick, beyond the wall's face
    there; a side where no room does is left out.
    """
    reach_m = max(box.size_m[1], WALL_THICKNESS_M) / 2 + WALL_THICKNESS_M
    floors = rooms if isinstance(rooms, Floors) else Floors(rooms)
    beside: list[str] = []
    for side in (1.0, -1.0):
        half_length = box.size_m[0] / 4
        local = np.array(
            [[-half_length, 0], [half_length, 0], [half_length, side * reach_m],
             [-half_length, side * reach_m]]
        )  # fmt: skip
        strip = Polygon(to_world(box, local))
        shares = {
            floors.rooms[index].id: floors.polygons[index].intersection(strip).area
            for index in floors.near(strip)
        }
        best = max(shares, key=lambda room_id: shares[room_id], default="")
        if best and shares[best] > 0.1 * strip.area and best not in beside:
            beside.append(best)
    return tuple(beside)


def polygons_of(area: BaseGeometry) -> list[Polygon]:
    """The polygons of a polygonal area, whatever shapely wrapped them in; empty ones dropped."""
    if isinstance(area, Polygon):
        return [] if area.is_empty else [area]
    if isinstance(area, MultiPolygon) or hasattr(area, "geoms"):
        return [part for child in area.geoms for part in polygons_of(child)]
    return []


def free_spot(floor: Polygon, taken: Iterable[Polygon]) -> tuple[float, float]:
    """The point of a floor furthest from its walls and from what takes it up, metres."""
    from shapely.ops import polylabel

    parts = polygons_of(floor.difference(unary_union([*taken]))) or [floor]
    point = polylabel(max(parts, key=lambda part: part.area), tolerance=0.05)
    return point.x, point.y


def is_axis_aligned(plan: Plan, tolerance_m: float = 0.005) -> bool:
    """Whether every wall runs along x or y, to within tolerance_m over its length."""
    for room in plan.rooms:
        sides = np.abs(np.roll(room.polygon_m, -1, axis=0) - room.polygon_m)
        if (sides.min(axis=1) > tolerance_m).any():
            return False
    return True


def seams(floors: Sequence[Polygon], within_m: float) -> Iterator[tuple[int, int, BaseGeometry]]:
    """Pairs of floors that are no farther apart than within_m, by their places in order, and the
    part of the first one's edge that is so near to the second."""
    # Of object dtype where there is no floor, too: the query takes no other.
    areas = np.array(floors, dtype=object)
    near = STRtree(areas).query(areas, predicate="dwithin", distance=within_m)
    for first, other in sorted((first, other) for first, other in near.T.tolist() if first < other):
        yield first, other, floors[first].exterior.intersection(floors[other].buffer(within_m))


def shared_rows(uvs: npt.ArrayLike) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]:
    """(K, 2) texture coordinates, each once, and (N,) which of them each of (N, 2) is."""
    rows = np.ascontiguousarray(uvs, dtype=np.float32) + np.float32(0.0)  # no -0.0 beside 0.0
    # As one number each: sorting rows takes ten times as long.
    _, first, places = np.unique(rows.view(np.int64), return_index=True, return_inverse=True)
    return rows[first], places.reshape(-1).astype(np.int32)


def gaps(spans: Iterable[tuple[float, float]], length: float) -> Iterator[tuple[float, float]]:
    """What no span covers from 0 to length, in order."""
    start = 0.0
    for low, high in sorted(spans):
        if min(low, length) > start:
            yield start, min(low, length)
        start = max(start, high)
    if start < length:
        yield start, length


def hanging_together(count: int, pairs: Iterable[tuple[int, int]]) -> list[list[int]]:
    """The numbers from 0 to count in groups that pairs join, directly or over others; in order."""
    group_of = [[index] for index in range(count)]
    for first, other in pairs:
        if group_of[first] is not group_of[other]:
            joined = sorted(group_of[first] + group_of[other])
            for index in joined:
                group_of[index] = joined
    return [group for index, group in enumerate(group_of) if group[0] == index]
