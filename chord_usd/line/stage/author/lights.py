"""One area light per room, at its centre, sized to it (CHOrD, section 4); and the lights of lamps.

A lamp is a component that says where it shines (customData `chord.light` on its root). They are
found in the layer itself, so that a room that was furnished or dressed again is lit by what is
there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf

from chord_usd.base.runtime.stages import open_layer
from chord_usd.base.scene.light_panel import panel_for
from chord_usd.base.scene.types import ROOM_HEIGHT_M, FloatArray
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.author.names import NamedRoom
from chord_usd.line.stage.author.prims import Types, attribute, define, place
from chord_usd.line.stage.shell.walls import Walls

_BELOW_CEILING_M = 0.03
_RADIANT_W_PER_M2 = 3.0
"""Power per floor area, so that every room is as bright as the next."""

_W_PER_LUMEN = 0.015
"""A panel gives a room what 200 lumens a square metre do."""

_LAMPS_K = 2800.0
"""Colour temperature of lamps that are pieces of furniture or dressing."""

LIGHT_ROOTS = ("Furniture", "Dressing")
"""Groups of a room that may hold lamps."""


@dataclass(frozen=True)
class Lamp:
    """The light of a room, as long as nobody has said how bright it is (lighting.py does)."""

    path: Sdf.Path
    intensity: float
    """USD's intensity when fully on: a panel of area A emits pi * intensity * A, in Blender too."""
    by_window: bool = False
    """Whether daylight reaches its room."""
    is_panel: bool = True
    """The area light of its room, not a lamp that one sees."""


def hang_light(layer: Sdf.Layer, room: NamedRoom, walls: Walls) -> Lamp:
    """Write Lights/AreaLight of a room, its brightness left open."""
    floor = walls.floors_m[room.index]
    panel = panel_for(floor)
    scope = define(layer, f"{room.path}/Lights", "Scope")
    light = define(layer, scope.path.AppendChild("AreaLight"), "RectLight")
    place(light, at_m=(*panel.center_m, ROOM_HEIGHT_M - _BELOW_CEILING_M), yaw_deg=panel.yaw_deg)
    width, height = panel.size_m
    attribute(light, "inputs:width", Types.Float, width)
    attribute(light, "inputs:height", Types.Float, height)
    attribute(light, "inputs:enableColorTemperature", Types.Bool, True)
    by_window = any(tunnel.opening.kind == "window" for tunnel in walls.tunnels_of(room.room.id))
    radiance = _RADIANT_W_PER_M2 * floor.area / (math.pi * width * height)
    return Lamp(light.path, radiance, by_window)


def hang_lamps(layer: Sdf.Layer, room_path: str, folders: Sequence[Path]) -> list[Lamp]:
    """Write a SphereLight for each lamp that stands or hangs in a room, its brightness left open.

    folders: where the packages that the layer refers to are.
    """
    room = Sdf.Path(room_path)
    lamps = []
    for root in LIGHT_ROOTS:
        group = layer.GetPrimAtPath(room.AppendChild(root))
        for spec, to_room in _placed(group, np.eye(4)) if group else ():
            shining = _light_of(spec, folders)
            if not shining:
                continue
            names = str(spec.path.MakeRelativePath(group.path)).split("/")
            name = "_".join(name for name in names if name != "Items")
            light = define(layer, f"{room}/Lights/{name}", "SphereLight")
            at_m = to_room @ np.array([*shining["at_m"], 1.0])
            place(light, at_m=[round(float(x), 4) for x in at_m[:3]])
            attribute(light, "inputs:radius", Types.Float, float(shining["radius_m"]))
            # A power, whatever its size; as Blender's importer takes it.
            attribute(light, "inputs:normalize", Types.Bool, True)
            attribute(light, "inputs:enableColorTemperature", Types.Bool, True)
            attribute(light, "inputs:colorTemperature", Types.Float, _LAMPS_K)
            power = _W_PER_LUMEN * float(shining["lumens"])
            lamps.append(Lamp(light.path, power / math.pi, is_panel=False))
    return lamps


def _placed(spec: Sdf.PrimSpec, outer: FloatArray) -> Iterator[tuple[Sdf.PrimSpec, FloatArray]]:
    """All references below a prim, with (4, 4) their frames in the room."""
    for child in spec.nameChildren:
        frame = outer @ _frame(child)
        if child.referenceList.prependedItems:
            yield child, frame
        else:
            yield from _placed(child, frame)


def _frame(spec: Sdf.PrimSpec) -> FloatArray:
    """(4, 4) of what prims.place wrote."""
    frame = np.eye(4)
    values = {
        name: spec.attributes[f"xformOp:{name}"].default
        for name in ("translate", "rotateZ", "scale")
        if f"xformOp:{name}" in spec.attributes
    }
    frame[:3, 3] = values.get("translate", (0.0, 0.0, 0.0))
    frame[:2, :2] = rotation_2d(values.get("rotateZ", 0.0))
    return frame @ np.diag([*values.get("scale", (1.0, 1.0, 1.0)), 1.0])


def _light_of(spec: Sdf.PrimSpec, folders: Sequence[Path]) -> Mapping[str, Any]:
    """What a component tells of its light; empty for what is no lamp."""
    name = spec.referenceList.prependedItems[0].assetPath.removeprefix("./")
    file = next((folder / name for folder in folders if (folder / name).is_file()), None)
    component = open_layer(file) if file else None
    root = component.GetPrimAtPath(f"/{component.defaultPrim}") if component else None
    told: Mapping[str, Any] = (root.customData.get("chord", {}) if root else {}).get("light", {})
    return told
