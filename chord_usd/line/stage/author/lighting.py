"""The house's variant set `lighting`: a day with sky and sun, an evening and a night by the lamps.

Only brightness and colour vary; where the lamps hang is said once, in their rooms.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from pxr import Gf, Sdf
from shapely.geometry import Polygon

from chord_usd.base.raster.hdri import developed
from chord_usd.base.runtime.stages import open_layer
from chord_usd.base.scene.light_panel import panel_for
from chord_usd.base.scene.skies import SKIES, TIMES, Rgb, Sky, Sun, Time, dome_turn_deg, skies_with
from chord_usd.base.scene.tunnels import Tunnel
from chord_usd.base.scene.types import ROOM_HEIGHT_M, ByteArray, FloatArray
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.author.names import NamedRoom
from chord_usd.line.stage.author.prims import (
    Types,
    add_variants,
    attribute,
    define,
    note,
    over,
    place,
    set_op_order,
)
from chord_usd.line.stage.shell.ground import lay_ground
from chord_usd.line.stage.shell.walls import Walls

SCOPE = "/House/Lighting"
_SUN_BESIDE_DEG = 25.0
"""The sun stands this far beside the direction most windows look to: light falls in slantwise."""

_SUN_ANGLE_DEG = 1.2
"""A little larger than the real sun, as on a hazy day: soft edges cost fewer samples."""

_SKY_PX = (64, 64)
"""Width and height of a drawn sky's picture; it only varies with height."""

_CREDIT = {"author": "Greg Zaal, Poly Haven", "licence": "CC0"}
"""Of the HDRIs of Blender's wheel, as stated beside them; CC0 allows us to carry them without their
sun."""

Stops = Sequence[tuple[float, Rgb]]


@dataclass(frozen=True)
class Mood:
    """How lamps shine in one choice of the variant set, as shares of their full brightness."""

    panels: tuple[float, float]
    """The area lights of rooms with windows, and without."""
    panels_k: float
    """Colour temperature of the area lights."""
    lamps: float
    """All others: floor, table, wall, ceiling and pendant lamps."""


MOODS: dict[Time, Mood] = {
    "day": Mood((0.25, 1.0), 5200.0, 0.0),
    "evening": Mood((0.12, 0.25), 3500.0, 1.0),
    "night": Mood((0.05, 0.12), 3200.0, 1.0),
}
"""The first is selected where no sky of another time was chosen."""


def set_lighting(
    layer: Sdf.Layer, lamps: Sequence[Lamp], walls: Walls, folder: Path, sky: Sky = SKIES[0]
) -> None:
    """Write the variant set, what it lights the house with, and the ground around.

    folder: beside the layer's file, for the pictures of sky and ground. sky: what is seen at its
    time, which is selected; the others see the usual ones. Raises ChordError for a sky whose file
    is no HDRI.
    """
    define(layer, SCOPE, "Scope")
    house = layer.GetPrimAtPath("/House")
    yaw_deg = sun_yaw_deg(walls)
    note(layer.GetPrimAtPath(SCOPE), sun_yaw_deg=yaw_deg)
    variants = dict(zip(TIMES, add_variants(house, "lighting", TIMES), strict=True))
    house.variantSelections["lighting"] = sky.time
    skies = skies_with(sky)
    for time, variant in variants.items():
        shine(variant, lamps, MOODS[time])
        seen = _hang_sky(variant, skies[time], yaw_deg, folder)
        if seen.sun:
            _hang_sun(variant, seen.sun, yaw_deg)
    floors = np.vstack([np.asarray(floor.exterior.coords) for floor in walls.floors_m])
    middle = (floors.min(axis=0) + floors.max(axis=0)) / 2
    lay_ground(layer, middle[:2], "paving" if skies["day"].name == "overcast" else "lawn", folder)


