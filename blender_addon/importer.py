"""A stage as a collection tree: house > rooms > furniture, with its lights, cameras and sky."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy

from .core.edits import Matrix, opened_file
from .core.tree import Branch, collection_tree, is_piece, room_names, usd_paths
from .properties import PATH_KEY, fields, show_ceilings

WORLD = "CHOrD sky"

PLACED_KEY = "chord_usd_placed"
"""Custom property of pieces, and of the house for all of them: the placement they came in with."""

PROTOTYPES = "prototypes"
"""The importer's collection of what is instanced, left out of the view layer."""


def import_house(context: bpy.types.Context, house: Path) -> list[str]:
    """Import the stage in place of the house that was there; returns the rooms' names.

    Changes that were saved for it come in with it.
    """
    remove_house(context)
    if context.scene.world is None:  # without one, the importer drops the stage's sky
        context.scene.world = bpy.data.worlds.get(WORLD) or bpy.data.worlds.new(WORLD)
    before = set(bpy.data.objects)
    bpy.ops.wm.usd_import(filepath=str(opened_file(house)), support_scene_instancing=True)
    _own_prototypes(context)
    linked = {item for item in context.scene.collection.objects if item not in before}
    paths = usd_paths({item.name: item.parent.name if item.parent else None for item in linked})
    for item in linked:
        item[PATH_KEY] = paths[item.name]
        if is_piece(paths[item.name]):
            item[PLACED_KEY] = [x for row in item.matrix_local for x in row]
    ordered = dict(sorted(paths.items(), key=lambda pair: pair[1]))
    tree = collection_tree(ordered)
    root = _collection(tree)
    context.scene.collection.children.link(root)
    root[PLACED_KEY] = {paths[o.name]: o[PLACED_KEY] for o in linked if PLACED_KEY in o}
    for item in linked:
        context.scene.collection.objects.unlink(item)
    _choose_camera(context, linked)
    show_ceilings(context)
    return room_names(ordered.values())


def remove_house(context: bpy.types.Context) -> None:
    """Take the house of this scene out of the file, and what only it used."""
    for collection in list(context.scene.collection.children):
        if PATH_KEY in collection:
            _remove(collection)
    bpy.data.orphans_purge(do_recursive=True)


def room_collection(context: bpy.types.Context, room: str) -> bpy.types.Collection | None:
    """The collection of a room of the house at hand."""
    for house in context.scene.collection.children:
        if PATH_KEY in house:
            for collection in house.children:
                if collection[PATH_KEY] == room:
                    return collection
    return None


def placements(context: bpy.types.Context) -> tuple[dict[str, Matrix], dict[str, Matrix]]:
    """Where each piece stood when the house came in, and where it stands now; removed ones do not.

    The first is remembered in the house's collection, since a removed object remembers nothing.
    """
    now = {}
    for item in context.scene.objects:
        if PLACED_KEY in item:
            now[str(item[PATH_KEY])] = tuple(tuple(row) for row in item.matrix_local)
    return _remembered(context), now


def _remembered(context: bpy.types.Context) -> dict[str, Matrix]:
    for house in context.scene.collection.children:
        if PLACED_KEY in house:
            return {path: _rows(entries) for path, entries in house[PLACED_KEY].items()}
    return {}


def _rows(entries: Sequence[float]) -> Matrix:
    return tuple(tuple(float(x) for x in entries[4 * row : 4 * row + 4]) for row in range(4))


def objects_at(context: bpy.types.Context, paths: list[str]) -> list[bpy.types.Object]:
    """The objects at these USD paths and below them."""
    found = []
    for item in context.scene.objects:
        own = str(item.get(PATH_KEY, ""))
        if any(own == path or own.startswith(f"{path}/") for path in paths):
            found.append(item)
    return found


def fill_rooms(context: bpy.types.Context, rooms: list[str]) -> None:
    """The rooms list, with the seeds it had."""
    own = fields(context)
    seeds = {room.name: room.seed for room in own.rooms}
    own.rooms.clear()
    for name in rooms:
        line = own.rooms.add()
        line.name, line.seed = name, seeds.get(name, own.seed)
    own.room_index = min(own.room_index, max(0, len(rooms) - 1))


def _own_prototypes(context: bpy.types.Context) -> None:
    """What instances are made of goes with the house when that is replaced."""
    for collection in context.scene.collection.children:
        if collection.name.startswith(PROTOTYPES) and PATH_KEY not in collection:
            collection[PATH_KEY] = ""
            # They lie at the origin, all in one heap.
            context.view_layer.layer_collection.children[collection.name].exclude = True


def _collection(branch: Branch) -> bpy.types.Collection:
    collection = bpy.data.collections.new(branch.name)
    collection[PATH_KEY] = branch.name
    for name in branch.objects:
        collection.objects.link(bpy.data.objects[name])
    for part in branch.branches.values():
        collection.children.link(_collection(part))
    return collection


def _choose_camera(context: bpy.types.Context, linked: set[bpy.types.Object]) -> None:
    """The importer brings cameras but makes none of them the scene's."""
    cameras = sorted((item for item in linked if item.type == "CAMERA"), key=lambda c: c.name)
    if cameras:
        context.scene.camera = cameras[0]


def _remove(collection: bpy.types.Collection) -> None:
    for part in list(collection.children):
        _remove(part)
    for item in list(collection.objects):
        bpy.data.objects.remove(item, do_unlink=True)
    bpy.data.collections.remove(collection)
