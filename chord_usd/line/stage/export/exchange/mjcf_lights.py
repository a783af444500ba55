"""Lights and cameras of a stage as MJCF has them."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom, UsdLux

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.export.exchange.mjcf_frames import numbers, placed
from chord_usd.line.stage.export.gltf_lights import light_of

_SUN, _LAMP = 0.6, 0.9
"""How bright they are on MuJoCo's screen, where full is 1: its renderer knows no exposure."""

_FADES = "1 0 0.3"
"""A lamp lights its room and little of the next: its light goes through walls."""

_WIDEST_DEG = 80.0
_MM_PER_TENTH = 0.1
_NEAR_M = 0.3
_SUBJECT_M = 3.0
"""So far from a camera's near plane its picture is as wide as on the stage."""

_WIDTH_PX = 1280


def light_attributes(prim: Usd.Prim, pose: FloatArray) -> dict[str, str] | None:
    """Of a `<light>` in the world; None for what is dark, and for skies."""
    told = light_of(prim)
    if told is None:
        return None
    kind = str(told["type"])
    level = _SUN if kind == "directional" else _LAMP
    found = {
        "type": "directional" if kind == "directional" else kind,
        "pos": numbers(pose[:3, 3]),
        "dir": numbers(-pose[:3, 2]),
        "diffuse": numbers(np.array(told["color"]) * level),
        "specular": "0.1 0.1 0.1",
        "castshadow": "true" if kind == "directional" else "false",
    }
    if kind != "directional":
        found |= {"attenuation": _FADES, "intensity": numbers([told["intensity"]])}
    if kind == "spot":
        found |= {"cutoff": numbers([_WIDEST_DEG]), "exponent": "1"}
    return found


def camera_attributes(prim: Usd.Prim, pose: FloatArray, metres: float) -> dict[str, str]:
    """Of a `<camera>` in the frame of its body, which is moved to where its picture begins.

    MuJoCo has one near plane for all: a camera that looks into a room from behind a wall would see
    the wall. It stands at its own near plane, with a lens as much wider.
    """
    lens = UsdGeom.Camera(prim).GetCamera()
    across, up = lens.horizontalAperture, lens.verticalAperture
    if lens.projection == lens.Orthographic:
        height = numbers([up * _MM_PER_TENTH * metres])
        return {"projection": "orthographic", "fovy": height, **placed(pose)}
    behind_m = lens.clippingRange.min * metres
    wider = 1.0
    if behind_m > _NEAR_M:
        pose = pose.copy()
        pose[:3, 3] -= behind_m * pose[:3, 2]
        wider = 1.0 + behind_m / _SUBJECT_M
    # In metres; any unit would do.
    sensor, focal = np.array([across, up]) * wider * 1e-3, lens.focalLength * 1e-3
    # MuJoCo counts the vertical shift downwards.
    shift = np.array([lens.horizontalApertureOffset, -lens.verticalApertureOffset]) * wider * 1e-3
    told = {
        "sensorsize": numbers(sensor), "focal": numbers([focal, focal]),
        "resolution": f"{_WIDTH_PX} {round(_WIDTH_PX * up / across)}",
    }  # fmt: skip
    if np.abs(shift).max() > 0.0:
        told["principal"] = numbers(shift)
    return told | placed(pose)


def strength(prim: Usd.Prim) -> tuple[bool, float]:
    """By which lights are put in order, the first of which a renderer may take alone."""
    told = light_of(prim) or {"intensity": 0.0}
    return not prim.IsA(UsdLux.DistantLight), -float(told["intensity"])
