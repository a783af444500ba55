"""A stage as a trimesh scene that exports to GLB: meshes shared by instances, textures, Y up."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import trimesh
from PIL import Image
from pxr import Ar, Usd, UsdGeom, UsdShade
from trimesh.visual.material import PBRMaterial

from chord_usd.scene.types import FloatArray
from chord_usd.stage.mesh import corner_normals, fans
from chord_usd.stage.textures import (
    as_it_is,
    bound_material,
    placed,
    placement_of,
    source_of,
    st_of,
    value_of,
)

_PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
_Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
"""glTF is Y up; Z up turns into it about x."""

_DECIMALS = 6


def scene_of(stage: Usd.Stage) -> trimesh.Scene:
    """All meshes that are rendered, in metres, Y up; nodes are named after prim paths.

    Lights and cameras are left out. Instances of one model share their meshes.
    """
    scene = trimesh.Scene()
    reader = _Reader()
    transforms = UsdGeom.XformCache()
    for prim in Usd.PrimRange(stage.GetDefaultPrim(), _PROXIES):
        if not prim.IsA(UsdGeom.Mesh) or not _is_rendered(prim):
            continue
        world = _Y_UP @ np.array(transforms.GetLocalToWorldTransform(prim)).T
        key = str((prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim).GetPath())
        name = str(prim.GetPath()).strip("/")
        if key in scene.geometry:
            scene.graph.update(frame_to=name, geometry=key, matrix=world)
        else:
            scene.add_geometry(reader.mesh(prim), node_name=name, geom_name=key, transform=world)
    return scene


def _is_rendered(prim: Usd.Prim) -> bool:
    shape = UsdGeom.Imageable(prim)
    shown = shape.ComputeVisibility() != UsdGeom.Tokens.invisible
    aside = (UsdGeom.Tokens.guide, UsdGeom.Tokens.render)  # colliders, and the ground outside
    return shown and shape.ComputePurpose() not in aside


class _Reader:
    """Meshes with their materials, each material read once."""

    def __init__(self) -> None:
        self._materials: dict[str, tuple[PBRMaterial, FloatArray]] = {}

    def mesh(self, prim: Usd.Prim) -> trimesh.Trimesh:
        """A mesh in its own frame, corners merged where point, normal and coordinate agree."""
        mesh = UsdGeom.Mesh(prim)
        counts = np.array(mesh.GetFaceVertexCountsAttr().Get(), dtype=np.int32)
        corners = np.array(mesh.GetFaceVertexIndicesAttr().Get(), dtype=np.int64)
        points = np.array(mesh.GetPointsAttr().Get(), dtype=np.float64)[corners]
        normals = _per_corner(mesh.GetNormalsAttr().Get(), mesh.GetNormalsInterpolation(), corners)
        if normals is None:
            normals = corner_normals(points, counts)
        st = st_of(prim)
        uvs = _per_corner(st.Get(), st.GetInterpolation(), corners) if st else None
        if uvs is None:
            uvs = np.zeros((len(corners), 2))
        material, placement = self._material(prim)
        rows = np.round(np.hstack([points, normals, placed(uvs, placement)]), _DECIMALS)
        unique, index = np.unique(rows, axis=0, return_inverse=True)
        return trimesh.Trimesh(
            unique[:, :3],
            index.reshape(-1)[fans(counts)],
            vertex_normals=unique[:, 3:6],
            visual=trimesh.visual.TextureVisuals(uv=unique[:, 6:8], material=material),
            process=False,
        )

    def _material(self, prim: Usd.Prim) -> tuple[PBRMaterial, FloatArray]:
        """The material a prim wears, and (2, 3) what it does to texture coordinates."""
        bound = bound_material(prim)
        key = str(bound.GetPath()) if bound else ""
        if key not in self._materials:
            self._materials[key] = _read_material(bound) if bound else (PBRMaterial(), as_it_is())
        return self._materials[key]


def _per_corner(values: Any, interpolation: str, corners: np.ndarray) -> FloatArray | None:
    """(C, K) values of each corner of a mesh; None where there are none."""
    if values is None:
        return None
    array = np.array(values, dtype=np.float64)
    return array if interpolation == UsdGeom.Tokens.faceVarying else array[corners]


def _read_material(material: UsdShade.Material) -> tuple[PBRMaterial, FloatArray]:
    shader = material.ComputeSurfaceSource()[0]
    if not shader:
        return PBRMaterial(), as_it_is()
    opacity = float(value_of(shader, "opacity", 1.0))
    texture = source_of(shader, "diffuseColor")
    colour = (1.0, 1.0, 1.0) if texture else tuple(value_of(shader, "diffuseColor", (0.18,) * 3))
    pbr = PBRMaterial(
        name=str(material.GetPath()).strip("/").replace("/", "_"),
        baseColorFactor=[*map(float, colour), opacity],
        baseColorTexture=_image(texture) if texture else None,
        roughnessFactor=float(value_of(shader, "roughness", 0.5)),
        metallicFactor=float(value_of(shader, "metallic", 0.0)),
        alphaMode="BLEND" if opacity < 1.0 else "OPAQUE",
    )
    return pbr, placement_of(texture) if texture else as_it_is()


def _image(texture: UsdShade.Shader) -> Image.Image:
    """A texture's picture, from a folder or out of a package."""
    path = texture.GetInput("file").Get().resolvedPath
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
    picture = Image.open(io.BytesIO(bytes(asset.GetBuffer())))
    picture.load()
    return picture
