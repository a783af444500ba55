"""A copy of a house whose materials also have MaterialX networks, for Houdini, Omniverse, Arnold.

Each UsdPreviewSurface network gets a twin of MaterialX's own nodes for it (its definitions in
libraries/bxdf/usd_preview_surface.mtlx), beside it in the same layer: defaults, colourways and
overrides alike, so that variants switch both. The preview network stays as it is. Houses are not
written so by themselves: USD without its MaterialX plugin, as its wheel comes, reports every node
that it does not know.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pxr import Sdf, Usd

from chord_usd.base.errors import StageError
from chord_usd.base.runtime.stages import open_layer
from chord_usd.line.stage.export.export_stage import copy_files

Types = Sdf.ValueTypeNames

SUFFIX = "_MaterialX"
"""Of the name of a twin."""

_VECTOR = "_Vector"
"""Of the node that takes a picture's colour as a direction."""

NODES = {
    "UsdPreviewSurface": "ND_UsdPreviewSurface_surfaceshader",
    "UsdUVTexture": "ND_UsdUVTexture_23",
    "UsdPrimvarReader_float2": "ND_UsdPrimvarReader_vector2",
    "UsdTransform2d": "ND_UsdTransform2d",
}
"""Definition of the twin of each shader."""

_CONVERT = "ND_convert_color3_vector3"

_OUTPUTS = {"surface": "out", "result": "out"}
"""What MaterialX calls differently; r and rgb are as they are."""

_RETYPED = {
    "normal": Types.Float3,
    "wrapS": Types.String,
    "wrapT": Types.String,
    "scale": Types.Color4f,
    "bias": Types.Color4f,
    "fallback": Types.Color4f,
    "rgb": Types.Color3f,
}
"""Inputs and outputs whose type changes; UsdTransform2d keeps its types."""

_WRAP = {"repeat": "periodic", "clamp": "clamp", "mirror": "mirror", "black": "constant"}
_SPACES = {"sRGB": "srgb_texture", "raw": "raw"}


@dataclass(frozen=True)
class _Networks:
    """Which shaders the materials of a house have: (material, shader) -> id, by their names."""

    ids: dict[tuple[str, str], str]
    spaces: dict[tuple[str, str], str]
    """Colour space of textures."""


def write_materialx(stage: Usd.Stage, folder: Path) -> None:
    """Copy a house and all it points to into folder, and give its materials their twins.

    Raises StageError for a package, whose files cannot be added to.
    """
    source = Path(stage.GetRootLayer().realPath)
    if source.suffix == ".usdz":
        raise StageError(
            "a .usdz holds its files unchanged", where=str(source),
            expected="the house as .usda or .usdc",
        )  # fmt: skip
    layers = [open_layer(copy) for copy in copy_files(source, folder)]
    networks = _networks(layers)
    for layer in layers:
        with Sdf.ChangeBlock():
            for shader in list(_shaders(layer, networks)):
                _add_twin(shader, networks)
        layer.Save()


def _prims(layer: Sdf.Layer) -> Iterator[Sdf.PrimSpec]:
    """Every prim spec, also those in variants."""
    paths: list[Sdf.Path] = []
    layer.Traverse(Sdf.Path.absoluteRootPath, paths.append)
    for path in paths:
        if path.IsPrimPath() or path.IsPrimVariantSelectionPath():
            spec = layer.GetObjectAtPath(path)
            if isinstance(spec, Sdf.PrimSpec):
                yield spec


def _networks(layers: list[Sdf.Layer]) -> _Networks:
    networks = _Networks({}, {})
    for layer in layers:
        for spec in _prims(layer):
            identity = spec.attributes.get("info:id")
            if identity is not None and str(identity.default) in NODES:
                key = spec.nameParent.name, spec.name
                networks.ids[key] = str(identity.default)
                space = spec.attributes.get("inputs:sourceColorSpace")
                if space is not None:
                    networks.spaces[key] = str(space.default)
    return networks


