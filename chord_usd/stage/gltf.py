"""A stage as a trimesh scene that exports to GLB: meshes shared by instances, textures, Y up."""

from __future__ import annotations

import io
from pathlib import Path
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


def write_glb(stage: Usd.Stage, target: Path) -> None:
    """Write the stage as one .glb file."""
    target.write_bytes(scene_of(stage).export(file_type="glb"))


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
        self._pictures = _Pictures()

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
            read = _read_material(bound, self._pictures) if bound else (PBRMaterial(), as_it_is())
            self._materials[key] = read
        return self._materials[key]


def _per_corner(values: Any, interpolation: str, corners: np.ndarray) -> FloatArray | None:
    """(C, K) values of each corner of a mesh; None where there are none."""
    if values is None:
        return None
    array = np.array(values, dtype=np.float64)
    return array if interpolation == UsdGeom.Tokens.faceVarying else array[corners]


class _Pictures:
    """The pictures of textures, each opened once, from a folder or out of a package."""

    def __init__(self) -> None:
        self._opened: dict[str, Image.Image] = {}
        self._packed: dict[tuple[str, float], Image.Image] = {}

    def of(self, texture: UsdShade.Shader) -> Image.Image:
        """The picture of a texture as it is."""
        path = texture.GetInput("file").Get().resolvedPath
        if path not in self._opened:
            asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
            self._opened[path] = _with_its_bytes(bytes(asset.GetBuffer()))
        return self._opened[path]

    def roughness(self, texture: UsdShade.Shader) -> Image.Image:
        """A roughness map as glTF has it: in green, with blue left to the factor of metal.

        Factors end at 1, so what a stage's scale has beyond that goes into the picture.
        """
        beyond = max(_scale_of(texture), 1.0)
        key = texture.GetInput("file").Get().resolvedPath, round(beyond, 3)
        if key not in self._packed:
            green = np.array(self.of(texture).convert("L"), dtype=np.float64) * beyond
            green = np.clip(np.round(green), 0, 255).astype(np.uint8)
            white = np.full_like(green, 255)
            buffer = io.BytesIO()
            packed = Image.fromarray(np.stack([white, green, white], axis=-1))
            packed.save(buffer, "JPEG", quality=85, subsampling=0)
            self._packed[key] = _with_its_bytes(buffer.getvalue())
        return self._packed[key]


def _with_its_bytes(data: bytes) -> Image.Image:
    """A picture that is exported as the file it was: trimesh would encode JPEGs anew, and worse."""
    picture = Image.open(io.BytesIO(data))
    picture.load()
    if picture.format == "JPEG":
        picture.save = lambda file, **_: file.write(data)  # type: ignore[method-assign]
    return picture


def _scale_of(texture: UsdShade.Shader) -> float:
    return float(value_of(texture, "scale", (1.0,))[0])


def _read_material(
    material: UsdShade.Material, pictures: _Pictures
) -> tuple[PBRMaterial, FloatArray]:
    shader = material.ComputeSurfaceSource()[0]
    if not shader:
        return PBRMaterial(), as_it_is()
    opacity = float(value_of(shader, "opacity", 1.0))
    texture, rough, normal = (
        source_of(shader, name) for name in ("diffuseColor", "roughness", "normal")
    )
    colour = (1.0, 1.0, 1.0) if texture else tuple(value_of(shader, "diffuseColor", (0.18,) * 3))
    roughness = min(_scale_of(rough), 1.0) if rough else value_of(shader, "roughness", 0.5)
    pbr = PBRMaterial(
        name=str(material.GetPath()).strip("/").replace("/", "_"),
        baseColorFactor=[*map(float, colour), opacity],
        baseColorTexture=pictures.of(texture) if texture else None,
        metallicRoughnessTexture=pictures.roughness(rough) if rough else None,
        normalTexture=pictures.of(normal) if normal else None,
        roughnessFactor=float(roughness),
        metallicFactor=float(value_of(shader, "metallic", 0.0)),
        alphaMode="BLEND" if opacity < 1.0 else "OPAQUE",
    )
    return pbr, placement_of(texture) if texture else as_it_is()
