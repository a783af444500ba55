"""Plain materials: the one table of the shell's own surfaces, written as UsdPreviewSurface."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from PIL import Image
from pxr import Ar, Gf, Sdf, Usd, UsdGeom, UsdShade

from chord_usd.base.errors import StageError
from chord_usd.base.scene.feels import FEEL_OF_SURFACE
from chord_usd.base.scene.style_finishes import metal_like
from chord_usd.base.scene.styles import Agreed, HomeStyle, InnerDoor
from chord_usd.base.scene.types import FloatArray
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.author.names import NamedRoom
from chord_usd.line.stage.author.physics import write_feel
from chord_usd.line.stage.author.prims import Types, attribute, define, label


@dataclass(frozen=True)
class Surface:
    """A surface without textures."""

    rgb: tuple[int, int, int]
    """sRGB, 0 to 255."""
    roughness: float
    metallic: float = 0.0
    opacity: float = 1.0


PLAIN_SURFACES: dict[str, Surface] = {
    "Ceiling": Surface((243, 242, 239), 0.9),
    "Trim": Surface((240, 239, 235), 0.35),
    "WindowFrame": Surface((226, 226, 224), 0.3),
    "EntranceDoor": Surface((74, 84, 80), 0.4),
    "Metal": Surface((176, 174, 170), 0.28, metallic=1.0),
    "Glass": Surface((24, 28, 27), 0.0, opacity=0.08),  # a pale one would be a veil in the sun
    "Facade": Surface((222, 217, 208), 0.9),
    "WallTop": Surface((58, 58, 60), 0.9),
    "RoofTiles": Surface((124, 72, 56), 0.8),
    "PlainFloor": Surface((182, 152, 118), 0.5),
    "PlainWall": Surface((236, 233, 226), 0.85),
    "Placeholder": Surface((178, 178, 182), 0.6),
}


@dataclass(frozen=True)
class Fitout:
    """What the shell of a home is finished with."""

    surfaces: Mapping[str, Surface] = field(default_factory=lambda: PLAIN_SURFACES)
    """What has no look, such as ceilings and skirting."""
    doors: InnerDoor = "panel"


_LEVERS = {
    "chrome": PLAIN_SURFACES["Metal"],
    "brass": Surface((188, 150, 88), 0.3, metallic=1.0),
    "black_metal": Surface((34, 34, 36), 0.45, metallic=0.6),
}


def fitout(style: HomeStyle, home: Agreed) -> Fitout:
    """Ceilings, trim, window frames and doors of a style; levers of the home's metal."""
    colours = {"Ceiling": style.ceiling, "Trim": style.trim, "WindowFrame": style.frames}
    coloured = {
        name: replace(PLAIN_SURFACES[name], rgb=(int(c[1:3], 16), int(c[3:5], 16), int(c[5:7], 16)))
        for name, c in colours.items()
    }
    levers = {"Metal": _LEVERS[metal_like(home.metal)]}
    return Fitout({**PLAIN_SURFACES, **coloured, **levers}, style.doors)


def write_surface(layer: Sdf.Layer, path: Sdf.Path, name: str, surface: Surface) -> None:
    """A material that looks like this surface. name: of its row."""
    material = define(layer, path, "Material")
    label(material, "material", name)
    shade(layer, material, surface)
    write_feel(material, FEEL_OF_SURFACE[name])


def shade(layer: Sdf.Layer, material: Sdf.PrimSpec, surface: Surface) -> None:
    """Give a material the shader of this surface."""
    shader = define(layer, material.path.AppendChild("PreviewSurface"), "Shader")
    attribute(shader, "info:id", Types.Token, "UsdPreviewSurface", uniform=True)
    color = Gf.Vec3f(*(linear_from_srgb(value) for value in surface.rgb))
    attribute(shader, "inputs:diffuseColor", Types.Color3f, color)
    attribute(shader, "inputs:roughness", Types.Float, surface.roughness)
    attribute(shader, "inputs:metallic", Types.Float, surface.metallic)
    attribute(shader, "inputs:opacity", Types.Float, surface.opacity)
    Sdf.AttributeSpec(shader, "outputs:surface", Types.Token)
    output = Sdf.AttributeSpec(material, "outputs:surface", Types.Token)
    source = shader.path.StripAllVariantSelections().AppendProperty("outputs:surface")
    output.connectionPathList.explicitItems.append(source)


def linear_from_srgb(level: int) -> float:
    """sRGB level 0 to 255 to linear light 0 to 1, which USD colours hold (IEC 61966-2-1)."""
    value = level / 255.0
    return value / 12.92 if value <= 0.04045 else float(((value + 0.055) / 1.055) ** 2.4)


