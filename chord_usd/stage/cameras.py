"""Where to photograph a house from: one camera per room and one above it all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from pxr import Gf, Sdf
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.geometry import footprint, footprint_polygon, polygons_of
from chord_usd.stage.names import NamedRoom
from chord_usd.stage.prims import Types, attribute, define, set_op_order
from chord_usd.stage.walls import ROOM_HEIGHT_M, Walls
from chord_usd.types import BoolArray, FloatArray, Item

EYE_M = 1.5
SENSOR_MM = (36.0, 20.25)
"""Width and height: a full-frame sensor cut to 16 : 9."""

SHIFT_MM = -3.6
"""How far the lens is shifted, as architecture is photographed: more floor, less ceiling, and
verticals stay straight."""

TENTHS_PER_MM = 0.01
"""Lenses and sensors are written in tenths of a scene unit, which is a metre here."""

TOP_CAMERA = "Top"
_TOP_LENS_MM = 50.0
_TOP_MARGIN = 1.06
_FROM_WALL_M = (0.35, 0.25, 0.15)
"""How far from walls and furniture to stand; the next one where the first leaves no place."""

_BLOCKS_FROM_M = 1.3
"""Items whose top is higher hide what is behind them, and nobody stands over them."""

_HEADINGS_DEG = np.arange(0.0, 360.0, 7.5)
_CLEAR_M = 1.2
"""Walls and tall items nearer than this crowd the picture."""

_CROWDING = 0.8
"""Share of its score that a view loses when all of it is crowded."""

_ITEM_WEIGHT = 4.0
"""A square metre of furniture counts as much as this many of bare floor."""

_SAMPLES = 60
"""Points of a room's floor that a view is judged by."""


@dataclass(frozen=True)
class View:
    """A camera that stands upright and looks horizontally, so that verticals stay straight."""

    position_m: tuple[float, float]
    yaw_deg: float
    """Direction it looks to, counter-clockwise from +x."""
    lens_mm: float


def set_cameras(layer: Sdf.Layer, rooms: Sequence[NamedRoom], walls: Walls) -> None:
    """Write /House/Cameras: one per room under the room's name, and Top."""
    define(layer, "/House/Cameras", "Scope")
    for room in rooms:
        view = choose_view(walls.floors_m[room.index], [named.item for named in room.items])
        position = Gf.Vec3d(*view.position_m, EYE_M)
        turn = Gf.Vec3f(90.0, 0.0, view.yaw_deg - 90.0)
        _write(layer, room.name, position, turn, view.lens_mm, SHIFT_MM)
    _write(layer, TOP_CAMERA, _above(walls), Gf.Vec3f(0.0, 0.0, 0.0), _TOP_LENS_MM, 0.0)


def choose_view(floor: Polygon, items: Sequence[Item]) -> View:
    """The view that shows most of a room's furniture and floor, from a corner or by a wall."""
    lens_mm = 18.0 if floor.area < 12.0 else 20.0 if floor.area < 24.0 else 22.0
    tall = unary_union([footprint_polygon(i.box) for i in items if _top(i) > _BLOCKS_FROM_M])
    sights_m, weights = _sights(floor, items)
    shapely.prepare(floor)
    shapely.prepare(tall)
    best, best_score = View((0.0, 0.0), 0.0, lens_mm), -1.0
    for position in _standpoints(floor, items, tall):
        seen = weights * _visible(position, sights_m[:, :2], floor, tall)
        scores = _scores(position, sights_m, seen, lens_mm)
        scores *= 1.0 - _CROWDING * _crowded(position, floor, tall, lens_mm)
        heading = int(np.argmax(scores))
        if scores[heading] > best_score:
            best_score = float(scores[heading])
            x, y = (round(float(value), 3) for value in position)
            best = View((x, y), float(_HEADINGS_DEG[heading]), lens_mm)
    return best


def _standpoints(floor: Polygon, items: Sequence[Item], tall: BaseGeometry) -> FloatArray:
    """(N, 2) places to stand: corners of the free floor, and the middles of its sides.

    Never inside an item: where there is no room between them one leans over the low ones.
    """
    footprints = unary_union([footprint_polygon(item.box) for item in items])
    for obstacles in (footprints, tall):
        for distance in _FROM_WALL_M:
            free = floor.buffer(-distance, join_style="mitre")
            free = free.difference(obstacles.buffer(distance, join_style="mitre"))
            rings = [np.asarray(part.exterior.coords) for part in polygons_of(free)]
            if rings:
                middles = [(ring[:-1] + ring[1:]) / 2 for ring in rings]
                return np.round(np.concatenate([ring[:-1] for ring in rings] + middles), 6)
    return np.array([floor.representative_point().coords[0]])


