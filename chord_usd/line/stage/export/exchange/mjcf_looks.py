"""What is seen, for MJCF: OBJ meshes and materials with a colour map, each written once."""

from __future__ import annotations

import hashlib
import itertools
import json
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import numpy.typing as npt
import trimesh
from PIL import Image
from pxr import Usd, UsdGeom, UsdShade

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.author.surfaces import (
    bound_material,
    opened_picture,
    picture_bytes,
    placement_of,
    texture_of,
    value_of,
)
from chord_usd.line.stage.export.exchange.mjcf_frames import numbers
from chord_usd.line.stage.read.vertices import Vertices, vertices_of

MESHES, TEXTURES = "meshes", "textures"
"""Folders beside the model."""

_LARGEST_PX = 512
_GREY = (0.5, 0.5, 0.5)
_LEAST_M2 = 1e-9
"""MuJoCo refuses meshes that cover nothing."""

Look = tuple[str, FloatArray | None]
"""Name of a material, and (2, 3) what it does to texture coordinates; None where it has no map."""


class Assets:
    """The `<asset>` of a model, and the files that it names."""

    def __init__(self, folder: Path) -> None:
        self.element = ET.Element("asset")
        self._folder = folder
        self._names: set[tuple[str, str]] = set()
        self._looks: dict[str, Look] = {}
        self._same: dict[str, str] = {}
        self._pictures: dict[bytes, str] = {}
        self._meshes: dict[tuple[str, str], str] = {}
        self._files: dict[bytes, str] = {}
        self._hulls: dict[str, str] = {}

    # Materials ------------------------------------------------------------------------------------

    def look_of(self, prim: Usd.Prim) -> Look:
        """The look of a gprim: its material, or its display colour."""
        material = bound_material(prim)
        shader = material.ComputeSurfaceSource()[0] if material else None
        if material is None or not shader:
            return self._material("plain", _shown(prim), {}), None
        key = str(material.GetPath())
        if key not in self._looks:
            self._looks[key] = self._read(material, shader)
        return self._looks[key]

    def _read(self, material: UsdShade.Material, shader: UsdShade.Shader) -> Look:
        texture = texture_of(shader, "diffuseColor")
        plain = value_of(shader, "diffuseColor", _GREY)
        rgb = value_of(texture, "scale", (1.0,) * 4)[:3] if texture else plain
        glow = np.array(value_of(shader, "emissiveColor", (0.0,) * 3), dtype=np.float64)
        rough = float(value_of(shader, "roughness", 0.5))
        attributes = {
            "specular": numbers([0.5 * (1.0 - rough)]), "shininess": numbers([(1.0 - rough) ** 2]),
            "roughness": numbers([rough]),
            "metallic": numbers([float(value_of(shader, "metallic", 0.0))]),
        }  # fmt: skip
        if glow.max() > 0.0:
            attributes["emission"] = numbers([min(float(glow.max()), 1.0)])
        opacity = float(value_of(shader, "opacity", 1.0))
        if texture:
            attributes["texture"] = self._picture(texture)
        colour = [*_as_shown(rgb), opacity] if not texture else [*rgb, opacity]
        name = self._material(material.GetPrim().GetName(), colour, attributes)
        return name, placement_of(texture) if texture else None

    def _material(self, name: str, rgba: list[float], attributes: dict[str, str]) -> str:
        attributes = {"rgba": numbers(np.clip(rgba, 0.0, 1.0)), **attributes}
        content = json.dumps(attributes, sort_keys=True)
        if content not in self._same:
            self._same[content] = self._free("material", name)
            ET.SubElement(self.element, "material", {"name": self._same[content], **attributes})
        return self._same[content]

    def _picture(self, texture: UsdShade.Shader) -> str:
        """A picture as PNG, which is what MuJoCo reads."""
        data = picture_bytes(texture)
        key = hashlib.sha256(data).digest()
        if key not in self._pictures:
            inner = texture.GetInput("file").Get().path.replace("[", "/").rstrip("]")
            name = self._free("texture", _plain(Path(inner).stem))
            with opened_picture(data) as picture:
                shown = picture.convert("RGB")
            shown.thumbnail((_LARGEST_PX, _LARGEST_PX), Image.Resampling.LANCZOS)
            place = self._folder / TEXTURES / f"{name}.png"
            place.parent.mkdir(exist_ok=True)
            shown.save(place, compress_level=3)
            attributes = {"name": name, "type": "2d", "file": place.name, "colorspace": "sRGB"}
            ET.SubElement(self.element, "texture", attributes)
            self._pictures[key] = name
        return self._pictures[key]

    # Meshes ---------------------------------------------------------------------------------------

    def mesh(self, name: str, parts: list[Vertices], scale: FloatArray) -> str | None:
        """Name of a mesh; None for one that covers nothing. One file serves copies of any size."""
        file = self._file(name, parts)
        if file is None:
            return None
        key = file, numbers(scale)
        if key not in self._meshes:
            self._meshes[key] = self._free("mesh", Path(file).stem)
            # Sheets have no volume; what is seen weighs nothing anyway.
            attributes = {"name": self._meshes[key], "file": file, "inertia": "shell"}
            attributes |= {} if np.allclose(scale, 1.0) else {"scale": numbers(scale)}
            ET.SubElement(self.element, "mesh", attributes)
        return self._meshes[key]

    def hull(self, points: FloatArray) -> str:
        """Name of a mesh that collides as the hull of points, (N, 3). It is a file: Drake ignores
        vertices in the model."""
        text = numbers(points.ravel())
        if text not in self._hulls:
            solid = trimesh.convex.convex_hull(points)
            around = Vertices(solid.vertices, solid.vertex_normals, None, solid.faces)
            self._hulls[text] = self._free("mesh", "hull")
            file = self._written("hull", [around])
            attributes = {"name": self._hulls[text], "file": file, "inertia": "convex"}
            ET.SubElement(self.element, "mesh", attributes)
        return self._hulls[text]

    def _file(self, name: str, parts: list[Vertices]) -> str | None:
        triangles = np.vstack([part.points[part.triangles] for part in parts])
        sides = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        if np.linalg.norm(sides, axis=1).sum() / 2 < _LEAST_M2:
            return None
        return self._written(name, parts)

    def _written(self, name: str, parts: list[Vertices]) -> str:
        """Name of the file of a mesh; equal ones are one file."""
        data = _obj(parts).encode()
        key = hashlib.sha256(data).digest()
        if key not in self._files:
            self._files[key] = f"{self._free('file', _plain(name))}.obj"
            place = self._folder / MESHES / self._files[key]
            place.parent.mkdir(exist_ok=True)
            place.write_bytes(data)
        return self._files[key]

    def _free(self, kind: str, name: str) -> str:
        """A name that nothing else of its kind has, not even in capitals: files have them too."""
        taken = (f"{name}_{number}" for number in itertools.count(2))
        free = next(
            candidate
            for candidate in itertools.chain([name], taken)
            if (kind, candidate.casefold()) not in self._names
        )
        self._names.add((kind, free.casefold()))
        return free


