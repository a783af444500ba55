"""The walls of a house as one solid, and whose each of its faces is. Shapely only.

Two boxes in the same place have coincident faces, which render black. So the walls are one solid
seen from above (geometry.wall_area); openings are tunnels cut through it, and every face of what
is left belongs to exactly one owner: the room it looks into, the opening whose lining it is, or
the outside. Together the faces enclose the solid exactly once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import MultiPolygon, Polygon, box
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import Floors, polygons_of
from chord_usd.base.scene.tunnels import (
    GRID_M,
    LINTEL_M,
    ON_LINE_M,
    Tunnel,
    dig_tunnels,
    wall_solid,
)
from chord_usd.base.scene.types import ROOM_HEIGHT_M, Box, FloatArray, Plan, Room
from chord_usd.line.stage.shell.mesh import Face, flat, upright
from chord_usd.line.stage.shell.railings import gaps_for_railings

IntArray = npt.NDArray[np.intp]

BOX_DEPTH_M = 0.1
"""Less than half a wall, so that the boxes behind its two faces stay apart."""


@dataclass(frozen=True)
class Hole:
    """Where a tunnel ends on a wall line."""

    from_m: float
    to_m: float
    """Along the line, from its start."""
    low_m: float
    high_m: float


@dataclass(frozen=True, eq=False)
class WallLine:
    """A straight piece of the boundary of the walls, seen from above; it faces its right side."""

    start_m: FloatArray
    end_m: FloatArray
    room: int | None
    """Index of the room it looks into; None outside."""
    edge: int
    """Which edge of that room's polygon it lies on; outside, a running number."""
    holes: tuple[Hole, ...] = ()
    """In no particular order."""

    @property
    def length_m(self) -> float:
        """From start to end."""
        return float(np.hypot(*(self.end_m - self.start_m)))


@dataclass(frozen=True, eq=False)
class Walls:
    """The walls of a house."""

    rooms: tuple[Room, ...]
    floors_m: tuple[Polygon, ...]
    """One per room; where rooms overlap the earlier one keeps the floor."""
    solid_m: MultiPolygon
    """Where walls stand, before openings are cut."""
    lines: tuple[WallLine, ...]
    tunnels: dict[str, Tunnel]
    """By opening id; openings that meet no wall are absent."""
    railings: tuple[tuple[int, Tunnel], ...] = ()
    """Index of a balcony, and a gap in its outer wall that a railing closes."""

    def lines_of(self, room: int | None) -> list[WallLine]:
        """The lines that look into a room, by its index; None for those that look outside."""
        return self._lines_by_room.get(room, [])

    def floors_near(self, shape: BaseGeometry) -> list[Polygon]:
        """The floors whose bounds meet the bounds of a shape."""
        return [self.floors_m[index] for index in sorted(self._floor_tree.query(shape))]

    def tunnels_near(self, shape: BaseGeometry, distance_m: float) -> list[Tunnel]:
        """The tunnels that may be no farther from a shape than this, in their order."""
        west, south, east, north = shape.bounds
        around = box(west - distance_m, south - distance_m, east + distance_m, north + distance_m)
        tunnels = list(self.tunnels.values())
        return [tunnels[index] for index in sorted(self._tunnel_tree.query(around))]

    def tunnels_of(self, room_id: str) -> list[Tunnel]:
        """The tunnels that join a room to something, by its id."""
        return self._tunnels_by_room.get(room_id, [])

    # Large houses: what is asked for each room must not go through the whole house.

    @cached_property
    def _lines_by_room(self) -> dict[int | None, list[WallLine]]:
        lines: dict[int | None, list[WallLine]] = {}
        for line in self.lines:
            lines.setdefault(line.room, []).append(line)
        return lines

    @cached_property
    def _tunnels_by_room(self) -> dict[str, list[Tunnel]]:
        tunnels: dict[str, list[Tunnel]] = {}
        for tunnel in self.tunnels.values():
            for room_id in dict.fromkeys(tunnel.opening.room_ids):
                tunnels.setdefault(room_id, []).append(tunnel)
        return tunnels

    @cached_property
    def _floor_tree(self) -> shapely.STRtree:
        return shapely.STRtree(self.floors_m)

    @cached_property
    def _tunnel_tree(self) -> shapely.STRtree:
        return shapely.STRtree([tunnel.area_m for tunnel in self.tunnels.values()])

    def cuts(self) -> list[Tunnel]:
        """Everything that is cut through the walls."""
        return [*self.tunnels.values(), *(tunnel for _, tunnel in self.railings)]


def _on_grid(polygon_m: FloatArray) -> FloatArray:
    """The corners of a room on the grid of walls; arms narrower than it are left out."""
    rounded = np.round(polygon_m / GRID_M) * GRID_M
    if shapely.is_valid(Polygon(rounded)):
        return rounded
    whole = shapely.set_precision(Polygon(polygon_m), GRID_M)
    largest = max(polygons_of(whole), key=lambda part: part.area, default=Polygon(polygon_m))
    return np.asarray(orient(largest).exterior.coords)[:-1]


