"""A stage as a collection tree: house > rooms > furniture, with its lights, cameras and sky."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy

from .core.layer import house_of, mend_layer, opened_file, read_changes, roof_of, roofed_text
from .core.tree import Branch, collection_tree, room_names, shown_names, usd_paths
from .house import (
    Objects,
    adopt,
    hang_on_carriers,
    light_of,
    own_objects,
    remember,
    show_ceilings,
    show_rooms,
)
from .properties import PART_KEY, fields

WORLD = "CHOrD sky"

SUN_IMPORT = 4.0
"""Blender's importer makes suns this many times as strong as USD means them, measured on white."""

PROTOTYPE = ""
"""The part of the house that its instances show."""


def import_house(context: bpy.types.Context, house: Path) -> None:
    """Import the stage in place of the house that was there.

    Changes that were saved for it come in with it. What the artist put beside it stays.
    """
    mend_layer(house)
    remove_house(context)
    objects = _import_stage(context, opened_file(house))
    adopt(context, objects)
    root = _collection(collection_tree({item.name: path for path, item in objects.items()}))
    context.scene.collection.children.link(root)
    for item in objects.values():
        context.scene.collection.objects.unlink(item)
    context.view_layer.update()
    hang_on_carriers(objects)
    context.view_layer.update()
    remember(context, house, read_changes(house))
    _fill_rooms(context, room_names(objects))
    _choose_camera(context, objects.values())
    show_ceilings(context)
    show_rooms(context)
    _name(objects)


def _name(objects: Objects) -> None:
    """Give objects names that need no numbers."""
    for item in objects.values():
        item.name = f"chord {item.name}"  # the name of one may be what another gets
    for path, name in shown_names(objects).items():
        objects[path].name = name


def remove_house(context: bpy.types.Context) -> None:
    """Take the house of this scene out of the file, and what only it used.

    What the artist made stays, also where it lies in the collections of the house.
    """
    parts = [
        collection
        for collection in context.scene.collection.children_recursive
        if PART_KEY in collection
    ]
    prototypes = [part for part in parts if part[PART_KEY] == PROTOTYPE]
    of_house = {line.object for line in fields(context).objects} - {None}
    shown = {item for prototype in prototypes for item in prototype.objects}
    theirs = [item for item in context.scene.objects if item not in of_house | shown]
    used, unused = _used_prototypes(theirs), _unused()
    for item in theirs:
        _leave_house(context, item, of_house)
    for item in of_house | {item for item in shown if used.isdisjoint(item.users_collection)}:
        bpy.data.objects.remove(item, do_unlink=True)
    for part in parts:
        _remove_collection(context, part, is_used=part in used)
    fields(context).objects.clear()
    _purge(unused)


def _import_stage(context: bpy.types.Context, stage: Path) -> Objects:
    """What the stage holds, by USD path in its order; as yet in the scene's own collection."""
    if context.scene.world is None:  # without one, the importer drops the stage's sky
        context.scene.world = bpy.data.worlds.get(WORLD) or bpy.data.worlds.new(WORLD)
    before, collections = set(bpy.data.objects), set(bpy.data.collections)
    with _roofed(stage) as roofed:
        bpy.ops.wm.usd_import(filepath=str(roofed), support_scene_instancing=True)
    _hide_prototypes(context, set(bpy.data.collections) - collections)
    linked = [item for item in context.scene.collection.objects if item not in before]
    for item in linked:
        if item.type == "LIGHT" and item.data.type == "SUN":
            item.data.energy /= SUN_IMPORT
    paths = usd_paths({item.name: item.parent.name if item.parent else None for item in linked})
    return dict(sorted(((paths[item.name], item) for item in linked), key=lambda pair: pair[0]))


@contextmanager
def _roofed(stage: Path) -> Iterator[Path]:
    """The stage with the roof that its house offers: the panel shows and hides it."""
    roof = roof_of(house_of(stage))
    if not roof:
        yield stage
        return
    with TemporaryDirectory() as folder:
        layer = Path(folder) / "roofed.usda"
        layer.write_text(roofed_text(stage, roof), encoding="utf-8")
        yield layer


