"""Masses of moving bodies, as UsdPhysics ranks what a stage says about them."""

from __future__ import annotations

from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np
from pxr import Usd, UsdPhysics

from chord_usd.stage.exchange.mjcf_frames import Frames, numbers
from chord_usd.stage.exchange.mjcf_geoms import density_of

_WATER_KG_PER_M3 = 1000.0
_UNFELT_KG, _UNFELT_M = 1.0, 0.05
"""Mass and radius of a body that nothing says anything about."""


@dataclass(frozen=True, eq=False)
class PieceOfMass:
    """A geom of a moving body."""

    prim: Usd.Prim
    geom: ET.Element
    volume_m3: float


class Masses:
    """Masses of a stage, in kilograms."""

    def __init__(self, stage: Usd.Stage) -> None:
        self._kg = UsdPhysics.GetStageKilogramsPerUnit(stage)

    def share(
        self, body: Usd.Prim, element: ET.Element, felt: list[PieceOfMass], frames: Frames
    ) -> None:
        """Give the geoms of a body their masses, or the body its own where it has none.

        The mass of the body counts, else its density, else what each collider says, else its
        material.
        """
        per_m3 = self._kg / frames.metres**3
        dense = _told(body, "density") * per_m3
        shares = [self._own(one, dense, per_m3) for one in felt]
        whole = _told(body, "mass") * self._kg
        if whole > 0.0 and sum(shares) > 0.0:
            shares = [share * whole / sum(shares) for share in shares]
        for one, share in zip(felt, shares, strict=True):
            one.geom.set("mass", f"{share:.9g}")
        inertia = UsdPhysics.MassAPI(body).GetDiagonalInertiaAttr().Get()
        if sum(shares) <= 0.0 or (inertia and max(inertia) > 0.0):
            _say(element, body, whole or sum(shares) or _UNFELT_KG, inertia, self._kg, frames)

    def _own(self, one: PieceOfMass, dense: float, per_m3: float) -> float:
        mass = _told(one.prim, "mass") * self._kg
        if mass > 0.0 and dense == 0.0:
            return mass
        own = _told(one.prim, "density") or density_of(one.prim)
        return (dense or own * per_m3 or _WATER_KG_PER_M3) * one.volume_m3


def _told(prim: Usd.Prim, name: str) -> float:
    value = prim.GetAttribute(f"physics:{name}").Get() if prim.HasAPI(UsdPhysics.MassAPI) else None
    return float(value or 0.0)


def _say(
    element: ET.Element, body: Usd.Prim, mass: float, inertia: object, kg: float, frames: Frames
) -> None:
    """The inertia of a body in so many words; of a small ball where the stage has none."""
    api = UsdPhysics.MassAPI(body)
    diagonal = np.array(inertia if inertia else (0.0,) * 3) * kg * frames.metres**2
    if diagonal.max() <= 0.0:
        diagonal = np.full(3, 0.4 * mass * _UNFELT_M**2)
    told = {"pos": "0 0 0", "mass": f"{mass:.9g}", "diaginertia": numbers(diagonal)}
    middle = api.GetCenterOfMassAttr().Get()
    if middle is not None and np.isfinite(middle).all():
        matrix = frames.of(body)
        scale = np.linalg.norm(matrix[:3, :3], axis=0)
        told["pos"] = numbers(np.array(middle) * scale)
    axes = api.GetPrincipalAxesAttr().Get()
    if axes is not None and axes.GetLength() > 0.0:
        told["quat"] = numbers([axes.GetReal(), *list(axes.GetImaginary())])
    element.insert(0, ET.Element("inertial", told))
