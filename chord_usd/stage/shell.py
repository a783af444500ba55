"""Floors, walls, ceilings, doors and windows: one component per room, one for the outside.

The meshes of a component lie in a layer of their own behind a payload, so that a house opens
without them. Every face exists once (see walls.py): a room owns the faces that look into it and
the doors and windows named after it; the facade and the tops of the walls are the Exterior.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
from pxr import Sdf
from shapely.geometry import LineString, Polygon
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.scene.feels import FEEL_OF_SURFACE
from chord_usd.scene.geometry import footprint_polygon, polygons_of, room_polygon
from chord_usd.scene.trim import CASING_M
from chord_usd.scene.tunnels import Tunnel
from chord_usd.scene.types import ROOM_HEIGHT_M, WALL_THICKNESS_M, Box, FloatArray, Opening
from chord_usd.scene.units import rotation_2d
from chord_usd.stage.door_leaves import LeafKind, leaf_parts
from chord_usd.stage.mesh import Face, flat, mesh_of, upright
from chord_usd.stage.names import NamedOpening, NamedRoom
from chord_usd.stage.opening_parts import (
    PointM,
    fixed_parts,
    leaf_box,
    leaves_of,
    railing_guard,
    railing_parts,
    sashes_in,
    side_of,
)
from chord_usd.stage.opening_shapes import Leaf, Part
from chord_usd.stage.physics import (
    DOOR_KG_PER_M2,
    DOOR_OPENS_DEG,
    SASH_KG_PER_M2,
    define_colliders,
    hang_leaf,
    write_collider,
    write_feel,
)
from chord_usd.stage.prims import (
    bind,
    define,
    define_class,
    hint_extent,
    identify,
    inherit,
    label,
    new_layer,
    note,
    note_size,
    place,
    write_mesh,
)
from chord_usd.stage.slabs import slab_faces
from chord_usd.stage.stage_levels import Level, is_shaft, note_stair
from chord_usd.stage.stair_parts import (
    floor_boxes,
    guard_lines,
    guard_part,
    open_landing_sides,
    stair_boxes,
    stair_parts,
)
from chord_usd.stage.surfaces import Fitout, write_surface
from chord_usd.stage.walls import (
    WallLine,
    Walls,
    free_stretches,
    top_faces,
    wall_boxes,
    wall_faces,
)
from chord_usd.stage.window_parts import Sash

_SKIRTING_M = (0.004, 0.07)
"""Depth and height. Thin, so that furniture set against the wall does not collide with it."""

_SLAB_M = 0.2
"""How far down a floor is solid."""

_TILED = ("bathroom", "balcony")
"""Kinds of rooms without skirting boards."""

_FLOOR = "_Floor"

_GLASS_DOOR_FROM_M = 1.5
"""Outer doors this wide are glass doors, whatever they lead to."""


def draw_shell(
    layer: Sdf.Layer,
    level: Level,
    folder: Path,
    fitout: Fitout | None = None,
    above: Level | None = None,
) -> FloatArray:
    """Write Architecture of every room of a storey and its Exterior; returns the bounds, (2, 3)
    metres in the storey's frame.

    folder: where the payload layers go, beside the layer's own file. fitout: by default plain.
    above: the storey on top, whose floor's edge is drawn with the exterior.
    """
    fitout = fitout or Fitout()
    extents = []
    for room in level.rooms:
        extents.append(_draw_room(layer, room, level, folder, fitout))
    extents.append(_draw_exterior(layer, level, above, folder, fitout))
    bounds = np.array(extents)
    return np.array([bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)])


def floor_material(room: NamedRoom) -> str:
    """Name of the room's floor material; unique in the house, since Blender merges by name."""
    return f"{room.name}{_FLOOR}"


def wall_material(room: NamedRoom) -> str:
    """Name of the room's wall material."""
    return f"{room.name}_Wall"


