"""The cameras of a house: one per room (viewpoints.py chooses where), and for each storey one
straight above and one above a corner, which see it cut open, as a model on a table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from pxr import Gf, Sdf
from shapely.geometry import Polygon

from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.types import FloatArray, Item
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.author.names import NamedRoom
from chord_usd.line.stage.author.prims import Types, attribute, define, note, set_op_order
from chord_usd.line.stage.author.stage_levels import Level, is_shaft
from chord_usd.line.stage.shell.walls import Walls
from chord_usd.line.stage.views.view_places import QUICK, THOROUGH, Effort
from chord_usd.line.stage.views.viewpoints import EYE_M, NEAR_M, SENSOR_MM, View, choose_view

TENTHS_PER_MM = 0.01
"""Lenses and sensors are written in tenths of a scene unit, which is a metre here."""

TENTHS_PER_M = 10.0

TOP_CAMERA = "Top"
ISOMETRIC_CAMERA = "Isometric"
OUTSIDE_CAMERA = "Outside"

_CLEAR_M = 0.1
"""A camera moves when a piece that is in its way comes nearer than this."""

_CLOSE_M = 0.6
"""Tall things so near to where a picture begins hide much of it."""

_LOW_M, _FLAT_M, _HIGH_M = 1.0, 0.05, 2.0
"""Pieces lower than the first are leant over, flatter than the second stood on, and what hangs
higher than the third is in nobody's way."""

_LARGE_M = 0.4
"""Smaller dressing hides nothing."""

_OUTSIDE_LENS_MM = 28.0
_MARGIN = 1.06

_ELEVATION_DEG = math.degrees(math.asin(math.tan(math.radians(30.0))))
"""Of an isometric view, 35.26: all three axes are shortened alike."""

_UPRIGHT_DEG = -90.0
"""Where a view straight down stands to show +y up, as plans do."""

_MANY_ROOMS = 100
"""From more on, few places of each room are tried for its camera."""

_CUT_AT_M = 1.2
"""Where views from above cut the walls."""


def set_cameras(layer: Sdf.Layer, levels: Sequence[Level]) -> None:
    """Write /House/Cameras: one per room under the room's name, Top, and Isometric; these two for
    each storey where there are several, the lowest's without its name."""
    define(layer, "/House/Cameras", "Scope")
    effort = THOROUGH if sum(len(level.rooms) for level in levels) <= _MANY_ROOMS else QUICK
    for level in levels:
        for room in level.rooms:
            if not is_shaft(level, room):
                _set_room_camera(layer, room, level.walls, level.elevation_m, effort)
    for level in levels:
        _set_cut_view(layer, TOP_CAMERA, level, _UPRIGHT_DEG, 90.0)
        _set_cut_view(layer, ISOMETRIC_CAMERA, level, _facing_deg(level.rooms), _ELEVATION_DEG)


def _set_room_camera(
    layer: Sdf.Layer, room: NamedRoom, walls: Walls, floor_m: float, effort: Effort
) -> None:
    openings = [tunnel.opening for tunnel in walls.tunnels_of(room.room.id)]
    floor, items = walls.floors_m[room.index], [named.item for named in room.items]
    dressing = _large(named.item for named in room.dressing)
    _write_view(layer, room.name, choose_view(floor, items, openings, dressing, effort), floor_m)


def _large(dressing: Iterable[Item]) -> list[Item]:
    """Dressing that one sees from afar, or would walk into."""
    return [item for item in _standing(dressing) if max(item.box.size_m) > _LARGE_M]