def _shaders(layer: Sdf.Layer, networks: _Networks) -> Iterator[Sdf.PrimSpec]:
    for spec in _prims(layer):
        if spec.nameParent and (spec.nameParent.name, spec.name) in networks.ids:
            yield spec


def _add_twin(shader: Sdf.PrimSpec, networks: _Networks) -> None:
    """What this layer says of a shader, said of its twin."""
    material = shader.nameParent
    key = material.name, shader.name
    kind = networks.ids[key]
    twin = Sdf.PrimSpec(material, shader.name + SUFFIX, shader.specifier, shader.typeName)
    for attribute in shader.attributes:
        base = attribute.name.rpartition(":")[2]
        if attribute.name == "info:id":
            Sdf.AttributeSpec(twin, "info:id", Types.Token, Sdf.VariabilityUniform).default = NODES[
                kind
            ]
        elif attribute.name.startswith("inputs:") and base != "sourceColorSpace":
            _copy_input(attribute, twin, kind, networks.spaces.get(key, "auto"))
        elif attribute.name.startswith("outputs:"):
            _copy_output(attribute, twin, base)
    if kind == "UsdPreviewSurface" and "outputs:surface" in shader.attributes:
        terminal = Sdf.AttributeSpec(material, "outputs:mtlx:surface", Types.Token)
        terminal.connectionPathList.explicitItems = [
            twin.path.StripAllVariantSelections().AppendProperty("outputs:out")
        ]


def _copy_input(attribute: Sdf.AttributeSpec, twin: Sdf.PrimSpec, kind: str, space: str) -> None:
    name = attribute.name.rpartition(":")[2]
    retyped = None if kind == "UsdTransform2d" else _RETYPED.get(name)
    copy = Sdf.AttributeSpec(twin, attribute.name, retyped or attribute.typeName)
    value = attribute.default
    if value is not None:
        copy.default = _WRAP[str(value)] if name in ("wrapS", "wrapT") else value
    if name == "file":
        copy.colorSpace = _SPACES.get(space, "srgb_texture")
    if attribute.HasInfo("connectionPaths"):
        # Also for an empty list, by which a plain colourway lets go of the maps.
        copy.connectionPathList.ClearEditsAndMakeExplicit()
        copy.connectionPathList.explicitItems = [
            _twin_of(path, twin, as_vector=name == "normal")
            for path in attribute.connectionPathList.explicitItems
        ]


def _copy_output(attribute: Sdf.AttributeSpec, twin: Sdf.PrimSpec, name: str) -> None:
    kind = _RETYPED.get(name, attribute.typeName)
    Sdf.AttributeSpec(twin, f"outputs:{_OUTPUTS.get(name, name)}", kind)


def _twin_of(path: Sdf.Path, twin: Sdf.PrimSpec, *, as_vector: bool) -> Sdf.Path:
    """The output of a twin for the output of a shader; of a picture of directions, as a vector."""
    output = path.name.rpartition(":")[2]
    prim = path.GetPrimPath()
    if prim == twin.nameParent.path.StripAllVariantSelections():
        return path  # a value that the material itself offers
    source = prim.ReplaceName(prim.name + SUFFIX)
    target = source.AppendProperty(f"outputs:{_OUTPUTS.get(output, output)}")
    return _vector(target, twin.nameParent) if as_vector else target


def _vector(colour: Sdf.Path, material: Sdf.PrimSpec) -> Sdf.Path:
    """The output of a node beside a picture's twin that makes a vector of its colour."""
    name = colour.GetPrimPath().name + _VECTOR
    if name not in material.nameChildren:
        node = Sdf.PrimSpec(material, name, Sdf.SpecifierDef, "Shader")
        Sdf.AttributeSpec(node, "info:id", Types.Token, Sdf.VariabilityUniform).default = _CONVERT
        wire = Sdf.AttributeSpec(node, "inputs:in", Types.Color3f)
        wire.connectionPathList.explicitItems = [colour]
        Sdf.AttributeSpec(node, "outputs:out", Types.Float3)
    return colour.GetPrimPath().ReplaceName(name).AppendProperty("outputs:out")
