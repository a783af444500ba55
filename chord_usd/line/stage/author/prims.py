"""Writing prims into a layer.

Sdf rather than Usd: no stage is composed while it is written, so forty references cost nothing
and nothing needs to be loaded. The layer's text follows the order of the calls.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Kind, Sdf, Vt

from chord_usd.base.scene.geometry import shared_rows
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.shell.mesh import Mesh

Types = Sdf.ValueTypeNames


def new_layer(path: Path, default_prim: str) -> Sdf.Layer:
    """An empty layer with the units and axes of every stage here: metres, kilograms, Z up."""
    layer = Sdf.Layer.CreateNew(str(path))
    layer.defaultPrim = default_prim
    root = layer.pseudoRoot
    root.SetInfo("upAxis", "Z")
    root.SetInfo("metersPerUnit", 1.0)
    root.SetInfo("kilogramsPerUnit", 1.0)
    return layer


def define(
    layer: Sdf.Layer, path: Sdf.Path | str, type_name: str, *, kind: str = "", name: str = ""
) -> Sdf.PrimSpec:
    """A typed prim; its parent must be there already. name: what a user interface shows."""
    prim = Sdf.CreatePrimInLayer(layer, path)
    prim.specifier = Sdf.SpecifierDef
    prim.typeName = type_name
    if kind:
        prim.kind = getattr(Kind.Tokens, kind)
    if name:
        prim.SetInfo("displayName", name)
    return prim


def define_class(layer: Sdf.Layer, name: str) -> Sdf.Path:
    """An empty `/__class__/<name>` to inherit from: one place to change all prims of a sort."""
    for path in (Sdf.Path("/__class__"), Sdf.Path("/__class__").AppendChild(name)):
        Sdf.CreatePrimInLayer(layer, path).specifier = Sdf.SpecifierClass
    return path


def inherit(prim: Sdf.PrimSpec, class_path: Sdf.Path) -> None:
    """Let prim inherit a class of the same layer."""
    prim.inheritPathList.prependedItems.append(class_path)


def attribute(
    prim: Sdf.PrimSpec,
    name: str,
    type_: Sdf.ValueTypeName,
    value: Any,
    *,
    uniform: bool = False,
    custom: bool = False,
) -> Sdf.AttributeSpec:
    """An attribute with a value, in place of the one that it has."""
    variability = Sdf.VariabilityUniform if uniform else Sdf.VariabilityVarying
    spec = (
        prim.attributes[name]
        if name in prim.attributes
        else Sdf.AttributeSpec(prim, name, type_, variability, custom)
    )
    spec.default = value
    return spec


def note(prim: Sdf.PrimSpec, **values: str | float | Sequence[str] | FloatArray) -> None:
    """Custom attributes `chord:<name>`. They survive Blender's import, also on instance roots."""
    for name, value in values.items():
        if isinstance(value, str):
            attribute(prim, f"chord:{name}", Types.String, value, custom=True)
        elif isinstance(value, int | float):
            attribute(prim, f"chord:{name}", Types.Double, float(value), custom=True)
        elif isinstance(value, np.ndarray):
            pairs = Vt.Vec2dArray.FromNumpy(np.ascontiguousarray(value, dtype=np.float64))
            attribute(prim, f"chord:{name}", Types.Double2Array, pairs, custom=True)
        else:
            attribute(prim, f"chord:{name}", Types.StringArray, Vt.StringArray(value), custom=True)


def note_size(prim: Sdf.PrimSpec, size_m: tuple[float, float, float]) -> None:
    """Custom attribute `chord:size_m`: length, width and height as it stands in its parent."""
    attribute(prim, "chord:size_m", Types.Double3, Gf.Vec3d(*size_m), custom=True)


def relate(prim: Sdf.PrimSpec, name: str, targets: Iterable[Sdf.Path | str]) -> None:
    """A relationship to these targets."""
    spec = Sdf.RelationshipSpec(prim, name, custom=False)
    for target in targets:
        spec.targetPathList.prependedItems.append(Sdf.Path(str(target)))


def apply_schema(prim: Sdf.PrimSpec, *names: str) -> None:
    """Add applied API schemas."""
    known = prim.GetInfo("apiSchemas").prependedItems if prim.HasInfo("apiSchemas") else []
    added = [name for name in names if name not in known]
    prim.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=[*known, *added]))


def label(prim: Sdf.PrimSpec, taxonomy: str, name: str) -> None:
    """Semantic label: `room` for kinds of rooms, `category` for what a thing is, `material`.

    A category is said as `class`, too, which is what simulators of robots filter by.
    """
    for instance in (taxonomy, "class") if taxonomy == "category" else (taxonomy,):
        apply_schema(prim, f"SemanticsLabelsAPI:{instance}")
        attribute(prim, f"semantics:labels:{instance}", Types.TokenArray, Vt.TokenArray([name]))


