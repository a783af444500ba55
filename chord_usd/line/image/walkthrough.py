"""A walk through a house: from room to room through the doors, around the furniture."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry import Polygon, box
from shapely.geometry.base import BaseGeometry
from shapely.ops import polylabel, unary_union

from chord_usd.base.errors import RenderError
from chord_usd.base.runtime.stages import open_stage, room_prims, storey_prims
from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.types import BoolArray, FloatArray
from chord_usd.line.image.stage_cameras import StageCamera

if TYPE_CHECKING:
    from pxr import Usd

EYE_M = 1.5
FOCAL_M = 0.02
APERTURE_M = 0.036
SHIFT = (0.0, -0.1)
"""Of the lens, over its width: more floor than ceiling, while verticals stay straight."""

_STEP_M = 0.1
"""Side of the squares one walks on."""

_FROM_WALL_M = (0.25, 0.15, 0.08)
"""Distance kept from walls and furniture; the next one where the first leaves rooms unreached."""

_DOOR_REACH_M = 0.5
"""How far before and behind a wall a doorway is free of it."""

_HEAD_ROOM_M = 2.0
"""What hangs higher is in nobody's way."""

_TOUCH_M = 0.01
_SMOOTH_M = 0.6
_LOOK_AHEAD_M = 1.5
"""One looks to where one will be after this way."""


@dataclass(frozen=True, eq=False)
class _House:
    """What a walker has to know of a house, seen from above."""

    rooms: dict[str, Polygon]
    doors: list[Polygon]
    items: list[Polygon]


def walk_cameras(path: Path, count: int) -> tuple[StageCamera, ...]:
    """Views along a walk through all rooms that can be reached, evenly spaced: Walk_000 and on.

    Raises StageError, and RenderError for a stage without rooms.
    """
    house = _read_house(path)
    if not house.rooms:
        raise RenderError(
            "has no rooms to walk through",
            where=str(path),
            expected="a house that chord-usd wrote",
            try_="no <walkthrough>",
        )
    way_m = _smooth(max((_way(house, d) for d in _FROM_WALL_M), key=_rooms_seen(house)))
    along_m = _along(way_m)
    stops = np.linspace(0.0, along_m[-1], count)
    places = _at(way_m, along_m, stops)
    ahead = _at(way_m, along_m, np.minimum(stops + _LOOK_AHEAD_M, along_m[-1]))
    headings = _headings(ahead - places)
    digits = max(3, len(str(count - 1)))
    return tuple(
        _camera(f"Walk_{at:0{digits}d}", place, heading, house)
        for at, (place, heading) in enumerate(zip(places, headings, strict=True))
    )


def _camera(name: str, place_m: FloatArray, heading: FloatArray, house: _House) -> StageCamera:
    """A camera that looks horizontally: x right, y up, z backwards."""
    x, y = (float(value) for value in heading)
    rows = ((y, 0.0, -x, float(place_m[0])), (-x, 0.0, -y, float(place_m[1])))
    at = shapely.Point(place_m)
    return StageCamera(
        name=name,
        room=min(house.rooms, key=lambda room: house.rooms[room].distance(at)),
        matrix=(*rows, (0.0, 1.0, 0.0, EYE_M), (0.0, 0.0, 0.0, 1.0)),
        focal_m=FOCAL_M,
        aperture_m=APERTURE_M,
        shift=SHIFT,
        orthographic=False,
        clip_m=(0.05, 1000.0),
        focus_m=0.0,
        f_stop=0.0,
        from_above=False,
    )


# --- the house ----------------------------------------------------------------------------------


