"""A stage as a collection tree: house > rooms > furniture, with its lights, cameras and sky."""

from __future__ import annotations

from pathlib import Path

import bpy

from .core.edits import placements_of_house
from .core.layer import opened_file, read_changes
from .core.tree import Branch, collection_tree, room_names, usd_paths
from .house import (
    LOCKED_KEY,
    light_of,
    own_objects,
    placements,
    remember,
    remember_lamps,
    show_rooms,
)
from .properties import PATH_KEY, fields, show_ceilings

WORLD = "CHOrD sky"

PROTOTYPES = "prototypes"
"""The importer's collection of what is instanced, left out of the view layer."""


def import_house(context: bpy.types.Context, house: Path) -> list[str]:
    """Import the stage in place of the house that was there; returns the rooms' names.

    Changes that were saved for it come in with it. What the artist put beside it stays.
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
    ordered = dict(sorted(paths.items(), key=lambda pair: pair[1]))
    root = _collection(collection_tree(ordered))
    context.scene.collection.children.link(root)
    for item in linked:
        context.scene.collection.objects.unlink(item)
    rooms = room_names(ordered.values())
    _recall_changes(context, root, house)
    _fill_rooms(context, rooms)
    _choose_camera(context, linked)
    show_ceilings(context)
    show_rooms(context)
    return rooms


def remove_house(context: bpy.types.Context) -> None:
    """Take the house of this scene out of the file, and what only it used."""
    own = set(own_objects(context).values())
    theirs = [item for item in context.scene.objects if item not in own]
    used = {item.instance_collection for item in theirs if item.instance_collection}
    # What the artist put into the house's collections does not go with them.
    for item in theirs:
        _leave_house(context, item)
    for collection in list(context.scene.collection.children):
        if PATH_KEY in collection:
            _remove(collection, used)
    bpy.data.orphans_purge(do_recursive=True)


def _recall_changes(context: bpy.types.Context, root: bpy.types.Collection, house: Path) -> None:
    context.view_layer.update()
    objects, changes = own_objects(context), read_changes(house)
    remember(root, placements_of_house(placements(objects), changes), changes)
    remember_lamps(objects, changes)
    for path in changes.locked:
        if path in objects:
            objects[path][LOCKED_KEY] = True


def _fill_rooms(context: bpy.types.Context, rooms: list[str]) -> None:
    """The rooms list, with the seeds it had."""
    own, objects = fields(context), own_objects(context)
    seeds = {room.name: room.seed for room in own.rooms}
    chosen = own.room_index
    own.rooms.clear()
    for name in rooms:
        line = own.rooms.add()
        line.name, line.seed = name, seeds.get(name, own.seed)
        line.light = light_of(objects, name)
    own.room_index = min(chosen, max(0, len(rooms) - 1))


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


def _leave_house(context: bpy.types.Context, item: bpy.types.Object) -> None:
    """Move an artist's own object out of the collections of the house, where it is in some."""
    homes = [c for c in item.users_collection if PATH_KEY in c]
    if item.parent and PATH_KEY in item.parent:
        world = item.matrix_world.copy()
        item.parent = None
        item.matrix_world = world
    item.pop(PATH_KEY, None)
    for home in homes:
        home.objects.unlink(item)
    if homes and not item.users_collection:
        context.scene.collection.objects.link(item)


def _remove(collection: bpy.types.Collection, used: set[bpy.types.Collection]) -> None:
    """Remove a collection and all in it, except what copies still show."""
    for part in list(collection.children):
        if part in used:
            collection.children.unlink(part)
        else:
            _remove(part, used)
    for item in list(collection.objects):
        bpy.data.objects.remove(item, do_unlink=True)
    bpy.data.collections.remove(collection)
