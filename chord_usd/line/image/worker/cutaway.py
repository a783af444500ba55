"""Houses cut open: walls and tall furniture cut at a height for a view of all rooms, as a model on
a table; one room alone on a turntable."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import bmesh
import bpy
import mapbox_earcut
import numpy as np
import shapely
from mathutils import Vector
from shapely.geometry import LineString, Polygon
from shapely.ops import polygonize, unary_union

from chord_usd.base.scene.palette import CATEGORIES, Mount
from chord_usd.line.image.stage_cameras import StageCamera
from chord_usd.line.image.worker.data import NUMBER_MARK
from chord_usd.line.image.worker.lamps import room_of
from chord_usd.line.image.worker.scene import is_of_roof

_BUILDING = ("Architecture", "Exterior")
_SHEETS = ("Wall", "Facade", "Lining")
"""Names of the sheets that bound the walls start so."""

_CAP_FROM = "WallTop"
_LID = "CutTop"
_LID_ALBEDO = 0.85
_BASE = "ModelBase"
_BASE_ALBEDO, _BASE_BELOW_M, _BASE_REACH_M = 0.8, 0.02, 200.0
"""Of the surface under the model, which shows its shadow alone and lights its facades."""
_CATEGORY, _NODE, _RESTS_ON = "chord:category", "chord:node_id", "chord:rests_on"
_OPENINGS = ("door", "window", "passage")
_HUNG = (Mount.WALL, Mount.WINDOW, Mount.CEILING)
_GRID_M = 1e-4
_BELOW_M = 0.7e-3
"""A cut is so much lower: sills and heads lie at round heights, and the sides of
corners are unknown where a plane runs through them."""
_NEAR_WALL_M = 0.3
_OVER_M = 0.15
"""Things are cut that are so much higher than the walls."""

_NEXT_FLOOR_M = 1.5
"""A cut is no lower than this under the floor above: what stands higher is of another storey."""


def cut_open(height_m: float) -> None:
    """Cut the building at a height, close the cut walls, and take away the roof, what hung above,
    and what stands on the storeys above.

    For good: views that come later see it so.
    """
    height_m -= _BELOW_M
    sheets: list[LineString] = []
    tops: list[Polygon] = []
    number = 0
    for thing in bpy.data.objects:  # higher cuts came before
        if _plain_name(thing) == _LID or is_of_roof(thing):
            thing.hide_render = True
    for thing in [obj for obj in bpy.data.objects if obj.type == "MESH" and _is_building(obj)]:
        name = _plain_name(thing)
        if name.startswith(_CAP_FROM):
            tops += _seen_from_above(thing, height_m)
            number = thing.data.get(NUMBER_MARK, number)
        elif name.startswith(_SHEETS):
            sheets += _section(thing, height_m)
        if name.startswith("Ceiling") or not _cut(thing, height_m):
            thing.hide_render = True
    _close(sheets, unary_union(tops), height_m, number)
    _cut_things(height_m)


def set_on_base(scene: Any, shown: bool) -> None:
    """Put the house on a surface that catches its shadow, in a scene with a transparent film."""
    base = scene.objects.get(_BASE)
    if base is None and shown:
        low_m = min(
            ((obj.matrix_world @ Vector(corner)).z for obj in scene.objects if _is_wall(obj)
             for corner in obj.bound_box), default=0.0,
        )  # fmt: skip
        reach, height_m = _BASE_REACH_M, low_m - _BASE_BELOW_M
        corners = [(-reach, -reach), (reach, -reach), (reach, reach), (-reach, reach)]
        mesh = bpy.data.meshes.new(_BASE)
        mesh.from_pydata([(x, y, height_m) for x, y in corners], [], [(0, 1, 2, 3)])
        mesh.materials.append(_matte(_BASE, _BASE_ALBEDO))
        base = bpy.data.objects.new(_BASE, mesh)
        base.is_shadow_catcher = True
        scene.collection.objects.link(base)
    if base is not None:
        base.hide_render = not shown


def show_alone(view: StageCamera, rooms: tuple[str, ...]) -> None:
    """Show one room, without what stands between it and the camera; everything for a usual view."""
    eye = Vector([row[3] for row in view.matrix[:3]])
    for thing in bpy.data.objects:
        owner = room_of(thing, rooms)
        if thing.type != "LIGHT" and (owner or _is_building(thing)):
            thing.hide_render = view.is_alone and owner != view.room
    if not view.is_alone:
        return
    walls = [t for t in bpy.data.objects if _is_wall(t) and room_of(t, rooms) == view.room]
    planes = [_plane(wall) for wall in walls]
    away = [(eye - middle).dot(normal) < 0.0 for middle, normal in planes]
    hidden: dict[str, bool] = {}
    for wall, is_away in zip(walls, away, strict=True):
        wall.visible_camera = not is_away
    for thing in _dressed():
        mine = room_of(thing, rooms) == view.room
        hung = _mount(thing) in _HUNG or thing.get(_CATEGORY) in _OPENINGS
        if not hung:
            continue
        at = [_gap_m(thing, wall, plane) for wall, plane in zip(walls, planes, strict=True)]
        nearest = min(range(len(at)), key=at.__getitem__, default=-1)
        touches = nearest >= 0 and at[nearest] < _NEAR_WALL_M
        is_ceiling = _mount(thing) is Mount.CEILING
        shown = (touches and not away[nearest]) or (mine and is_ceiling)
        if mine or touches:
            _hide(thing, not shown)
            hidden[thing.get(_NODE)] = not shown
    _hide_resting(hidden)


# --- what belongs to what -----------------------------------------------------------------------


def _above(thing: Any) -> Iterator[Any]:
    while thing is not None:
        yield thing
        thing = thing.parent


def _plain_name(thing: Any) -> str:
    """Blender numbers what has one name, behind a dot."""
    return str(thing.name).split(".")[0]


def _is_building(thing: Any) -> bool:
    return any(_plain_name(obj) in _BUILDING for obj in _above(thing))


def _is_wall(thing: Any) -> bool:
    return thing.type == "MESH" and _plain_name(thing).startswith("Wall_") and _is_building(thing)


def _dressed() -> list[Any]:
    return [thing for thing in bpy.data.objects if _CATEGORY in thing]


def _mount(thing: Any) -> Mount | None:
    row = CATEGORIES.get(str(thing.get(_CATEGORY)))
    return row.mount if row else None


def _top_m(thing: Any) -> float:
    size = thing.get("chord:size_m")
    return float(thing.matrix_world.translation.z) + (float(size[2]) if size else 0.0)


def _hide(thing: Any, hidden: bool = True) -> None:
    thing.hide_render = hidden
    for below in thing.children_recursive:
        below.hide_render = hidden


def _hide_resting(hidden: Mapping[str, bool]) -> None:
    """Hide, or show, what lies on things as these are, by their ids."""
    for thing in _dressed():
        carrier = thing.get(_RESTS_ON, "")  # things of others have no ids
        if carrier in hidden:
            _hide(thing, hidden[carrier])


def _plane(wall: Any) -> tuple[Vector, Vector]:
    """Middle and mean normal of a wall, in the world."""
    mesh, matrix = wall.data, wall.matrix_world
    normal = sum((face.normal * face.area for face in mesh.polygons), Vector())
    middle = sum((face.center * face.area for face in mesh.polygons), Vector())
    middle = matrix @ (middle / max(sum(face.area for face in mesh.polygons), 1e-9))
    return middle, (matrix.to_3x3() @ normal).normalized()


def _gap_m(thing: Any, wall: Any, plane: tuple[Vector, Vector]) -> float:
    """How far a thing's origin is from a wall."""
    middle, normal = plane
    place = thing.matrix_world.translation
    off = abs((place - middle).dot(normal))
    along = normal.cross(Vector((0.0, 0.0, 1.0)))
    corners = [(wall.matrix_world @ Vector(corner)).dot(along) for corner in wall.bound_box]
    beside = max(min(corners) - place.dot(along), place.dot(along) - max(corners), 0.0)
    return float(off + beside)


