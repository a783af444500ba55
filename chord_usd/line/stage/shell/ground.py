"""What a house stands on, as it is seen through its windows: a lawn, or paving under a city's sky.

It is a picture's business alone: purpose `render`, so that bounds, exports and simulators pass it
by, without a collider, and a little lower than the floors.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image
from pxr import Gf, Sdf, Vt

from chord_usd.base.scene.types import ByteArray, FloatArray
from chord_usd.line.stage.author.prims import (
    Types,
    attribute,
    bind,
    define,
    hint_extent,
    label,
    new_layer,
)

PATH = Sdf.Path("/House/Ground")
_ROOT = Sdf.Path.absoluteRootPath.AppendChild(PATH.name)
_BELOW_FLOORS_M = 0.03
_RADII_M = (1.0, 6.0, 14.0, 30.0, 60.0, 110.0)
_SECTORS = 48
_TILE_M = 7.0
_TILE_PX = 512

_SHADES: dict[str, tuple[FloatArray, FloatArray, float]] = {
    "lawn": (np.array([46, 62, 26.0]), np.array([112, 128, 62.0]), 1.25),
    "paving": (np.array([96, 94, 90.0]), np.array([134, 131, 125.0]), 1.6),
}
"""Darkest and lightest sRGB, and how soft: the power by which finer detail is fainter."""


def lay_ground(layer: Sdf.Layer, centre_m: FloatArray, look: str, folder: Path) -> None:
    """Write the ground around a house, behind a payload as all meshes are.

    look: a row of _SHADES. folder: beside the layer's file, for its layer and picture.
    """
    picture = folder / f"ground_{look}.jpg"
    Image.fromarray(ground_rgb(look)).save(picture, quality=88)
    file = folder / f"{PATH.name}.usdc"
    payload = new_layer(file, PATH.name)
    define(payload, _ROOT, "Xform")
    define(payload, _ROOT.AppendChild("Materials"), "Scope")
    material = _material(payload, f"./{picture.name}")
    disc = _disc(payload, centre_m)
    bind(disc, material)
    payload.Save()
    ground = define(layer, PATH, "Xform")
    ground.payloadList.prependedItems.append(Sdf.Payload(f"./{folder.name}/{file.name}"))
    attribute(ground, "purpose", Types.Token, "render", uniform=True)
    label(ground, "category", "ground")
    nothing = [[0.0, 0.0, 0.0]] * 2  # for purpose `default`, which comes first
    hint_extent(ground, np.array([*nothing, *np.array(disc.attributes["extent"].default)]))


def _disc(layer: Sdf.Layer, centre_m: FloatArray) -> Sdf.PrimSpec:
    """Rings, so that coordinates stay exact near the house."""
    turns = 2 * np.pi * np.arange(_SECTORS) / _SECTORS
    rim = np.column_stack([np.cos(turns), np.sin(turns)])
    plane = np.vstack([[[0.0, 0.0]], *(radius * rim for radius in _RADII_M)]) + centre_m
    points = np.column_stack([plane, np.full(len(plane), -_BELOW_FLOORS_M)]).astype(np.float32)
    faces = [[0, 1 + k, 1 + (k + 1) % _SECTORS] for k in range(_SECTORS)]
    for ring in range(len(_RADII_M) - 1):
        inner, outer = 1 + ring * _SECTORS, 1 + (ring + 1) * _SECTORS
        for k in range(_SECTORS):
            after = (k + 1) % _SECTORS
            faces.append([inner + k, outer + k, outer + after, inner + after])
    prim = define(layer, _ROOT.AppendChild("Disc"), "Mesh")
    corners = [corner for face in faces for corner in face]
    extent = np.array([points.min(axis=0), points.max(axis=0)])
    attribute(prim, "extent", Types.Float3Array, Vt.Vec3fArray.FromNumpy(extent))
    attribute(prim, "faceVertexCounts", Types.IntArray, Vt.IntArray([len(f) for f in faces]))
    attribute(prim, "faceVertexIndices", Types.IntArray, Vt.IntArray(corners))
    normals = attribute(prim, "normals", Types.Normal3fArray, Vt.Vec3fArray([Gf.Vec3f(0, 0, 1)]))
    normals.SetInfo("interpolation", "constant")
    attribute(prim, "points", Types.Point3fArray, Vt.Vec3fArray.FromNumpy(points))
    uvs = Vt.Vec2fArray.FromNumpy((plane / _TILE_M).astype(np.float32))
    st = attribute(prim, "primvars:st", Types.TexCoord2fArray, uvs)
    st.SetInfo("interpolation", "vertex")
    attribute(prim, "subdivisionScheme", Types.Token, "none", uniform=True)
    return prim


def _material(layer: Sdf.Layer, file: str) -> Sdf.Path:
    material = define(layer, _ROOT.AppendPath("Materials/Ground"), "Material")
    label(material, "material", "ground")
    surface = _shader(
        layer, material, "PreviewSurface", "UsdPreviewSurface", "surface", Types.Token
    )
    picture = _shader(layer, material, "Picture", "UsdUVTexture", "rgb", Types.Float3)
    reader = _shader(layer, material, "Reader", "UsdPrimvarReader_float2", "result", Types.Float2)
    attribute(reader, "inputs:varname", Types.String, "st")
    attribute(picture, "inputs:file", Types.Asset, Sdf.AssetPath(file))
    for side in "ST":
        attribute(picture, f"inputs:wrap{side}", Types.Token, "repeat")
    attribute(picture, "inputs:sourceColorSpace", Types.Token, "sRGB")
    attribute(surface, "inputs:roughness", Types.Float, 1.0)
    _connect(picture, "inputs:st", Types.Float2, reader, "result")
    _connect(surface, "inputs:diffuseColor", Types.Color3f, picture, "rgb")
    _connect(material, "outputs:surface", Types.Token, surface, "surface")
    return material.path


def _shader(
    layer: Sdf.Layer,
    material: Sdf.PrimSpec,
    name: str,
    kind: str,
    output: str,
    type_: Sdf.ValueTypeName,
) -> Sdf.PrimSpec:
    prim = define(layer, material.path.AppendChild(name), "Shader")
    attribute(prim, "info:id", Types.Token, kind, uniform=True)
    Sdf.AttributeSpec(prim, f"outputs:{output}", type_)
    return prim


def _connect(
    prim: Sdf.PrimSpec, name: str, type_: Sdf.ValueTypeName, source: Sdf.PrimSpec, output: str
) -> None:
    spec = Sdf.AttributeSpec(prim, name, type_)
    spec.connectionPathList.explicitItems.append(source.path.AppendProperty(f"outputs:{output}"))


def ground_rgb(look: str) -> ByteArray:
    """(N, N, 3) uint8 picture that tiles: patches of all sizes, the large ones strongest."""
    dark, light, softness = _SHADES[look]
    rng = np.random.default_rng(7)
    waves = np.hypot(*np.meshgrid(*[np.fft.fftfreq(_TILE_PX) * _TILE_PX] * 2))
    waves[0, 0] = np.inf
    spectrum = (
        np.fft.fft2(rng.standard_normal((_TILE_PX, _TILE_PX))) / np.maximum(waves, 3) ** softness
    )
    patches = np.real(np.fft.ifft2(spectrum))
    share = np.clip(0.5 + patches / patches.std() / 5.0, 0.0, 1.0)[..., None]
    return np.round(dark + share * (light - dark)).astype(np.uint8)