class _Component:
    """A payload layer being written: meshes under Geometry, materials under Materials."""

    def __init__(self, path: Path, name: str, fitout: Fitout) -> None:
        self.fitout = fitout
        self.file = f"./{path.parent.name}/{path.name}"
        """The layer's path as the house writes it."""
        self.extents_m: list[FloatArray] = []
        """(2, 3) world bounds of each mesh."""
        self._layer = new_layer(path, name)
        self._root = Sdf.Path.absoluteRootPath.AppendChild(name)
        define(self._layer, self._root, "Xform", kind="component")
        define(self._layer, self._root.AppendChild("Geometry"), "Scope")
        define(self._layer, self._root.AppendChild("Materials"), "Scope")

    def group(self, name: str) -> Sdf.PrimSpec:
        """An Xform under Geometry."""
        return define(self._layer, self._root.AppendPath(f"Geometry/{name}"), "Xform")

    def mesh(
        self, name: str, faces: Sequence[Face], material: str, frame: _Frame | None = None
    ) -> Sdf.PrimSpec:
        """A mesh under Geometry that wears a material of this component.

        frame: where the groups above it stand, if it is not drawn in the world.
        """
        mesh = mesh_of(faces)
        prim = write_mesh(self._layer, self._root.AppendPath(f"Geometry/{name}"), mesh)
        bind(prim, self._material(material))
        points = frame.in_world(mesh.points_m) if frame else mesh.points_m
        self.extents_m.append(np.array([points.min(axis=0), points.max(axis=0)]))
        return prim

    def block(self, boxes: Sequence[tuple[Box, str]]) -> None:
        """Colliders of what is drawn as sheets, each with what it feels like."""
        scope = define_colliders(self._layer, self._root.AppendChild("Colliders"))
        for index, (box, material) in enumerate(boxes):
            path = scope.path.AppendChild(f"Box_{index}")
            write_collider(self._layer, path, box, self._material(material))

    def guard(self, parent: Sdf.PrimSpec, box: Box, material: str) -> None:
        """The collider of a part that is drawn in bars."""
        path = parent.path.AppendChild("Collider")
        write_collider(self._layer, path, box, self._material(material))

    def hang(
        self, leaf: Sdf.PrimSpec, hinge_m: PointM, drawn: Leaf | Sash, side: int, material: str
    ) -> None:
        """Let a leaf swing towards +y of its opening where side is 1, towards -y where it is -1."""
        turn_deg = DOOR_OPENS_DEG * (-side if drawn.hung_right else side)
        limits_deg = (min(turn_deg, 0.0), max(turn_deg, 0.0))
        own = self._material(material)
        if isinstance(drawn, Sash):
            box, kg_per_m2 = drawn.box, SASH_KG_PER_M2
        else:
            box, kg_per_m2 = leaf_box(drawn), DOOR_KG_PER_M2
        hang_leaf(self._layer, leaf, hinge_m, box, limits_deg, own, kg_per_m2)

    def _material(self, name: str) -> Sdf.Path:
        path = self._root.AppendPath(f"Materials/{name}")
        if not self._layer.GetPrimAtPath(path):
            if name in self.fitout.surfaces:
                write_surface(self._layer, path, self.fitout.surfaces[name])
            else:  # the room's variant sets say what it looks like
                plain = "PlainFloor" if name.endswith(_FLOOR) else "PlainWall"
                write_feel(define(self._layer, path, "Material"), FEEL_OF_SURFACE[plain])
        return path

    def reserve(self, material: str) -> None:
        """A material that the room's variants write, though nothing here wears it."""
        self._material(material)

    def save(self) -> None:
        """Write the layer's file."""
        self._layer.Save()


@dataclass(frozen=True, eq=False)
class _Frame:
    """Where an opening, or a leaf in it, stands in the world."""

    yaw_deg: float
    origin_m: tuple[float, float, float]

    def in_world(self, points_m: FloatArray) -> FloatArray:
        """(N, 3) points of this frame in the world."""
        turned = points_m.copy()
        turned[:, :2] = points_m[:, :2] @ rotation_2d(self.yaw_deg).T
        return turned + np.array(self.origin_m)

    def inner(self, origin_m: tuple[float, float, float]) -> _Frame:
        """A frame of the same yaw with its origin at this point of the frame."""
        x, y, z = self.in_world(np.array([origin_m]))[0]
        return _Frame(self.yaw_deg, (float(x), float(y), float(z)))


