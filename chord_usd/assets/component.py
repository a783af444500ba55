"""Writes a design as a USD component: interface, payload and the layers behind it.

    Desk_A/Desk_A.usda        kind, assetInfo, class, extentsHint, colourways, payload
    Desk_A/payload.usda       sublayers: physics, materials, geometry
    Desk_A/{physics.usda, materials.usda, geometry.usdc}

A closed payload still gives bounds and colourways. Structure: ASWF asset-structure guidelines.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chord_usd.assets.finishes import Finish
from chord_usd.assets.model import Design, Part
from chord_usd.assets.shading import corner_normals, corner_uvs_m
from chord_usd.scene.credits import AUTHOR, LICENCE

if TYPE_CHECKING:
    from pxr import Sdf, Usd

COMPONENT_VERSION = "1"
TEXTURES = "textures"
"""Folder of the pictures of a component."""

COLOUR_VARIANT_SET = "colour"
WALL_VARIANT_SET = "wallUnit"
WALL_VARIANTS = ("none", "hung")
"""Whether what hangs on the wall over a piece is there; the first one is the default."""

_INPUTS = ("diffuseColor", "roughness", "metallic", "opacity", "emissiveColor")


@dataclass(frozen=True)
class ComponentInfo:
    """What assetInfo says beside the name."""

    licence: str = LICENCE
    author: str = AUTHOR
    label: str = ""
    """For people, where it differs from the name."""


def write_component(design: Design, folder: Path, info: ComponentInfo | None = None) -> Path:
    """Write a component package into folder/design.id; returns its interface layer.

    The bytes depend on the design and the USD version only. Raises AssetError where a drawing
    misses its nominal size, KeyError where a colourway names no finish.
    """
    parts = design.parts()
    package = folder / design.id
    package.mkdir(parents=True)
    _write_geometry(design, parts, package / "geometry.usdc")
    _write_materials(design, parts, package / "materials.usda")
    _write_physics(design, parts, package / "physics.usda")
    _write_payload(design, package / "payload.usda")
    interface = package / f"{design.id}.usda"
    _write_interface(design, parts, interface, info or ComponentInfo())
    return interface


def _new_stage(design: Design) -> Usd.Stage:
    """A stage in memory with the root prim as its default prim."""
    from pxr import Usd, UsdGeom

    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, f"/{design.id}")
    stage.SetDefaultPrim(root.GetPrim())
    return stage


def _save(stage: Usd.Stage, path: Path) -> None:
    stage.GetRootLayer().Export(str(path))


def _detached(stage: Usd.Stage) -> Sdf.Layer:
    """The stage's layer without the stage, which would look at once for what it points to."""
    from pxr import Sdf

    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.TransferContent(stage.GetRootLayer())
    return layer


def _write_geometry(design: Design, parts: Iterable[Part], path: Path) -> None:
    from pxr import UsdGeom

    stage = _new_stage(design)
    UsdGeom.Scope.Define(stage, f"/{design.id}/Geometry")
    for part in parts:
        _define_mesh(stage, f"/{design.id}/Geometry/{part.name}", part)
    _save(stage, path)


def _define_mesh(stage: Usd.Stage, path: str, part: Part) -> None:
    from pxr import Sdf, UsdGeom, Vt

    mesh = UsdGeom.Mesh.Define(stage, path)
    points = Vt.Vec3fArray.FromNumpy(part.solid.points_m.astype(np.float32))
    corners = part.solid.faces.reshape(-1).astype(np.int32)
    mesh.CreatePointsAttr(points)
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray([3] * (len(corners) // 3)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners))
    mesh.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(points))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    if part.two_sided:
        mesh.CreateDoubleSidedAttr(True)
    normals = corner_normals(part.solid).astype(np.float32)
    mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals))
    mesh.SetNormalsInterpolation(UsdGeom.Tokens.faceVarying)
    flat = corner_uvs_m(part.solid) if part.uvs is None else part.uvs
    uvs = Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(flat, dtype=np.float32))
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(
        "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying
    )
    primvar.Set(uvs)


def _write_materials(design: Design, parts: Iterable[Part], path: Path) -> None:
    """One material per slot in use, dressed in the first colourway, and what wears which."""
    from pxr import UsdGeom, UsdShade

    stage = _new_stage(design)
    UsdGeom.Scope.Define(stage, f"/{design.id}/Geometry")
    UsdGeom.Scope.Define(stage, f"/{design.id}/Materials")
    first = next(iter(design.colourways.values()))
    for slot in used_slots(parts):
        finish = design.finishes[first[slot]]
        path_ = material_path(design.id, slot)
        _define_material(stage, path_, finish)
        if finish.texture is not None:
            _add_texture(stage, path_, finish, path.parent / TEXTURES / f"{slot}.jpg")
    for part in parts:
        prim = stage.OverridePrim(f"/{design.id}/Geometry/{part.name}")
        material = UsdShade.Material.Get(stage, material_path(design.id, part.slot))
        UsdShade.MaterialBindingAPI.Apply(prim).Bind(material)
    _save(stage, path)


