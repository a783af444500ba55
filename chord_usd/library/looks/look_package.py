"""Writes a wall or floor look as a USD material that is adjusted through its own inputs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pxr import Sdf, Usd, UsdShade

SRGB, RAW = "sRGB", "raw"


def map_file(look: str, kind: str) -> str:
    """Name of a map: Planks_1f3a9c_base_color.jpg.

    No two pictures of a house may have one name: Blender unpacks a .usdz into one folder.
    """
    return f"{look}_{kind}.jpg"


def write_material(
    path: Path, tile_m: tuple[float, float], rotation_deg: float, about: Mapping[str, str]
) -> None:
    """Write path (named after the material) over the maps in maps/ beside it, see map_file.

    The material's inputs `uvScale` (repeats per metre), `uvRotation` (degrees) and `uvOffset`
    drive all maps, so a room adjusts a look by overriding them; its tint is `inputs:scale` of the
    shader BaseColor. UVs are metres.
    """
    from pxr import Sdf, Usd, UsdGeom, UsdShade

    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    material = UsdShade.Material.Define(stage, f"/{path.stem}")
    stage.SetDefaultPrim(material.GetPrim())
    material.GetPrim().SetAssetInfo(
        {"name": path.stem, "identifier": Sdf.AssetPath(f"./{path.name}"), "version": "1"}
    )
    material.GetPrim().SetCustomDataByKey("chord", dict(about))
    _add_inputs(material, tile_m, rotation_deg)
    _add_shaders(stage, material)
    stage.GetRootLayer().Export(str(path))


def _add_inputs(
    material: UsdShade.Material, tile_m: tuple[float, float], rotation_deg: float
) -> None:
    from pxr import Gf, Sdf

    types = Sdf.ValueTypeNames
    for name, type_name, value in (
        ("uvScale", types.Float2, Gf.Vec2f(1.0 / tile_m[0], 1.0 / tile_m[1])),
        ("uvRotation", types.Float, rotation_deg),
        ("uvOffset", types.Float2, Gf.Vec2f(0.0, 0.0)),
    ):
        material.CreateInput(name, type_name).Set(value)


def _add_shaders(stage: Usd.Stage, material: UsdShade.Material) -> None:
    from pxr import Gf, Sdf

    types = Sdf.ValueTypeNames
    reader = _shader(stage, material, "Uv", "UsdPrimvarReader_float2")
    reader.CreateInput("varname", types.String).Set("st")
    place = _shader(stage, material, "Place", "UsdTransform2d")
    place.CreateInput("in", types.Float2).ConnectToSource(_output(reader, "result", types.Float2))
    for inner, public in (
        ("scale", "uvScale"),
        ("rotation", "uvRotation"),
        ("translation", "uvOffset"),
    ):
        source = material.GetInput(public)
        wire = place.CreateInput(inner, source.GetTypeName())
        wire.Set(source.Get())  # for readers that do not follow connections
        wire.ConnectToSource(source)
    uv = _output(place, "result", types.Float2)
    colour = _texture(stage, material, "BaseColor", "base_color", SRGB, uv)
    # Not an input of the material: Blender reads a texture's scale from the shader alone.
    colour.CreateInput("scale", types.Float4).Set(Gf.Vec4f(1.0, 1.0, 1.0, 1.0))
    rough = _texture(stage, material, "Roughness", "roughness", RAW, uv)
    normal = _texture(stage, material, "Normal", "normal", RAW, uv)
    normal.CreateInput("scale", types.Float4).Set(Gf.Vec4f(2.0, 2.0, 2.0, 1.0))
    normal.CreateInput("bias", types.Float4).Set(Gf.Vec4f(-1.0, -1.0, -1.0, 0.0))
    surface = _shader(stage, material, "Surface", "UsdPreviewSurface")
    for name, type_name, source in (
        ("diffuseColor", types.Color3f, _output(colour, "rgb", types.Float3)),
        ("roughness", types.Float, _output(rough, "r", types.Float)),
        ("normal", types.Normal3f, _output(normal, "rgb", types.Float3)),
    ):
        surface.CreateInput(name, type_name).ConnectToSource(source)
    surface.CreateInput("metallic", types.Float).Set(0.0)
    material.CreateSurfaceOutput().ConnectToSource(_output(surface, "surface", types.Token))


def _shader(
    stage: Usd.Stage, material: UsdShade.Material, name: str, identifier: str
) -> UsdShade.Shader:
    from pxr import UsdShade

    shader = UsdShade.Shader.Define(stage, material.GetPath().AppendChild(name))
    shader.CreateIdAttr(identifier)
    return shader


def _output(shader: UsdShade.Shader, name: str, type_name: Sdf.ValueTypeName) -> Any:
    return shader.CreateOutput(name, type_name)


def _texture(
    stage: Usd.Stage, material: UsdShade.Material, name: str, file: str, space: str, uv: Any
) -> UsdShade.Shader:
    from pxr import Sdf

    types = Sdf.ValueTypeNames
    texture = _shader(stage, material, name, "UsdUVTexture")
    texture.CreateInput("file", types.Asset).Set(
        Sdf.AssetPath(f"./maps/{map_file(material.GetPrim().GetName(), file)}")
    )
    texture.CreateInput("sourceColorSpace", types.Token).Set(space)
    texture.CreateInput("wrapS", types.Token).Set("repeat")
    texture.CreateInput("wrapT", types.Token).Set("repeat")
    texture.CreateInput("st", types.Float2).ConnectToSource(uv)
    return texture