def _draw_room(
    layer: Sdf.Layer, room: NamedRoom, level: Level, folder: Path, fitout: Fitout
) -> FloatArray:
    walls, rooms = level.walls, level.rooms
    component = _Component(folder / f"{room.name}.usdc", "Architecture", fitout)
    floor = walls.floors_m[room.index]
    lines = walls.lines_of(room.index)
    _draw_floor_and_ceiling(component, room, floor, level)
    for edge in sorted({line.edge for line in lines}):
        faces = wall_faces([line for line in lines if line.edge == edge])
        if faces:
            wall = component.mesh(f"Wall_{edge}", faces, wall_material(room))
            label(wall, "category", "wall")
    shaft = is_shaft(level, room)
    if room.room.kind not in _TILED and not shaft:
        skirting = _skirting(floor, lines, walls.tunnels_near(floor, CASING_M[0]))
        if skirting:
            component.mesh("Skirting", skirting, "Trim")
    for opening in room.openings:
        _draw_opening(component, opening, room, walls, rooms)
    railings = [tunnel for index, tunnel in walls.railings if index == room.index]
    for number, tunnel in enumerate(railings):
        _draw_railing(component, f"Railing_{number}", tunnel, room)
    if shaft:
        _draw_stairs(component, room, level)
    walled = [(box, wall_material(room)) for box in wall_boxes(lines)]
    slabs = [] if room.room.id in level.ways else _slabs(floor, level)
    steps = [box for own in level.rising.get(room.room.id, ()) for box in stair_boxes(own.built)]
    component.block([*((box, floor_material(room)) for box in (*slabs, *steps)), *walled])
    component.save()
    return _refer(layer, f"{room.path}/Architecture", component)


def _draw_floor_and_ceiling(
    component: _Component, room: NamedRoom, floor: Polygon, level: Level
) -> None:
    if room.room.id not in level.ways:
        sheet = component.mesh("Floor", flat(floor, 0.0, up=True), floor_material(room))
        label(sheet, "category", "floor")
    if room.room.id not in level.rising:
        ceiling = component.mesh("Ceiling", flat(floor, ROOM_HEIGHT_M, up=False), "Ceiling")
        label(ceiling, "category", "ceiling")


def _draw_stairs(component: _Component, room: NamedRoom, level: Level) -> None:
    """The stairs up from a room, and the railings around the hole that one comes up through."""
    solid = level.walls.solid_m
    for index, own in enumerate(level.rising.get(room.room.id, ())):
        group = component.group(f"Stair_{index}")
        label(group, "category", "stairs")
        note_stair(group, own)
        for part in stair_parts(own.built, solid):
            material = floor_material(room) if part.surface == "Floor" else part.surface
            component.mesh(f"{group.name}/{part.name}", part.faces, material)
        for number, (line, low_m) in enumerate(open_landing_sides(own.built, solid)):
            _draw_guard(component, f"{group.name}/Guard_{number}", line, low_m)
    ways = level.ways.get(room.room.id)
    if ways is not None:
        component.reserve(floor_material(room))
        for number, line in enumerate(guard_lines(room_polygon(room.room), solid, ways)):
            _draw_guard(component, f"Guard_{number}", line, 0.0)


def _draw_guard(component: _Component, name: str, line: FloatArray, low_m: float) -> None:
    part, collider = guard_part(line)
    group = component.group(name)
    place(group, at_m=(0.0, 0.0, low_m))
    label(group, "category", "railing")
    component.mesh(f"{name}/{part.name}", part.faces, part.surface, _Frame(0.0, (0.0, 0.0, low_m)))
    component.guard(group, collider, part.surface)


def _slabs(floor: Polygon, level: Level) -> list[Box]:
    """The slab of a room, with the holes of its storey left open."""
    slab = _slab(floor)
    under = footprint_polygon(slab)
    holes = [hole for hole in level.holes if hole.intersects(under)]
    if not holes:
        return [slab]
    (x0, y0), (x1, y1) = np.asarray(holes[0].exterior.coords)[:2]
    yaw_deg = float(np.degrees(np.arctan2(y1 - y0, x1 - x0)))
    return list(floor_boxes(slab, holes, yaw_deg))


