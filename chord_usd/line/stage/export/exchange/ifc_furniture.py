"""Furniture and fixed dressing in IFC: a type for each model, its mesh once, mapped placements."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from PIL import Image
from pxr import Ar, Usd, UsdShade

from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.line.stage.author.surfaces import bound_material, opened_picture, source_of, value_of
from chord_usd.line.stage.export.exchange.built_house import House
from chord_usd.line.stage.export.exchange.ifc_builder import Entity, IfcBuilder
from chord_usd.line.stage.export.exchange.placed_pieces import Piece, pieces_of


def add_furniture(
    stage: Usd.Stage, house: House, builder: IfcBuilder, storey: Entity
) -> dict[str, list[Entity]]:
    """Elements by the id of the room they are in; not yet contained in anything."""
    shop = _Shop(stage, builder, storey.ObjectPlacement)
    elements: dict[str, list[Entity]] = defaultdict(list)
    for piece in pieces_of(stage, house):
        elements[piece.item.room_id].append(shop.element(piece))
    shop.finish()
    return elements


class _Shop:
    """Types, each made when it is first needed."""

    def __init__(self, stage: Usd.Stage, builder: IfcBuilder, place: Entity) -> None:
        self._stage, self._builder, self._place = stage, builder, place
        self._types: dict[tuple[str, str], tuple[Entity, Entity, list[Entity]]] = {}
        """By model and category: type, map of its mesh, what is of that type."""
        self._looks = _Looks()

    def element(self, piece: Piece) -> Entity:
        """The element of one piece."""
        b, item = self._builder, piece.item
        element, predefined = _ifc_class(item.category)
        key = piece.model, item.category
        if key not in self._types:
            self._types[key] = self._type(piece)
        _, mapping, elements = self._types[key]
        name = item.id.rsplit("/", 1)[-1]
        made = b.rooted(
            element, item.id, name, ObjectType=_label_of(item.category),
            PredefinedType=predefined,
            ObjectPlacement=b.place(self._place, piece.at_m, piece.turn),
            Representation=b.mapped(mapping, piece.scale),
        )  # fmt: skip
        length_m, width_m, height_m = (round(side, 4) for side in item.box.size_m)
        b.describe(made, item.id, {
            "Category": item.category, "Asset": piece.asset, "Prim": item.id,
            "Length": length_m, "Width": width_m, "Height": height_m,
        })  # fmt: skip
        elements.append(made)
        return made

    def _type(self, piece: Piece) -> tuple[Entity, Entity, list[Entity]]:
        b = self._builder
        meshes = [
            b.triangles(mesh.vertices, mesh.faces, self._looks.rgba(self._stage, solid.path))
            for solid in piece.solids
            if len((mesh := piece.in_model(solid)).faces)
        ]
        drawn = b.drawing(meshes, "Tessellation")
        mapping = b.add("IfcRepresentationMap", MappingOrigin=b.origin, MappedRepresentation=drawn)
        element, predefined = _ifc_class(piece.item.category)
        # The first piece names it: numbers of USD's prototypes differ from run to run.
        extra = {"AssemblyPlace": "NOTDEFINED"} if element == "IfcFurniture" else {}
        kind = b.rooted(
            f"{element}Type", piece.item.id, piece.asset, PredefinedType=predefined,
            RepresentationMaps=[mapping], ElementType=_label_of(piece.item.category), **extra,
        )  # fmt: skip
        return kind, mapping, []

    def finish(self) -> None:
        """Tell which elements are of which type."""
        for kind, _, elements in self._types.values():
            self._builder.relate(
                "IfcRelDefinesByType", str(kind.GlobalId),
                RelatingType=kind, RelatedObjects=elements,
            )  # fmt: skip


def _label_of(category: str) -> str:
    row = CATEGORIES.get(category)
    return row.label if row else category


def _ifc_class(category: str) -> tuple[str, str]:
    """Class of IFC4 and predefined type; furniture of no kind where the table says nothing."""
    row = CATEGORIES.get(category)
    element, _, predefined = (row.ifc if row else "").partition(".")
    return element or "IfcFurniture", predefined or "NOTDEFINED"


class _Looks:
    """Colours of meshes: of plain materials their own, of pictures the mean."""

    def __init__(self) -> None:
        self._means: dict[str, tuple[float, ...]] = {}

    def rgba(self, stage: Usd.Stage, path: str) -> Sequence[float] | None:
        """(4,) red, green, blue, opacity; None for a mesh without a material that states a
        colour."""
        material = bound_material(stage.GetPrimAtPath(path))
        shader: UsdShade.Shader | None = material.ComputeSurfaceSource()[0] if material else None
        if not shader:
            return None
        opacity = float(value_of(shader, "opacity", 1.0))
        texture = source_of(shader, "diffuseColor")
        colour = self._mean(texture) if texture else value_of(shader, "diffuseColor", None)
        if colour is None:
            return None
        # Linear light in USD, what screens show in IFC.
        shown = np.clip(np.array(colour, dtype=np.float64), 0.0, 1.0) ** (1 / 2.2)
        return (*shown.tolist(), min(max(opacity, 0.0), 1.0))

    def _mean(self, texture: UsdShade.Shader) -> tuple[float, ...] | None:
        file = texture.GetInput("file")
        path = str(file.Get().resolvedPath) if file and file.Get() else ""
        asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path)) if path else None
        if asset is None:
            return None
        if path not in self._means:
            picture = opened_picture(bytes(asset.GetBuffer())).convert("RGB")
            pixel = np.array(picture.resize((1, 1), Image.Resampling.BOX))[0, 0]
            self._means[path] = tuple((pixel / 255.0) ** 2.2)
        return self._means[path]