def _hide_prototypes(
    context: bpy.types.Context, collections: Iterable[bpy.types.Collection]
) -> None:
    """What instances show lies at the origin, all in one heap; it goes with the house."""
    for collection in collections:
        collection[PART_KEY] = PROTOTYPE
        layer = context.view_layer.layer_collection.children.get(collection.name)
        if layer:
            layer.exclude = True


def _fill_rooms(context: bpy.types.Context, rooms: list[str]) -> None:
    """The rooms list, with the seeds it had."""
    props, objects = fields(context), own_objects(context)
    seeds = {room.name: room.seed for room in props.rooms}
    chosen = props.room_index
    props.rooms.clear()
    for name in rooms:
        line = props.rooms.add()
        line.name, line.seed = name, seeds.get(name, props.seed)
        line.light = light_of(objects, name)
    props.room_index = min(chosen, max(0, len(rooms) - 1))


def _collection(branch: Branch) -> bpy.types.Collection:
    collection = bpy.data.collections.new(branch.name)
    collection[PART_KEY] = branch.name
    for name in branch.objects:
        collection.objects.link(bpy.data.objects[name])
    for part in branch.branches.values():
        collection.children.link(_collection(part))
    return collection


def _choose_camera(context: bpy.types.Context, items: Iterable[bpy.types.Object]) -> None:
    """The importer brings cameras but makes none of them the scene's."""
    cameras = sorted((item for item in items if item.type == "CAMERA"), key=lambda c: c.name)
    if cameras:
        context.scene.camera = cameras[0]


def _used_prototypes(items: Iterable[bpy.types.Object]) -> set[bpy.types.Collection]:
    """The collections that these objects show, and those that are shown in them."""
    prototypes: set[bpy.types.Collection] = set()
    waiting = [item.instance_collection for item in items if item.instance_collection]
    while waiting:
        collection = waiting.pop()
        if collection not in prototypes:
            prototypes.add(collection)
            waiting += [*collection.children]
            waiting += [i.instance_collection for i in collection.objects if i.instance_collection]
    return prototypes


def _leave_house(
    context: bpy.types.Context, item: bpy.types.Object, of_house: set[bpy.types.Object]
) -> None:
    """Move an artist's own object out of the collections of the house, where it is in some."""
    homes = [collection for collection in item.users_collection if PART_KEY in collection]
    if item.parent in of_house:
        world = item.matrix_world.copy()
        item.parent = None
        item.matrix_world = world
    for home in homes:
        home.objects.unlink(item)
    if homes and not item.users_collection:
        context.scene.collection.objects.link(item)


def _remove_collection(
    context: bpy.types.Context, collection: bpy.types.Collection, *, is_used: bool
) -> None:
    """Remove a collection of the house; an artist's own in it move to the top.

    is_used: what copies still show stays in the file, and is the artist's from now on.
    """
    for child in collection.children:
        if PART_KEY not in child and child.name not in context.scene.collection.children:
            context.scene.collection.children.link(child)
    if not is_used:
        bpy.data.collections.remove(collection)
        return
    del collection[PART_KEY]
    for above in (context.scene.collection, *context.scene.collection.children_recursive):
        if collection.name in above.children:
            above.children.unlink(collection)


def _unused() -> list[bpy.types.ID]:
    """What nothing in the file uses."""
    kinds = [kind.identifier for kind in bpy.data.bl_rna.properties if kind.type == "COLLECTION"]
    blocks = (block for kind in kinds for block in getattr(bpy.data, kind))
    return [block for block in blocks if isinstance(block, bpy.types.ID) and not block.users]


def _purge(spared: Iterable[bpy.types.ID]) -> None:
    """Take out of the file what nothing uses, but for what nothing used before."""
    kept = [block for block in spared if block.is_editable]
    for block in kept:
        block.use_fake_user = True
    bpy.data.orphans_purge(do_recursive=True)
    for block in kept:
        block.use_fake_user = False