def _sights(floor: Polygon, items: Sequence[Item]) -> tuple[FloatArray, FloatArray]:
    """(N, 3) points worth seeing, on the floor and on items, and (N,) their weights."""
    low_x, low_y, high_x, high_y = floor.bounds
    step = math.sqrt(floor.area / _SAMPLES)
    across, along = (
        np.arange(low_x + step / 2, high_x, step),
        np.arange(low_y + step / 2, high_y, step),
    )
    grid = np.stack(np.meshgrid(across, along), axis=-1).reshape(-1, 2)
    grid = grid[shapely.contains_xy(floor, grid)]
    points = [np.column_stack([grid, np.zeros(len(grid))])]
    weights = [np.full(len(grid), step * step)]
    for item in items:
        corners = footprint(item.box)
        centre = corners.mean(axis=0)
        spots = np.concatenate([centre + (corners - centre) * 0.9, [centre]])
        height = item.box.center_m[2] + 0.7 * item.box.size_m[2]
        points.append(np.column_stack([spots, np.full(len(spots), height)]))
        area = item.box.size_m[0] * item.box.size_m[1]
        weights.append(np.full(len(spots), _ITEM_WEIGHT * area / len(spots)))
    return np.concatenate(points), np.concatenate(weights)


def _visible(
    position: FloatArray, points: FloatArray, floor: Polygon, tall: BaseGeometry
) -> FloatArray:
    """(N,) 1 where neither walls nor tall items stand between the position and the point."""
    # Stopping short of the point lets a tall item itself be seen.
    return _free(position, position + (points - position) * 0.85, floor, tall).astype(float)


def _free(position: FloatArray, ends: FloatArray, floor: Polygon, tall: BaseGeometry) -> BoolArray:
    rays = shapely.linestrings(np.stack([np.broadcast_to(position, ends.shape), ends], axis=1))
    free: BoolArray = shapely.covers(floor, rays) & ~shapely.intersects(tall, rays)
    return free


def _scores(
    position: FloatArray, sights_m: FloatArray, seen: FloatArray, lens_mm: float
) -> FloatArray:
    """(H,) weight in the picture for each heading; what is in the middle counts a little more."""
    offset = sights_m[:, :2] - position
    half_deg = _half_angle_deg(lens_mm)
    bearing = np.degrees(np.arctan2(offset[:, 1], offset[:, 0]))
    off_axis = _turn_deg(bearing[None, :], _HEADINGS_DEG[:, None])
    across = np.clip((half_deg - off_axis) / 8.0, 0.0, 1.0) * (1.0 - 0.3 * off_axis / half_deg)
    depth = np.hypot(*offset.T)[None, :] * np.cos(np.radians(np.minimum(off_axis, 89.0)))
    height_mm = (sights_m[:, 2] - EYE_M)[None, :] / depth * lens_mm
    low_mm, high_mm = SHIFT_MM - SENSOR_MM[1] / 2, SHIFT_MM + SENSOR_MM[1] / 2
    scores: FloatArray = (across * ((low_mm < height_mm) & (height_mm < high_mm))) @ seen
    return scores


def _crowded(
    position: FloatArray, floor: Polygon, tall: BaseGeometry, lens_mm: float
) -> FloatArray:
    """(H,) share of the picture's width that walls or tall items fill from close by."""
    bearing = np.radians(_HEADINGS_DEG)
    ends = position + _CLEAR_M * np.column_stack([np.cos(bearing), np.sin(bearing)])
    blocked = ~_free(position, ends, floor, tall)
    in_picture = _turn_deg(_HEADINGS_DEG[None, :], _HEADINGS_DEG[:, None]) < _half_angle_deg(
        lens_mm
    )
    share: FloatArray = (in_picture @ blocked.astype(float)) / in_picture.sum(axis=1)
    return share


def _half_angle_deg(lens_mm: float) -> float:
    return math.degrees(math.atan(SENSOR_MM[0] / 2 / lens_mm))


def _turn_deg(a_deg: FloatArray, b_deg: FloatArray) -> FloatArray:
    """Angle between two directions, [0, 180]."""
    turn: FloatArray = np.abs((a_deg - b_deg + 180.0) % 360.0 - 180.0)
    return turn


def _above(walls: Walls) -> Gf.Vec3d:
    """Where a camera that looks straight down sees the whole house."""
    low_x, low_y, high_x, high_y = walls.solid_m.bounds
    reach_x = (high_x - low_x) * _TOP_LENS_MM / SENSOR_MM[0]
    reach_y = (high_y - low_y) * _TOP_LENS_MM / SENSOR_MM[1]
    height = ROOM_HEIGHT_M + _TOP_MARGIN * max(reach_x, reach_y)
    return Gf.Vec3d((low_x + high_x) / 2, (low_y + high_y) / 2, height)


def _write(
    layer: Sdf.Layer,
    name: str,
    position: Gf.Vec3d,
    turn_deg: Gf.Vec3f,
    lens_mm: float,
    shift_mm: float,
) -> None:
    camera = define(layer, f"/House/Cameras/{name}", "Camera")
    width, height = SENSOR_MM
    attribute(camera, "clippingRange", Types.Float2, Gf.Vec2f(0.05, 1000.0))
    attribute(camera, "focalLength", Types.Float, lens_mm * TENTHS_PER_MM)
    attribute(camera, "horizontalAperture", Types.Float, width * TENTHS_PER_MM)
    attribute(camera, "verticalAperture", Types.Float, height * TENTHS_PER_MM)
    attribute(camera, "verticalApertureOffset", Types.Float, shift_mm * TENTHS_PER_MM)
    attribute(camera, "xformOp:translate", Types.Double3, position)
    attribute(camera, "xformOp:rotateXYZ", Types.Float3, turn_deg)
    set_op_order(camera, ["xformOp:translate", "xformOp:rotateXYZ"])


def _top(item: Item) -> float:
    return item.box.center_m[2] + item.box.size_m[2]