def clear_camera(
    layer: Sdf.Layer, room_name: str, floor: Polygon, items: Sequence[Item], floor_m: float = 0.0
) -> None:
    """Find a room's camera another place where new furniture or dressing stands in its way.

    floor_m: height of the room's storey.
    """
    camera = layer.GetPrimAtPath(f"/House/Cameras/{room_name}")
    if not camera or "xformOp:translate" not in camera.attributes:
        return
    values = {name: spec.default for name, spec in camera.attributes.items()}
    view = View(
        position_m=tuple(values["xformOp:translate"][:2]),
        yaw_deg=values["xformOp:rotateXYZ"][2] + 90.0,
        lens_mm=values["focalLength"] / TENTHS_PER_MM,
        shift_mm=0.0,
        near_m=values["clippingRange"][0],
    )
    standing = _standing(items)
    if _is_in_way(view, standing):
        _write_view(layer, room_name, choose_view(floor, standing), floor_m)


def _standing(items: Iterable[Item]) -> list[Item]:
    """What one could stand on or walk into: not what lies flat, nor what hangs high."""
    return [
        item for item in items if item.box.center_m[2] < _HIGH_M and item.box.size_m[2] > _FLAT_M
    ]


def _is_in_way(view: View, items: Iterable[Item]) -> bool:
    """Whether something stands where the picture begins: at the lens, or, for a view through a
    wall, at the clipping plane; or is tall and close before it."""
    touches, hides = _first_m(view, _CLEAR_M), _first_m(view, _CLOSE_M)
    through_wall = view.near_m > NEAR_M + 1e-6
    for item in items:
        is_tall = item.box.top_m > _LOW_M
        shape = footprint_polygon(item.box)
        if (through_wall or is_tall) and shape.distance(touches) < _CLEAR_M:
            return True
        if is_tall and shape.intersects(hides):
            return True
    return False


def _first_m(view: View, reach_m: float) -> Polygon:
    """What the picture holds within a reach of where it begins, seen from above."""
    ahead, beside = rotation_2d(view.yaw_deg).T
    corners = []
    for distance_m, sides in ((view.near_m, (-1, 1)), (view.near_m + reach_m, (1, -1))):
        middle = np.array(view.position_m) + distance_m * ahead
        half = distance_m * SENSOR_MM[0] / 2 / view.lens_mm * beside
        corners += [middle + side * half for side in sides]
    return Polygon(corners)


def _write_view(layer: Sdf.Layer, name: str, view: View, floor_m: float = 0.0) -> None:
    turn = Gf.Vec3f(90.0, 0.0, view.yaw_deg - 90.0)
    camera = _camera(layer, name, Gf.Vec3d(*view.position_m, floor_m + EYE_M), turn)
    _set_lens(camera, view.lens_mm, view.shift_mm, view.near_m)


def _set_cut_view(
    layer: Sdf.Layer, kind: str, level: Level, yaw_deg: float, elevation_deg: float
) -> None:
    """An orthographic view of a storey from above; `chord:cut_m` says where walls are cut for it.

    yaw_deg: direction in which it stands, counter-clockwise from +x.
    """
    rise = math.radians(elevation_deg)
    towards = np.array([*rotation_2d(yaw_deg)[:, 0] * math.cos(rise), math.sin(rise)])
    right = np.append(rotation_2d(yaw_deg)[:, 1], 0.0)
    up = np.cross(towards, right)
    outline = np.array(level.walls.solid_m.convex_hull.exterior.coords)[:-1]
    corners = np.array([[x, y, z] for x, y in outline for z in (0.0, _CUT_AT_M)])
    spans = [(float(low), float(high)) for low, high in
             ((along.min(), along.max()) for along in (corners @ right, corners @ up))]  # fmt: skip
    middle = sum(
        (axis * (low + high) / 2 for axis, (low, high) in zip((right, up), spans, strict=True)),
        np.zeros(3),
    )
    wide_m, high_m = (high - low for low, high in spans)
    width_m = _MARGIN * max(wide_m, high_m * SENSOR_MM[0] / SENSOR_MM[1])
    eye = middle + towards * (2.0 * width_m + 10.0) + np.array([0.0, 0.0, level.elevation_m])
    turn = Gf.Vec3f(90.0 - elevation_deg, 0.0, yaw_deg + 90.0)
    name = f"{kind}_{level.group}" if level.elevation_m else kind
    camera = _camera(layer, name, Gf.Vec3d(*eye.tolist()), turn)
    attribute(camera, "projection", Types.Token, "orthographic", uniform=True)
    attribute(camera, "clippingRange", Types.Float2, Gf.Vec2f(NEAR_M, 1000.0))
    height_m = width_m * SENSOR_MM[1] / SENSOR_MM[0]
    attribute(camera, "horizontalAperture", Types.Float, width_m * TENTHS_PER_M)
    attribute(camera, "verticalAperture", Types.Float, height_m * TENTHS_PER_M)
    note(camera, cut_m=level.elevation_m + _CUT_AT_M)