def shine(variant: Sdf.PrimSpec, lamps: Iterable[Lamp], mood: Mood) -> None:
    """Say in a variant of the house how bright lamps are."""
    for lamp in lamps:
        spec = over(variant, *str(lamp.path).split("/")[2:])
        share = mood.panels[0 if lamp.by_window else 1] if lamp.is_panel else mood.lamps
        attribute(spec, "inputs:intensity", Types.Float, share * lamp.intensity)
        if lamp.is_panel:
            attribute(spec, "inputs:colorTemperature", Types.Float, mood.panels_k)


def forget(house: Sdf.PrimSpec, lamps: Iterable[Sdf.Path]) -> None:
    """Take what the variants say of lamps out again."""
    for variant in house.variantSets["lighting"].variants.values():
        for path in lamps:
            spec = variant.primSpec
            for name in str(path.GetParentPath()).split("/")[2:]:
                spec = spec and spec.nameChildren.get(name)
            if spec and path.name in spec.nameChildren:
                del spec.nameChildren[path.name]


def variants_of(house: Sdf.PrimSpec) -> Mapping[Time, Sdf.PrimSpec]:
    """What each choice of `lighting` says, in a house that was written before."""
    variants = house.variantSets["lighting"].variants if "lighting" in house.variantSets else {}
    return {time: variants[time].primSpec for time in TIMES if time in variants}


def sun_yaw_deg(walls: Walls) -> float:
    """Direction towards the sun, counter-clockwise from +x: where most glass can see it."""
    candidates = np.arange(0.0, 360.0, 15.0)
    floors = {room.id: floor for room, floor in zip(walls.rooms, walls.floors_m, strict=True)}
    windows = _windows(walls.tunnels.values())
    normals = [_outward(t, floors.get(_owner(t), walls.floors_m[0])) for t in windows]
    if not normals:
        return 225.0
    sides = np.array(normals)
    towards = np.column_stack([np.cos(np.radians(candidates)), np.sin(np.radians(candidates))])
    lit = np.maximum(towards @ sides.T, 0.0).sum(axis=1)
    return float(candidates[int(np.argmax(np.round(lit, 6)))]) + _SUN_BESIDE_DEG


def _windows(tunnels: Iterable[Tunnel]) -> list[Tunnel]:
    """Those that lead outside."""
    return [t for t in tunnels if t.opening.kind == "window" and len(t.opening.room_ids) < 2]


def _owner(tunnel: Tunnel) -> str:
    """Id of the room that a window belongs to, "" for none."""
    return tunnel.opening.room_ids[0] if tunnel.opening.room_ids else ""


def _outward(tunnel: Tunnel, floor: Polygon) -> FloatArray:
    """(2,) direction a room's window looks to, as long as its glass has square metres."""
    box = tunnel.opening.box
    normal = rotation_2d(box.yaw_deg)[:, 1]
    inside = floor.representative_point().coords[0]
    if float((np.array(inside) - np.array(box.center_m[:2])) @ normal) > 0.0:
        normal = -normal
    area: FloatArray = normal * box.size_m[0] * (tunnel.high_m - tunnel.low_m)
    return area


def _hang_sun(variant: Sdf.PrimSpec, shining: Sun, yaw_deg: float) -> None:
    sun = _light(variant, "Sun", "DistantLight")
    attribute(sun, "inputs:angle", Types.Float, _SUN_ANGLE_DEG)
    attribute(sun, "inputs:intensity", Types.Float, shining.irradiance)
    # Else the intensity would be a radiance of the disc, and a larger sun a brighter one.
    attribute(sun, "inputs:normalize", Types.Bool, True)
    attribute(sun, "inputs:enableColorTemperature", Types.Bool, True)
    attribute(sun, "inputs:colorTemperature", Types.Float, shining.kelvin)
    turn = Gf.Vec3f(90.0 - shining.height_deg, 0.0, yaw_deg + 90.0)
    attribute(sun, "xformOp:rotateXYZ", Types.Float3, turn)
    set_op_order(sun, ["xformOp:rotateXYZ"])


