"""Reads GLB, OBJ and USD into triangles with colours: one sheet of triangles per material."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from trimesh.resolvers import Resolver

from chord_usd.base.errors import AssetError, ChordError
from chord_usd.base.runtime.confined import decode
from chord_usd.base.runtime.stages import count_prims, open_known, walk
from chord_usd.base.scene.types import ByteArray, FloatArray, frozen_array

if TYPE_CHECKING:
    from PIL.Image import Image

MOST_FILE_BYTES = 600 * 2**20
MOST_TRIANGLES = 12_000_000
"""What can be read and thinned out in the memory of a laptop."""

TEXTURE_PX = 1024
"""Longest side that a picture keeps."""

_USD = (".usd", ".usda", ".usdc", ".usdz")


@dataclass(frozen=True, eq=False)
class Sheet:
    """Triangles of one material, in the mesh's own axes and units."""

    points: FloatArray
    """(N, 3)."""
    faces: np.ndarray
    """(T, 3) indices into points."""
    uvs: FloatArray | None
    """(N, 2) texture coordinates of the points."""
    rgb: tuple[int, int, int]
    """sRGB."""
    roughness: float
    metallic: float
    opacity: float
    texture: ByteArray | None
    """(H, W, 3) sRGB, at most TEXTURE_PX a side."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """A model as its file holds it."""

    sheets: tuple[Sheet, ...]
    unit_m: float | None
    """Metres per unit, where the format says."""
    up: str
    front: str
    """The format's usual axes."""


def read_mesh(path: Path, library: Path | None = None) -> Mesh:
    """The triangles of a file, read in a process of its own.

    library: the folder that textures and buffers may be taken from, by default that of the file.
    Raises AssetError for a mesh without faces, too large, damaged, or with files from elsewhere.
    """
    home = (library or path.parent).resolve()
    if not path.resolve().is_relative_to(home):
        raise AssetError("the mesh is a link out of its library", where=path.name)
    if path.stat().st_size > MOST_FILE_BYTES:
        raise AssetError(
            f"the mesh has {path.stat().st_size / 2**20:.0f} MB",
            where=path.name,
            expected=f"at most {MOST_FILE_BYTES / 2**20:.0f} MB",
        )
    mesh: Mesh = decode("mesh", path.resolve(), home, where=path.name, error=AssetError)
    return mesh


def _read_here(path: Path, home: Path) -> Mesh:
    """The triangles of a file, in this process."""
    is_usd = path.suffix.lower() in _USD
    try:
        mesh = _read_usd(path, home) if is_usd else _read_scene(path, home)
    except (ChordError, MemoryError):
        raise
    # The readers of other people's files fail in every way there is.
    except Exception as error:
        raise AssetError(f"the mesh cannot be read ({error})"[:300], where=path.name) from error
    _require_sound(mesh, path)
    return mesh


def _require_sound(mesh: Mesh, path: Path) -> None:
    count = sum(len(sheet.faces) for sheet in mesh.sheets)
    if count == 0:
        raise AssetError("the mesh has no faces", where=path.name)
    if count > MOST_TRIANGLES:
        raise AssetError(
            f"the mesh has {count:,} triangles",
            where=path.name,
            expected=f"at most {MOST_TRIANGLES:,}",
            try_="reduce it in Blender first",
        )
    for sheet in mesh.sheets:
        if sheet.points.shape[1:] != (3,):
            raise AssetError("the mesh has points that are none in space", where=path.name)
        scalars = (sheet.roughness, sheet.metallic, sheet.opacity)
        uvs = np.zeros(0) if sheet.uvs is None else sheet.uvs
        if not all(np.isfinite(values).all() for values in (sheet.points, uvs, scalars)):
            raise AssetError("the mesh has values that are no numbers", where=path.name)
        if not all(0.0 <= value <= 1.0 for value in scalars):
            raise AssetError(
                "the mesh has a material out of range", where=path.name,
                expected="roughness, metalness and opacity from 0 to 1",
            )  # fmt: skip
        if sheet.faces.min() < 0 or sheet.faces.max() >= len(sheet.points):
            raise AssetError("the mesh has faces without points", where=path.name)


