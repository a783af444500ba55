"""Lights and cameras of a stage as glTF has them."""

from __future__ import annotations

import math

import numpy as np
from pxr import Usd, UsdGeom, UsdLux

from chord_usd.line.stage.export.gltf_file import Entry

_LM_PER_W = 1.0 / 0.015
"""Of the lights of houses, which are written in watts; glTF counts candela and lux."""

LUX_PER_UNIT = 150.0
"""Viewers such as three.js show one unit, at their default exposure, as bright as a white wall. In
rooms by day a white wall has so many lux."""

_MM_PER_TENTH = 0.1
"""Lenses are in tenths of a scene unit."""


def light_of(prim: Usd.Prim) -> Entry | None:
    """A light of KHR_lights_punctual; None for what is dark, and for skies, which it has none of.

    A rectangle shines to one side, most straight ahead: a spot of half a circle.
    """
    light = UsdLux.LightAPI(prim)
    intensity = light.GetIntensityAttr().Get() * 2.0 ** light.GetExposureAttr().Get()
    colour = np.array(light.GetColorAttr().Get(), dtype=np.float64)
    if light.GetEnableColorTemperatureAttr().Get():
        kelvin = light.GetColorTemperatureAttr().Get()
        colour = colour * np.array(UsdLux.BlackbodyTemperatureAsRgb(kelvin))
    shining: Entry
    if prim.IsA(UsdLux.DistantLight):
        shining = {"type": "directional"}
        if not light.GetNormalizeAttr().Get():
            half_deg = UsdLux.DistantLight(prim).GetAngleAttr().Get() / 2
            intensity *= math.pi * math.sin(math.radians(half_deg)) ** 2
    elif prim.IsA(UsdLux.RectLight) or prim.IsA(UsdLux.DiskLight):
        cone = {"innerConeAngle": 0.0, "outerConeAngle": math.pi / 2}
        shining = {"type": "spot", "spot": cone}
        intensity *= 1.0 if light.GetNormalizeAttr().Get() else _area_m2(prim)
    elif prim.IsA(UsdLux.SphereLight):
        shining = {"type": "point"}
        radius = UsdLux.SphereLight(prim).GetRadiusAttr().Get()
        # Power of a sphere over all directions; normalized, as Blender's importer reads it.
        intensity *= 0.25 if light.GetNormalizeAttr().Get() else math.pi * radius**2
    else:
        return None
    strongest = colour.max()
    if intensity * strongest <= 0.0:
        return None
    rgb = [round(float(value), 4) for value in colour / strongest]
    candela = round(float(intensity * strongest) * _LM_PER_W, 4)
    return {"name": prim.GetName(), **shining, "color": rgb, "intensity": candela}


def _area_m2(prim: Usd.Prim) -> float:
    if prim.IsA(UsdLux.DiskLight):
        return math.pi * float(UsdLux.DiskLight(prim).GetRadiusAttr().Get()) ** 2
    panel = UsdLux.RectLight(prim)
    return float(panel.GetWidthAttr().Get() * panel.GetHeightAttr().Get())


def camera_of(prim: Usd.Prim, metres: float) -> Entry:
    """A camera of glTF, which knows no shift. metres: of a unit of the stage."""
    # Rooms have the names of their cameras, and some readers place what has a camera's name.
    name = f"{prim.GetName()}_Camera"
    lens = UsdGeom.Camera(prim).GetCamera()
    clip = lens.clippingRange
    reach = {"znear": max(clip.min * metres, 1e-3), "zfar": max(clip.max * metres, 1.0)}
    across, up = lens.horizontalAperture, lens.verticalAperture
    if lens.projection == lens.Orthographic:
        half = _MM_PER_TENTH * metres / 2
        sides = {"xmag": across * half, "ymag": up * half}
        return {"name": name, "type": "orthographic", "orthographic": sides | reach}
    angle = {"yfov": 2.0 * math.atan(up / 2 / lens.focalLength), "aspectRatio": across / up}
    return {"name": name, "type": "perspective", "perspective": angle | reach}