def used_slots(parts: Iterable[Part]) -> tuple[str, ...]:
    """Slots that some part wears, in order of first use."""
    return tuple(dict.fromkeys(part.slot for part in parts))


def material_path(root: str, slot: str) -> str:
    """Prim path of a slot's material: `book_red` becomes `BookRed`."""
    return f"/{root}/Materials/{''.join(word.capitalize() for word in slot.split('_'))}"


def _define_material(stage: Usd.Stage, path: str, finish: Finish) -> None:
    """A UsdPreviewSurface of constants; Blender does not follow inputs of the material itself."""
    from pxr import Sdf, UsdShade

    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, _surface_path(path))
    shader.CreateIdAttr("UsdPreviewSurface")
    for name, (type_name, value) in _values(finish).items():
        shader.CreateInput(name, getattr(Sdf.ValueTypeNames, type_name)).Set(value)
    shader.CreateInput("ior", Sdf.ValueTypeNames.Float).Set(1.5)
    surface = shader.CreateOutput("surface", Sdf.ValueTypeNames.Token)
    material.CreateSurfaceOutput().ConnectToSource(surface)


def _add_texture(stage: Usd.Stage, material: str, finish: Finish, file: Path) -> None:
    """Put a picture, written to file, in place of a material's colour."""
    from pxr import Sdf, UsdShade

    assert finish.texture is not None
    file.parent.mkdir(exist_ok=True)
    finish.texture.save(file, quality=88)
    reader = UsdShade.Shader.Define(stage, f"{material}/Uv")
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
    texture = UsdShade.Shader.Define(stage, f"{material}/Texture")
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(f"./{TEXTURES}/{file.name}")
    texture.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set("sRGB")
    for side in ("wrapS", "wrapT"):
        texture.CreateInput(side, Sdf.ValueTypeNames.Token).Set("repeat")
    texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(
        reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)
    )
    surface = UsdShade.Shader.Get(stage, _surface_path(material))
    surface.GetInput("diffuseColor").ConnectToSource(
        texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3)
    )


def _surface_path(material: str) -> str:
    return f"{material}/Surface"


def _values(finish: Finish) -> dict[str, tuple[str, Any]]:
    """UsdPreviewSurface input to (USD type, value) of a finish."""
    from pxr import Gf

    colour = Gf.Vec3f(*finish.linear_rgb())
    values = (
        ("Color3f", colour),
        ("Float", finish.roughness),
        ("Float", finish.metallic),
        ("Float", finish.opacity),
        ("Color3f", colour * finish.glow),
    )
    return dict(zip(_INPUTS, values, strict=True))


def _write_physics(design: Design, parts: Iterable[Part], path: Path) -> None:
    """Colliders only: whether a piece may move is decided where it is placed.

    A bounding box is drawn as an unseen cube of its own. Engines that are asked for the box around
    a mesh turn it until it is smallest, and a round table top gets corners that stick out.
    """
    from pxr import UsdGeom, UsdPhysics

    stage = _new_stage(design)
    UsdGeom.Scope.Define(stage, f"/{design.id}/Geometry")
    UsdGeom.Scope.Define(stage, f"/{design.id}/Colliders")
    for part in parts:
        for name, bounds_m in part.felt_boxes_m().items():
            _define_box(stage, f"/{design.id}/Colliders/{name}", bounds_m)
        if part.collider not in ("boundingCube", None):
            prim = stage.OverridePrim(f"/{design.id}/Geometry/{part.name}")
            UsdPhysics.CollisionAPI.Apply(prim)
            mesh = UsdPhysics.MeshCollisionAPI.Apply(prim)
            mesh.CreateApproximationAttr(part.collider)
    _save(stage, path)


def _define_box(stage: Usd.Stage, path: str, bounds_m: np.ndarray) -> None:
    """A collider that is a box between two corners, (2, 3)."""
    from pxr import Gf, UsdGeom, UsdPhysics

    low, high = bounds_m
    cube = UsdGeom.Cube.Define(stage, path)
    cube.CreateSizeAttr(1.0)
    cube.CreateExtentAttr([Gf.Vec3f(-0.5), Gf.Vec3f(0.5)])
    cube.CreatePurposeAttr(UsdGeom.Tokens.guide)
    cube.AddTranslateOp().Set(Gf.Vec3d(*((low + high) / 2).tolist()))
    cube.AddScaleOp().Set(Gf.Vec3f(*(high - low).tolist()))
    UsdPhysics.CollisionAPI.Apply(cube.GetPrim())


def _write_payload(design: Design, path: Path) -> None:
    layer = _detached(_new_stage(design))
    layer.subLayerPaths = ["./physics.usda", "./materials.usda", "./geometry.usdc"]
    layer.Export(str(path))