def _read_scene(path: Path, home: Path) -> Mesh:
    """GLB and OBJ through trimesh."""
    import trimesh

    beside = Beside(path.parent, home)
    with path.open("rb") as file:
        scene: Any = trimesh.load(
            file, file_type=path.suffix[1:].lower(), resolver=beside, force="scene", process=False
        )
    if beside.refused:
        raise AssetError(
            f"the mesh names a file outside its library: {beside.refused!r}", where=path.name
        )
    sheets = [
        _sheet_of(geometry)
        for geometry in scene.dump()
        if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces)
    ]
    unit_m = 1.0 if path.suffix.lower() in (".glb", ".gltf") else None
    return Mesh(tuple(sheets), unit_m, "+y", "+z")


def _sheet_of(geometry: Any) -> Sheet:
    material = getattr(geometry.visual, "material", None)
    uvs = getattr(geometry.visual, "uv", None)
    colour = [160, 160, 160, 255]
    if material is not None:
        main = getattr(material, "main_color", None)
        colour = list(main) if main is not None else colour
    elif geometry.visual.kind in ("face", "vertex"):
        colour = list(geometry.visual.main_color)
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    rough = getattr(material, "roughnessFactor", None)
    metal = getattr(material, "metallicFactor", None)
    has_uvs = uvs is not None and len(uvs) == len(geometry.vertices)
    return Sheet(
        points=np.asarray(geometry.vertices, dtype=np.float64),
        faces=np.asarray(geometry.faces, dtype=np.int64),
        uvs=np.asarray(uvs, dtype=np.float64) if has_uvs else None,
        rgb=(int(colour[0]), int(colour[1]), int(colour[2])),
        roughness=0.6 if rough is None else float(rough),
        # What a file does not say is 1 in glTF and would make every sofa a mirror.
        metallic=0.0 if metal is None else float(metal),
        opacity=float(colour[3]) / 255.0,
        texture=_small(image) if has_uvs and image else None,
    )


def _read_usd(path: Path, home: Path) -> Mesh:
    from pxr import Usd, UsdGeom

    outside = walk(path).outside([home])
    if outside is not None:
        raise AssetError(
            f"the mesh names a file outside its library: {outside.name!r}", where=path.name
        )
    stage = open_known(path)
    count_prims(stage, path)
    is_z = UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z
    sheets = [
        sheet
        for prim in stage.Traverse(Usd.TraverseInstanceProxies())
        if prim.IsA(UsdGeom.Mesh)
        for sheet in _usd_sheets(prim, path)
    ]
    unit_m = UsdGeom.GetStageMetersPerUnit(stage)
    return Mesh(tuple(sheets), unit_m, "+z" if is_z else "+y", "-y" if is_z else "+z")


def _small(picture: Image) -> ByteArray:
    """A picture as large as it is used."""
    picture.draft("RGB", (TEXTURE_PX, TEXTURE_PX))
    picture = picture.convert("RGB")
    picture.thumbnail((TEXTURE_PX, TEXTURE_PX))
    return frozen_array(np.asarray(picture), np.uint8)


