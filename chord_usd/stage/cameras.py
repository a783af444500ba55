"""The cameras of a house: one per room and one above it all (viewpoints.py chooses where)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pxr import Gf, Sdf

from chord_usd.stage.names import NamedRoom
from chord_usd.stage.prims import Types, attribute, define, set_op_order
from chord_usd.stage.viewpoints import EYE_M, SENSOR_MM, choose_view
from chord_usd.scene.types import ROOM_HEIGHT_M
from chord_usd.stage.walls import Walls

TENTHS_PER_MM = 0.01
"""Lenses and sensors are written in tenths of a scene unit, which is a metre here."""

TOP_CAMERA = "Top"
_TOP_LENS_MM = 50.0
_TOP_MARGIN = 1.06


def set_cameras(layer: Sdf.Layer, rooms: Sequence[NamedRoom], walls: Walls) -> None:
    """Write /House/Cameras: one per room under the room's name, and Top."""
    define(layer, "/House/Cameras", "Scope")
    for room in rooms:
        doors = [
            np.array(tunnel.opening.box.center_m[:2])
            for tunnel in walls.tunnels_of(room.room.id)
            if tunnel.opening.kind != "window"
        ]
        view = choose_view(walls.floors_m[room.index], [named.item for named in room.items], doors)
        position = Gf.Vec3d(*view.position_m, EYE_M)
        turn = Gf.Vec3f(90.0, 0.0, view.yaw_deg - 90.0)
        _write(layer, room.name, position, turn, view.lens_mm, view.shift_mm)
    _write(layer, TOP_CAMERA, _above(walls), Gf.Vec3f(0.0, 0.0, 0.0), _TOP_LENS_MM, 0.0)


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