def _hang_sky(variant: Sdf.PrimSpec, wanted: Sky, yaw_deg: float, folder: Path) -> Sky:
    """Write a DomeLight; returns the sky with the sun that its picture had."""
    picture = developed(wanted)
    dome = _light(variant, "Sky", "DomeLight")
    attribute(dome, "inputs:intensity", Types.Float, wanted.radiance)
    if picture is None:
        file = folder / f"sky_{wanted.name}.png"
        Image.fromarray(sky_rgb(wanted.stops)).save(file)
        turn_deg = 0.0
    else:
        file = folder / f"sky_{wanted.time if wanted.file else wanted.name}.exr"
        file.write_bytes(picture.exr)
        wanted = picture.sky
        turn_deg = dome_turn_deg(wanted.sun_at_deg, yaw_deg)
        dome.customData = {"chord": {"label": wanted.title, **({} if wanted.file else _CREDIT)}}
    path = Sdf.AssetPath(f"./{folder.name}/{file.name}")
    attribute(dome, "inputs:texture:file", Types.Asset, path)
    attribute(dome, "inputs:texture:format", Types.Token, "latlong")
    attribute(dome, "xformOp:rotateX", Types.Double, 90.0)  # a dome's top is +Y
    attribute(dome, "xformOp:rotateZ", Types.Double, turn_deg)
    set_op_order(dome, ["xformOp:rotateZ", "xformOp:rotateX"])
    return wanted


def _light(variant: Sdf.PrimSpec, name: str, type_name: str) -> Sdf.PrimSpec:
    prim = over(variant, "Lighting", name)
    prim.specifier = Sdf.SpecifierDef
    prim.typeName = type_name
    return prim


def sky_rgb(stops: Stops) -> ByteArray:
    """(H, W, 3) uint8 picture of a sky, longitude across, latitude down."""
    width, height = _SKY_PX
    latitude = np.pi / 2 - (np.arange(height) + 0.5) / height * np.pi
    heights = [stop[0] for stop in stops]
    columns = [np.interp(np.sin(latitude), heights, [s[1][c] for s in stops]) for c in range(3)]
    rows = np.round(255.0 * np.column_stack(columns)).astype(np.uint8)
    return np.repeat(rows[:, None, :], width, axis=1)


# One area light per room, at its centre, sized to it (CHOrD, section 4); and the lights ----------

# A lamp is a component that says where it shines (customData `chord.light` on its root). They are
# found in the layer itself, so that a room that was furnished or dressed again is lit by what is
# there.

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
    """Write the area light of a room, its brightness left open."""
    floor = walls.floors_m[room.index]
    panel = panel_for(floor)
    scope = define(layer, f"{room.path}/Lights", "Scope")
    light = define(layer, scope.path.AppendChild(light_name("AreaLight", room.name)), "RectLight")
    place(light, at_m=(*panel.center_m, ROOM_HEIGHT_M - _BELOW_CEILING_M), yaw_deg=panel.yaw_deg)
    width, height = panel.size_m
    attribute(light, "inputs:width", Types.Float, width)
    attribute(light, "inputs:height", Types.Float, height)
    attribute(light, "inputs:enableColorTemperature", Types.Bool, True)
    by_window = any(tunnel.opening.kind == "window" for tunnel in walls.tunnels_of(room.room.id))
    radiance = _RADIANT_W_PER_M2 * floor.area / (math.pi * width * height)
    return Lamp(light.path, radiance, by_window)


def light_name(lamp: str, room: str) -> str:
    """Of a light's prim; no other light of the house has it."""
    return f"{lamp}_{room}"


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
            light = define(layer, f"{room}/Lights/{light_name(name, room.name)}", "SphereLight")
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
    """Notes of a component about its light; empty for a component that is no lamp."""
    name = spec.referenceList.prependedItems[0].assetPath.removeprefix("./")
    file = next((folder / name for folder in folders if (folder / name).is_file()), None)
    component = open_layer(file) if file else None
    root = component.GetPrimAtPath(f"/{component.defaultPrim}") if component else None
    facts: Mapping[str, Any] = (root.customData.get("chord", {}) if root else {}).get("light", {})
    return facts