def _slab(floor: Polygon) -> Box:
    """What carries a room and its thresholds. Everything in a house stands at one height."""
    west, south, east, north = floor.buffer(WALL_THICKNESS_M).bounds
    middle = ((west + east) / 2, (south + north) / 2, -_SLAB_M)
    return Box(middle, (east - west, north - south, _SLAB_M), 0.0)


def _draw_opening(
    component: _Component,
    named: NamedOpening,
    room: NamedRoom,
    walls: Walls,
    rooms: Sequence[NamedRoom],
) -> None:
    opening = named.opening
    tunnel = walls.tunnels.get(opening.id)
    sill_m = tunnel.low_m if tunnel else opening.box.center_m[2]
    frame = _Frame(opening.box.yaw_deg, (*opening.box.center_m[:2], sill_m))
    group = component.group(named.name)
    place(group, at_m=frame.origin_m, yaw_deg=frame.yaw_deg)
    label(group, "category", opening.kind)
    note(group, node_id=opening.id, category=opening.kind, rooms=opening.room_ids)
    note_size(group, opening.box.size_m)
    if tunnel is None:  # rooms that touch have no wall to cut
        return
    indoors = walls.floors_m[room.index].representative_point().coords[0]
    inside = side_of(indoors, tunnel)
    opens = opens_to(tunnel, walls, inside)
    for part in fixed_parts(tunnel, inside=inside, opens=opens):
        _draw_part(component, named.name, part, room, frame)
        if part.name == "Board":  # vases stand on it
            component.guard(group, _around(part.faces), part.surface)
    for index, (hinge_m, leaf) in enumerate(leaves_of(tunnel)):
        drawn = component.group(f"{named.name}/Leaf_{index}")
        place(drawn, at_m=hinge_m, yaw_deg=0.0)
        kind = _leaf_kind(opening, rooms, component.fitout)
        parts = leaf_parts(leaf, kind=kind, opens=opens)
        for part in parts:
            _draw_part(component, f"{named.name}/{drawn.name}", part, room, frame.inner(hinge_m))
        component.hang(drawn, hinge_m, leaf, opens, parts[0].surface)
    for index, sash in enumerate(sashes_in(tunnel, inside)):
        drawn = component.group(f"{named.name}/Sash_{index}")
        place(drawn, at_m=sash.hinge_m, yaw_deg=0.0)
        for part in sash.parts:
            path = f"{named.name}/{drawn.name}"
            _draw_part(component, path, part, room, frame.inner(sash.hinge_m))
        component.hang(drawn, sash.hinge_m, sash, inside, sash.parts[0].surface)


def _around(faces: Sequence[Face]) -> Box:
    """The upright box around faces, in their own frame."""
    points = mesh_of(faces).points_m
    low, high = points.min(axis=0), points.max(axis=0)
    (x, y, _), (length, depth, height) = ((low + high) / 2).tolist(), (high - low).tolist()
    return Box((x, y, float(low[2])), (length, depth, height), 0.0)


def _draw_railing(component: _Component, name: str, tunnel: Tunnel, room: NamedRoom) -> None:
    """A gap in a balcony's wall, with a railing on the kerb."""
    opening = tunnel.opening
    frame = _Frame(opening.box.yaw_deg, (*opening.box.center_m[:2], tunnel.low_m))
    group = component.group(name)
    place(group, at_m=frame.origin_m, yaw_deg=frame.yaw_deg)
    label(group, "category", "railing")
    for part in railing_parts(tunnel):
        _draw_part(component, name, part, room, frame)
    component.guard(group, railing_guard(tunnel), "Metal")


def opens_to(tunnel: Tunnel, walls: Walls, inside: int) -> int:
    """The side a door's leaves swing to: where more floor is free, else into its own room.

    1 is towards the opening's own +y, -1 towards its -y.
    """
    box = tunnel.opening.box
    reach_m = WALL_THICKNESS_M / 2 + box.size_m[0]
    shares = {}
    for side in (inside, -inside):
        middle = np.array(box.center_m[:2]) + rotation_2d(box.yaw_deg)[:, 1] * side * reach_m / 2
        swept = Box((middle[0], middle[1], 0.0), (box.size_m[0], reach_m, 1.0), box.yaw_deg)
        shape = footprint_polygon(swept)
        floors = unary_union(walls.floors_near(shape))
        shares[side] = round(shape.intersection(floors).area, 2)
    return max(shares, key=lambda side: shares[side])


