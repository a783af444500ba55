"""Which view of a room a photographer would take: where to stand, where to look, how to shift.

Plane geometry only. Views are judged by what they show of the furniture and the floor, by how
openly they look into the room, and by what stands too close to the lens.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.scene.geometry import footprint, footprint_polygon, polygons_of
from chord_usd.scene.types import BoolArray, FloatArray, Item

EYE_M = 1.5
SENSOR_MM = (36.0, 20.25)
"""Width and height: a full-frame sensor cut to 16 : 9."""

_SHIFTS_MM = ((-3.6, 1.0), (-6.0, 0.92), (-8.0, 0.84))
"""How far the lens may be shifted, as architecture is photographed, and what a view is worth then.
A shift shows more floor and less ceiling while verticals stay straight; much of it looks steep."""

_FROM_WALL_M = (0.35, 0.25, 0.15)
"""How far from walls and furniture to stand; the next one where the first leaves no place."""

_NARROW_M2 = 9.0
"""In rooms smaller than this one also stands as close to the walls as one can."""

_BLOCKS_FROM_M = 1.3
"""Items whose top is higher hide what is behind them, and nobody stands over them."""

_HEADINGS_DEG = np.arange(0.0, 360.0, 10.0)
_CLEAR_M = 1.5
"""Walls and tall items nearer than this crowd the picture."""

_CROWDING = 0.9
"""Share of its score that a view loses when all of it is crowded."""

_ITEM_WEIGHT = 4.0
"""A square metre of furniture counts as much as this many of bare floor."""

_DEPTH_WEIGHT = 0.15
"""Worth of a view as deep as the room is wide, over that of the whole floor."""

_SAMPLES = 60
"""Points of a room's floor that a view is judged by."""


@dataclass(frozen=True)
class View:
    """A camera that stands upright and looks horizontally, so that verticals stay straight."""

    position_m: tuple[float, float]
    yaw_deg: float
    """Direction it looks to, counter-clockwise from +x."""
    lens_mm: float
    shift_mm: float
    """Of the lens, upwards; negative shows more floor."""


def choose_view(floor: Polygon, items: Sequence[Item], doors_m: Sequence[FloatArray] = ()) -> View:
    """The view that shows most of a room's furniture and floor, from a corner, a wall or a door.

    doors_m: middles of the room's doors, (2,) each. The same room always has the same view.
    """
    lens_mm = 18.0 if floor.area < 12.0 else 20.0 if floor.area < 24.0 else 22.0
    room = _Room(floor, items, lens_mm)
    best, best_score = View((0.0, 0.0), 0.0, lens_mm, _SHIFTS_MM[0][0]), -1.0
    for position in _standpoints(floor, items, doors_m):
        scores = room.scores(position)
        heading, shift = np.unravel_index(int(np.argmax(scores)), scores.shape)
        if scores[heading, shift] > best_score:
            best_score = float(scores[heading, shift])
            x, y = (round(float(value), 3) for value in position)
            yaw_deg, shift_mm = float(_HEADINGS_DEG[heading]), _SHIFTS_MM[int(shift)][0]
            best = View((x, y), yaw_deg, lens_mm, shift_mm)
    return best


class _Room:
    """What there is to see, and what stands before it."""

    def __init__(self, floor: Polygon, items: Sequence[Item], lens_mm: float) -> None:
        self._area_m2, self._lens_mm = floor.area, lens_mm
        self._half_deg = math.degrees(math.atan(SENSOR_MM[0] / 2 / lens_mm))
        in_picture = _turn_deg(_HEADINGS_DEG[None, :], _HEADINGS_DEG[:, None]) < self._half_deg
        self._share: FloatArray = in_picture / in_picture.sum(axis=1, keepdims=True)
        """(H, H) share of the picture's width that each direction takes, for each heading."""
        self._sights_m, self._weights, self._owners = _sights(floor, items)
        edges = [(_edges(floor), -1)]
        edges += [
            (_edges(footprint_polygon(item.box)), index)
            for index, item in enumerate(items)
            if _top_m(item) > _BLOCKS_FROM_M
        ]
        self._edges_m = np.concatenate([lines for lines, _ in edges])
        self._edge_owners = np.concatenate([np.full(len(lines), owner) for lines, owner in edges])

    def scores(self, position: FloatArray) -> FloatArray:
        """(H, S) worth of looking to each of _HEADINGS_DEG with each of _SHIFTS_MM."""
        offset = self._sights_m[:, :2] - position
        seen = self._weights * self._is_seen(position, offset)
        bearing = np.degrees(np.arctan2(offset[:, 1], offset[:, 0]))
        off_axis = _turn_deg(bearing[None, :], _HEADINGS_DEG[:, None])
        off_centre = off_axis / self._half_deg
        across = np.clip((self._half_deg - off_axis) / 8.0, 0.0, 1.0) * (1.0 - 0.3 * off_centre)
        depth = np.hypot(*offset.T)[None, :] * np.cos(np.radians(np.minimum(off_axis, 89.0)))
        height_mm = (self._sights_m[:, 2] - EYE_M)[None, :] / depth * self._lens_mm
        deep, clear = self._openness(position)
        columns = []
        for shift_mm, worth in _SHIFTS_MM:
            upright = np.abs(height_mm - shift_mm) < SENSOR_MM[1] / 2
            columns.append(worth * ((across * upright) @ seen + deep))
        scores: FloatArray = np.column_stack(columns) * clear[:, None]
        return scores

    def _is_seen(self, position: FloatArray, offset: FloatArray) -> BoolArray:
        """(N,) whether nothing stands before each sight; an item does not hide itself."""
        blocks = self._edge_owners[None, :] != self._owners[:, None]
        shares = np.where(blocks, _crossings(position, offset, self._edges_m), np.inf)
        seen: BoolArray = shares.min(axis=1) > 0.999
        return seen

    def _openness(self, position: FloatArray) -> tuple[FloatArray, FloatArray]:
        """For each heading: the worth of its depth, and a factor for how clear it is, each (H,)."""
        bearing = np.radians(_HEADINGS_DEG)
        directions = np.column_stack([np.cos(bearing), np.sin(bearing)])
        free_m = _crossings(position, directions, self._edges_m).min(axis=1)
        width_m = math.sqrt(self._area_m2)
        deep = self._share @ np.minimum(free_m / width_m, 1.5)
        crowded = self._share @ np.clip((_CLEAR_M - free_m) / _CLEAR_M, 0.0, 1.0)
        return _DEPTH_WEIGHT * self._area_m2 * deep, 1.0 - _CROWDING * crowded


