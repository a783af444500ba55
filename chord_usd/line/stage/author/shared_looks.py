"""Looks that the pieces of a house share, each of them once.

    /House/Looks/PaleOak                       bound to all parts of pale oak
    /__class__/Desk_A{looks=house}…            binds the pieces of a component to it, and leaves
                                               out the component's own Materials

A component brings the materials of its parts, so a house would have nine hundred of them where two
hundred differ, and readers build each of them. The component itself inherits the class, whose
bindings hold for the colourways and metals that the house selects. A colourway that is selected
later uses the component's own looks, and so does a piece without the variant. All of it is in a
sublayer of the house, in its architecture folder.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from typing import Any

from pxr import Sdf, Tf

from chord_usd.base.runtime.stages import open_layer
from chord_usd.base.scene.articulation import (
    ARTICULATION,
    FIXED,
    JOINTED,
    JOINTED_LAYER,
    PAYLOAD_LAYER,
    layer_file,
)
from chord_usd.line.stage.author.prims import apply_schema, attribute, define, over
from chord_usd.line.stage.author.stage_levels import room_specs
from chord_usd.line.stage.export.packages import SHARED

LOOKS = "/House/Looks"
LOOKS_LAYER = "Looks.usdc"
LOOKS_SET, OF_HOUSE = "looks", "house"
"""The variant set, and the variant of pieces that use the looks of the house."""

_LOOK = "chord:look"
"""Attribute of a component's materials: the look that each has."""

_PAYLOADS = {FIXED: PAYLOAD_LAYER, JOINTED: JOINTED_LAYER}
_STRONGEST_FIRST = (ARTICULATION, "metal", "colour")
"""The variant sets of components that select materials."""

_GLOW, _PICTURE = "inputs:emissiveColor", "Texture"
_FELT, _PHYSICS = "Felt", "physics:"

_Choice = tuple[tuple[str, str], ...]
"""Variants that are chosen, by their sets."""


def share_looks(layer: Sdf.Layer, folder: Path) -> None:
    """Bind the pieces of a house to looks that they share, in a sublayer in folder.

    layer: of the house, with its pieces. folder: beside the layer's file, as are its assets.
    """
    home = Path(layer.realPath).parent
    worn: dict[tuple[str, _Choice], list[Sdf.PrimSpec]] = {}
    chosen_in = cache(partial(_chosen_in, home))
    for piece, file in _pieces(layer):
        usual = chosen_in(file)
        if usual is not None:
            chosen = usual | dict(piece.variantSelections)
            choice = tuple((name, chosen[name]) for name in _STRONGEST_FIRST if name in chosen)
            worn.setdefault((file, choice), []).append(piece)
    shared = Sdf.Layer.CreateAnonymous(LOOKS_LAYER)
    define(shared, "/House", "Xform").specifier = Sdf.SpecifierOver
    define(shared, LOOKS, "Scope")
    shelf = _Shelf(shared)
    for (file, choice), pieces in worn.items():
        if _Component(home / file, dict(choice)).share(shelf, choice):
            for piece in pieces:
                piece.variantSelections[LOOKS_SET] = OF_HOUSE
    if shared.GetPrimAtPath(LOOKS).nameChildren:
        shared.Export(str(folder / LOOKS_LAYER))
        layer.subLayerPaths.append(f"./{folder.name}/{LOOKS_LAYER}")


def _pieces(layer: Sdf.Layer) -> Iterator[tuple[Sdf.PrimSpec, str]]:
    """Things that are placed in rooms, with the file that they refer to."""
    due = [
        group
        for room in room_specs(layer)
        for group in room.nameChildren
        if group.name in ("Furniture", "Dressing")
    ]
    while due:
        prim = due.pop(0)
        due += prim.nameChildren
        for reference in prim.referenceList.prependedItems:
            yield prim, reference.assetPath


def _chosen_in(home: Path, file: str) -> dict[str, str] | None:
    """The variants that a component chooses; None for one that does not inherit a class of its
    name, or lies in a folder of another name.

    A package has another name where two of one name differ, and their class is the same.
    """
    name = Path(file).stem
    if Path(file).parent.name != name:
        return None
    layer = open_layer(home / file)
    root = layer.GetPrimAtPath(f"/{name}")
    if layer.defaultPrim != name or not root:
        return None
    if f"/__class__/{name}" not in root.inheritPathList.prependedItems:
        return None
    return dict(root.variantSelections)


