"""Writes a design as a USD component: interface, payload and the layers behind it.

    Desk_A/Desk_A.usda        kind, assetInfo, class, extentsHint, colourways, payload
    Desk_A/payload.usda       sublayers: physics, materials, geometry
    Desk_A/{physics.usda, materials.usdc, geometry.usdc}

A closed payload still gives bounds and colourways. Structure: ASWF asset-structure guidelines.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chord_usd.assets.fittings import METAL_VARIANT_SET, METALS, USUAL, fitting_slots
from chord_usd.assets.material import (
    TEXTURES,
    Looks,
    MapShelf,
    define_material,
    override_material,
    save_pictures,
    slot_looks,
)
from chord_usd.assets.model import Design, Part
from chord_usd.assets.physical import feel_of, write_feel
from chord_usd.assets.shading import corner_normals, corner_uvs_m
from chord_usd.assets.solids import Solid
from chord_usd.assets.surface_maps import MAPS_FOLDER
from chord_usd.scene.credits import AUTHOR, LICENCE
from chord_usd.scene.geometry import shared_rows

if TYPE_CHECKING:
    from pxr import Sdf, Usd

_LEAST_FACE_M2 = 2e-12
"""What is smaller is a line; validators refuse it."""

COMPONENT_VERSION = "1"
COLOUR_VARIANT_SET = "colour"


@dataclass(frozen=True)
class ComponentInfo:
    """What assetInfo says beside the name."""

    licence: str = LICENCE
    author: str = AUTHOR
    label: str = ""
    """For people, where it differs from the name."""


def write_component(
    design: Design, folder: Path, info: ComponentInfo | None = None, maps: MapShelf | None = None
) -> Path:
    """Write a component package into folder/design.id; returns its interface layer.

    maps: where maps of finishes are, or come to; by default beside the package, where its
    materials look for them. The bytes depend on the design, the size of the maps and the versions
    of USD and Pillow only. Raises AssetError where a drawing misses its nominal size, KeyError
    where a colourway names no finish, OSError.
    """
    parts = design.parts()
    worn = _worn(design, used_slots(parts), maps or MapShelf(folder / MAPS_FOLDER))
    package = folder / design.id
    package.mkdir(parents=True)
    _write_geometry(design, parts, package / "geometry.usdc")
    _write_materials(design, parts, worn, package / "materials.usdc")
    _write_physics(design, parts, package / "physics.usda")
    _write_payload(design, package / "payload.usda")
    interface = package / f"{design.id}.usda"
    _write_interface(design, parts, worn, interface, info or ComponentInfo())
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

    part = _without_slivers(part)
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
    flat = corner_uvs_m(part.solid, part.name) if part.uvs is None else part.uvs
    uvs, places = shared_rows(flat)
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(
        "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying
    )
    primvar.Set(Vt.Vec2fArray.FromNumpy(uvs))
    primvar.SetIndices(Vt.IntArray.FromNumpy(places))


def _without_slivers(part: Part) -> Part:
    """The part without faces that have no area once their corners are in single precision."""
    solid = part.solid
    a, b, c = np.moveaxis(solid.points_m.astype(np.float32)[solid.faces].astype(np.float64), 1, 0)
    is_face = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2 >= _LEAST_FACE_M2
    if is_face.all():
        return part
    uvs = None if part.uvs is None else part.uvs.reshape(-1, 3, 2)[is_face].reshape(-1, 2)
    return replace(part, solid=Solid(solid.points_m, solid.faces[is_face]), uvs=uvs)


def _write_materials(
    design: Design, parts: Iterable[Part], worn: Mapping[str, Looks], path: Path
) -> None:
    """One material per slot in use, dressed in the first colourway, and what wears which."""
    from pxr import UsdGeom, UsdShade

    stage = _new_stage(design)
    UsdGeom.Scope.Define(stage, f"/{design.id}/Geometry")
    UsdGeom.Scope.Define(stage, f"/{design.id}/Materials")
    for slot, looks in worn.items():
        define_material(stage, material_path(design.id, slot), looks)
        save_pictures(looks, path.parent / TEXTURES)
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
        felt = [
            _define_box(stage, f"/{design.id}/Colliders/{name}", bounds_m)
            for name, bounds_m in part.felt_boxes_m().items()
        ]
        if part.collider not in ("boundingCube", None):
            prim = stage.OverridePrim(f"/{design.id}/Geometry/{part.name}")
            UsdPhysics.CollisionAPI.Apply(prim)
            mesh = UsdPhysics.MeshCollisionAPI.Apply(prim)
            mesh.CreateApproximationAttr(part.collider)
            felt.append(prim)
        _bind_feel(design, part.slot, felt)
    _save(stage, path)


def _bind_feel(design: Design, slot: str, colliders: Iterable[Usd.Prim]) -> None:
    """Colliders are felt like the finish that their part wears in the first colourway."""
    from pxr import UsdShade

    looks = next(iter(design.colourways.values()))
    for collider in colliders:
        stage = collider.GetStage()
        path = material_path(design.id, slot)
        write_feel(stage.OverridePrim(path), feel_of(design.finishes[looks[slot]]))
        relation = UsdShade.MaterialBindingAPI.Apply(collider).GetDirectBindingRel("physics")
        relation.SetTargets([path])


def _define_box(stage: Usd.Stage, path: str, bounds_m: np.ndarray) -> Usd.Prim:
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
    return cube.GetPrim()


def _write_payload(design: Design, path: Path) -> None:
    layer = _detached(_new_stage(design))
    layer.subLayerPaths = ["./physics.usda", "./materials.usdc", "./geometry.usdc"]
    layer.Export(str(path))


def _write_interface(
    design: Design, parts: tuple[Part, ...], worn: Mapping[str, Looks], path: Path,
    info: ComponentInfo,
) -> None:  # fmt: skip
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
    root.SetCustomDataByKey("chord", _about(design, worn, info))
    stage.CreateClassPrim("/__class__")
    inherited = stage.CreateClassPrim(f"/__class__/{design.id}")
    root.GetInherits().AddInherit(inherited.GetPath())
    UsdGeom.ModelAPI.Apply(root)
    _hint(root, parts)
    # The first set is the stronger one.
    _add_metals(stage, design, worn)
    _add_colourways(stage, design, worn)
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


def _bounds(parts: Iterable[Part]) -> tuple[np.ndarray, np.ndarray]:
    """Corners of all parts, also those above the nominal height, in single precision."""
    corners = np.array([part.solid.bounds_m() for part in parts], dtype=np.float32)
    return corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)


def _add_colourways(stage: Usd.Stage, design: Design, worn: Mapping[str, Looks]) -> None:
    """The variant set: colourways override what they have in another way than the others."""
    root = stage.GetDefaultPrim()
    variants = root.GetVariantSets().AddVariantSet(COLOUR_VARIANT_SET)
    for index, variant in enumerate(design.colourways):
        variants.AddVariant(variant)
        variants.SetVariantSelection(variant)
        with variants.GetVariantEditContext():
            for slot, looks in worn.items():
                override_material(stage, material_path(design.id, slot), looks, index)
    variants.SetVariantSelection(next(iter(design.colourways)))


def _add_metals(stage: Usd.Stage, design: Design, worn: Mapping[str, Looks]) -> None:
    """The variant set of the metal of fittings, where a design has any."""
    slots = fitting_slots(design, worn)
    if not slots:
        return
    variants = stage.GetDefaultPrim().GetVariantSets().AddVariantSet(METAL_VARIANT_SET)
    variants.AddVariant(USUAL)
    for index, metal in enumerate(METALS, start=len(design.colourways)):
        variants.AddVariant(metal)
        variants.SetVariantSelection(metal)
        with variants.GetVariantEditContext():
            for slot in slots:
                override_material(stage, material_path(design.id, slot), worn[slot], index)
    variants.SetVariantSelection(USUAL)


def _worn(design: Design, slots: Sequence[str], maps: MapShelf) -> dict[str, Looks]:
    """What each slot in use wears, colourway by colourway; fittings, then, of each metal."""
    fittings = fitting_slots(design, slots)
    worn = {}
    for slot in slots:
        names = [looks[slot] for looks in design.colourways.values()]
        names += METALS if slot in fittings else ()
        finishes = [design.finishes[name] for name in names]
        worn[slot] = slot_looks(design.id, slot, finishes, maps)
    return worn