def _draw_part(
    component: _Component, parent: str, part: Part, room: NamedRoom, frame: _Frame
) -> None:
    looks = {"Wall": wall_material(room), "Floor": floor_material(room)}
    material = looks.get(part.surface, part.surface)
    component.mesh(f"{parent}/{part.name}", part.faces, material, frame)


def _leaf_kind(opening: Opening, rooms: Sequence[NamedRoom], fitout: Fitout) -> LeafKind:
    """Doors to balconies are glass doors, and so are wide ones that lead outside."""
    kinds = {named.room.kind for named in rooms if named.room.id in opening.room_ids}
    leads_out = len(opening.room_ids) < 2
    if "balcony" in kinds or (leads_out and opening.box.size_m[0] >= _GLASS_DOOR_FROM_M):
        return "glass"
    return "entrance" if leads_out else fitout.doors


def _skirting(floor: Polygon, lines: Iterable[WallLine], tunnels: Iterable[Tunnel]) -> list[Face]:
    """A board along the foot of every wall, left out at doors and where there is no wall."""
    depth, height = _SKIRTING_M
    ring = floor.difference(floor.buffer(-depth, join_style="mitre"))
    backed = [
        LineString(stretch).buffer(2 * depth, cap_style="square")
        for line in lines
        for stretch in free_stretches(line, below_m=height)
    ]
    frames = [
        footprint_polygon(tunnel.opening.box).buffer(CASING_M[0], join_style="mitre")
        for tunnel in tunnels
        if tunnel.low_m < height and tunnel.area_m.distance(floor) < CASING_M[0]
    ]
    boards = ring.intersection(unary_union(backed)).difference(unary_union(frames))
    boards = boards.simplify(_SKIRTING_M[0] / 40)
    faces: list[Face] = []
    for board in map(orient, polygons_of(boards)):
        faces += flat(board, height, up=True) + _fronts(board, floor, height)
    return faces


def _fronts(board: Polygon, floor: Polygon, height: float) -> list[Face]:
    """The sides of a board that do not lie against the wall."""
    faces = []
    for ring in (board.exterior, *board.interiors):
        corners = np.asarray(ring.coords)
        middles = shapely.points((corners[:-1] + corners[1:]) / 2)
        exposed = shapely.distance(middles, floor.exterior) > _SKIRTING_M[0] / 4
        for start, end, shown in zip(corners[:-1], corners[1:], exposed, strict=True):
            if shown:
                faces.append(upright(start, end, 0.0, height))
    return faces


def _draw_exterior(
    layer: Sdf.Layer, level: Level, above: Level | None, folder: Path, fitout: Fitout
) -> FloatArray:
    """Facade and wall tops: daylight comes in through windows only, cut walls look solid."""
    walls, name = level.walls, level.group or "Exterior"
    component = _Component(folder / f"{name}.usdc", name, fitout)
    facade = wall_faces(walls.lines_of(None))
    if facade:
        component.mesh("Facade", facade, "Facade")
        component.mesh("WallTop", top_faces(walls), "WallTop")
    if above:
        outside, inside = slab_faces(walls, above.walls, above.holes)
        component.mesh("FacadeSlab", outside, "Facade")
        if inside:
            component.mesh("SlabHole", inside, "Ceiling")
    component.save()
    if not level.group:
        return _refer(layer, "/House/Exterior", component)
    path = f"/House/Exterior/{name}"
    extent = _refer(layer, path, component)
    place(layer.GetPrimAtPath(path), at_m=(0.0, 0.0, level.elevation_m))
    return extent


def _refer(layer: Sdf.Layer, path: str, component: _Component) -> FloatArray:
    """The component's interface in the house: kind, bounds, payload. Returns the bounds."""
    prim = define(layer, path, "Xform", kind="component")
    identify(prim, prim.name, component.file)
    inherit(prim, define_class(layer, prim.name))
    prim.payloadList.prependedItems.append(Sdf.Payload(component.file))
    extents = np.array(component.extents_m)
    extent = np.array([extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)])
    hint_extent(prim, extent)
    return extent
