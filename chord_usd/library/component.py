"""Writes a design as a USD component: an interface to read, and what is behind its payload.

    Desk_A/Desk_A.usda          kind, assetInfo, class, labels, extentsHint, names of variants
    Desk_A/simready_usd/        the same as a prop: prop.py
        payloads/payload.usdc   meshes, materials, what colourways make of them, colliders
        payloads/jointed.usdc   another payload, of a variant, where doors or drawers open
        payloads/textures/      all pictures; maps of finishes are hard links

A closed payload still gives bounds and the names of colourways. Structure: ASWF asset-structure
guidelines; but one layer, not three, since a house opens all layers of all its assets.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chord_usd.base.scene.articulation import (
    ARTICULATION,
    FIXED,
    JOINTED,
    JOINTED_LAYER,
    PAYLOAD_LAYER,
    PAYLOADS,
    PROP,
)
from chord_usd.base.scene.credits import AUTHOR, DRAWN_ON, LICENCE
from chord_usd.base.scene.label_sets import wikidata_item
from chord_usd.library.component_prims import (
    bind_feel,
    define_box,
    define_colliders,
    define_mesh,
    detached,
    material_path,
    mesh_name,
    new_stage,
    write_labels,
)
from chord_usd.library.kit.fittings import METAL_VARIANT_SET, METALS, USUAL, fitting_slots
from chord_usd.library.kit.jointed import SHAPES, write_jointed
from chord_usd.library.kit.links import opens
from chord_usd.library.kit.model import Design, Part
from chord_usd.library.material import (
    TEXTURES,
    Looks,
    MapShelf,
    define_material,
    save_pictures,
    slot_looks,
    write_values,
)
from chord_usd.library.prop import body_of, feel_soft, give_body, provenance, write_thumbnail
from chord_usd.library.surfaces.surface_maps import MAPS_FOLDER

if TYPE_CHECKING:
    from pxr import Sdf, Usd

COMPONENT_VERSION = "1"
COLOUR_VARIANT_SET = "colour"


@dataclass(frozen=True)
class ComponentInfo:
    """What assetInfo says beside the name."""

    licence: str = LICENCE
    author: str = AUTHOR
    label: str = ""
    """For people, where it differs from the name."""
    made: str = DRAWN_ON
    """Date on which it was made, as ISO 8601 has it."""


def write_component(
    design: Design, folder: Path, info: ComponentInfo | None = None, maps: MapShelf | None = None
) -> Path:
    """Write a component package into folder/design.id; returns its interface layer.

    maps: where maps of finishes are, or come to; by default beside the package, which has links to
    them. The bytes depend on the design, the size of the maps and the versions
    of USD and Pillow only. Raises AssetError where a drawing misses its nominal size, KeyError
    where a colourway names no finish, OSError.
    """
    drawn = design.parts()
    parts = _sharing_materials(design, drawn)
    maps, info = maps or MapShelf(folder / MAPS_FOLDER), info or ComponentInfo()
    worn = _worn(design, used_slots(parts), maps)
    package = folder / design.id
    payloads = package / PAYLOADS
    payloads.mkdir(parents=True)
    for looks in worn.values():
        save_pictures(looks, maps, payloads / TEXTURES)
    _write_payload(design, parts, worn, payloads)
    if opens(parts):
        write_jointed(design, parts, payloads / JOINTED_LAYER)
    about = _about(design, used_slots(drawn), info)
    _write_interface(design, parts, about, package)
    _write_prop(design, parts, about, package, info)
    write_thumbnail(design, parts, package)
    return package / f"{design.id}.usda"


def _write_payload(
    design: Design, parts: Sequence[Part], worn: Mapping[str, Looks], folder: Path
) -> None:
    from pxr import Sdf

    stage = new_stage(design)
    geometry = f"/{design.id}/Geometry"
    if opens(parts):
        # Of no component: what opens has the same meshes elsewhere.
        _add_geometry(stage, SHAPES, design, parts)
        stage.GetPrimAtPath(SHAPES).SetSpecifier(Sdf.SpecifierClass)
    else:
        _add_geometry(stage, geometry, design, parts)
    _add_materials(stage, design, parts, worn)
    _add_colliders(stage, design, parts)
    # The first set is the stronger one.
    _add_metals(stage, design, worn)
    _add_colourways(stage, design, worn)
    layer = detached(stage)
    if opens(parts):
        shared = Sdf.Reference("", SHAPES)
        layer.GetPrimAtPath(geometry).referenceList.prependedItems = [shared]
    layer.Export(str(folder / PAYLOAD_LAYER))


def _add_geometry(stage: Usd.Stage, scope: str, design: Design, parts: Iterable[Part]) -> None:
    from pxr import UsdGeom

    UsdGeom.Scope.Define(stage, scope)
    for part in parts:
        define_mesh(stage, f"{scope}/{mesh_name(design, part.name)}", part)


def _add_materials(
    stage: Usd.Stage, design: Design, parts: Iterable[Part], worn: Mapping[str, Looks]
) -> None:
    """Writes a material per slot in use, with the values all colourways share, and the bindings."""
    from pxr import UsdGeom, UsdShade

    UsdGeom.Scope.Define(stage, f"/{design.id}/Geometry")
    UsdGeom.Scope.Define(stage, f"/{design.id}/Materials")
    for slot, looks in worn.items():
        define_material(stage, material_path(design.id, slot), looks)
    for part in parts:
        prim = stage.OverridePrim(f"/{design.id}/Geometry/{mesh_name(design, part.name)}")
        material = UsdShade.Material.Get(stage, material_path(design.id, part.slot))
        UsdShade.MaterialBindingAPI.Apply(prim).Bind(material)


def used_slots(parts: Iterable[Part]) -> tuple[str, ...]:
    """Slots of parts, in order of first use."""
    return tuple(dict.fromkeys(part.slot for part in parts))


def _add_colliders(stage: Usd.Stage, design: Design, parts: Iterable[Part]) -> None:
    """Colliders only: whether a piece may move is decided where it is placed.

    A bounding box is drawn as an unseen cube of its own. Engines that are asked for the box around
    a mesh turn it until it is smallest, and a round table top gets corners that stick out.
    """
    from pxr import UsdPhysics

    define_colliders(stage, f"/{design.id}/Colliders")
    for part in parts:
        colliders = [
            define_box(stage, f"/{design.id}/Colliders/{name}", bounds_m)
            for name, bounds_m in part.collider_boxes_m().items()
        ]
        if part.collider not in ("boundingCube", None):
            prim = stage.OverridePrim(f"/{design.id}/Geometry/{mesh_name(design, part.name)}")
            UsdPhysics.CollisionAPI.Apply(prim)
            mesh = UsdPhysics.MeshCollisionAPI.Apply(prim)
            mesh.CreateApproximationAttr(part.collider)
            colliders.append(prim)
        bind_feel(design, part.slot, colliders)


def _write_interface(
    design: Design, parts: tuple[Part, ...], about: Mapping[str, Any], package: Path
) -> None:
    layer = detached(_interface(design, parts, about))
    _point(layer, design, parts, PAYLOADS)
    layer.Export(str(package / f"{design.id}.usda"))


def _write_prop(
    design: Design, parts: tuple[Part, ...], about: Mapping[str, Any], package: Path,
    info: ComponentInfo,
) -> None:  # fmt: skip
    """The interface once more, as a body of its own."""
    stage = _interface(design, parts, about)
    bounds_m = np.array(_bounds(parts))
    if all(part.collider is None for part in parts):
        feel_soft(stage, bounds_m)
    layer = detached(stage)
    _point(layer, design, parts, PAYLOADS.removeprefix(f"{PROP}/"))
    give_body(layer.GetPrimAtPath(f"/{design.id}"), body_of(design, parts))
    metadata = provenance(design, info.author, info.licence, info.made, bounds_m)
    layer.customLayerData = {"SimReady_Metadata": metadata}
    layer.Export(str(package / PROP / f"{design.id}.usda"))


def _point(layer: Sdf.Layer, design: Design, parts: Sequence[Part], folder: str) -> None:
    """Let an interface find its payloads in a folder beside it."""
    from pxr import Sdf

    spec = layer.GetPrimAtPath(f"/{design.id}")
    spec.payloadList.prependedItems = [Sdf.Payload(f"./{folder}/{PAYLOAD_LAYER}")]
    if opens(parts):
        _add_articulation(spec, folder)


def _interface(design: Design, parts: tuple[Part, ...], about: Mapping[str, Any]) -> Usd.Stage:
    from pxr import Sdf, Usd, UsdGeom

    stage = new_stage(design)
    root = stage.GetDefaultPrim()
    Usd.ModelAPI(root).SetKind("component")
    root.SetAssetInfo(
        {
            "name": design.id,
            "identifier": Sdf.AssetPath(f"./{design.id}.usda"),
            "version": COMPONENT_VERSION,
        }
    )
    root.SetCustomDataByKey("chord", dict(about))
    item = wikidata_item(design.category)
    category = design.category
    write_labels(root, {"category": category, "class": category, "wikidata_qcode": item})
    stage.CreateClassPrim("/__class__")
    inherited = stage.CreateClassPrim(f"/__class__/{design.id}")
    root.GetInherits().AddInherit(inherited.GetPath())
    UsdGeom.ModelAPI.Apply(root)
    _hint(root, parts)
    if fitting_slots(design, used_slots(parts)):
        _offer(root, METAL_VARIANT_SET, (USUAL, *METALS))
    _offer(root, COLOUR_VARIANT_SET, design.colourways)
    return stage


def _offer(root: Usd.Prim, name: str, variants: Iterable[str]) -> None:
    """A variant set whose contents are in the payload; the first variant is chosen."""
    variant_set = root.GetVariantSets().AddVariantSet(name)
    for variant in variants:
        variant_set.AddVariant(variant)
    variant_set.SetVariantSelection(next(iter(variants)))


def _about(design: Design, slots: Iterable[str], info: ComponentInfo) -> dict[str, Any]:
    """The root's customData: makers, finishes of the colourways, places of light."""
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
    """The variant set: colourways say what they have in another way than the others."""
    for index, variant in enumerate(design.colourways):
        with _variant(stage, COLOUR_VARIANT_SET, variant):
            for slot, looks in worn.items():
                write_values(stage, material_path(design.id, slot), looks.choice(index))