def seen_of(
    prim: Usd.Prim, frame: FloatArray, placement: FloatArray | None
) -> Vertices | None:  # fmt: skip
    """The mesh of a prim in a frame of its body; three points are drawn from both sides."""
    vertices = vertices_of(prim, frame, placement)
    if vertices is None or len(vertices.points) > 3:
        return vertices
    return Vertices(
        np.vstack([vertices.points, vertices.points]),
        np.vstack([vertices.normals, -vertices.normals]),
        None if vertices.uvs is None else np.vstack([vertices.uvs, vertices.uvs]),
        np.vstack([vertices.triangles, vertices.triangles[:, ::-1] + len(vertices.points)]),
    )


def _obj(parts: list[Vertices]) -> str:
    """Text of an OBJ: each vertex has one normal, and texture coordinates or none."""
    lines = []
    start = 1
    for part in parts:
        lines += ["v %.6g %.6g %.6g" % (x, y, z) for x, y, z in part.points.tolist()]  # noqa: UP031
    for part in parts:
        lines += ["vn %.4g %.4g %.4g" % (x, y, z) for x, y, z in part.normals.tolist()]  # noqa: UP031
    with_uvs = all(part.uvs is not None for part in parts)
    for part in parts if with_uvs else ():
        lines += ["vt %.6g %.6g" % (u, v) for u, v in part.uvs.tolist()]  # type: ignore[union-attr]  # noqa: UP031
    form = "f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}" if with_uvs else "f {0}//{0} {1}//{1} {2}//{2}"
    for part in parts:
        lines += [form.format(*corners) for corners in (part.triangles + start).tolist()]
        start += len(part.points)
    return "\n".join(lines) + "\n"


def _plain(name: str) -> str:
    """A name of a file that every system can have."""
    kept = "".join(
        char if char.isascii() and (char.isalnum() or char in "_-") else "_" for char in name
    )
    return kept[:80] or "unnamed"


def _shown(prim: Usd.Prim) -> list[float]:
    """Colour of a gprim without a material."""
    primvar = UsdGeom.Gprim(prim).GetDisplayColorPrimvar()
    colours = primvar.ComputeFlattened() if primvar else None
    return [*_as_shown(colours[0] if colours else _GREY), 1.0]


def _as_shown(rgb: npt.ArrayLike) -> list[float]:
    """Linear light as levels of a screen, which is how MuJoCo shows colours."""
    linear = np.clip(np.asarray(rgb, dtype=np.float64), 0.0, 1.0)
    levels = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return [float(level) for level in levels]
