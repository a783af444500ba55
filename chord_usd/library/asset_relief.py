"""Assets seen from above: their meshes as heights over a grid."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np

from chord_usd.base.raster.relief import LEAST_HEIGHT, Relief
from chord_usd.base.runtime.asset_stages import open_asset
from chord_usd.base.scene.types import Asset, FloatArray
from chord_usd.library.kept_arrays import Arrays, kept

if TYPE_CHECKING:
    from pxr import Usd

CELL_M = 0.005

_FINE_BITS = 4

_UPPER_SIDE = np.array([[(-1, -1, 1), (1, -1, 1), (1, 1, 1)], [(-1, -1, 1), (1, 1, 1), (-1, 1, 1)]])
"""(2, 3, 3) triangles of a cube's upper side, from -1 to 1."""


def relief_of(asset: Asset) -> Relief:
    """The relief of an asset at its own size, read from its meshes once.

    Parts that rise above its nominal height are in it. Raises AssetError for a file that cannot be
    opened.
    """
    return _read(asset.usd_path, asset.size_m)


@lru_cache(maxsize=256)
def _read(path: Path, size_m: tuple[float, float, float]) -> Relief:
    def measure() -> Arrays:
        seen, felt = triangles_m(path)
        arrays = {"seen": _from_above(seen, size_m)}
        return {**arrays, "felt": _from_above(felt, size_m)} if len(felt) else arrays

    arrays = kept(path, "reliefs", Path(__file__), measure)
    return Relief(arrays["seen"], size_m, arrays.get("felt"))


def _from_above(triangles_m: FloatArray, size_m: tuple[float, float, float]) -> FloatArray:
    """(rows, columns) highest point of triangles (N, 3, 3) in every cell of a footprint."""
    normals_z = np.cross(
        triangles_m[:, 1, :2] - triangles_m[:, 0, :2], triangles_m[:, 2, :2] - triangles_m[:, 0, :2]
    )
    tops_m = triangles_m[:, :, 2].max(axis=1)
    kept = np.abs(normals_z) > 1e-10
    kept &= tops_m > LEAST_HEIGHT * size_m[2]
    rows, columns = (max(round(side / CELL_M), 1) for side in (size_m[1], size_m[0]))
    scale = np.array([columns / size_m[0], -rows / size_m[1]])
    points = triangles_m[kept][:, :, :2] * scale + (columns / 2 - 0.5, rows / 2 - 0.5)
    points = np.rint(points * (1 << _FINE_BITS)).astype(np.int32)
    heights = np.zeros((rows, columns), np.float32)
    # Lower ones first, so that what is highest remains.
    for index in tops_m[kept].argsort(kind="stable"):
        height = float(tops_m[kept][index])
        cv2.fillConvexPoly(heights, points[index], (height,), shift=_FINE_BITS)
    return heights.astype(np.float64)


def triangles_m(path: Path) -> tuple[FloatArray, FloatArray]:
    """(N, 3, 3) corners of all triangles that are shown, and of all that collide.

    Both in the frame of the asset. Of a cube that collides, its upper side.
    """
    from pxr import UsdGeom, UsdPhysics

    stage = open_asset(path)
    transforms = UsdGeom.XformCache()
    seen, felt = [np.zeros((0, 3, 3))], [np.zeros((0, 3, 3))]
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.Gprim):
            continue
        matrix = np.array(transforms.GetLocalToWorldTransform(prim))
        collides = prim.HasAPI(UsdPhysics.CollisionAPI)
        if prim.IsA(UsdGeom.Mesh):
            faces_m = _faces_m(prim, matrix)
            if UsdGeom.Imageable(prim).ComputePurpose() != "guide":
                seen.append(faces_m)
            if collides:
                felt.append(faces_m)
        elif prim.IsA(UsdGeom.Cube) and collides:
            half = UsdGeom.Cube(prim).GetSizeAttr().Get() / 2
            felt.append(_UPPER_SIDE * half @ matrix[:3, :3] + matrix[3, :3])
    return np.concatenate(seen), np.concatenate(felt)


def _faces_m(prim: Usd.Prim, matrix: FloatArray) -> FloatArray:
    """(N, 3, 3) triangles of one mesh; faces are cut into fans."""
    from pxr import UsdGeom

    mesh = UsdGeom.Mesh(prim)
    points = np.array(mesh.GetPointsAttr().Get(), dtype=np.float64).reshape(-1, 3)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(), dtype=np.int64)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get(), dtype=np.int64)
    points = points @ matrix[:3, :3] + matrix[3, :3]
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
    faces = np.repeat(np.arange(len(counts)), np.maximum(counts - 2, 0))
    step = np.arange(len(faces)) - np.searchsorted(faces, faces) + 1
    first = starts[faces]
    return points[np.stack([corners[first], corners[first + step], corners[first + step + 1]], 1)]
