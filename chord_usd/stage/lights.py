"""One area light per room, at its centre, sized to it (CHOrD, section 4)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pxr import Sdf

from chord_usd.scene.light_panel import panel_for
from chord_usd.scene.types import ROOM_HEIGHT_M
from chord_usd.stage.names import NamedRoom
from chord_usd.stage.prims import Types, attribute, define, place
from chord_usd.stage.walls import Walls

_BELOW_CEILING_M = 0.03
_RADIANT_W_PER_M2 = 3.0
"""Power per floor area, so that every room is as bright as the next."""


@dataclass(frozen=True)
class Lamp:
    """The light of a room, as long as nobody has said how bright it is (lighting.py does)."""

    path: Sdf.Path
    radiance: float
    """USD's intensity when fully on: a panel of area A emits pi * radiance * A, in Blender too."""
    by_window: bool
    """Whether daylight reaches its room."""


def hang_light(layer: Sdf.Layer, room: NamedRoom, walls: Walls) -> Lamp:
    """Write Lights/AreaLight of a room, its brightness left open."""
    floor = walls.floors_m[room.index]
    panel = panel_for(floor)
    scope = define(layer, f"/House/Rooms/{room.name}/Lights", "Scope")
    light = define(layer, scope.path.AppendChild("AreaLight"), "RectLight")
    place(light, at_m=(*panel.center_m, ROOM_HEIGHT_M - _BELOW_CEILING_M), yaw_deg=panel.yaw_deg)
    width, height = panel.size_m
    attribute(light, "inputs:width", Types.Float, width)
    attribute(light, "inputs:height", Types.Float, height)
    attribute(light, "inputs:enableColorTemperature", Types.Bool, True)
    by_window = any(tunnel.opening.kind == "window" for tunnel in walls.tunnels_of(room.room.id))
    radiance = _RADIANT_W_PER_M2 * floor.area / (math.pi * width * height)
    return Lamp(light.path, radiance, by_window)