def _read_house(path: Path) -> _House:
    from pxr import Usd

    stage = open_stage(path, load=False)
    storeys = storey_prims(stage)
    if storeys:
        raise RenderError(
            f"the house has {len(storeys)} storeys, and walkthroughs are not made for these yet",
            where=str(path),
            expected="a house of one storey",
        )
    stage.Load()
    rooms, doors, items = {}, [], []
    for room in room_prims(stage):
        if room.HasAttribute("chord:polygon_m"):
            rooms[room.GetName()] = Polygon(np.array(room.GetAttribute("chord:polygon_m").Get()))
        for prim in Usd.PrimRange(room):
            if not prim.HasAttribute("chord:size_m"):
                continue
            if not prim.HasAttribute("chord:rooms"):
                items += footprint_m(prim)
            elif prim.GetAttribute("chord:category").Get() != "window":
                doors += footprint_m(prim, _DOOR_REACH_M)
    return _House(rooms, doors, items)


def footprint_m(prim: Usd.Prim, reach_m: float = 0.0, floor_m: float = 0.0) -> list[Polygon]:
    """Outline of what a prim takes up at walking height over a floor, longer by reach_m front and
    back."""
    from pxr import Gf, Usd, UsdGeom

    length, width, _ = prim.GetAttribute("chord:size_m").Get()
    place = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    x, y, z = place.ExtractTranslation()
    if z > floor_m + _HEAD_ROOM_M:
        return []
    along = place.TransformDir(Gf.Vec3d(1, 0, 0))
    upright = box(-length / 2, -width / 2 - reach_m, length / 2, width / 2 + reach_m)
    yaw = float(np.arctan2(along[1], along[0]))
    turned = affinity.rotate(upright, yaw, origin=(0, 0), use_radians=True)
    return [affinity.translate(turned, x, y)]


# --- the way ------------------------------------------------------------------------------------


def _way(house: _House, distance_m: float) -> FloatArray:
    """(N, 2) from room to room, neighbours first, keeping this distance."""
    doors = [door.buffer(-distance_m * 0.5, join_style="mitre") for door in house.doors]
    # Rooms that touch are one open plan.
    floor = unary_union([room.buffer(_TOUCH_M) for room in house.rooms.values()])
    inside = floor.buffer(-distance_m - _TOUCH_M, join_style="mitre")
    free = unary_union([inside, *doors]).difference(
        unary_union([item.buffer(distance_m) for item in house.items])
    )
    grid = _Grid(free)
    stops = list(_stops(house, free))
    if not stops:
        return np.array([floor.representative_point().coords[0] for floor in house.rooms.values()])
    way = [np.array([stops[0]])]
    left = stops[1:]
    while left:
        lengths, before = grid.ways_from(way[-1][-1])
        reach = [lengths[grid.node(stop)] for stop in left]
        nearest = int(np.argmin(reach))
        if not np.isfinite(reach[nearest]):
            break
        way.append(grid.way_to(left.pop(nearest), before))
    return np.concatenate(way)


def _stops(house: _House, free: BaseGeometry) -> Iterator[FloatArray]:
    """The most open place of each room, (2,), the largest room first."""
    for floor in sorted(house.rooms.values(), key=lambda floor: -floor.area):
        parts = polygons_of(floor.intersection(free))
        if parts:
            most = polylabel(max(parts, key=lambda part: part.area), tolerance=0.05)
            yield np.array([most.x, most.y])


def _rooms_seen(house: _House) -> Callable[[FloatArray], int]:
    """How many rooms a way enters; of equal ones max() takes the first, the widest."""

    def count(way_m: FloatArray) -> int:
        points = shapely.points(way_m)
        return sum(bool(shapely.contains(r, points).any()) for r in house.rooms.values())

    return count


