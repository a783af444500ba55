"""Materials of a stage as materials of a GLB, one for all that look the same."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any

import numpy as np
from PIL import Image
from pxr import UsdShade

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.author.surfaces import (
    opened_picture,
    picture_bytes,
    placement_of,
    texture_of,
    value_of,
)
from chord_usd.line.stage.export.gltf_file import Entry, GltfFile

_TYPES = {"JPEG": "image/jpeg", "PNG": "image/png"}
_QUALITY, _SMALL_QUALITY = 85, 75
_DIGITS = 5

Look = tuple[int, FloatArray | None]
"""Place of a material, and (2, 3) what it does to texture coordinates; None where it has none."""

Packed = tuple[bytes, str]
"""A picture's file and its format, as PIL calls it."""


class Looks:
    """Materials, each read once, and written once however many look alike."""

    def __init__(self, file: GltfFile, pool: Executor, most_px: int | None = None) -> None:
        """pool: packs pictures. most_px: their longer side, at most; None leaves them as they
        are."""
        self._file = file
        self._read: dict[tuple[str, bool], Look] = {}
        self._places: dict[str, int] = {}
        self._reliefs: set[int | None] = set()
        self._pictures = _Pictures(file, pool, most_px)

    def of(self, material: UsdShade.Material | None, *, two_sided: bool) -> Look | None:
        """The look of a material; None where nothing is bound."""
        shader = material.ComputeSurfaceSource()[0] if material else None
        if not material or not shader:
            return None
        key = str(material.GetPath()), two_sided
        if key not in self._read:
            entry, placement = self._entry(shader)
            if two_sided:
                entry["doubleSided"] = True
            content = json.dumps(entry, sort_keys=True)
            if content not in self._places:
                named = {"name": material.GetPrim().GetName(), **entry}
                self._places[content] = self._file.add("materials", named)
                if "normalTexture" in entry:
                    self._reliefs.add(self._places[content])
            self._read[key] = self._places[content], placement
        return self._read[key]

    def has_relief(self, material: int | None) -> bool:
        """Whether the material at a place has a normal map."""
        return material in self._reliefs

    def finish(self) -> None:
        """Write the pictures, once all materials are there."""
        self._pictures.finish()

    def _entry(self, shader: UsdShade.Shader) -> tuple[Entry, FloatArray | None]:
        inputs = ("diffuseColor", "roughness", "normal", "emissiveColor")
        colour, rough, normal, glow = (texture_of(shader, name) for name in inputs)
        opacity = float(value_of(shader, "opacity", 1.0))
        metallic = float(value_of(shader, "metallic", 0.0))
        # Constants under a texture are its mean, for readers without pictures.
        rgb = value_of(colour, "scale", (1.0,) * 4)[:3] if colour else _rgb(shader, "diffuseColor")
        surface: Entry = {"baseColorFactor": _rounded([*rgb, opacity])}
        surface["metallicFactor"] = _rounded([metallic])[0]
        scale = float(value_of(rough, "scale", (1.0,))[0]) if rough else 1.0
        roughness = min(scale, 1.0) if rough else float(value_of(shader, "roughness", 0.5))
        surface["roughnessFactor"] = _rounded([roughness])[0]
        entry: Entry = {"pbrMetallicRoughness": surface}
        if colour:
            surface["baseColorTexture"] = {"index": self._pictures.of(colour)}
        if rough:
            picture = self._pictures.roughness(rough, max(scale, 1.0), is_metal=metallic > 0.0)
            surface["metallicRoughnessTexture"] = {"index": picture}
        if normal:
            entry["normalTexture"] = {"index": self._pictures.of(normal, is_colour=False)}
        self._shine(entry, shader, glow)
        if opacity < 1.0:
            cut = float(value_of(shader, "opacityThreshold", 0.0))
            entry |= {"alphaMode": "MASK", "alphaCutoff": cut} if cut else {"alphaMode": "BLEND"}
        drawn = colour or rough or normal or glow
        return entry, (placement_of(drawn) if drawn else None)

    def _shine(self, entry: Entry, shader: UsdShade.Shader, glow: UsdShade.Shader | None) -> None:
        """What a material emits; beyond white that takes an extension."""
        emitted = value_of(glow, "scale", (1.0,) * 4)[:3] if glow else _rgb(shader, "emissiveColor")
        strength = max(map(float, emitted))
        if strength <= 0.0:
            return
        beyond = max(strength, 1.0)
        entry["emissiveFactor"] = _rounded([value / beyond for value in emitted])
        if glow:
            entry["emissiveTexture"] = {"index": self._pictures.of(glow)}
        if beyond > 1.0:
            self._file.extend("KHR_materials_emissive_strength")
            said = {"emissiveStrength": _rounded([beyond])[0]}
            entry["extensions"] = {"KHR_materials_emissive_strength": said}


