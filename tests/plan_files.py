"""Plans written the way other programs do, to be read back."""

from __future__ import annotations

import zipfile
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from shapely.geometry import Polygon
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import footprint, footprint_polygon, polygons_of, wall_area
from chord_usd.base.scene.types import Opening, Plan

KINDS = {"door": "Door Swing Beside", "window": "Window Regular", "passage": "Opening"}


def solid_walls(plan: Plan) -> list[Polygon]:
    """Walls with the holes of doors and windows in them."""
    holes = unary_union([footprint_polygon(opening.box) for opening in plan.openings])
    return polygons_of(wall_area(plan.rooms).difference(holes.buffer(1e-6)))


def write_cubicasa(plan: Plan, path: Path, px_per_m: float = 50.0) -> None:
    """As CubiCasa's model.svg: groups with classes, y down, pixels of no stated size."""

    def points(corners: np.ndarray) -> str:
        return " ".join(f"{x * px_per_m:.4f},{-y * px_per_m:.4f}" for x, y in corners)

    def group(kind: str, corners: np.ndarray, inner: str = "") -> str:
        return f'<g class="{kind}"><polygon points="{points(corners)}"/>{inner}</g>'

    parts = []
    for room in plan.rooms:
        name = '<g class="TextLabel"><text x="0" y="0">x</text></g>'
        parts.append(group(f"Space {room.kind.title()}", room.polygon_m, name))
    for wall in polygons_of(wall_area(plan.rooms)):
        # Walls are simple polygons there; one with holes is cut into two.
        for piece in simple(wall):
            parts.append(group("Wall External", np.array(piece.exterior.coords[:-1])))
    parts += [group(KINDS[o.kind], footprint(o.box)) for o in plan.openings]
    path.write_text(
        '<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 900">'
        f'<g class="Model"><g class="Floor" transform="translate(40 300)">{"".join(parts)}</g></g>'
        "</svg>"
    )


def simple(area: Polygon) -> list[Polygon]:
    """An area with holes as areas without."""
    if not area.interiors:
        return [area]
    x = Polygon(area.interiors[0]).centroid.x
    low_x, low_y, _, high_y = area.bounds
    left = Polygon([(low_x, low_y), (x, low_y), (x, high_y), (low_x, high_y)])
    halves = [area.intersection(left), area.difference(left)]
    return [part for half in halves for piece in polygons_of(half) for part in simple(piece)]


def write_dxf(plan: Plan, path: Path, units: int = 4, per_m: float = 1000.0) -> None:
    """Walls as outlines of their faces, doors as arcs with leaves in blocks, windows as lines."""
    import ezdxf

    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = units
    space = document.modelspace()
    for wall in solid_walls(plan):
        for ring in (wall.exterior, *wall.interiors):
            points = (np.array(ring.coords[:-1]) * per_m).tolist()
            space.add_lwpolyline(points, close=True, dxfattribs={"layer": "A-WALL"})
    for index, opening in enumerate(plan.openings):
        add_opening(document, opening, per_m, index)
    for room in plan.rooms:
        place = Polygon(room.polygon_m).representative_point()
        text = space.add_text(room.kind.upper(), dxfattribs={"layer": "A-TEXT"})
        text.set_placement((place.x * per_m, place.y * per_m))
    document.saveas(path)


def write_single_lines(path: Path) -> None:
    """Two rooms, 5 by 4 and 3 by 4 m from line to line, a door with its arc between them."""
    import ezdxf

    document = ezdxf.new()
    document.header["$INSUNITS"] = 6
    space = document.modelspace()
    outline = [(0, 0), (8, 0), (8, 4), (0, 4), (0, 0)]
    for start, stop in (*pairwise(outline), ((5, 0), (5, 1)), ((5, 1.9), (5, 4))):
        space.add_line(start, stop, dxfattribs={"layer": "WALLS"})
    space.add_line((5, 1), (5.9, 1), dxfattribs={"layer": "DOORS"})
    space.add_arc((5, 1), 0.9, 0, 90, dxfattribs={"layer": "DOORS"})
    document.saveas(path)


def add_opening(document: Any, opening: Opening, per_m: float, index: int) -> None:
    corners, space = footprint(opening.box) * per_m, document.modelspace()
    if opening.kind == "door":
        length = opening.box.size_m[0] * per_m
        block = document.blocks.new(f"door_{index}")
        block.add_line((0, 0), (0, length))
        block.add_arc((0, 0), length, 0, 90)
        where = {"layer": "A-DOOR", "rotation": opening.box.yaw_deg}
        space.add_blockref(block.name, corners[0], dxfattribs=where)
    else:
        # Panes of a window; a passage is drawn as a line across each end.
        layer = "A-GLAZ" if opening.kind == "window" else "A-DOOR-OPENING"
        for start, stop in ((0, 3), (1, 2)):
            space.add_line(corners[start], corners[stop], dxfattribs={"layer": layer})


