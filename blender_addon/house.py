"""The house as it stands in the scene: its rooms and pieces, and what was changed in it."""

from __future__ import annotations

import json
from collections.abc import Iterable

import bpy

from .core.edits import Changes, Matrix, moves, told, understood
from .core.tree import is_light, is_piece, is_placed, room_of
from .properties import PATH_KEY, chosen_room, fields

PLACED_KEY = "chord_usd_placed"
"""Custom property of the house's collection: where the house itself has its pieces, as JSON.

A removed object remembers nothing. Custom properties have short names: a dictionary by path of its
own would not do."""

CHANGES_KEY = "chord_usd_changes"
"""Custom property of the house's collection: the changes it came in with, as JSON."""

LOCKED_KEY = "chord_usd_locked"
"""Custom property of pieces that stay when their room is furnished anew."""

LAMP_KEY = "chord_usd_lamp"
"""Custom property of lamps: the brightness that the house itself has them at."""

LEAST_LIGHT = 1e-3
"""Share of its brightness that a lamp keeps that was put out; an exposure has no zero."""

CATEGORY_KEY, SIZE_KEY = "chord:category", "chord:size_m"
"""Custom properties that the importer gives pieces: attributes of the stage."""

Objects = dict[str, bpy.types.Object]


def house_collection(context: bpy.types.Context) -> bpy.types.Collection | None:
    """The house of this scene."""
    for collection in context.scene.collection.children:
        if PLACED_KEY in collection:
            return collection
    return None


def room_collection(context: bpy.types.Context, room: str) -> bpy.types.Collection | None:
    """The collection of a room of the house at hand."""
    house = house_collection(context)
    for collection in house.children if house else ():
        if collection.get(PATH_KEY) == room:
            return collection
    return None


def own_objects(context: bpy.types.Context) -> Objects:
    """The house's objects by USD path. Of copies that an artist made, only the first counts."""
    found: Objects = {}
    for item in sorted(context.scene.objects, key=lambda one: one.name):
        if PATH_KEY in item:
            found.setdefault(str(item[PATH_KEY]), item)
    return found


def objects_at(context: bpy.types.Context, paths: Iterable[str]) -> list[bpy.types.Object]:
    """The objects at these USD paths and below them."""
    wanted = tuple(paths)
    return [
        item
        for path, item in own_objects(context).items()
        if any(path == one or path.startswith(f"{one}/") for one in wanted)
    ]


def pieces_of(context: bpy.types.Context, room: str) -> Objects:
    """The furniture of a room by USD path, in the order of their names."""
    found = own_objects(context)
    return {path: found[path] for path in sorted(found) if is_piece(path) and room_of(path) == room}


def component(objects: Objects, piece: str) -> str:
    """Path of what refers to a piece's model: itself, or the one part of its group that does."""
    for path in (piece, *(p for p in objects if p.rpartition("/")[0] == piece)):
        if path in objects and CATEGORY_KEY in objects[path]:
            return path
    return piece


def matrix_of(item: bpy.types.Object) -> Matrix:
    """An object's placement in its parent."""
    return tuple(tuple(row) for row in item.matrix_local)


def placements(objects: Objects) -> dict[str, Matrix]:
    """Where everything stands that can be moved."""
    return {path: matrix_of(item) for path, item in objects.items() if is_placed(path)}


def remember(house: bpy.types.Collection, was: dict[str, Matrix], changes: Changes) -> None:
    """Keep with the house how it was, so that undo undoes that, too."""
    house[PLACED_KEY] = json.dumps(was)
    house[CHANGES_KEY] = json.dumps(told(changes))


def house_placements(context: bpy.types.Context) -> dict[str, Matrix]:
    """Where the house itself has its pieces."""
    house = house_collection(context)
    placed = json.loads(house[PLACED_KEY]) if house else {}
    return {path: tuple(map(tuple, rows)) for path, rows in placed.items()}


def changes_of(context: bpy.types.Context) -> Changes:
    """What is changed in the house of this scene, against the house itself."""
    house = house_collection(context)
    if house is None:
        return Changes()
    came_with = understood(json.loads(house[CHANGES_KEY]))
    context.view_layer.update()
    objects = own_objects(context)
    return Changes(
        pieces=moves(house_placements(context), placements(objects), came_with.swaps),
        looks=came_with.looks,
        lights={p: s for p, s in _strengths(objects).items() if abs(s - 1.0) > LEAST_LIGHT},
        locked=tuple(sorted(path for path, item in objects.items() if item.get(LOCKED_KEY))),
    )


def remember_lamps(objects: Objects, changes: Changes) -> None:
    """Keep with each lamp how bright the house itself has it."""
    for path, item in objects.items():
        if is_light(path) and item.type == "LIGHT":
            item[LAMP_KEY] = _brightness(item) / changes.lights.get(path, 1.0)


def set_light(context: bpy.types.Context, room: str, strength: float) -> None:
    """Let the lamps of a room burn so much brighter than the house has them."""
    for path, item in own_objects(context).items():
        if room_of(path) == room and LAMP_KEY in item:
            item.data.energy *= strength * item[LAMP_KEY] / max(_brightness(item), LEAST_LIGHT)


def light_of(objects: Objects, room: str) -> float:
    """How much brighter the lamps of a room burn."""
    return next((s for path, s in _strengths(objects).items() if room_of(path) == room), 1.0)


def show_rooms(context: bpy.types.Context) -> None:
    """Show the chosen room alone, or all of them, as the field says."""
    house = house_collection(context)
    if house is None:
        return
    chosen = chosen_room(context) if fields(context).solo else ""
    layers = context.view_layer.layer_collection.children[house.name].children
    for layer in layers:
        name = layer.collection.get(PATH_KEY, "")
        layer.hide_viewport = bool(chosen) and name != chosen


def select(context: bpy.types.Context, items: Iterable[bpy.types.Object]) -> None:
    """Select these objects alone, and look at them where there is a 3-D view."""
    for other in context.selected_objects:
        other.select_set(False)
    visible = [item for item in items if item.visible_get()]
    for item in visible:
        item.select_set(True)
    if visible:
        context.view_layer.objects.active = visible[0]
    for area in context.screen.areas if context.screen else ():
        if area.type == "VIEW_3D":
            region = next(region for region in area.regions if region.type == "WINDOW")
            with context.temp_override(area=area, region=region):
                bpy.ops.view3d.view_selected()


def _strengths(objects: Objects) -> dict[str, float]:
    """How much brighter each lamp burns than the house has it, by path."""
    return {
        path: max(_brightness(item) / item[LAMP_KEY], LEAST_LIGHT)
        for path, item in objects.items()
        if item.get(LAMP_KEY)
    }


def _brightness(lamp: bpy.types.Object) -> float:
    """Power as it comes out; Blender 4.2 has no exposure of lamps, its importer none to keep."""
    return float(lamp.data.energy * 2 ** getattr(lamp.data, "exposure", 0.0))