def _rgb(shader: UsdShade.Shader, name: str) -> Any:
    return value_of(shader, name, (0.18,) * 3 if name == "diffuseColor" else (0.0,) * 3)


def _rounded(values: list[float]) -> list[float]:
    return [round(float(value), _DIGITS) for value in values]


class _Pictures:
    """The pictures of textures, from a folder or out of a package, each written once."""

    def __init__(self, file: GltfFile, pool: Executor, most_px: int | None) -> None:
        self._file, self._pool, self._most_px = file, pool, most_px
        self._places: dict[tuple[Any, ...], int] = {}
        self._packed: dict[tuple[str, float], int] = {}
        """Places by file, and by what its levels are multiplied with; 0 for a file as it is."""
        self._waiting: list[tuple[Entry, Future[Packed]]] = []

    def of(self, texture: UsdShade.Shader, *, is_colour: bool = True) -> int:
        """Place of the texture, with the bytes of the file where glTF knows its format."""
        key = texture.GetInput("file").Get().resolvedPath, 0.0
        if key not in self._packed:
            data, most_px = picture_bytes(texture), self._px(is_colour=is_colour)
            self._packed[key] = self._place(texture, data, _as_it_is, most_px)
        return self._packed[key]

    def roughness(self, texture: UsdShade.Shader, beyond: float, *, is_metal: bool) -> int:
        """A roughness map as glTF has it: in green, with the factor of metal in blue.

        beyond: factors end at 1, so what a stage's scale has above that goes into the picture. A
        grey picture serves as it is where nothing is metal.
        """
        key = texture.GetInput("file").Get().resolvedPath, round(beyond, 2)
        if key not in self._packed:
            data, most_px = picture_bytes(texture), self._px(is_colour=False)
            with opened_picture(data) as picture:
                if beyond == 1.0 and not is_metal and picture.mode == "L":
                    return self.of(texture, is_colour=False)
            self._packed[key] = self._place(texture, data, _roughness, most_px, beyond)
        return self._packed[key]

    def finish(self) -> None:
        """Write the bytes of all pictures, in the order in which they were asked for."""
        for picture, packed in self._waiting:
            data, kind = packed.result()
            picture |= {"bufferView": self._file.add_view(data), "mimeType": _TYPES[kind]}
        self._waiting.clear()

    def _px(self, *, is_colour: bool) -> int | None:
        # Half as fine where the eye sees no edges of its own: relief and gloss.
        return self._most_px if is_colour or not self._most_px else self._most_px // 2

    def _place(
        self, texture: UsdShade.Shader, data: bytes, pack: Callable[..., Packed], *how: Any
    ) -> int:
        """Place of a picture whose bytes are packed meanwhile."""
        key = hashlib.sha256(data).digest(), pack, *how
        if key not in self._places:
            path = str(texture.GetInput("file").Get().path)
            picture: Entry = {"name": path.replace("[", "/").rstrip("]").split("/")[-1]}
            self._waiting.append((picture, self._pool.submit(pack, data, *how)))
            source = self._file.add("images", picture)
            self._places[key] = self._file.add("textures", {"source": source})
        return self._places[key]


def _as_it_is(data: bytes, most_px: int | None) -> Packed:
    """A picture, no larger than it may be, in a format that glTF knows."""
    data = _smaller(data, most_px) if most_px else data
    with opened_picture(data) as picture:
        kind = picture.format or ""
        return (data, kind) if kind in _TYPES else (_encoded(picture, "PNG"), "PNG")


def _roughness(data: bytes, most_px: int | None, beyond: float) -> Packed:
    """Green from a grey picture, its levels multiplied."""
    with opened_picture(_smaller(data, most_px) if most_px else data) as picture:
        levels = np.arange(256) * beyond
        green = picture.convert("L").point(np.clip(np.round(levels), 0, 255).tolist())
    white = Image.new("L", green.size, 255)
    return _encoded(Image.merge("RGB", (white, green, white)), "JPEG"), "JPEG"


def _smaller(data: bytes, most_px: int) -> bytes:
    """A JPEG with no side longer than this, and lightly packed; others as PNG."""
    with opened_picture(data) as picture:
        kind = "JPEG" if picture.format == "JPEG" else "PNG"
        if kind == "PNG" and max(picture.size) <= most_px:
            return data
        picture.thumbnail((most_px, most_px))  # of a JPEG only what that takes is decoded
        return _encoded(picture, kind, _SMALL_QUALITY)


def _encoded(picture: Image.Image, kind: str, quality: int = _QUALITY) -> bytes:
    buffer = io.BytesIO()
    options: dict[str, Any] = {"quality": quality, "subsampling": 0} if kind == "JPEG" else {}
    picture.save(buffer, kind, **options)
    return buffer.getvalue()