# --- cutting ------------------------------------------------------------------------------------


def _cut_things(height_m: float) -> None:
    """Cut furniture and doors that stand higher, and hide what hung or lay there."""
    hidden: dict[str, bool] = {}
    tall = []
    for thing in _dressed():
        hung = _mount(thing) in _HUNG and _top_m(thing) > height_m
        if hung or thing.matrix_world.translation.z > height_m + _NEXT_FLOOR_M:
            _hide(thing)
            hidden[thing.get(_NODE)] = True
        elif _top_m(thing) > height_m + _OVER_M and not thing.hide_render:
            tall.append(thing)
    _hide_resting(hidden)
    parts = _instanced_parts(tall)
    for thing in tall:
        below = [part for part in (thing, *thing.children_recursive) if part.type == "MESH"]
        for part in below:
            part.data = part.data.copy()  # other pieces of its model may share it
        for part in below + [_placed(thing, *placed) for placed in parts.get(thing.name, ())]:
            part.hide_render = not _cut(part, height_m, closes=True)
        if thing.name in parts:
            thing.hide_render = True
    cut = {thing.get(_NODE) for thing in tall}
    for thing in _dressed():
        if thing.get(_RESTS_ON) in cut and thing.matrix_world.translation.z > height_m:
            _hide(thing)


def _instanced_parts(things: Iterable[Any]) -> dict[str, list[tuple[Any, Any]]]:
    """Meshes of things that are instances of a collection, with their places in the world."""
    names = {thing.name for thing in things}
    parts: dict[str, list[tuple[Any, Any]]] = {}
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        if (
            instance.is_instance
            and instance.object.type == "MESH"
            and instance.parent.name in names
        ):
            mesh = bpy.data.meshes.new_from_object(instance.object)
            parts.setdefault(instance.parent.name, []).append((mesh, instance.matrix_world.copy()))
    return parts