def _standpoints(
    floor: Polygon, items: Sequence[Item], doors_m: Sequence[FloatArray]
) -> FloatArray:
    """(N, 2) places to stand: corners of the free floor, middles of its sides, doorways.

    Never inside an item: where there is no room between them one leans over the low ones.
    """
    tall = unary_union([footprint_polygon(i.box) for i in items if _top_m(i) > _BLOCKS_FROM_M])
    everything = unary_union([footprint_polygon(item.box) for item in items])
    enough = 2 if floor.area < _NARROW_M2 else 1
    for obstacles in (everything, tall):
        found: list[FloatArray] = []
        for distance_m in _FROM_WALL_M:
            places = _free_places(floor, obstacles, distance_m, doors_m)
            found += [places] if len(places) else []
            if len(found) == enough or (found and distance_m == _FROM_WALL_M[-1]):
                return np.concatenate(found).round(6)
    return np.array([floor.representative_point().coords[0]])


def _free_places(
    floor: Polygon, obstacles: BaseGeometry, distance_m: float, doors_m: Sequence[FloatArray]
) -> FloatArray:
    """(N, 2) places this far from walls and obstacles, perhaps none."""
    free = floor.buffer(-distance_m, join_style="mitre")
    free = free.difference(obstacles.buffer(distance_m, join_style="mitre"))
    places = [np.empty((0, 2))]
    for part in polygons_of(free):
        ring = np.asarray(part.exterior.coords)
        places += [ring[:-1], (ring[:-1] + ring[1:]) / 2]
    if not free.is_empty:
        nearest = [shapely.shortest_line(free, shapely.Point(door)) for door in doors_m]
        places += [np.array(line.coords[:1]) for line in nearest if line.length < 3 * distance_m]
    return np.concatenate(places)


def _sights(floor: Polygon, items: Sequence[Item]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(N, 3) points worth seeing, on the floor and on items, their (N,) weights and items.

    The floor is item -2; -1 are the walls.
    """
    low_x, low_y, high_x, high_y = floor.bounds
    step = math.sqrt(floor.area / _SAMPLES)
    across = np.arange(low_x + step / 2, high_x, step)
    along = np.arange(low_y + step / 2, high_y, step)
    grid = np.stack(np.meshgrid(across, along), axis=-1).reshape(-1, 2)
    grid = grid[shapely.contains_xy(floor, grid)]
    points = [np.column_stack([grid, np.zeros(len(grid))])]
    weights = [np.full(len(grid), step * step)]
    owners = [np.full(len(grid), -2.0)]
    for index, item in enumerate(items):
        corners = footprint(item.box)
        centre = corners.mean(axis=0)
        spots = np.concatenate([centre + (corners - centre) * 0.9, [centre]])
        height = item.box.center_m[2] + 0.7 * item.box.size_m[2]
        points.append(np.column_stack([spots, np.full(len(spots), height)]))
        area_m2 = item.box.size_m[0] * item.box.size_m[1]
        weights.append(np.full(len(spots), _ITEM_WEIGHT * area_m2 / len(spots)))
        owners.append(np.full(len(spots), float(index)))
    return np.concatenate(points), np.concatenate(weights), np.concatenate(owners)


def _edges(area: Polygon) -> FloatArray:
    """(E, 2, 2) the sides of an area."""
    rings = [np.asarray(ring.coords)[:, :2] for ring in (area.exterior, *area.interiors)]
    return np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])


def _crossings(position: FloatArray, offset: FloatArray, edges_m: FloatArray) -> FloatArray:
    """(N, E) share of each offset (N, 2) after which it crosses each edge; infinite for never."""
    start, side = edges_m[:, 0] - position, edges_m[:, 1] - edges_m[:, 0]
    across = offset[:, 0, None] * side[None, :, 1] - offset[:, 1, None] * side[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (start[:, 0] * side[:, 1] - start[:, 1] * side[:, 0])[None, :] / across
        along = (
            start[None, :, 0] * offset[:, 1, None] - start[None, :, 1] * offset[:, 0, None]
        ) / across
    hits = (share > 1e-9) & (along >= 0.0) & (along <= 1.0)
    return np.where(hits, share, np.inf)


def _turn_deg(a_deg: FloatArray, b_deg: FloatArray) -> FloatArray:
    """Angle between two directions, [0, 180]."""
    turn: FloatArray = np.abs((a_deg - b_deg + 180.0) % 360.0 - 180.0)
    return turn


def _top_m(item: Item) -> float:
    return item.box.center_m[2] + item.box.size_m[2]