def _add_metals(stage: Usd.Stage, design: Design, worn: Mapping[str, Looks]) -> None:
    """The variant set of the metal of fittings, where a design has any."""
    slots = fitting_slots(design, worn)
    if not slots:
        return
    with _variant(stage, METAL_VARIANT_SET, USUAL):
        pass
    for index, metal in enumerate(METALS, start=len(design.colourways)):
        with _variant(stage, METAL_VARIANT_SET, metal):
            for slot in slots:
                write_values(stage, material_path(design.id, slot), worn[slot].overrides(index))


@contextmanager
def _variant(stage: Usd.Stage, name: str, variant: str) -> Iterator[None]:
    """Write into a variant of the root; which one is chosen is said by the interface."""
    variants = stage.GetDefaultPrim().GetVariantSets().AddVariantSet(name)
    variants.AddVariant(variant)
    variants.SetVariantSelection(variant)
    with variants.GetVariantEditContext():
        yield
    variants.ClearVariantSelection()


def _add_articulation(root: Sdf.PrimSpec, folder: str) -> None:
    """The variant set that opens a piece: another payload over the usual one."""
    from pxr import Sdf

    variants = Sdf.VariantSetSpec(root, ARTICULATION)
    root.variantSetNameList.prependedItems.append(ARTICULATION)
    root.variantSelections[ARTICULATION] = FIXED
    Sdf.VariantSpec(variants, FIXED)
    jointed = Sdf.VariantSpec(variants, JOINTED).primSpec
    jointed.payloadList.prependedItems = [Sdf.Payload(f"./{folder}/{JOINTED_LAYER}")]


def _sharing_materials(design: Design, parts: tuple[Part, ...]) -> tuple[Part, ...]:
    """The parts, with one slot for those that are finished alike in every colourway and metal."""
    fittings = fitting_slots(design, used_slots(parts))
    first: dict[tuple[object, ...], str] = {}

    def shared(slot: str) -> str:
        finishes = (looks[slot] for looks in design.colourways.values())
        return first.setdefault((slot in fittings, *finishes), slot)

    return tuple(replace(part, slot=shared(part.slot)) for part in parts)


def _worn(design: Design, slots: Sequence[str], maps: MapShelf) -> dict[str, Looks]:
    """The finishes of each slot in use, by colourway; of fittings also by metal."""
    fittings = fitting_slots(design, slots)
    worn = {}
    for slot in slots:
        names = [looks[slot] for looks in design.colourways.values()]
        names += METALS if slot in fittings else ()
        finishes = [(name, design.finishes[name]) for name in names]
        worn[slot] = slot_looks(design.id, slot, finishes, maps)
    return worn
