"""A stage as a trimesh scene that exports to GLB: meshes shared by instances, textures, Y up."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import trimesh
from PIL import Image
from pxr import Ar, Usd, UsdGeom, UsdShade
from trimesh.visual.material import PBRMaterial

from chord_usd.stage.mesh import corner_normals
from chord_usd.types import FloatArray
from chord_usd.units import rotation_2d

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
    return shown and shape.ComputePurpose() != UsdGeom.Tokens.guide


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
        st = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
        uvs = _per_corner(st.Get(), st.GetInterpolation(), corners) if st else None
        if uvs is None:
            uvs = np.zeros((len(corners), 2))
        material, placement = self._material(prim)
        uvs = np.column_stack([uvs, np.ones(len(uvs))]) @ placement.T
        rows = np.round(np.hstack([points, normals, uvs]), _DECIMALS)
        unique, index = np.unique(rows, axis=0, return_inverse=True)
        return trimesh.Trimesh(
            unique[:, :3],
            index.reshape(-1)[_fans(counts)],
            vertex_normals=unique[:, 3:6],
            visual=trimesh.visual.TextureVisuals(uv=unique[:, 6:8], material=material),
            process=False,
        )

    def _material(self, prim: Usd.Prim) -> tuple[PBRMaterial, FloatArray]:
        """The material a prim wears, and (2, 3) what it does to texture coordinates."""
        bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        key = str(bound.GetPath()) if bound else ""
        if key not in self._materials:
            self._materials[key] = _read_material(bound) if bound else (PBRMaterial(), _plain())
        return self._materials[key]


def _per_corner(values: Any, interpolation: str, corners: np.ndarray) -> FloatArray | None:
    """(C, K) values of each corner of a mesh; None where there are none."""
    if values is None:
        return None
    array = np.array(values, dtype=np.float64)
    return array if interpolation == UsdGeom.Tokens.faceVarying else array[corners]


def _fans(counts: np.ndarray) -> np.ndarray:
    """(T, 3) corners of the triangles of convex faces, fanned from the first corner of each."""
    starts = np.cumsum(counts) - counts
    faces = np.repeat(np.arange(len(counts)), counts - 2)
    step = np.arange(len(faces)) - np.searchsorted(faces, faces) + 1
    first = starts[faces]
    return np.stack([first, first + step, first + step + 1], axis=1)


def _plain() -> FloatArray:
    return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def _read_material(material: UsdShade.Material) -> tuple[PBRMaterial, FloatArray]:
    shader = material.ComputeSurfaceSource()[0]
    if not shader:
        return PBRMaterial(), _plain()
    opacity = float(_value(shader, "opacity", 1.0))
    texture = _source(shader, "diffuseColor")
    colour = (1.0, 1.0, 1.0) if texture else tuple(_value(shader, "diffuseColor", (0.18,) * 3))
    pbr = PBRMaterial(
        name=str(material.GetPath()).strip("/").replace("/", "_"),
        baseColorFactor=[*map(float, colour), opacity],
        baseColorTexture=_image(texture) if texture else None,
        roughnessFactor=float(_value(shader, "roughness", 0.5)),
        metallicFactor=float(_value(shader, "metallic", 0.0)),
        alphaMode="BLEND" if opacity < 1.0 else "OPAQUE",
    )
    return pbr, _placement(texture) if texture else _plain()


def _value(shader: UsdShade.Shader, name: str, default: Any) -> Any:
    """An input that is a constant; the default where it is a texture or absent."""
    attributes = (
        shader.GetInput(name).GetValueProducingAttributes() if shader.GetInput(name) else []
    )
    value = attributes[0].Get() if attributes else None
    return default if value is None else value


def _source(shader: UsdShade.Shader, name: str) -> UsdShade.Shader | None:
    """The shader that an input is connected to."""
    wire = shader.GetInput(name)
    sources = wire.GetConnectedSources()[0] if wire else []
    return UsdShade.Shader(sources[0].source.GetPrim()) if sources else None


def _image(texture: UsdShade.Shader) -> Image.Image:
    """A texture's picture, from a folder or out of a package."""
    path = texture.GetInput("file").Get().resolvedPath
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
    picture = Image.open(io.BytesIO(bytes(asset.GetBuffer())))
    picture.load()
    return picture


def _placement(texture: UsdShade.Shader) -> FloatArray:
    """(2, 3) of the UsdTransform2d before a texture: scale, then turn, then shift."""
    place = _source(texture, "st")
    if place is None or place.GetIdAttr().Get() != "UsdTransform2d":
        return _plain()
    scale = np.diag(np.array(_value(place, "scale", (1.0, 1.0)), dtype=np.float64))
    turn = rotation_2d(float(_value(place, "rotation", 0.0)))
    shift = np.array(_value(place, "translation", (0.0, 0.0)), dtype=np.float64)
    return np.column_stack([turn @ scale, shift])