FLOOR = "_Floor"
"""Names of materials of floors end so."""


def floor_material(room: NamedRoom) -> str:
    """Name of the room's floor material; unique in the house, since Blender merges by name."""
    return f"{room.name}{FLOOR}"


def wall_material(room: NamedRoom) -> str:
    """Name of the room's wall material."""
    return f"{room.name}_Wall"


# What a material's network says: constants, textures, and how pictures are laid ------------------

_FORMATS = ("PNG", "JPEG", "WEBP", "BMP", "TGA", "TIFF")
_MOST_PX = 8192
_EXPECTED = f"pictures ({', '.join(_FORMATS)}) of at most {_MOST_PX} pixels a side"


def value_of(shader: UsdShade.Shader, name: str, default: Any) -> Any:
    """An input that is a constant; the default where it is a texture or absent."""
    wire = shader.GetInput(name)
    attributes = wire.GetValueProducingAttributes() if wire else []
    value = attributes[0].Get() if attributes else None
    return default if value is None else value


def source_of(shader: UsdShade.Shader, name: str) -> UsdShade.Shader | None:
    """The shader that an input is connected to."""
    return _source(shader.GetInput(name))


def _source(wire: UsdShade.Input) -> UsdShade.Shader | None:
    sources = wire.GetConnectedSources()[0] if wire and wire.HasConnectedSource() else []
    return UsdShade.Shader(sources[0].source.GetPrim()) if sources else None


def texture_of(shader: UsdShade.Shader, name: str) -> UsdShade.Shader | None:
    """The texture that an input reads; None for one whose file is not there."""
    texture = source_of(shader, name)
    wire = texture.GetInput("file") if texture else None
    file = wire.Get() if wire else None
    return texture if file and file.resolvedPath else None


def picture_bytes(texture: UsdShade.Shader) -> bytes:
    """The file of a texture, from a folder or out of a package."""
    path = Ar.ResolvedPath(texture.GetInput("file").Get().resolvedPath)
    return bytes(Ar.GetResolver().OpenAsset(path).GetBuffer())


def opened_picture(data: bytes) -> Image.Image:
    """The picture of a texture, not decoded yet, of bounded sides.

    Raises StageError for others, since a small file may stand for gigabytes of pixels.
    """
    try:
        picture = Image.open(io.BytesIO(data), formats=_FORMATS)
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise StageError("has a texture that cannot be read", expected=_EXPECTED) from error
    if max(picture.size) > _MOST_PX:
        size = "×".join(map(str, picture.size))
        raise StageError(f"has a texture of {size} pixels", expected=_EXPECTED)
    return picture


def bound_material(prim: Usd.Prim) -> UsdShade.Material | None:
    """The material that a prim is bound to."""
    return UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0] or None


def coordinates_read(surface: UsdShade.Shader) -> list[str]:
    """Names of the primvars by which the pictures of a surface are laid, each once."""
    names = {}
    for wire in surface.GetInputs():
        texture = _source(wire)
        if texture and texture.GetIdAttr().Get() == "UsdUVTexture":
            place = place_of(texture)
            reader = source_of(place, "in") if place else source_of(texture, "st")
            if reader and reader.GetIdAttr().Get() == "UsdPrimvarReader_float2":
                names[str(value_of(reader, "varname", "st"))] = True
    return list(names)


def as_it_is() -> FloatArray:
    """(2, 3) of a picture that lies where the coordinates say."""
    return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def placement_of(texture: UsdShade.Shader) -> FloatArray:
    """(2, 3) of the UsdTransform2d before a texture: scale, then turn, then shift."""
    place = place_of(texture)
    if place is None:
        return as_it_is()
    scale = np.diag(np.array(value_of(place, "scale", (1.0, 1.0)), dtype=np.float64))
    turn = rotation_2d(float(value_of(place, "rotation", 0.0)))
    shift = np.array(value_of(place, "translation", (0.0, 0.0)), dtype=np.float64)
    return np.column_stack([turn @ scale, shift])


def place_of(texture: UsdShade.Shader) -> UsdShade.Shader | None:
    """The UsdTransform2d before a texture, if there is one."""
    place = source_of(texture, "st")
    return place if place and place.GetIdAttr().Get() == "UsdTransform2d" else None


def placed(uvs: FloatArray, placement: FloatArray) -> FloatArray:
    """(N, 2) texture coordinates after a placement."""
    moved: FloatArray = np.column_stack([uvs, np.ones(len(uvs))]) @ placement.T
    return moved


def st_of(prim: Usd.Prim) -> UsdGeom.Primvar | None:
    """The texture coordinates of a mesh, if it has any."""
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
    return primvar if primvar and primvar.HasAuthoredValue() else None