def _placed(thing: Any, mesh: Any, place: Any) -> Any:
    """An object in place of a part of an instance, with the notes of the thing."""
    mesh.transform(thing.matrix_world.inverted() @ place)
    part = bpy.data.objects.new(thing.name, mesh)
    part.matrix_world = thing.matrix_world
    for key in thing.keys():  # noqa: SIM118 (no mapping)
        part[key] = thing[key]
    for scene in bpy.data.scenes:
        scene.collection.objects.link(part)
    return part


def _cut(thing: Any, height_m: float, *, closes: bool = False) -> bool:
    """Take away what of a mesh is higher; whether anything is left. closes: with lids."""
    edited = bmesh.new()
    edited.from_mesh(thing.data)
    edited.transform(thing.matrix_world)
    made = bmesh.ops.bisect_plane(
        edited,
        geom=[*edited.verts, *edited.edges, *edited.faces],
        plane_co=(0.0, 0.0, height_m),
        plane_no=(0.0, 0.0, 1.0),
        clear_outer=True,
    )
    if closes:
        rim = [edge for edge in made["geom_cut"] if isinstance(edge, bmesh.types.BMEdge)]
        bmesh.ops.holes_fill(edited, edges=rim, sides=0)
    edited.transform(thing.matrix_world.inverted())
    edited.to_mesh(thing.data)
    left = bool(edited.faces)
    edited.free()
    return left


def _triangles_m(thing: Any) -> np.ndarray:
    """(T, 3, 3) triangles of a mesh in the world."""
    mesh = thing.data
    mesh.calc_loop_triangles()
    if not mesh.loop_triangles:  # an earlier cut has taken all of it
        return np.zeros((0, 3, 3))
    points = np.array([thing.matrix_world @ vertex.co for vertex in mesh.vertices])
    corners = np.array([triangle.vertices[:] for triangle in mesh.loop_triangles], dtype=np.int64)
    return points[corners.reshape(-1, 3)]


def _seen_from_above(thing: Any, height_m: float) -> list[Polygon]:
    """The triangles of the storey that is cut."""
    triangles = _triangles_m(thing)
    over = triangles[:, :, 2].min(axis=1) - height_m
    shapes = shapely.polygons(triangles[(over > 0.0) & (over < _NEXT_FLOOR_M + 0.2)][:, :, :2])
    return list(shapes[shapely.area(shapes) > 0.0])


def _section(thing: Any, height_m: float) -> list[LineString]:
    """Where the triangles of a mesh cross a height."""
    lines = []
    for triangle in _triangles_m(thing):
        over = triangle[:, 2] > height_m
        if over.all() or not over.any():
            continue
        ends = [
            a[:2] + (height_m - a[2]) / (b[2] - a[2]) * (b[:2] - a[:2])
            for a, b in zip(triangle, np.roll(triangle, -1, axis=0), strict=True)
            if (a[2] > height_m) != (b[2] > height_m)
        ]
        lines.append(LineString(ends))
    return lines


def _close(sheets: list[LineString], tops: Any, height_m: float, number: int) -> None:
    """Lids on the cut walls: what the sheets enclose and wall tops lie over.

    number: of the thing that the lids show in masks.
    """
    if not sheets:
        return
    lines = unary_union(shapely.set_precision(np.array(sheets), _GRID_M))
    # By area: a point may lie on the seam between two triangles of a top.
    solid = [p for p in polygonize(lines) if p.intersection(tops).area > p.area / 2]
    edited = bmesh.new()
    for part in solid:
        rings = [np.asarray(ring.coords)[:-1] for ring in (part.exterior, *part.interiors)]
        verts = [edited.verts.new((x, y, height_m)) for ring in rings for x, y in ring]
        ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
        cut = mapbox_earcut.triangulate_float64(np.concatenate(rings), ends)
        for corners in cut.reshape(-1, 3):
            edited.faces.new([verts[corner] for corner in corners])
    bmesh.ops.recalc_face_normals(edited, faces=edited.faces)
    mesh = bpy.data.meshes.new(_LID)
    edited.to_mesh(mesh)
    edited.free()
    mesh.materials.append(_matte(_LID, _LID_ALBEDO))
    mesh[NUMBER_MARK] = number
    lid = bpy.data.objects.new(_LID, mesh)
    for scene in bpy.data.scenes:  # that of depth and masks, too
        scene.collection.objects.link(lid)


def _matte(name: str, albedo: float) -> Any:
    """A grey matte material."""
    material = bpy.data.materials.get(name)
    if material is None:
        material = bpy.data.materials.new(name)
        shader = material.node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = (albedo, albedo, albedo, 1.0)
        shader.inputs["Roughness"].default_value = 1.0
        shader.inputs["Specular IOR Level"].default_value = 0.0
    return material