def _write_interface(
    design: Design, parts: tuple[Part, ...], path: Path, info: ComponentInfo
) -> None:
    from pxr import Sdf, Usd, UsdGeom

    stage = _new_stage(design)
    root = stage.GetDefaultPrim()
    Usd.ModelAPI(root).SetKind("component")
    root.SetAssetInfo(
        {
            "name": design.id,
            "identifier": Sdf.AssetPath(f"./{design.id}.usda"),
            "version": COMPONENT_VERSION,
        }
    )
    root.SetCustomDataByKey("chord", _about(design, used_slots(parts), info))
    stage.CreateClassPrim("/__class__")
    inherited = stage.CreateClassPrim(f"/__class__/{design.id}")
    root.GetInherits().AddInherit(inherited.GetPath())
    on_wall = [part for part in parts if part.on_wall]
    UsdGeom.ModelAPI.Apply(root)
    if on_wall:
        _add_wall_unit(stage, design, parts)
    else:
        _hint(root, parts)
    _add_colourways(stage, design, used_slots(parts))
    layer = _detached(stage)
    spec = layer.GetPrimAtPath(f"/{design.id}")
    spec.payloadList.prependedItems = [Sdf.Payload("./payload.usda")]
    layer.Export(str(path))


def _about(design: Design, slots: Iterable[str], info: ComponentInfo) -> dict[str, Any]:
    """What the root's customData says: who made it, what its colourways wear, where it shines."""
    from pxr import Gf, Vt

    about: dict[str, Any] = {
        "category": design.category,
        "licence": info.licence,
        "author": info.author,
        "finishes": {
            colourway: " ".join(looks[slot] for slot in slots)
            for colourway, looks in design.colourways.items()
        },
    }
    if info.label:
        about["label"] = info.label
    if design.styles:
        about["styles"] = Vt.StringArray(design.styles)
    if design.light is not None:
        about["light"] = {
            "at_m": Gf.Vec3d(*design.light.at_m),
            "radius_m": design.light.radius_m,
            "lumens": design.light.lumens,
        }
    return about


def _hint(root: Usd.Prim, parts: Iterable[Part]) -> None:
    """Bounds that hold while the payload is closed."""
    from pxr import UsdGeom, Vt

    low, high = _bounds(parts)
    hint = Vt.Vec3fArray([tuple(low.tolist()), tuple(high.tolist())])
    UsdGeom.ModelAPI(root).SetExtentsHint(hint)


def _add_wall_unit(stage: Usd.Stage, design: Design, parts: tuple[Part, ...]) -> None:
    """The variant set that leaves out, or shows, what hangs on the wall."""
    root = stage.GetDefaultPrim()
    variants = root.GetVariantSets().AddVariantSet(WALL_VARIANT_SET)
    for variant in WALL_VARIANTS:
        hung = variant == WALL_VARIANTS[1]
        variants.AddVariant(variant)
        variants.SetVariantSelection(variant)
        with variants.GetVariantEditContext():
            _hint(root, [part for part in parts if hung or not part.on_wall])
            for part in parts:
                if part.on_wall and not hung:
                    stage.OverridePrim(f"/{design.id}/Geometry/{part.name}").SetActive(False)
                    for name in part.felt_boxes_m():
                        stage.OverridePrim(f"/{design.id}/Colliders/{name}").SetActive(False)
    variants.SetVariantSelection(WALL_VARIANTS[0])


def _bounds(parts: Iterable[Part]) -> tuple[np.ndarray, np.ndarray]:
    """Corners of all parts, also those above the nominal height, in single precision."""
    corners = np.array([part.solid.bounds_m() for part in parts], dtype=np.float32)
    return corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)


def _add_colourways(stage: Usd.Stage, design: Design, slots: tuple[str, ...]) -> None:
    """The variant set: colourways override the shader inputs in which they differ."""
    root = stage.GetDefaultPrim()
    variants = root.GetVariantSets().AddVariantSet(COLOUR_VARIANT_SET)
    first = {slot: _values(finish) for slot, finish in _worn(design, slots, 0)}
    varying = {
        (slot, name)
        for index in range(1, len(design.colourways))
        for slot, finish in _worn(design, slots, index)
        for name, value in _values(finish).items()
        if value != first[slot][name]
    }
    for index, variant in enumerate(design.colourways):
        variants.AddVariant(variant)
        variants.SetVariantSelection(variant)
        with variants.GetVariantEditContext():
            for slot, finish in _worn(design, slots, index):
                values = {n: v for n, v in _values(finish).items() if (slot, n) in varying}
                _override_inputs(stage, _surface_path(material_path(design.id, slot)), values)
    variants.SetVariantSelection(next(iter(design.colourways)))


def _worn(design: Design, slots: tuple[str, ...], index: int) -> list[tuple[str, Finish]]:
    """(slot, finish) in one colourway."""
    looks = list(design.colourways.values())[index]
    return [(slot, design.finishes[looks[slot]]) for slot in slots]


def _override_inputs(stage: Usd.Stage, path: str, values: Mapping[str, tuple[str, Any]]) -> None:
    from pxr import Sdf

    for name, (type_name, value) in values.items():
        prim = stage.OverridePrim(path)
        attribute = prim.CreateAttribute(
            f"inputs:{name}", getattr(Sdf.ValueTypeNames, type_name), custom=False
        )
        attribute.Set(value)