HOME = """<?xml version='1.0'?>
<home version='6000'>
  <level id='ground' name='Ground' elevation='0'/>
  <wall level='ground' xStart='0' yStart='0' xEnd='600' yEnd='0' thickness='20' height='250'/>
  <wall level='ground' xStart='600' yStart='0' xEnd='600' yEnd='400' thickness='20'/>
  <wall level='ground' xStart='600' yStart='400' xEnd='0' yEnd='400' thickness='20'/>
  <wall level='ground' xStart='0' yStart='400' xEnd='0' yEnd='0' thickness='20'/>
  <wall level='ground' xStart='350' yStart='0' xEnd='350' yEnd='400' thickness='10'/>
  {rooms}
  <doorOrWindow level='ground' catalogId='eTeks#door' name='Door' x='350' y='200' width='90'
    depth='15' height='208' angle='1.5707964'/>
  <doorOrWindow level='ground' catalogId='eTeks#frontDoor' name='Front door' x='100' y='400'
    width='90' depth='20' height='208' angle='0'/>
  <doorOrWindow level='ground' catalogId='eTeks#window85x123' name='Window' x='470' y='0'
    width='120' depth='20' height='123' elevation='80' angle='0'/>
</home>"""
ROOMS = """<room level='ground' name='Salon'><point x='0' y='0'/><point x='350' y='0'/>
  <point x='350' y='400'/><point x='0' y='400'/></room>
  <room level='ground' name='Chambre'><point x='350' y='0'/><point x='600' y='0'/>
  <point x='600' y='400'/><point x='350' y='400'/></room>"""


def write_sweethome(path: Path, home: str = HOME, rooms: str = ROOMS) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("Home.xml", home.replace("{rooms}", rooms))


def write_ifc(
    path: Path, *, spaces: bool = True, unit: str = "MILLIMETRE", roof: bool = False
) -> None:
    """A house of two rooms, 5 by 4 and 3 by 4 m, in walls 0.2 m thick, with door and window.

    roof: with another storey, a space of 15 by 10 m.
    """
    import ifcopenshell.api.aggregate
    import ifcopenshell.api.context
    import ifcopenshell.api.feature
    import ifcopenshell.api.geometry
    import ifcopenshell.api.project
    import ifcopenshell.api.root
    import ifcopenshell.api.spatial
    import ifcopenshell.api.unit

    api = ifcopenshell.api
    model = api.project.create_file()
    project = api.root.create_entity(model, ifc_class="IfcProject", name="House")
    length = api.unit.add_si_unit(
        model, unit_type="LENGTHUNIT", prefix="MILLI" if unit == "MILLIMETRE" else None
    )
    api.unit.assign_unit(model, units=[length])
    per_m = 1000.0 if unit == "MILLIMETRE" else 1.0
    context = api.context.add_context(model, context_type="Model")
    body = api.context.add_context(
        model, context_type="Model", context_identifier="Body", target_view="MODEL_VIEW",
        parent=context,
    )  # fmt: skip
    storey = api.root.create_entity(model, ifc_class="IfcBuildingStorey", name="Ground")
    api.aggregate.assign_object(model, products=[storey], relating_object=project)

    def block(kind: str, name: str, low: tuple[float, ...], size: tuple[float, ...]) -> Any:
        entity = api.root.create_entity(model, ifc_class=kind, name=name)
        matrix = np.eye(4)
        matrix[:3, 3] = low
        api.geometry.edit_object_placement(model, product=entity, matrix=matrix)
        corners = [(0.0, 0.0), (size[0], 0.0), (size[0], size[1]), (0.0, size[1])]
        points = [model.createIfcCartesianPoint((x * per_m, y * per_m)) for x, y in corners]
        curve = model.createIfcPolyline([*points, points[0]])
        profile = model.createIfcArbitraryClosedProfileDef("AREA", None, curve)
        up = model.createIfcDirection((0.0, 0.0, 1.0))
        origin = model.createIfcAxis2Placement3D(model.createIfcCartesianPoint((0.0, 0.0, 0.0)))
        solid = model.createIfcExtrudedAreaSolid(profile, origin, up, size[2] * per_m)
        shape = model.createIfcShapeRepresentation(body, "Body", "SweptSolid", [solid])
        api.geometry.assign_representation(model, product=entity, representation=shape)
        return entity

    walls = {
        "south": block("IfcWall", "south", (0, 0, 0), (8.6, 0.2, 2.7)),
        "north": block("IfcWall", "north", (0, 4.2, 0), (8.6, 0.2, 2.7)),
        "west": block("IfcWall", "west", (0, 0.2, 0), (0.2, 4, 2.7)),
        "east": block("IfcWall", "east", (8.4, 0.2, 0), (0.2, 4, 2.7)),
        "inner": block("IfcWall", "inner", (5.2, 0.2, 0), (0.2, 4, 2.7)),
    }
    api.spatial.assign_container(model, products=list(walls.values()), relating_structure=storey)
    for kind, wall, low, size in (
        ("IfcDoor", "inner", (5.2, 1, 0), (0.2, 0.9, 2.1)),
        ("IfcDoor", "south", (1, 0, 0), (1.0, 0.2, 2.1)),
        ("IfcWindow", "north", (6, 4.2, 0.9), (1.5, 0.2, 1.2)),
    ):
        hole = block("IfcOpeningElement", "hole", low, size)
        api.feature.add_feature(model, feature=hole, element=walls[wall])
        filling = block(kind, kind, low, size)
        filling.OverallWidth = max(size[:2]) * per_m
        api.feature.add_filling(model, opening=hole, element=filling)
        api.spatial.assign_container(model, products=[filling], relating_structure=storey)
    if spaces:
        rooms = [
            block("IfcSpace", "1", (0.2, 0.2, 0), (5, 4, 2.5)),
            block("IfcSpace", "2", (5.4, 0.2, 0), (3, 4, 2.5)),
        ]
        rooms[0].LongName, rooms[1].LongName = "Wohnzimmer", "Küche"
        api.aggregate.assign_object(model, products=rooms, relating_object=storey)
    if roof:
        above = api.root.create_entity(model, ifc_class="IfcBuildingStorey", name="Roof")
        api.aggregate.assign_object(model, products=[above], relating_object=project)
        attic = block("IfcSpace", "attic", (-3, -3, 3), (15, 10, 2))
        api.aggregate.assign_object(model, products=[attic], relating_object=above)
    model.write(str(path))
