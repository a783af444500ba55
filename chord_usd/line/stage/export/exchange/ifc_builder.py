"""An IFC4 file being written: identifiers, placements, bodies, relations. Lengths in metres.

Entities are made directly, not through ifcopenshell.api: its identifiers are random, and the same
house must give the same bytes.
"""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from shapely.geometry import Polygon

from chord_usd import __version__
from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.export.exchange.built_house import printable

Entity = Any
"""ifcopenshell.entity_instance, which has attributes by schema."""

_DECIMALS = 5
_LONGEST_LABEL = 255
_WRITTEN_AT = "2000-01-01T00:00:00"
"""Any fixed time: the header wants one."""

_MVD = "ViewDefinition [ReferenceView_V1.2]"


class IfcBuilder:
    """The file, and the context that bodies are drawn in."""

    def __init__(self, digest: str) -> None:
        """digest: names the house, so that identifiers are its own. Raises MissingExtraError."""
        with needed_for("writing IFC"):
            import ifcopenshell
            import ifcopenshell.guid
        self._compress = ifcopenshell.guid.compress
        self._house = uuid.uuid5(uuid.NAMESPACE_URL, f"chord-usd/{digest}")
        self.file = ifcopenshell.file(schema="IFC4")
        self.within = ""
        """What keys begin with: the storey, in a house of several."""
        self._directions: dict[tuple[float, ...], Entity] = {}
        self._styles: dict[tuple[float, ...], Entity] = {}
        self.origin = self._axes((0.0, 0.0, 0.0))
        whole = self.add(
            "IfcGeometricRepresentationContext", ContextType="Model", CoordinateSpaceDimension=3,
            Precision=1e-5, WorldCoordinateSystem=self.origin,
        )  # fmt: skip
        self.body = self.add(
            "IfcGeometricRepresentationSubContext", ContextIdentifier="Body", ContextType="Model",
            ParentContext=whole, TargetView="MODEL_VIEW",
        )  # fmt: skip
        self.context = whole

    def add(self, kind: str, **values: Any) -> Entity:
        """An entity without an identifier of its own."""
        return self.file.create_entity(kind, **values)

    def rooted(self, kind: str, key: str, name: str = "", **values: Any) -> Entity:
        """An entity with an identifier, the same for the same key of the same house."""
        guid = self._compress(uuid.uuid5(self._house, f"{kind}/{self.within}{key}").hex)
        return self.add(kind, GlobalId=guid, Name=label(name) or None, **values)

    def relate(self, kind: str, key: str, **values: Any) -> None:
        """A relation between rooted entities."""
        self.rooted(kind, key, **values)

    def write(self, target: Path) -> None:
        """Write the file."""
        header = self.file.header
        header.file_description.description = (_MVD,)
        header.file_name.name = "house.ifc"
        header.file_name.time_stamp = _WRITTEN_AT
        header.file_name.author = ("",)
        header.file_name.organization = ("",)
        header.file_name.preprocessor_version = f"chord-usd {__version__}"
        header.file_name.originating_system = f"chord-usd {__version__}"
        self.file.write(str(target))

    # Places ---------------------------------------------------------------------------------------

    def place(
        self, parent: Entity | None = None, at_m: Sequence[float] | FloatArray = (0.0, 0.0, 0.0),
        turn: FloatArray | None = None,
    ) -> Entity:  # fmt: skip
        """Where something stands in its parent's frame. turn: (3, 3), columns are its axes."""
        return self.add(
            "IfcLocalPlacement", PlacementRelTo=parent, RelativePlacement=self._axes(at_m, turn)
        )

    def _axes(self, at_m: Sequence[float] | FloatArray, turn: FloatArray | None = None) -> Entity:
        given = {}
        if turn is not None:
            given = {
                "Axis": self._direction(turn[:, 2]), "RefDirection": self._direction(turn[:, 0])
            }  # fmt: skip
        return self.add("IfcAxis2Placement3D", Location=self.point(at_m), **given)

    def point(self, at_m: Iterable[float]) -> Entity:
        """A point in two or three dimensions."""
        return self.add("IfcCartesianPoint", Coordinates=numbers(at_m))

    def _direction(self, way: Iterable[float]) -> Entity:
        key = tuple(round(float(value), 9) + 0.0 for value in way)
        if key not in self._directions:
            self._directions[key] = self.add("IfcDirection", DirectionRatios=key)
        return self._directions[key]

    # Bodies ---------------------------------------------------------------------------------------

    def extrusion(self, area: Polygon, low_m: float, high_m: float) -> Entity:
        """What stands on an area from one height to another."""
        outer = self._ring(area.exterior.coords)
        inner = [self._ring(hole.coords) for hole in area.interiors]
        kind = "IfcArbitraryProfileDefWithVoids" if inner else "IfcArbitraryClosedProfileDef"
        profile = self.add(kind, ProfileType="AREA", OuterCurve=outer)
        if inner:
            profile.InnerCurves = inner
        return self.add(
            "IfcExtrudedAreaSolid", SweptArea=profile, Position=self._axes((0.0, 0.0, low_m)),
            ExtrudedDirection=self._direction((0.0, 0.0, 1.0)), Depth=float(high_m - low_m),
        )  # fmt: skip

    def _ring(self, corners: Iterable[Sequence[float]]) -> Entity:
        points = [self.point(corner[:2]) for corner in list(corners)[:-1]]
        return self.add("IfcPolyline", Points=[*points, points[0]])

    def triangles(
        self, points_m: FloatArray, faces: np.ndarray, rgba: Sequence[float] | None
    ) -> Entity:
        """A mesh; points that agree become one. rgba: its colour, [0, 1], where it has one."""
        unique, index = np.unique(np.round(points_m, _DECIMALS), axis=0, return_inverse=True)
        corners = index.reshape(-1)[faces]
        flat = (corners == np.roll(corners, 1, axis=1)).any(axis=1)
        drawn = self.add(
            "IfcTriangulatedFaceSet",
            Coordinates=self.add("IfcCartesianPointList3D", CoordList=(unique + 0.0).tolist()),
            CoordIndex=(corners[~flat] + 1).tolist(),
        )
        if rgba is not None:
            self.add("IfcStyledItem", Item=drawn, Styles=[self._style(rgba)])
        return drawn

    def _style(self, rgba: Sequence[float]) -> Entity:
        key = tuple(round(float(value), 3) for value in rgba)
        if key not in self._styles:
            red, green, blue, opacity = key
            colour = self.add("IfcColourRgb", Red=red, Green=green, Blue=blue)
            shading = self.add(
                "IfcSurfaceStyleShading", SurfaceColour=colour, Transparency=1.0 - opacity
            )
            self._styles[key] = self.add("IfcSurfaceStyle", Side="BOTH", Styles=[shading])
        return self._styles[key]

    def drawing(self, items: Sequence[Entity], kind: str) -> Entity:
        """Bodies of one kind of representation: SweptSolid, Tessellation, MappedRepresentation."""
        return self.add(
            "IfcShapeRepresentation", ContextOfItems=self.body, RepresentationIdentifier="Body",
            RepresentationType=kind, Items=list(items),
        )  # fmt: skip

    def shape(self, items: Sequence[Entity], kind: str = "SweptSolid") -> Entity:
        """The shape of a product."""
        return self.add("IfcProductDefinitionShape", Representations=[self.drawing(items, kind)])

    def mapped(
        self, mapping: Entity, scale: Sequence[float] | FloatArray = (1.0, 1.0, 1.0)
    ) -> Entity:
        """The shape of a product that is drawn as its type is, scaled along the type's axes."""
        values = {"LocalOrigin": self.point((0.0, 0.0, 0.0)), "Scale": float(scale[0])}
        kind = "IfcCartesianTransformationOperator3D"
        if not np.allclose(scale, scale[0], atol=1e-6):
            kind = "IfcCartesianTransformationOperator3DnonUniform"
            values |= {"Scale2": float(scale[1]), "Scale3": float(scale[2])}
        item = self.add(
            "IfcMappedItem", MappingSource=mapping, MappingTarget=self.add(kind, **values)
        )
        return self.shape([item], "MappedRepresentation")

    # Properties -----------------------------------------------------------------------------------

    def describe(
        self, element: Entity, key: str, values: Mapping[str, str | float], named: str = ""
    ) -> None:
        """What we know of an element, as a property set: named as in the standard, or our own."""
        properties = [
            self.add("IfcPropertySingleValue", Name=name, NominalValue=self._value(value))
            for name, value in values.items()
        ]
        full_key = f"{key}/{named}" if named else key
        held = self.rooted(
            "IfcPropertySet", full_key, named or "ChordUsd", HasProperties=properties
        )
        self._define(element, full_key, held)

    def measure(self, element: Entity, key: str, values: Mapping[str, float]) -> None:
        """Base quantities of an element by their names, which say lengths, areas and volumes."""
        quantities = []
        for name, value in values.items():
            unit = next(
                (suffix for suffix in ("Area", "Volume") if name.endswith(suffix)), "Length"
            )
            amount = {f"{unit}Value": round(float(value), 4)}
            quantities.append(self.add(f"IfcQuantity{unit}", Name=name, **amount))
        kind = str(element.is_a()).removeprefix("Ifc")
        name = f"Qto_{kind}BaseQuantities"
        held = self.rooted("IfcElementQuantity", f"{key}/{name}", name, Quantities=quantities)
        self._define(element, f"{key}/{name}", held)

    def _define(self, element: Entity, key: str, held: Entity) -> None:
        self.relate(
            "IfcRelDefinesByProperties", key,
            RelatedObjects=[element], RelatingPropertyDefinition=held,
        )  # fmt: skip

    def make_of(self, elements: Sequence[Entity], material: str) -> None:
        """Say what elements are made of."""
        self.relate(
            "IfcRelAssociatesMaterial", material, RelatedObjects=list(elements),
            RelatingMaterial=self.add("IfcMaterial", Name=material),
        )  # fmt: skip

    def _value(self, value: str | float) -> Entity:
        if isinstance(value, bool):
            return self.add("IfcBoolean", wrappedValue=value)
        if isinstance(value, str):
            return self.add("IfcLabel", wrappedValue=label(value))
        return self.add("IfcReal", wrappedValue=float(value))


def label(text: str) -> str:
    """Text as an IfcLabel can hold it: printable, in one line, not too long."""
    return printable(text)[:_LONGEST_LABEL]


def numbers(values: Iterable[float]) -> tuple[float, ...]:
    """Coordinates, to a hundredth of a millimetre; no negative zeros."""
    return tuple(round(float(value), _DECIMALS) + 0.0 for value in values)
