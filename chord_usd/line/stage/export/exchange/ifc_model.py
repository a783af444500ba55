"""A house as a building in IFC4: spaces, walls with holes, doors, windows, furnishing elements.

Left out: what stands on tables, shelves and furniture, and lies on it; lights and cameras. The
ceiling is where spaces end.
"""

from __future__ import annotations

import hashlib
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import shapely
from pxr import Usd
from shapely.geometry import Polygon, box
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import footprint_polygon, polygons_of, room_polygon
from chord_usd.base.scene.storeys import CEILING_TO_FLOOR_M, IFC_FORMS
from chord_usd.base.scene.tunnels import Tunnel
from chord_usd.base.scene.types import ROOM_HEIGHT_M
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.export.exchange.built_house import House, houses_of, span_in_plan
from chord_usd.line.stage.export.exchange.ifc_builder import Entity, IfcBuilder, label
from chord_usd.line.stage.export.exchange.ifc_furniture import add_furniture
from chord_usd.line.stage.export.exchange.wall_pieces import WallPiece, wall_pieces
from chord_usd.line.stage.shell.opening_parts import leaf_box, leaves_of, railing_guard
from chord_usd.line.stage.shell.opening_shapes import GLASS_M

_SLAB_M = 0.2
_FRAME_M = 0.05
"""Width and depth of the frames of doors and windows."""

_SEEN_M = 0.1
"""A wall that has more of the house's outline is external."""

_STAIRS = {str(form): word for form, word in IFC_FORMS.items()}


def write_ifc(stage: Usd.Stage, target: Path) -> None:
    """Write the house on a stage as an .ifc file. Raises StageError, MissingExtraError."""
    houses = houses_of(stage)
    builder = IfcBuilder(_digest(houses))
    building = _open_building(builder)
    for house in houses:
        builder.within = f"{house.storey}/" if house.storey else ""
        storey = _Storey(house, builder, building)
        storey.add_spaces()
        storey.add_walls()
        storey.add_slab()
        storey.add_stairs()
        for room_id, elements in add_furniture(stage, house, builder, storey.storey).items():
            storey.contain(elements, storey.spaces.get(room_id))
        storey.finish()
    builder.write(target)


def _digest(houses: Sequence[House]) -> str:
    if len(houses) == 1:
        return houses[0].digest
    return hashlib.sha256(" ".join(house.digest for house in houses).encode()).hexdigest()


def _open_building(b: IfcBuilder) -> Entity:
    """Project, site and building; returns the building."""
    units = b.add("IfcUnitAssignment", Units=[
        b.add("IfcSIUnit", UnitType=kind, Name=name)
        for kind, name in (
            ("LENGTHUNIT", "METRE"), ("AREAUNIT", "SQUARE_METRE"),
            ("VOLUMEUNIT", "CUBIC_METRE"), ("PLANEANGLEUNIT", "RADIAN"),
        )
    ])  # fmt: skip
    parent = b.rooted(
        "IfcProject", "", "House", UnitsInContext=units, RepresentationContexts=[b.context]
    )
    place = None
    for kind, name in (("IfcSite", "Site"), ("IfcBuilding", "House")):
        place = b.place(place)
        parent = _part_of(b, parent, kind, name, place)
    return parent


def _part_of(b: IfcBuilder, parent: Entity, kind: str, name: str, place: Entity) -> Entity:
    made = b.rooted(kind, "", name, ObjectPlacement=place, CompositionType="ELEMENT")
    b.relate("IfcRelAggregates", kind, RelatingObject=parent, RelatedObjects=[made])
    return made