@dataclass
class _Shelf:
    """The looks of a house, and what feels alike, while they are written."""

    layer: Sdf.Layer
    _paths: dict[tuple[object, ...], Sdf.Path] = field(default_factory=dict)
    _names: dict[str, int] = field(default_factory=dict)

    def find(self, key: tuple[object, ...]) -> Sdf.Path | None:
        """Where a look is, if it is here already."""
        return self._paths.get(key)

    def add(self, key: tuple[object, ...], name: str) -> Sdf.Path:
        """A new place; others of that name have numbers."""
        self._names[name] = number = self._names.get(name, 0) + 1
        path = Sdf.Path(LOOKS).AppendChild(name if number == 1 else f"{name}_{number}")
        self._paths[key] = path
        return path


class _Component:
    """A component in some of its variants."""

    def __init__(self, interface: Path, chosen: Mapping[str, str]) -> None:
        self._name = interface.stem
        self._interface = interface
        self._chosen = [(name, chosen[name]) for name in _STRONGEST_FIRST if name in chosen]
        self._payload = self._open(_PAYLOADS[FIXED])
        form = chosen.get(ARTICULATION, FIXED)
        self._shapes = self._open(_PAYLOADS.get(form, ""))

    def _open(self, file: str) -> Sdf.Layer | None:
        path = layer_file(self._interface, file) if file else None
        return open_layer(path) if path else None

    def share(self, shelf: _Shelf, choice: _Choice) -> bool:
        """Write bindings of pieces in these variants to the looks of the house into its class.

        Returns False, and writes nothing, where a material has no note of its look.
        """
        scope = self._payload and self._payload.GetPrimAtPath(f"/{self._name}/Materials")
        if not scope or not self._shapes:
            return False
        slots = list(scope.nameChildren)
        if not all(self._value(slot, f".{_LOOK}") for slot in slots):
            return False
        looks = {slot.path: self._look(slot, shelf) for slot in slots}
        feels = {slot.path: self._feel(slot, shelf) for slot in slots}
        variant = _variant_of_class(shelf.layer, self._name, choice)
        over(variant, "Materials").SetInfo("active", False)
        root = self._shapes.GetPrimAtPath(f"/{self._name}")
        bound_to = {"material:binding": looks, "material:binding:physics": feels}
        for part in root.nameChildren:
            for prim in _below(part) if part.name != "Materials" else ():
                for bound in prim.relationships:
                    slot_path = next(iter(bound.targetPathList.GetAppliedItems()), None)
                    target = bound_to.get(bound.name, {}).get(slot_path)
                    if target:
                        names = str(prim.path.MakeRelativePath(root.path)).split("/")
                        spec = Sdf.RelationshipSpec(over(variant, *names), bound.name, custom=False)
                        spec.targetPathList.explicitItems = [target]
        return True

    def _said_of(self, slot: Sdf.PrimSpec) -> Iterator[Sdf.PrimSpec]:
        """What there is about a material, the strongest first: its own, then the variants'."""
        yield slot
        for name, variant in self._chosen:
            path = Sdf.Path(f"/{self._name}").AppendVariantSelection(name, variant)
            said = slot.layer.GetPrimAtPath(path.AppendPath(f"Materials/{slot.name}"))
            if said:
                yield said

    def _value(self, slot: Sdf.PrimSpec, name: str) -> Any:
        """Of an attribute of a material, or of a shader in it; None where it has none."""
        for said in self._said_of(slot):
            spec = said.GetAttributeAtPath(name)
            if spec and spec.HasDefaultValue():
                return spec.default
        return None

    def _look(self, slot: Sdf.PrimSpec, shelf: _Shelf) -> Sdf.Path:
        """Where the house has what a material looks like."""
        look = str(self._value(slot, f".{_LOOK}"))
        # Renderers know by the names of slots what shines; pictures are of the component.
        glows = any(self._value(slot, f"Surface.{_GLOW}") or ())
        component = self._name if _PICTURE in slot.nameChildren else ""
        key = (look, slot.name if glows else "", component)
        path = shelf.find(key)
        if path is None:
            name = look.rpartition("_")[0].title().replace("_", "")
            path = shelf.add(key, slot.name if glows else Tf.MakeValidIdentifier(name))
            self._copy(slot, shelf.layer, path)
        return path

    def _feel(self, slot: Sdf.PrimSpec, shelf: _Shelf) -> Sdf.Path | None:
        """Where the house has what a material feels like; None where nothing touches it."""
        # The leaves of a jointed piece collide where the fixed piece does not; they have a note of
        # it.
        moved = self._shapes and self._shapes.GetPrimAtPath(slot.path)
        by_name = {spec.name: spec for said in (moved, slot) if said for spec in said.attributes}
        physics = [spec for name, spec in by_name.items() if name.startswith(_PHYSICS)]
        if not physics:
            return None
        key = tuple((spec.name, spec.default) for spec in physics)
        path = shelf.find(key)
        if path is None:
            path = shelf.add(key, _FELT)
            material = define(shelf.layer, path, "Material")
            apply_schema(material, "PhysicsMaterialAPI")
            for spec in physics:
                attribute(material, spec.name, spec.typeName, spec.default)
        return path

    def _copy(self, slot: Sdf.PrimSpec, layer: Sdf.Layer, path: Sdf.Path) -> None:
        """The material as it is in these variants, without what nothing reads."""
        for said in reversed([*self._said_of(slot)]):
            for prim in (said, *_below(said)):
                inner = prim.path.MakeRelativePath(said.path)
                made = Sdf.CreatePrimInLayer(
                    layer, path if prim == said else path.AppendPath(inner)
                )
                if prim.specifier == Sdf.SpecifierDef:
                    made.specifier, made.typeName = prim.specifier, prim.typeName
                if prim.HasInfo("apiSchemas"):
                    named = prim.GetInfo("apiSchemas").GetAppliedItems()
                    apply_schema(
                        made, *(schema for schema in named if not schema.startswith("Physics"))
                    )
                for spec in prim.attributes:
                    if not spec.name.startswith(_PHYSICS):
                        self._copy_attribute(spec, made, slot.path, path)
        material = layer.GetPrimAtPath(path)
        surface = material.nameChildren["Surface"]
        if not any(spec.connectionPathList.explicitItems for spec in surface.attributes):
            for name in {*material.nameChildren.keys()} - {"Surface"}:
                del material.nameChildren[name]

    def _copy_attribute(
        self, source: Sdf.AttributeSpec, prim: Sdf.PrimSpec, was: Sdf.Path, now: Sdf.Path
    ) -> None:
        spec = prim.attributes.get(source.name) or Sdf.AttributeSpec(
            prim, source.name, source.typeName, source.variability, source.custom
        )
        value = source.default
        if isinstance(value, Sdf.AssetPath):
            folder = Path(source.layer.realPath).parent
            value = Sdf.AssetPath(self._seen_from_looks(folder / value.path))
        if value is not None:
            spec.default = value
        if source.HasInfo("connectionPaths"):
            read = [
                path.ReplacePrefix(was, now) for path in source.connectionPathList.GetAppliedItems()
            ]
            spec.connectionPathList.explicitItems = read

    def _seen_from_looks(self, file: Path) -> str:
        """A picture of a component: the copy that all share, so that readers load it once."""
        assets = self._interface.parent.parent
        shared = assets / SHARED / file.name
        if shared.is_file():
            file = shared
        return Path("..", os.path.relpath(file, assets.parent)).as_posix()


def _below(prim: Sdf.PrimSpec) -> Iterator[Sdf.PrimSpec]:
    for child in prim.nameChildren:
        yield child
        yield from _below(child)


def _variant_of_class(layer: Sdf.Layer, name: str, choice: _Choice) -> Sdf.PrimSpec:
    """The part of a component's class for pieces in these variants with looks of the house."""
    prim = Sdf.CreatePrimInLayer(layer, f"/__class__/{name}")
    prim.specifier = prim.nameParent.specifier = Sdf.SpecifierClass
    for set_name, variant in ((LOOKS_SET, OF_HOUSE), *choice):
        variants = prim.variantSets.get(set_name)
        if variants is None:
            variants = Sdf.VariantSetSpec(prim, set_name)
            prim.variantSetNameList.prependedItems.append(set_name)
        chosen = variants.variants.get(variant) or Sdf.VariantSpec(variants, variant)
        prim = chosen.primSpec
    return prim