def build_walls(plan: Plan) -> Walls:
    """Solid, boundary and tunnels of a plan's walls."""
    rooms = tuple(
        Room(room.id, room.kind, _on_grid(room.polygon_m), room.name) for room in plan.rooms
    )
    solid = wall_solid(rooms)
    dug = zip(plan.openings, dig_tunnels(plan.openings, solid), strict=True)
    tunnels = {opening.id: tunnel for opening, tunnel in dug if tunnel is not None}
    open_sides = list(gaps_for_railings(rooms, plan.openings, ROOM_HEIGHT_M - LINTEL_M))
    dug_gaps = dig_tunnels([gap for _, gap in open_sides], solid)
    gaps = [
        (index, tunnel)
        for (index, _), tunnel in zip(open_sides, dug_gaps, strict=True)
        if tunnel is not None
    ]
    cut = [*tunnels.values(), *(tunnel for _, tunnel in gaps)]
    lines = tuple(_with_holes(_lines(rooms, solid), cut))
    return Walls(rooms, tuple(_floors(rooms)), solid, lines, tunnels, tuple(gaps))


def wall_faces(lines: Sequence[WallLine]) -> list[Face]:
    """The faces of lines that become one mesh, from floor to ceiling, less their holes.

    All lines are cut at the same heights, so that faces share whole edges with their neighbours.
    """
    holes = [hole for line in lines for hole in line.holes]
    heights = {0.0, ROOM_HEIGHT_M, *(h for hole in holes for h in (hole.low_m, hole.high_m))}
    rows = list(pairwise(sorted(heights)))
    faces = []
    for line in lines:
        for start, end, cut in _columns(line):
            along = float(np.hypot(*(start - line.start_m)))
            for low, high in rows:
                if not any(hole.low_m <= low and high <= hole.high_m for hole in cut):
                    faces.append(upright(start, end, low, high, along_m=along))
    return faces


def wall_boxes(lines: Sequence[WallLine]) -> list[Box]:
    """What one runs into: upright boxes behind the lines, with the holes left free.

    They reach BOX_DEPTH_M into the wall from its face, along which their length lies.
    """
    boxes = []
    for line in lines:
        for start, end, holes in _columns(line):
            for low, high in _solid_spans(holes):
                boxes.append(_box_behind(start, end, low, high))
    return boxes


def _solid_spans(holes: Sequence[Hole]) -> list[tuple[float, float]]:
    """(low, high) of what is wall in a column with these holes."""
    stops = sorted({0.0, ROOM_HEIGHT_M, *(h for hole in holes for h in (hole.low_m, hole.high_m))})
    return [
        (low, high)
        for low, high in pairwise(stops)
        if not any(hole.low_m <= low and high <= hole.high_m for hole in holes)
    ]


def _box_behind(start: FloatArray, end: FloatArray, low_m: float, high_m: float) -> Box:
    along = end - start
    length = float(np.hypot(*along))
    behind = np.array([-along[1], along[0]]) / length * (BOX_DEPTH_M / 2)
    x, y = (start + end) / 2 + behind
    yaw_deg = float(np.degrees(np.arctan2(along[1], along[0])))
    return Box((float(x), float(y), low_m), (length, BOX_DEPTH_M, high_m - low_m), yaw_deg)


def top_faces(walls: Walls) -> list[Face]:
    """The tops of all walls: what a picture from above shows once the ceilings are hidden."""
    return flat(walls.solid_m, ROOM_HEIGHT_M, up=True)


def free_stretches(line: WallLine, below_m: float) -> list[tuple[FloatArray, FloatArray]]:
    """(start, end) of the parts of a line with wall behind them, from the floor up to below_m."""
    return [
        (start, end)
        for start, end, holes in _columns(line)
        if all(hole.low_m >= below_m for hole in holes)
    ]


def _floors(rooms: Sequence[Room]) -> Iterator[Polygon]:
    floors = Floors(rooms)
    for index, floor in enumerate(floors.polygons):
        earlier = [floors.polygons[other] for other in floors.near(floor) if other < index]
        taken = unary_union(earlier)
        free = floor.difference(taken) if floor.intersection(taken).area > GRID_M else floor
        yield max(polygons_of(free), key=lambda part: part.area, default=floor)


def _lines(rooms: Sequence[Room], solid: MultiPolygon) -> Iterator[WallLine]:
    """The boundary of the solid, cut where the rooms it looks into change."""
    starts, ends, room_of, edge_of = _room_edges(rooms)
    corners_by_place = shapely.STRtree(shapely.points(starts))
    edges_by_place = shapely.STRtree(shapely.linestrings(np.stack([starts, ends], axis=1)))
    outside = 0
    for part in solid.geoms:
        for ring in (part.exterior, *part.interiors):
            corners = np.asarray(ring.coords)
            for a, b in pairwise(corners):
                near = _near(corners_by_place, a, b)
                for start, end in _split(a, b, starts[near]):
                    middle = (start + end) / 2
                    near = _near(edges_by_place, middle, middle)
                    nearest = _nearest_edge(middle, near, starts, ends)
                    if nearest is None:
                        yield WallLine(start, end, None, outside)
                        outside += 1
                    else:
                        yield WallLine(start, end, room_of[nearest], edge_of[nearest])


