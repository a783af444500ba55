"""Masses, centres and inertias of moving bodies, as UsdPhysics ranks what a stage says of them.

They are written out for each body. MuJoCo would compute them from colliders only where a setting of
the whole model says so, and a robot that is added to the model would then lose its weight.
"""

from __future__ import annotations

from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np
import trimesh
from pxr import Usd, UsdPhysics
from scipy.spatial.transform import Rotation

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.export.exchange.mjcf_frames import Frames, numbers
from chord_usd.line.stage.export.exchange.mjcf_geoms import Shape, density_of

_WATER_KG_PER_M3 = 1000.0
_LEAST_KG_M2 = 1e-9
_DEFAULT_KG, _DEFAULT_M = 1.0, 0.05
"""Mass and radius of a body without any statement of either."""

STILL = {"pos": "0 0 0", "mass": "1", "diaginertia": "1 1 1"}
"""Of a body that stands still, where no engine asks for it, but Drake computes one from meshes if
there is none, and refuses sheets."""


@dataclass(frozen=True, eq=False)
class PieceOfMass:
    """A geom of a moving body."""

    prim: Usd.Prim
    shape: Shape


class Masses:
    """Masses of a stage, in kilograms."""

    def __init__(self, stage: Usd.Stage) -> None:
        self._kg = UsdPhysics.GetStageKilogramsPerUnit(stage)

    def share(
        self, body: Usd.Prim, element: ET.Element, colliders: list[PieceOfMass], frames: Frames
    ) -> None:
        """Give a body its inertial element.

        The mass of the body counts, else its density, else what each collider says, else its
        material.
        """
        per_m3 = self._kg / frames.metres**3
        dense = _stated(body, "density") * per_m3
        shares = [self._mass_of(collider, dense, per_m3) for collider in colliders]
        whole = _stated(body, "mass") * self._kg
        if whole > 0.0 and sum(shares) > 0.0:
            shares = [share * whole / sum(shares) for share in shares]
        inertia = UsdPhysics.MassAPI(body).GetDiagonalInertiaAttr().Get()
        if sum(shares) <= 0.0 or (inertia and max(inertia) > 0.0):
            _say(element, body, whole or sum(shares) or _DEFAULT_KG, inertia, self._kg, frames)
        else:
            element.insert(0, _summed([collider.shape for collider in colliders], shares))

    def _mass_of(self, collider: PieceOfMass, dense: float, per_m3: float) -> float:
        mass = _stated(collider.prim, "mass") * self._kg
        if mass > 0.0 and dense == 0.0:
            return mass
        density = _stated(collider.prim, "density") or density_of(collider.prim)
        return (dense or density * per_m3 or _WATER_KG_PER_M3) * collider.shape.volume_m3


def _summed(shapes: list[Shape], masses: list[float]) -> ET.Element:
    """The inertial element of solids of these masses, in kg."""
    total = sum(masses)
    parts = [inertia_of(shape, mass) for shape, mass in zip(shapes, masses, strict=True)]
    centre = np.average([at for at, _ in parts], axis=0, weights=masses)
    tensor = np.zeros((3, 3))
    for mass, (at, inertia) in zip(masses, parts, strict=True):
        away = at - centre
        tensor += inertia + mass * (away @ away * np.eye(3) - np.outer(away, away))
    tensor += _LEAST_KG_M2 * np.eye(3)
    six = (*np.diag(tensor), tensor[0, 1], tensor[0, 2], tensor[1, 2])
    return ET.Element("inertial", {
        "pos": numbers(centre), "mass": f"{total:.9g}",
        "fullinertia": " ".join(f"{value:.9g}" for value in six),
    })  # fmt: skip


def _stated(prim: Usd.Prim, name: str) -> float:
    value = prim.GetAttribute(f"physics:{name}").Get() if prim.HasAPI(UsdPhysics.MassAPI) else None
    return float(value or 0.0)


def _say(
    element: ET.Element, body: Usd.Prim, mass: float, inertia: object, kg: float, frames: Frames
) -> None:
    """The inertia of a body in so many words; of a small ball where the stage has none."""
    api = UsdPhysics.MassAPI(body)
    diagonal = np.array(inertia if inertia else (0.0,) * 3) * kg * frames.metres**2
    if diagonal.max() <= 0.0:
        diagonal = np.full(3, 0.4 * mass * _DEFAULT_M**2)
    attributes = {"pos": "0 0 0", "mass": f"{mass:.9g}", "diaginertia": numbers(diagonal)}
    middle = api.GetCenterOfMassAttr().Get()
    if middle is not None and np.isfinite(middle).all():
        matrix = frames.of(body)
        scale = np.linalg.norm(matrix[:3, :3], axis=0)
        attributes["pos"] = numbers(np.array(middle) * scale)
    axes = api.GetPrincipalAxesAttr().Get()
    if axes is not None and axes.GetLength() > 0.0:
        attributes["quat"] = numbers([axes.GetReal(), *list(axes.GetImaginary())])
    element.insert(0, ET.Element("inertial", attributes))


# Centres and moments of inertia of the solids that geoms of MJCF are -----------------------------


def inertia_of(shape: Shape, mass_kg: float) -> tuple[FloatArray, FloatArray]:
    """Centre, (3,) in metres, and inertia about it, (3, 3) in kg m2, of an even solid of a mass, in
    the frame of its body."""
    if shape.hull is not None:
        return _of_hull(shape.hull, mass_kg)
    attributes = shape.attributes
    size = np.array([float(word) for word in attributes["size"].split()])
    squares = mass_kg * _mean_squares(attributes["type"], size)
    tensor = np.diag(squares.sum() - squares)
    centre = np.array([float(word) for word in attributes.get("pos", "0 0 0").split()])
    w, x, y, z = (float(word) for word in attributes.get("quat", "1 0 0 0").split())
    turn = Rotation.from_quat([x, y, z, w]).as_matrix()
    return centre, turn @ tensor @ turn.T


def _mean_squares(kind: str, size: FloatArray) -> FloatArray:
    """(3,) means of x, y and z squared over a solid about its middle; size: as MJCF has it."""
    if kind == "box":
        return size**2 / 3
    if kind in ("sphere", "ellipsoid"):
        return np.broadcast_to(size, 3) ** 2 / 5
    radius, half = size
    if kind == "cylinder":
        return np.array([radius**2 / 4, radius**2 / 4, half**2 / 3])
    # A capsule: a cylinder, and two half balls whose middles lie 3/8 of the radius beyond its ends.
    ball = 4 / 3 * radius / (4 / 3 * radius + 2 * half)
    across = ball * radius**2 / 5 + (1 - ball) * radius**2 / 4
    caps = half**2 + 3 / 4 * half * radius + radius**2 / 5
    return np.array([across, across, ball * caps + (1 - ball) * half**2 / 3])


def _of_hull(points: FloatArray, mass_kg: float) -> tuple[FloatArray, FloatArray]:
    hull = trimesh.convex.convex_hull(points)
    return np.array(hull.center_mass), np.array(hull.moment_inertia) * mass_kg / hull.volume
