"""Frames as MJCF has them: metres, Z up, turned and moved and never scaled."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom
from scipy.spatial.transform import Rotation

from chord_usd.base.scene.types import FloatArray

STRAIGHT = 1e-4
"""Frames that are less square than this are skewed."""

_Z_UP = {
    "Y": np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]),
    "Z": np.eye(4),
}
_DIGITS = 6


class Frames:
    """Where prims of a stage are, (4, 4) for columns, in metres and Z up."""

    def __init__(self, stage: Usd.Stage) -> None:
        self._cache = UsdGeom.XformCache()
        self.metres = UsdGeom.GetStageMetersPerUnit(stage)
        """Length of a unit of the stage."""
        up = _Z_UP[str(UsdGeom.GetStageUpAxis(stage))]
        self.world = up @ np.diag([self.metres] * 3 + [1.0])
        """Of the stage itself."""

    def of(self, prim: Usd.Prim) -> FloatArray:
        """With whatever scale it has."""
        matrix: FloatArray = self.world @ np.array(self._cache.GetLocalToWorldTransform(prim)).T
        return matrix

    def within(self, prim: Usd.Prim, above: Usd.Prim) -> FloatArray:
        """Of a prim in the frame of one above it, in units of the stage."""
        local, _ = self._cache.ComputeRelativeTransform(prim, above)
        return np.array(local).T


def rigid(matrix: FloatArray) -> FloatArray:
    """The frame without its scale and skew."""
    left, _, right = np.linalg.svd(matrix[:3, :3])
    if np.linalg.det(left @ right) < 0.0:
        left[:, 2] *= -1.0
    pose = np.eye(4)
    pose[:3, :3] = left @ right
    pose[:3, 3] = matrix[:3, 3]
    return pose


def scale_of(matrix: FloatArray) -> FloatArray | None:
    """(3,) of a frame along its own axes; None for one that is skewed."""
    stretch = rigid(matrix)[:3, :3].T @ matrix[:3, :3]
    scale = np.diag(stretch)
    square = np.abs(stretch - np.diag(scale)).max() <= STRAIGHT * np.abs(scale).max()
    return scale if square else None


def turned(quaternion: Gf.Quatf | Gf.Quatd) -> FloatArray:
    """(3, 3) of a rotation of USD."""
    return Rotation.from_quat([*list(quaternion.GetImaginary()), quaternion.GetReal()]).as_matrix()


def dotted(path: Sdf.Path | str) -> str:
    """The path of a prim as a name, with dots, which no name of a prim holds:
    `House.Rooms.Kitchen_0`. Some readers of MJCF refuse slashes."""
    return str(path).strip("/").replace("/", ".")


def numbers(values: Iterable[float]) -> str:
    """As attributes of XML hold them."""
    rounded = np.round(np.asarray(list(values), dtype=np.float64), _DIGITS) + 0.0
    return " ".join(f"{value:.9g}" for value in rounded)


def placed(matrix: FloatArray) -> dict[str, str]:
    """Attributes pos and quat of a rigid frame; those that change nothing are left out."""
    attributes: dict[str, Any] = {}
    if np.abs(matrix[:3, 3]).max() > 0.5 * 10.0**-_DIGITS:
        attributes["pos"] = numbers(matrix[:3, 3])
    x, y, z, w = Rotation.from_matrix(matrix[:3, :3]).as_quat(canonical=True)
    if abs(w) < 1.0 - 1e-12:
        attributes["quat"] = numbers((w, x, y, z))
    return attributes