class _Grid:
    """Squares one can stand on, joined to their neighbours."""

    def __init__(self, free: BaseGeometry) -> None:
        from scipy import ndimage, sparse

        low_x, low_y, high_x, high_y = free.bounds if not free.is_empty else (0.0, 0.0, 0.0, 0.0)
        x, y = (
            np.arange(low_x, high_x + _STEP_M, _STEP_M),
            np.arange(low_y, high_y + _STEP_M, _STEP_M),
        )
        self._places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        is_free = shapely.contains_xy(free, self._places).reshape(len(x), len(y))
        room_m = ndimage.distance_transform_edt(np.pad(is_free, 1))[1:-1, 1:-1] * _STEP_M
        # The middle of a passage is nicer to walk in than its edge.
        cost = 1.0 + 0.3 / np.maximum(room_m, _STEP_M)
        starts, ends, lengths = _edges(is_free, cost)
        size = len(self._places)
        self._graph = sparse.csr_matrix((lengths, (starts, ends)), shape=(size, size))
        self._free = np.flatnonzero(is_free.ravel())

    def node(self, place_m: FloatArray) -> int:
        """The free square nearest to a place."""
        off = self._places[self._free] - place_m
        return int(self._free[np.argmin((off**2).sum(axis=1))])

    def ways_from(self, place_m: FloatArray) -> tuple[FloatArray, np.ndarray]:
        """Length of the way to each square, and the square before it."""
        from scipy.sparse.csgraph import dijkstra

        return dijkstra(
            self._graph, directed=False, indices=self.node(place_m), return_predecessors=True
        )

    def way_to(self, place_m: FloatArray, before: np.ndarray) -> FloatArray:
        """(N, 2) the way that ends at a place."""
        nodes = [self.node(place_m)]
        while before[nodes[-1]] >= 0:
            nodes.append(int(before[nodes[-1]]))
        return self._places[nodes[::-1]]


def _edges(is_free: BoolArray, cost: FloatArray) -> tuple[np.ndarray, np.ndarray, FloatArray]:
    """Pairs of free neighbours, straight and diagonal, and what a step between them costs."""
    index = np.arange(is_free.size).reshape(is_free.shape)
    starts, ends, lengths = [], [], []
    for across, along in ((1, 0), (0, 1), (1, 1), (1, -1)):
        here = (slice(0, -across or None), slice(max(0, -along), -along if along > 0 else None))
        there = (slice(across, None), slice(max(0, along), along if along < 0 else None))
        both = is_free[here] & is_free[there]
        starts.append(index[here][both])
        ends.append(index[there][both])
        step = _STEP_M * float(np.hypot(across, along))
        lengths.append(step * (cost[here][both] + cost[there][both]) / 2)
    return np.concatenate(starts), np.concatenate(ends), np.concatenate(lengths)


# --- along the way ------------------------------------------------------------------------------


def _along(way_m: FloatArray) -> FloatArray:
    """(N,) length of the way up to each of its points."""
    steps = np.hypot(*np.diff(way_m, axis=0).T) if len(way_m) > 1 else np.empty(0)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _at(
    way_m: FloatArray, along_m: FloatArray, stops_m: Sequence[float] | FloatArray
) -> FloatArray:
    """(K, 2) points after these lengths."""
    return np.column_stack([np.interp(stops_m, along_m, way_m[:, axis]) for axis in range(2)])


def _smooth(way_m: FloatArray) -> FloatArray:
    """The way without the corners of its squares, evenly spaced."""
    along_m = _along(way_m)
    if along_m[-1] < _SMOOTH_M:
        return way_m
    spaced = _at(way_m, along_m, np.arange(0.0, along_m[-1], _STEP_M / 2))
    half = int(_SMOOTH_M / _STEP_M)
    padded = np.pad(spaced, ((half, half), (0, 0)), mode="edge")
    kernel = np.full(2 * half + 1, 1.0 / (2 * half + 1))
    return np.column_stack([np.convolve(padded[:, axis], kernel, "valid") for axis in range(2)])


def _headings(offsets: FloatArray) -> FloatArray:
    """(K, 2) unit directions; where one does not get on, the one before holds."""
    lengths = np.hypot(*offsets.T)
    headings = np.zeros_like(offsets)
    last = np.array([1.0, 0.0])
    moving = lengths > _LOOK_AHEAD_M / 4
    if moving.any():
        last = offsets[moving][0] / lengths[moving][0]
    for at, offset in enumerate(offsets):
        last = offset / lengths[at] if moving[at] else last
        headings[at] = last
    return headings
