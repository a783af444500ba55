"""Floors, walls, ceilings, doors and windows: one component per room, one for the outside.

The meshes of a component lie in a layer of their own behind a payload, so that a house opens
without them. Every face exists once (see walls.py): a room owns the faces that look into it and
the doors and windows named after it; the facade and the tops of the walls are the Exterior.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import shapely
from pxr import Sdf
from shapely.geometry import LineString, Polygon
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import footprint_polygon, polygons_of
from chord_usd.base.scene.trim import CASING_M
from chord_usd.base.scene.tunnels import Tunnel
from chord_usd.base.scene.types import (
    ROOM_HEIGHT_M,
    WALL_THICKNESS_M,
    WET_KINDS,
    Box,
    FloatArray,
    Opening,
)
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.author.names import NamedOpening, NamedRoom
from chord_usd.line.stage.author.prims import (
    label,
    note,
    note_size,
    place,
)
from chord_usd.line.stage.author.stage_levels import Level, is_shaft
from chord_usd.line.stage.author.surfaces import Fitout, floor_material, wall_material
from chord_usd.line.stage.shell.door_leaves import LeafKind, leaf_parts
from chord_usd.line.stage.shell.mesh import Face, flat, mesh_of, upright
from chord_usd.line.stage.shell.opening_parts import (
    fixed_parts,
    leaves_of,
    railing_guard,
    railing_parts,
    sashes_in,
    side_of,
)
from chord_usd.line.stage.shell.opening_shapes import Part
from chord_usd.line.stage.shell.shell_layers import Frame, ShellComponent, refer
from chord_usd.line.stage.shell.slabs import SEAM_M, SLAB_M, slab_faces
from chord_usd.line.stage.shell.walls import (
    WallLine,
    Walls,
    free_stretches,
    top_faces,
    wall_boxes,
    wall_faces,
)

_SKIRTING_M = (0.004, 0.07)
"""Depth and height. Thin, so that furniture set against the wall does not collide with it."""

_TILED = (*WET_KINDS, "balcony")
"""Kinds of rooms without skirting boards."""

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
        extents.append(_draw_room(layer, room, level, above, folder, fitout))
    extents.append(_draw_exterior(layer, level, above, folder, fitout))
    bounds = np.array(extents)
    return np.array([bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)])


def _draw_room(
    layer: Sdf.Layer, room: NamedRoom, level: Level, above: Level | None, folder: Path,
    fitout: Fitout,
) -> FloatArray:  # fmt: skip
    walls, rooms = level.walls, level.rooms
    component = ShellComponent(folder / f"{room.name}.usdc", "Architecture", fitout, room.name)
    floor = walls.floors_m[room.index]
    lines = walls.lines_of(room.index)
    _draw_floor_and_ceiling(component, room, floor, level, above)
    for edge in sorted({line.edge for line in lines}):
        faces = wall_faces([line for line in lines if line.edge == edge])
        component.mesh(f"Wall_{edge}", faces, wall_material(room), category="wall")
    shaft = is_shaft(level, room)
    if room.room.kind not in _TILED and not shaft:
        skirting = _skirting(floor, lines, walls.tunnels_near(floor, CASING_M[0]))
        component.mesh("Skirting", skirting, "Trim")
    for opening in room.openings:
        _draw_opening(component, opening, room, walls, rooms)
    railings = [tunnel for index, tunnel in walls.railings if index == room.index]
    for number, tunnel in enumerate(railings):
        _draw_railing(component, f"Railing_{number}_{room.name}", tunnel, room)
    holes = level.holes if room.room.id in level.ways else ()
    steps: list[Box] = []
    hulls: list[Sequence[Face]] = []
    if shaft:
        from chord_usd.line.stage.shell.author_stairs import draw_stairs, stair_colliders

        draw_stairs(component, room, level)
        steps, hulls = stair_colliders(room, level, floor, holes)
    walled = [(box, wall_material(room)) for box in wall_boxes(lines)]
    slabs = [slab for part in _less(floor, holes) for slab in _slabs(part, level)]
    turns = [(hull, floor_material(room)) for hull in hulls]
    component.block([*((box, floor_material(room)) for box in (*slabs, *steps)), *walled], turns)
    component.save()
    return refer(layer, f"{room.path}/Architecture", component)


def _draw_floor_and_ceiling(
    component: ShellComponent, room: NamedRoom, floor: Polygon, level: Level, above: Level | None
) -> None:
    """Both less the holes that stairs go through."""
    holes = level.holes if room.room.id in level.ways else ()
    faces = [face for part in _less(floor, holes) for face in flat(part, 0.0, up=True)]
    component.mesh("Floor", faces, floor_material(room), category="floor")
    holes = above.holes if above and room.room.id in level.rising else ()
    faces = [face for part in _less(floor, holes) for face in flat(part, ROOM_HEIGHT_M, up=False)]
    component.mesh("Ceiling", faces, "Ceiling", category="ceiling")


def _less(floor: Polygon, holes: Sequence[Polygon]) -> list[Polygon]:
    """What is left of a floor around holes; strips too narrow to see are left out."""
    if not any(hole.intersects(floor) for hole in holes):
        return [floor]
    left = floor.difference(unary_union(list(holes)).buffer(SEAM_M, join_style="mitre"))
    seen = left.buffer(-SEAM_M).buffer(2 * SEAM_M, join_style="mitre").intersection(
        floor.difference(unary_union(list(holes)))
    )  # fmt: skip
    return [part for part in polygons_of(seen) if part.area > SEAM_M]


def _slabs(floor: Polygon, level: Level) -> list[Box]:
    """The slab of a room, with the holes of its storey left open."""
    slab = _slab(floor)
    holes = [hole for hole in level.holes if hole.intersects(footprint_polygon(slab))]
    if not holes:
        return [slab]
    from chord_usd.line.stage.shell.author_stairs import holed_slabs

    return holed_slabs(slab, holes)


def _slab(floor: Polygon) -> Box:
    """What carries a room and its thresholds. Everything in a house stands at one height."""
    west, south, east, north = floor.buffer(WALL_THICKNESS_M).bounds
    middle = ((west + east) / 2, (south + north) / 2, -SLAB_M)
    return Box(middle, (east - west, north - south, SLAB_M), 0.0)


def _draw_opening(
    component: ShellComponent,
    named: NamedOpening,
    room: NamedRoom,
    walls: Walls,
    rooms: Sequence[NamedRoom],
) -> None:
    opening = named.opening
    tunnel = walls.tunnels.get(opening.id)
    sill_m = tunnel.low_m if tunnel else opening.box.center_m[2]
    frame = Frame(opening.box.yaw_deg, (*opening.box.center_m[:2], sill_m))
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
            component.guard(group, [_around(part.faces)], part.surface)
    for index, (hinge_m, leaf) in enumerate(leaves_of(tunnel)):
        drawn = component.group(f"{named.name}/Leaf_{index}_{named.name}")
        place(drawn, at_m=hinge_m, yaw_deg=0.0)
        kind = _leaf_kind(opening, rooms, component.fitout)
        parts = leaf_parts(leaf, kind=kind, opens=opens)
        for part in parts:
            _draw_part(component, f"{named.name}/{drawn.name}", part, room, frame.inner(hinge_m))
        component.hang(drawn, hinge_m, leaf, opens, parts[0].surface)
    for index, sash in enumerate(sashes_in(tunnel, inside)):
        drawn = component.group(f"{named.name}/Sash_{index}_{named.name}")
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


def _draw_railing(component: ShellComponent, name: str, tunnel: Tunnel, room: NamedRoom) -> None:
    """A gap in a balcony's wall, with a railing on the kerb."""
    opening = tunnel.opening
    frame = Frame(opening.box.yaw_deg, (*opening.box.center_m[:2], tunnel.low_m))
    group = component.group(name)
    place(group, at_m=frame.origin_m, yaw_deg=frame.yaw_deg)
    label(group, "category", "railing")
    for part in railing_parts(tunnel):
        _draw_part(component, name, part, room, frame)
    component.guard(group, [railing_guard(tunnel)], "Metal")


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
    component: ShellComponent, parent: str, part: Part, room: NamedRoom, frame: Frame
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
    component = ShellComponent(folder / f"{name}.usdc", name, fitout, level.group)
    facade = wall_faces(walls.lines_of(None))
    component.mesh("Facade", facade, "Facade")
    if facade:
        component.mesh("WallTop", top_faces(walls), "WallTop")
    if above:
        outside, inside = slab_faces(walls, above.walls, above.holes)
        component.mesh("FacadeSlab", outside, "Facade")
        component.mesh("SlabHole", inside, "Ceiling")
    component.save()
    if not level.group:
        return refer(layer, "/House/Exterior", component)
    path = f"/House/Exterior/{name}"
    extent = refer(layer, path, component)
    place(layer.GetPrimAtPath(path), at_m=(0.0, 0.0, level.elevation_m))
    return extent