def _usd_sheets(prim: Any, path: Path) -> Iterator[Sheet]:
    """The triangles of a mesh prim; corners of different texture coordinates become points."""
    from pxr import Usd, UsdGeom

    mesh = UsdGeom.Mesh(prim)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get() or (), dtype=np.int64)
    index = np.array(mesh.GetFaceVertexIndicesAttr().Get() or (), dtype=np.int64)
    local = np.array(mesh.GetPointsAttr().Get() or (), dtype=np.float64).reshape(-1, 3)
    shape = UsdGeom.Imageable(prim)
    hidden = shape.ComputePurpose() in (UsdGeom.Tokens.guide, UsdGeom.Tokens.proxy)
    if hidden or not len(counts) or not len(local):
        return
    matrix = np.array(shape.ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
    points = local @ matrix[:3, :3] + matrix[3, :3]
    corners = _fan(counts)
    if mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded:
        corners = corners[:, ::-1]
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
    uvs = np.array(primvar.ComputeFlattened()) if primvar and primvar.HasValue() else None
    rgb, rough, metal, opacity, image = _usd_material(prim, path)
    if uvs is not None and len(uvs) == len(index):
        yield Sheet(points[index], corners, uvs, rgb, rough, metal, opacity, image)
        return
    by_point = uvs if uvs is not None and len(uvs) == len(points) else None
    image = image if by_point is not None else None
    yield Sheet(points, index[corners], by_point, rgb, rough, metal, opacity, image)


def _fan(counts: np.ndarray) -> np.ndarray:
    """(T, 3) places in the list of corners of the triangles of each polygon."""
    starts = np.cumsum(counts) - counts
    owner = np.repeat(np.arange(len(counts)), np.maximum(counts - 2, 0))
    step = np.arange(len(owner)) - np.searchsorted(owner, owner) + 1
    first = starts[owner]
    return np.stack([first, first + step, first + step + 1], axis=1)


def _usd_material(
    prim: Any, path: Path
) -> tuple[tuple[int, int, int], float, float, float, ByteArray | None]:
    """(colour, roughness, metalness, opacity, texture) of the material of a prim."""
    from PIL import Image as Pictures
    from pxr import UsdGeom, UsdShade

    material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
    surface = material.ComputeSurfaceSource()[0] if material else None
    shown = UsdGeom.Gprim(prim).GetDisplayColorAttr().Get()
    linear = tuple(shown[0]) if shown else (0.35, 0.35, 0.35)
    image = None
    values = {"roughness": 0.6, "metallic": 0.0, "opacity": 1.0}
    if surface:
        for name in values:
            value = surface.GetInput(name).Get() if surface.GetInput(name) else None
            values[name] = float(value) if value is not None else values[name]
        colour = surface.GetInput("diffuseColor")
        if colour and colour.HasConnectedSource():
            source = UsdShade.Shader(colour.GetConnectedSources()[0][0].source.GetPrim())
            file = source.GetInput("file").Get() if source.GetInput("file") else None
            if file and Path(file.resolvedPath).is_file():
                image = _small(Pictures.open(file.resolvedPath))
            linear = (1.0, 1.0, 1.0) if image else linear
        elif colour and colour.Get() is not None:
            linear = tuple(colour.Get())
    red, green, blue = (round(255 * max(0.0, min(1.0, v)) ** (1 / 2.2)) for v in linear)
    rgb = (red, green, blue)
    return rgb, values["roughness"], values["metallic"], values["opacity"], image


# The files that an OBJ or a glTF names: materials, textures, buffers -----------------------------

MOST_BYTES = 600 * 2**20


class Beside(Resolver):  # type: ignore[misc]
    """What trimesh asks for files by name; it gives none from outside a library."""

    def __init__(self, folder: Path, home: Path) -> None:
        """folder: where names start from; home: where files have to lie, links followed."""
        self._folder, self._home = folder, home
        self.refused = ""
        """The last name that led outside."""

    def get(self, name: str) -> bytes:
        """The bytes of a file. Raises FileNotFoundError."""
        name = name.strip()
        place = Path(os.path.realpath(self._folder / name.replace("\\", "/")))
        if not place.is_relative_to(self._home):
            self.refused = name
            raise FileNotFoundError(name)
        if not place.is_file() or place.stat().st_size > MOST_BYTES:
            raise FileNotFoundError(name)
        return place.read_bytes()

    def write(self, name: str, data: bytes) -> None:
        """Part of what trimesh calls a resolver; reading needs none of it."""
        raise NotImplementedError

    def namespaced(self, namespace: str) -> Beside:
        """The same, for names that start from a folder further down."""
        return Beside(self._folder / namespace, self._home)

    def keys(self) -> list[str]:
        """No names are offered, only given when asked for."""
        return []