def place(
    prim: Sdf.PrimSpec,
    *,
    at_m: Sequence[float] | None = None,
    yaw_deg: float | None = None,
    scale: Sequence[float] | None = None,
) -> None:
    """Translate, rotate about the vertical, scale: in this order, each one optional."""
    order = []
    if at_m is not None:
        attribute(prim, "xformOp:translate", Types.Double3, Gf.Vec3d(*map(float, at_m)))
        order.append("xformOp:translate")
    if yaw_deg is not None:
        attribute(prim, "xformOp:rotateZ", Types.Double, float(yaw_deg))
        order.append("xformOp:rotateZ")
    if scale is not None:
        attribute(prim, "xformOp:scale", Types.Double3, Gf.Vec3d(*map(float, scale)))
        order.append("xformOp:scale")
    set_op_order(prim, order)


def set_op_order(prim: Sdf.PrimSpec, order: Sequence[str]) -> None:
    """Which transform operations count, the outermost first."""
    attribute(prim, "xformOpOrder", Types.TokenArray, Vt.TokenArray(order), uniform=True)


def hint_extent(prim: Sdf.PrimSpec, extent_m: FloatArray) -> None:
    """Bounds of a model, (2, 3), which hold while its payload is not loaded."""
    attribute(prim, "extentsHint", Types.Float3Array, _float3(extent_m))


def identify(prim: Sdf.PrimSpec, name: str, file: str) -> None:
    """Asset info of a model: its name and the layer it comes from, relative to this one."""
    prim.SetInfo("assetInfo", {"identifier": Sdf.AssetPath(file), "name": name})


def bind(prim: Sdf.PrimSpec, material: Sdf.Path | str) -> None:
    """Bind prim to a material."""
    apply_schema(prim, "MaterialBindingAPI")
    relate(prim, "material:binding", [material])


def write_mesh(layer: Sdf.Layer, path: Sdf.Path | str, mesh: Mesh) -> Sdf.PrimSpec:
    """A polygon mesh with flat faces and texture coordinates `st` in metres."""
    prim = define(layer, path, "Mesh")
    attribute(prim, "extent", Types.Float3Array, _float3(mesh.extent_m()))
    attribute(prim, "faceVertexCounts", Types.IntArray, Vt.IntArray.FromNumpy(mesh.counts))
    attribute(prim, "faceVertexIndices", Types.IntArray, Vt.IntArray.FromNumpy(mesh.indices))
    normals = attribute(prim, "normals", Types.Normal3fArray, _float3(mesh.normals))
    normals.SetInfo("interpolation", "faceVarying")
    attribute(prim, "points", Types.Point3fArray, _float3(mesh.points_m))
    uvs, places = shared_rows(mesh.uvs_m)
    st = attribute(prim, "primvars:st", Types.TexCoord2fArray, Vt.Vec2fArray.FromNumpy(uvs))
    st.SetInfo("interpolation", "faceVarying")
    attribute(prim, "primvars:st:indices", Types.IntArray, Vt.IntArray.FromNumpy(places))
    attribute(prim, "subdivisionScheme", Types.Token, "none", uniform=True)
    attribute(prim, "doubleSided", Types.Bool, False, uniform=True)
    return prim


def add_variants(prim: Sdf.PrimSpec, name: str, choices: Sequence[str]) -> list[Sdf.PrimSpec]:
    """A variant set whose first choice is selected; returns what to write each choice into."""
    variants = Sdf.VariantSetSpec(prim, name)
    prim.variantSetNameList.prependedItems.append(name)
    prim.variantSelections[name] = choices[0]
    return [Sdf.VariantSpec(variants, choice).primSpec for choice in choices]


def over(parent: Sdf.PrimSpec, *names: str) -> Sdf.PrimSpec:
    """A chain of overs below a prim (of a variant, say); returns the last one."""
    prim = parent
    for name in names:
        prim = prim.nameChildren.get(name) or Sdf.PrimSpec(prim, name, Sdf.SpecifierOver)
    return prim


def dictionary(values: Mapping[str, Any]) -> dict[str, Any]:
    """Plain values that layer metadata can hold; whatever else becomes text."""
    return {
        key: dictionary(value)
        if isinstance(value, Mapping)
        else value
        if isinstance(value, bool | int | float | str)
        else str(value)
        for key, value in values.items()
    }


def _float3(values: FloatArray) -> Vt.Vec3fArray:
    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(values, dtype=np.float32))