def set_outside(layer: Sdf.Layer, bounds_m: FloatArray, yaw_deg: float, highest_m: float) -> None:
    """Write /House/Cameras/Outside, a level view of all within the bounds, (2, 3).

    yaw_deg: direction in which it stands, counter-clockwise from +x. highest_m: it stands lower.
    """
    (low, high), tangents = bounds_m, np.array(SENSOR_MM) / 2 / _OUTSIDE_LENS_MM
    middle = (low + high) / 2
    middle[2] = min(middle[2], highest_m)
    corners = np.array(
        [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    )
    towards, beside = rotation_2d(yaw_deg).T
    nearer = (corners - middle)[:, :2] @ towards
    aside = np.abs((corners - middle)[:, :2] @ beside) / tangents[0]
    above = np.abs((corners - middle)[:, 2]) / tangents[1]
    reach_m = float((nearer + _MARGIN * np.maximum(aside, above)).max())
    x, y = middle[:2] + towards * reach_m
    turn = Gf.Vec3f(90.0, 0.0, yaw_deg + 90.0)
    camera = _camera(layer, OUTSIDE_CAMERA, Gf.Vec3d(float(x), float(y), float(middle[2])), turn)
    _set_lens(camera, _OUTSIDE_LENS_MM, 0.0, NEAR_M)


def _facing_deg(rooms: Sequence[NamedRoom]) -> float:
    """The diagonal, counter-clockwise from +x, from which most large pieces show their fronts."""
    diagonals = np.arange(45.0, 360.0, 90.0)
    worth = np.zeros(len(diagonals))
    for room in rooms:
        for named in room.items:
            box = named.item.box
            front: FloatArray = -rotation_2d(box.yaw_deg)[:, 1]
            volume_m3 = float(np.prod(box.size_m))
            for at, diagonal in enumerate(diagonals):
                worth[at] += volume_m3 * float(front @ rotation_2d(float(diagonal))[:, 0])
    return float(diagonals[int(np.argmax(worth.round(6)))])


def _camera(layer: Sdf.Layer, name: str, position: Gf.Vec3d, turn_deg: Gf.Vec3f) -> Sdf.PrimSpec:
    camera = define(layer, f"/House/Cameras/{name}", "Camera")
    attribute(camera, "xformOp:translate", Types.Double3, position)
    attribute(camera, "xformOp:rotateXYZ", Types.Float3, turn_deg)
    set_op_order(camera, ["xformOp:translate", "xformOp:rotateXYZ"])
    return camera


def _set_lens(camera: Sdf.PrimSpec, lens_mm: float, shift_mm: float, near_m: float) -> None:
    width, height = SENSOR_MM
    attribute(camera, "clippingRange", Types.Float2, Gf.Vec2f(near_m, 1000.0))
    attribute(camera, "focalLength", Types.Float, lens_mm * TENTHS_PER_MM)
    attribute(camera, "horizontalAperture", Types.Float, width * TENTHS_PER_MM)
    attribute(camera, "verticalAperture", Types.Float, height * TENTHS_PER_MM)
    attribute(camera, "verticalApertureOffset", Types.Float, shift_mm * TENTHS_PER_MM)
