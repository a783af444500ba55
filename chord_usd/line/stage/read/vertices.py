"""Meshes of a stage as vertices and triangles, for formats that know no corners of faces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from chord_usd.base.scene.geometry import shared_rows
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.author.surfaces import placed, st_of
from chord_usd.line.stage.shell.mesh import corner_normals, fans

_NORMAL_STEPS = 2.0**20


@dataclass(frozen=True, eq=False)
class Vertices:
    """A mesh as renderers want it: what has two normals or two coordinates is twice."""

    points: FloatArray
    """(N, 3)."""
    normals: FloatArray
    """(N, 3), of length 1."""
    uvs: FloatArray | None
    """(N, 2) with v upwards, as in USD."""
    triangles: np.ndarray
    """(T, 3)."""


def vertices_of(prim: Usd.Prim, frame: FloatArray, placement: FloatArray | None) -> Vertices | None:
    """The mesh of a prim in another frame, (4, 4); corners that agree in all are one vertex.

    placement: (2, 3) of texture coordinates; None for a mesh that needs none.
    """
    mesh = UsdGeom.Mesh(prim)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get() or (), dtype=np.int32)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get() or (), dtype=np.int64)
    if not len(corners):
        return None
    points = np.array(mesh.GetPointsAttr().Get(), dtype=np.float64)
    normals = _per_corner(mesh.GetNormalsAttr().Get(), mesh.GetNormalsInterpolation(), corners)
    if normals is None:
        normals = corner_normals(points[corners], counts)
    keys = [corners, _numbered(normals)]
    uvs = None
    if placement is not None:
        uvs = _uvs(prim, corners, placement)
        keys.append(shared_rows(uvs)[1].astype(np.int64))
    first, index = _same_in_all(keys)
    points, normals = points[corners[first]], normals[first]
    triangles = index[fans(counts)]
    if not np.array_equal(frame, np.eye(4)):
        points = points @ frame[:3, :3].T + frame[:3, 3]
        normals = normals @ np.linalg.inv(frame[:3, :3])
        if np.linalg.det(frame[:3, :3]) < 0.0:
            triangles = triangles[:, ::-1]
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return Vertices(points, normals, None if uvs is None else uvs[first], triangles)


def joined(parts: Sequence[Vertices]) -> Vertices:
    """Several meshes as one. Either all of them have texture coordinates, or none."""
    starts = np.cumsum([0, *(len(part.points) for part in parts[:-1])])
    uvs = [part.uvs for part in parts if part.uvs is not None]
    return Vertices(
        np.vstack([part.points for part in parts]),
        np.vstack([part.normals for part in parts]),
        np.vstack(uvs) if uvs else None,
        np.vstack([part.triangles + at for part, at in zip(parts, starts, strict=True)]),
    )


def tangents_of(mesh: Vertices) -> FloatArray:
    """(N, 4) directions in which u grows, at right angles to the normals and of length 1, and 1
    where v then grows counter-clockwise of u, else -1 (Lengyel, "Tangent space", 2001)."""
    assert mesh.uvs is not None
    corner, right, left = (mesh.points[mesh.triangles[:, at]] for at in range(3))
    (du, dv), (eu, ev) = (
        (mesh.uvs[mesh.triangles[:, at]] - mesh.uvs[mesh.triangles[:, 0]]).T for at in (1, 2)
    )
    twist = du * ev - eu * dv
    share = np.where(np.abs(twist) > 1e-20, 1.0 / np.where(twist == 0.0, 1.0, twist), 0.0)
    along_u = (share * ev)[:, None] * (right - corner) - (share * dv)[:, None] * (left - corner)
    along_v = (share * du)[:, None] * (left - corner) - (share * eu)[:, None] * (right - corner)
    summed = np.zeros((2, len(mesh.points), 3))
    for at in range(3):
        for which, along in enumerate((along_u, along_v)):
            np.add.at(summed[which], mesh.triangles[:, at], along)
    tangents = _upright(summed[0], mesh.normals)
    hand = np.sum(np.cross(mesh.normals, tangents) * summed[1], axis=1)
    return np.column_stack([tangents, np.where(hand < 0.0, -1.0, 1.0)])


def _upright(along: FloatArray, normals: FloatArray) -> FloatArray:
    """(N, 3) directions turned at right angles to normals; any such where there is none."""
    across = along - normals * np.sum(along * normals, axis=1, keepdims=True)
    axis = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    lengths = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(lengths > 1e-12, across, np.cross(normals, axis))
    upright: FloatArray = across / np.linalg.norm(across, axis=1, keepdims=True)
    return upright


def _uvs(prim: Usd.Prim, corners: np.ndarray, placement: FloatArray) -> FloatArray:
    """(C, 2) texture coordinates."""
    st = st_of(prim)
    flat = _per_corner(st.ComputeFlattened(), st.GetInterpolation(), corners) if st else None
    return placed(np.zeros((len(corners), 2)) if flat is None else flat, placement)


def _per_corner(values: Any, interpolation: str, corners: np.ndarray) -> FloatArray | None:
    """(C, K) values of each corner of a mesh; None where there are none."""
    if values is None or not len(values):
        return None
    array = np.array(values, dtype=np.float64)
    if interpolation == UsdGeom.Tokens.constant:
        return np.repeat(array[:1], len(corners), axis=0)
    return array if interpolation == UsdGeom.Tokens.faceVarying else array[corners]


def _numbered(normals: FloatArray) -> np.ndarray:
    """(C,) the same number for the same direction."""
    steps = np.round((normals + 1.0) / 2.0 * (_NORMAL_STEPS - 1.0)).astype(np.int64)
    packed = (steps[:, 0] << 42) | (steps[:, 1] << 21) | steps[:, 2]
    return np.unique(packed, return_inverse=True)[1].reshape(-1)


def _same_in_all(keys: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """First corner of each group that agrees in all keys, and (C,) the group of each corner."""
    together = keys[0]
    for key in keys[1:]:
        together = np.unique(together * (key.max() + 1) + key, return_inverse=True)[1].reshape(-1)
    _, first, index = np.unique(together, return_index=True, return_inverse=True)
    return first, index.reshape(-1)
