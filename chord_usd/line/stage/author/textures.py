"""What a material's network says: constants, textures, and how pictures are laid."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from PIL import Image
from pxr import Ar, Usd, UsdGeom, UsdShade

from chord_usd.base.errors import StageError
from chord_usd.base.scene.types import FloatArray
from chord_usd.base.scene.units import rotation_2d

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
    """The material that a prim wears."""
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