class _Storey:
    """A storey, and what is added to it."""

    def __init__(self, house: House, builder: IfcBuilder, building: Entity) -> None:
        self.house, self.builder = house, builder
        self.spaces: dict[str, Entity] = {}
        """By id of the room."""
        self._in_storey: list[Entity] = []
        self._of_type: dict[tuple[object, ...], list[Entity]] = defaultdict(list)
        at_m = (0.0, 0.0, house.elevation_m)
        self._place = builder.place(building.ObjectPlacement, at_m)
        name = label(house.storey_title) or "Ground floor"
        self.storey = _part_of(builder, building, "IfcBuildingStorey", name, self._place)
        self.storey.Elevation = house.elevation_m

    def add_spaces(self) -> None:
        """A space for each room, up to its ceiling."""
        b = self.builder
        for room in self.house.plan.rooms:
            floor = room_polygon(room)
            space = b.rooted(
                "IfcSpace", room.id, room.id, LongName=label(self.house.title(room)),
                Description=label(self.house.titles[room.id]) or None, CompositionType="ELEMENT",
                PredefinedType="EXTERNAL" if room.kind == "balcony" else "INTERNAL",
                ObjectPlacement=b.place(self._place),
                Representation=b.shape([b.extrusion(floor, 0.0, ROOM_HEIGHT_M)]),
            )  # fmt: skip
            values = {"Category": room.kind, "FloorArea": round(floor.area, 4)}
            b.describe(space, room.id, values)
            common = {"Reference": room.kind, "IsExternal": room.kind == "balcony"}
            b.describe(space, room.id, common, "Pset_SpaceCommon")
            b.measure(space, room.id, {
                "NetFloorArea": floor.area, "GrossPerimeter": floor.length,
                "Height": ROOM_HEIGHT_M, "NetVolume": floor.area * ROOM_HEIGHT_M,
            })  # fmt: skip
            self.spaces[room.id] = space
        b.relate(
            "IfcRelAggregates", "spaces", RelatingObject=self.storey,
            RelatedObjects=list(self.spaces.values()),
        )  # fmt: skip

    def add_walls(self) -> None:
        """Straight walls, with what is cut through them."""
        b, made = self.builder, []
        walls = self.house.walls
        whole = unary_union([walls.solid_m, *walls.floors_m]).buffer(1e-3, join_style="mitre")
        outline = unary_union([part.exterior for part in polygons_of(whole.buffer(-2e-3))])
        for number, piece in enumerate(wall_pieces(self.house.walls)):
            wall = self._element(
                "IfcWall", f"Wall_{number}", self._wall_bodies(piece), PredefinedType="SOLIDWALL"
            )
            facade_m = shapely.intersection(piece.area_m, outline).length
            common = {"IsExternal": facade_m > _SEEN_M, "LoadBearing": False}
            b.describe(wall, f"Wall_{number}", common, "Pset_WallCommon")
            b.measure(wall, f"Wall_{number}", {
                "Height": ROOM_HEIGHT_M, "GrossFootprintArea": piece.area_m.area,
                "GrossVolume": piece.area_m.area * ROOM_HEIGHT_M,
            })  # fmt: skip
            made.append(wall)
            for tunnel in piece.tunnels:
                self._add_opening(wall, tunnel)
        b.make_of(made, "Masonry")
        for number, (_, tunnel) in enumerate(self.house.walls.railings):
            self._add_railing(f"Railing_{number}", tunnel)

    def _wall_bodies(self, piece: WallPiece) -> list[Entity]:
        """From floor to ceiling, but for the gaps that railings close."""
        b = self.builder
        gaps = unary_union([gap.area_m for gap in piece.gaps])
        bodies = [
            b.extrusion(part, 0.0, ROOM_HEIGHT_M)
            for part in polygons_of(shapely.difference(piece.area_m, gaps, grid_size=1e-4))
        ]
        for gap in piece.gaps:
            for part in polygons_of(shapely.intersection(piece.area_m, gap.area_m, grid_size=1e-4)):
                bodies.append(b.extrusion(part, 0.0, gap.low_m))
                bodies.append(b.extrusion(part, gap.high_m, ROOM_HEIGHT_M))
        return bodies

    def _element(self, kind: str, name: str, bodies: Sequence[Entity], **values: object) -> Entity:
        """An element of the storey that is drawn in the storey's frame."""
        b = self.builder
        made = b.rooted(
            kind, name, name, ObjectPlacement=b.place(self._place),
            Representation=b.shape(bodies), **values,
        )  # fmt: skip
        self._in_storey.append(made)
        return made

    def add_slab(self) -> None:
        """What rooms and walls stand on, with the holes that stairs come up through."""
        walls = self.house.walls
        whole = unary_union([walls.solid_m, *walls.floors_m]).buffer(1e-3, join_style="mitre")
        parts: list[Polygon] = [Polygon(part.exterior) for part in polygons_of(whole)]
        thick_m, kind = _SLAB_M, "BASESLAB"
        if self.house.elevation_m > 0.0:
            thick_m, kind = CEILING_TO_FLOOR_M, "FLOOR"
            free = unary_union(parts).difference(unary_union(self.house.holes))
            parts = polygons_of(shapely.set_precision(free, 1e-4))
        bodies = [self.builder.extrusion(part, -thick_m, 0.0) for part in parts]
        slab = self._element("IfcSlab", "Floor", bodies, PredefinedType=kind)
        area_m2 = sum(part.area for part in parts)
        ground = self.house.elevation_m <= 0.0
        self.builder.describe(slab, "Floor", {"IsExternal": ground}, "Pset_SlabCommon")
        self.builder.measure(slab, "Floor", {"Width": thick_m, "GrossArea": area_m2})
        self.builder.make_of([slab], "Concrete")

    def add_stairs(self) -> None:
        """Stairs up, each of its steps and what one holds on to, as meshes."""
        b = self.builder
        for stair in self.house.stairs:
            made = b.rooted(
                "IfcStair", stair.id, stair.id,
                PredefinedType=_STAIRS.get(stair.form, "NOTDEFINED"),
                ObjectPlacement=b.place(self._place),
            )  # fmt: skip
            parts = []
            for number, solid in enumerate(stair.solids):
                is_flight = solid.path.rsplit("/", 1)[-1].startswith("Steps")
                kind = "IfcStairFlight" if is_flight else "IfcRailing"
                mesh = b.triangles(solid.mesh.vertices, solid.mesh.faces, None)
                key = f"{stair.id}_{number}"
                parts.append(
                    b.rooted(
                        kind, key, solid.path.rsplit("/", 1)[-1],
                        ObjectPlacement=b.place(made.ObjectPlacement),
                        Representation=b.shape([mesh], "Tessellation"),
                    )
                )  # fmt: skip
            b.relate("IfcRelAggregates", stair.id, RelatingObject=made, RelatedObjects=parts)
            b.describe(made, stair.id, {"Category": "stairs", "Rooms": ", ".join(stair.rooms)})
            self._in_storey.append(made)

    def _add_railing(self, name: str, tunnel: Tunnel) -> None:
        b, guard = self.builder, railing_guard(tunnel)
        frame = tunnel.opening.box
        bar = footprint_polygon(guard)
        railing = b.rooted(
            "IfcRailing", name, name, PredefinedType="GUARDRAIL",
            ObjectPlacement=b.place(
                self._place, (*frame.center_m[:2], tunnel.low_m), _turn(frame.yaw_deg)
            ),
            Representation=b.shape([b.extrusion(bar, 0.0, guard.size_m[2])]),
        )  # fmt: skip
        self._in_storey.append(railing)

    # Openings -------------------------------------------------------------------------------------

    def _add_opening(self, wall: Entity, tunnel: Tunnel) -> None:
        b, opening = self.builder, tunnel.opening
        x_m, y_m, _ = opening.box.center_m
        place = b.place(wall.ObjectPlacement, (x_m, y_m, tunnel.low_m), _turn(opening.box.yaw_deg))
        hole = b.rooted(
            "IfcOpeningElement", opening.id, opening.id, PredefinedType="OPENING",
            ObjectPlacement=place,
            Representation=b.shape(
                [b.extrusion(_own_area(tunnel), 0.0, tunnel.high_m - tunnel.low_m)]
            ),
        )  # fmt: skip
        b.relate(
            "IfcRelVoidsElement", opening.id,
            RelatingBuildingElement=wall, RelatedOpeningElement=hole,
        )  # fmt: skip
        if opening.kind == "passage":
            return
        made = self._door(tunnel, place) if opening.kind == "door" else self._window(tunnel, place)
        b.relate(
            "IfcRelFillsElement", opening.id,
            RelatingOpeningElement=hole, RelatedBuildingElement=made,
        )  # fmt: skip
        joined = ", ".join(opening.room_ids)
        b.describe(made, opening.id, {"Category": opening.kind, "Rooms": joined})
        common = {"IsExternal": len(opening.room_ids) < 2}
        b.describe(made, opening.id, common, f"Pset_{opening.kind.capitalize()}Common")
        wide, high = made.OverallWidth, made.OverallHeight
        b.measure(made, opening.id, {"Width": wide, "Height": high, "Area": wide * high})
        self._in_storey.append(made)

    def _door(self, tunnel: Tunnel, hole: Entity) -> Entity:
        """Its own +y is the way it opens, as IFC has it."""
        opens = self.house.opens_to(tunnel.opening)
        leaves = leaves_of(tunnel)
        operation = "SINGLE_SWING_LEFT" if opens > 0 else "SINGLE_SWING_RIGHT"
        operation = "DOUBLE_DOOR_SINGLE_SWING" if len(leaves) > 1 else operation
        boxes = _frame(tunnel, sill=False)
        for (x_m, y_m, _), leaf in leaves:
            guard = leaf_box(leaf)
            area = shapely.affinity.translate(footprint_polygon(guard), x_m, y_m)
            boxes.append((area, guard.center_m[2], guard.top_m))
        turned = [
            (shapely.affinity.scale(area, opens, opens, origin=(0, 0)), low, high)
            for area, low, high in boxes
        ]
        return self._fill("IfcDoor", tunnel, hole, turned, 0.0 if opens > 0 else 180.0, operation)

    def _window(self, tunnel: Tunnel, hole: Entity) -> Entity:
        span = span_in_plan(tunnel)
        pane = box(
            span.left + _FRAME_M, span.middle - GLASS_M / 2,
            span.right - _FRAME_M, span.middle + GLASS_M / 2,
        )  # fmt: skip
        boxes = [*_frame(tunnel, sill=True), (pane, _FRAME_M, span.height - _FRAME_M)]
        return self._fill("IfcWindow", tunnel, hole, boxes, 0.0, "SINGLE_PANEL")

    def _fill(
        self, kind: str, tunnel: Tunnel, hole: Entity,
        boxes: Sequence[tuple[Polygon, float, float]], yaw_deg: float, works: str,
    ) -> Entity:  # fmt: skip
        """A door or window. boxes: (area, low, high) in its own frame."""
        b, opening, span = self.builder, tunnel.opening, span_in_plan(tunnel)
        bodies = [b.extrusion(area, low, high) for area, low, high in boxes if high > low]
        size_m = round(span.right - span.left, 4), round(span.height, 4)
        enum = "OperationType" if kind == "IfcDoor" else "PartitioningType"
        made = b.rooted(
            kind, opening.id, opening.id, OverallWidth=size_m[0], OverallHeight=size_m[1],
            PredefinedType=kind.removeprefix("Ifc").upper(), ObjectPlacement=b.place(
                hole, turn=_turn(yaw_deg)
            ),
            Representation=b.shape(bodies), **{enum: works},
        )  # fmt: skip
        self._of_type[kind, *size_m, works].append(made)
        return made

    # The end --------------------------------------------------------------------------------------

    def contain(self, elements: Sequence[Entity], space: Entity | None) -> None:
        """Let a space hold elements, or the storey where there is no space for them."""
        if space is None:
            self._in_storey += elements
            return
        self.builder.relate(
            "IfcRelContainedInSpatialStructure", str(space.Name),
            RelatingStructure=space, RelatedElements=list(elements),
        )  # fmt: skip

    def finish(self) -> None:
        """Write what holds many: the storey's elements, the types of doors and windows."""
        b = self.builder
        b.relate(
            "IfcRelContainedInSpatialStructure", "storey",
            RelatingStructure=self.storey, RelatedElements=self._in_storey,
        )  # fmt: skip
        for (kind, width_m, height_m, works), made in self._of_type.items():
            word = str(kind).removeprefix("Ifc")
            name = f"{word} {width_m:g} x {height_m:g} {works}"
            enum = "OperationType" if word == "Door" else "PartitioningType"
            shared = b.rooted(
                f"{kind}Type", name, name, PredefinedType=word.upper(), **{enum: works}
            )
            b.relate("IfcRelDefinesByType", name, RelatingType=shared, RelatedObjects=made)


def _turn(yaw_deg: float) -> np.ndarray:
    """(3, 3) about z."""
    turn = np.eye(3)
    turn[:2, :2] = rotation_2d(yaw_deg)
    return turn


def _own_area(tunnel: Tunnel) -> Polygon:
    """The hole seen from above, in the frame of its opening."""
    span = span_in_plan(tunnel)
    return box(span.left, span.front, span.right, span.back)


def _frame(tunnel: Tunnel, *, sill: bool) -> list[tuple[Polygon, float, float]]:
    """Jambs and head of a door or window, and its sill, in the frame of the hole."""
    span = span_in_plan(tunnel)
    front, back = span.middle - _FRAME_M / 2, span.middle + _FRAME_M / 2
    inner = span.left + _FRAME_M, span.right - _FRAME_M
    parts = [
        (box(span.left, front, inner[0], back), 0.0, span.height),
        (box(inner[1], front, span.right, back), 0.0, span.height),
    ]
    if inner[1] > inner[0]:
        lintel = box(inner[0], front, inner[1], back)
        parts.append((lintel, span.height - _FRAME_M, span.height))
        if sill:
            parts.append((lintel, 0.0, _FRAME_M))
    return parts