def _near(tree: shapely.STRtree, a: FloatArray, b: FloatArray) -> IntArray:
    """Indices, in order, of what may lie on the segment a to b."""
    low, high = np.minimum(a, b) - ON_LINE_M, np.maximum(a, b) + ON_LINE_M
    hits: IntArray = np.sort(tree.query(box(*low, *high)))
    return hits


def _room_edges(rooms: Sequence[Room]) -> tuple[FloatArray, FloatArray, list[int], list[int]]:
    starts = np.concatenate([room.polygon_m for room in rooms] or [np.empty((0, 2))])
    ends = np.concatenate(
        [np.roll(room.polygon_m, -1, axis=0) for room in rooms] or [np.empty((0, 2))]
    )
    room_of = [index for index, room in enumerate(rooms) for _ in room.polygon_m]
    edge_of = [edge for room in rooms for edge in range(len(room.polygon_m))]
    return starts, ends, room_of, edge_of


def _split(a: FloatArray, b: FloatArray, points: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
    """The segment a to b, cut at the points that lie on it."""
    length = float(np.hypot(*(b - a)))
    along, off = _along_and_off(a, b, points)
    inner = (off < ON_LINE_M) & (along > ON_LINE_M) & (along < length - ON_LINE_M)
    stops = [0.0, *_distinct(np.sort(along[inner])), length]
    corners = [a + (b - a) * (stop / length) for stop in stops]
    return list(pairwise(corners))


def _along_and_off(
    a: FloatArray, b: FloatArray, points: FloatArray
) -> tuple[FloatArray, FloatArray]:
    direction = (b - a) / np.hypot(*(b - a))
    offset = points - a
    across = offset[..., 0] * direction[1] - offset[..., 1] * direction[0]
    return offset @ direction, np.abs(across)


def _distinct(values: FloatArray) -> list[float]:
    kept: list[float] = []
    for value in values:
        if not kept or value - kept[-1] > ON_LINE_M:
            kept.append(float(value))
    return kept


def _nearest_edge(
    point: FloatArray, near: IntArray, starts: FloatArray, ends: FloatArray
) -> int | None:
    """Which of the edges near a point it lies on."""
    if not len(near):
        return None
    start, direction = starts[near], ends[near] - starts[near]
    squared = np.maximum(np.sum(direction**2, axis=1), GRID_M**2)
    share = np.sum((point - start) * direction, axis=1) / squared
    nearest = start + np.clip(share, 0.0, 1.0)[:, None] * direction
    distance = np.hypot(*(point - nearest).T)
    best = int(np.argmin(distance))
    return int(near[best]) if distance[best] < ON_LINE_M else None


def _with_holes(lines: Iterable[WallLine], tunnels: Iterable[Tunnel]) -> Iterator[WallLine]:
    """The lines with the holes of all tunnels that end on them."""
    ends = [(start, end, tunnel) for tunnel in tunnels for start, end in tunnel.ends_m()]
    corners = np.array([[start, end] for start, end, _ in ends]).reshape(-1, 2, 2)
    by_place = shapely.STRtree(shapely.linestrings(corners))
    for line in lines:
        near = _near(by_place, line.start_m, line.end_m)
        along, off = _along_and_off(line.start_m, line.end_m, corners[near])
        low, high, length = along.min(axis=1), along.max(axis=1), line.length_m
        met = (off.max(axis=1) < ON_LINE_M) & (high > ON_LINE_M) & (low < length - ON_LINE_M)
        holes = tuple(
            Hole(max(float(start), 0.0), min(float(end), length), tunnel.low_m, tunnel.high_m)
            for start, end, tunnel in zip(
                low[met], high[met], (ends[index][2] for index in near[met]), strict=True
            )
        )
        yield replace(line, holes=holes)


def _columns(line: WallLine) -> Iterator[tuple[FloatArray, FloatArray, list[Hole]]]:
    """(start, end, holes) of the parts of a line, each with the same holes all along."""
    length = line.length_m
    stops = [0.0, length, *(stop for hole in line.holes for stop in (hole.from_m, hole.to_m))]
    stops = _distinct(np.sort(np.array(stops)))
    stops[-1] = length
    unit = (line.end_m - line.start_m) / length
    for low, high in pairwise(stops):
        holes = [hole for hole in line.holes if hole.from_m < (low + high) / 2 < hole.to_m]
        yield line.start_m + unit * low, line.start_m + unit * high, holes
