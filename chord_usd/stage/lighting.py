"""The house's variant set `lighting`: a day with sky and sun, an evening by the lamps.

Only brightness and colour vary; where the lamps hang is said once, in their rooms.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image
from pxr import Gf, Sdf
from shapely.geometry import Polygon

from chord_usd.scene.types import ByteArray, FloatArray
from chord_usd.scene.units import rotation_2d
from chord_usd.stage.lights import Lamp
from chord_usd.stage.prims import Types, add_variants, attribute, define, over, set_op_order
from chord_usd.stage.walls import Tunnel, Walls

SCOPE = "/House/Lighting"
_SUN_HEIGHT_DEG = 38.0
_SUN_BESIDE_DEG = 25.0
"""The sun stands this far beside the direction most windows look to: light falls in slantwise."""

_SUN_ANGLE_DEG = 1.2
"""A little larger than the real sun, as on a hazy day: soft edges cost fewer samples."""

_SKY_PX = (64, 64)
"""Width and height of a sky's picture; it only varies with height."""

Stops = tuple[tuple[float, tuple[float, float, float]], ...]


@dataclass(frozen=True)
class Mood:
    """How bright everything is in one choice of the variant set."""

    name: str
    lamps: tuple[float, float]
    """Share of their full brightness of lamps in rooms with windows, and without."""
    lamps_k: float
    """Colour temperature."""
    sky: float
    """Radiance of the brightest part of the sky; a lit wall has about one."""
    sky_stops: Stops
    """(height from -1 below to 1 above, sRGB in [0, 1])."""
    sun: float
    """Irradiance of a surface that faces the sun; 0 for none."""
    sun_k: float = 5500.0


DAY = Mood(
    name="day",
    lamps=(0.35, 1.0),
    lamps_k=5200.0,
    sky=6.0,
    sky_stops=(
        (-1.0, (0.58, 0.56, 0.54)),
        (-0.01, (0.68, 0.66, 0.64)),
        (0.01, (0.98, 0.99, 1.0)),
        (0.4, (0.81, 0.90, 1.0)),
        (1.0, (0.66, 0.80, 1.0)),
    ),
    sun=16.0,
)
EVENING = Mood(
    name="evening",
    lamps=(1.0, 1.0),
    lamps_k=4300.0,
    sky=0.35,
    sky_stops=(
        (-1.0, (0.10, 0.10, 0.13)),
        (-0.01, (0.22, 0.20, 0.24)),
        (0.01, (0.98, 0.66, 0.48)),
        (0.25, (0.45, 0.47, 0.68)),
        (1.0, (0.16, 0.22, 0.45)),
    ),
    sun=0.0,
)
MOODS = (DAY, EVENING)
"""Choices of the variant set; the first one is selected."""


def set_lighting(layer: Sdf.Layer, lamps: Sequence[Lamp], walls: Walls, folder: Path) -> None:
    """Write the variant set and what it lights the house with.

    folder: beside the layer's file, for the pictures of the skies.
    """
    define(layer, SCOPE, "Scope")
    house = layer.GetPrimAtPath("/House")
    variants = add_variants(house, "lighting", [mood.name for mood in MOODS])
    for mood, variant in zip(MOODS, variants, strict=True):
        for lamp in lamps:
            spec = over(variant, *str(lamp.path).split("/")[2:])
            share = mood.lamps[0] if lamp.by_window else mood.lamps[1]
            attribute(spec, "inputs:intensity", Types.Float, share * lamp.radiance)
            attribute(spec, "inputs:colorTemperature", Types.Float, mood.lamps_k)
        _hang_sky(variant, mood, folder)
        if mood.sun:
            _hang_sun(variant, mood, sun_yaw_deg(walls))


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


def _hang_sun(variant: Sdf.PrimSpec, mood: Mood, yaw_deg: float) -> None:
    sun = _light(variant, "Sun", "DistantLight")
    attribute(sun, "inputs:angle", Types.Float, _SUN_ANGLE_DEG)
    attribute(sun, "inputs:intensity", Types.Float, mood.sun)
    # Else the intensity would be a radiance of the disc, and a larger sun a brighter one.
    attribute(sun, "inputs:normalize", Types.Bool, True)
    attribute(sun, "inputs:enableColorTemperature", Types.Bool, True)
    attribute(sun, "inputs:colorTemperature", Types.Float, mood.sun_k)
    turn = Gf.Vec3f(90.0 - _SUN_HEIGHT_DEG, 0.0, yaw_deg + 90.0)
    attribute(sun, "xformOp:rotateXYZ", Types.Float3, turn)
    set_op_order(sun, ["xformOp:rotateXYZ"])


def _hang_sky(variant: Sdf.PrimSpec, mood: Mood, folder: Path) -> None:
    file = folder / f"sky_{mood.name}.png"
    Image.fromarray(sky_rgb(mood.sky_stops)).save(file)
    sky = _light(variant, "Sky", "DomeLight")
    attribute(sky, "inputs:intensity", Types.Float, mood.sky)
    path = Sdf.AssetPath(f"./{folder.name}/{file.name}")
    attribute(sky, "inputs:texture:file", Types.Asset, path)
    attribute(sky, "inputs:texture:format", Types.Token, "latlong")
    attribute(sky, "xformOp:rotateX", Types.Double, 90.0)  # a dome's top is +Y
    set_op_order(sky, ["xformOp:rotateX"])


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
