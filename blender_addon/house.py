"""The house as it stands in the scene: its rooms and pieces, and what was changed in it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path

import bpy
from mathutils import Matrix as WorldMatrix

from .core.edits import Changes, Matrix, as_saved, moves, placements_of_house, to_json, understood
from .core.revisions import revision
from .core.tree import (
    CAMERAS,
    ROOF,
    is_ceiling,
    is_light,
    is_piece,
    is_placed,
    piece_of,
    room_of,
    room_path,
    storeys,
)
from .properties import PART_KEY, chosen_room, fields

LOCKED_KEY = "chord_usd_locked"
"""Custom property of pieces that stay when their room is furnished again."""

LAMP_KEY = "chord_usd_lamp"
"""Custom property of lamps: the brightness that the house itself has them at."""

LEAST_LIGHT = 1e-3
"""Share of its brightness that a lamp keeps that was put out; an exposure has no zero."""

CATEGORY_KEY, SIZE_KEY, DENSITY_KEY = "chord:category", "chord:size_m", "chord:kg_per_m3"
NODE_KEY, RESTS_KEY = "chord:node_id", "chord:rests_on"
EDITED_KEY, MOVED_KEY = "chord:edited_by", "chord:moved_m"
"""Custom properties that the importer gives pieces: attributes of the stage."""

Objects = dict[str, bpy.types.Object]


def own_objects(context: bpy.types.Context) -> Objects:
    """The house's objects by USD path, as far as they are in this scene; no copies of them."""
    there = set(context.scene.objects)
    return {line.path: line.object for line in fields(context).objects if line.object in there}


def is_shown(context: bpy.types.Context) -> bool:
    """Whether there is a house in this scene, or what an artist has left of it."""
    return bool(own_objects(context))


def adopt(context: bpy.types.Context, objects: Objects) -> None:
    """Keep which objects the house has, so that no copy and no new name is taken for another."""
    lines = fields(context).objects
    lines.clear()
    for path, item in objects.items():
        line = lines.add()
        line.path, line.object = path, item


def objects_at(context: bpy.types.Context, paths: Iterable[str]) -> list[bpy.types.Object]:
    """The objects at these USD paths and below them."""
    wanted = tuple(paths)
    return [
        item
        for path, item in own_objects(context).items()
        if any(path == target or path.startswith(f"{target}/") for target in wanted)
    ]


def pieces_of(context: bpy.types.Context, room: str) -> Objects:
    """Furniture and dressing of a room by USD path, in the order of their names."""
    objects = own_objects(context)
    return {
        path: objects[path] for path in sorted(objects) if is_piece(path) and room_of(path) == room
    }


def chosen_path(context: bpy.types.Context) -> str:
    """USD path of the chosen room."""
    return room_path(own_objects(context), chosen_room(context))


def carriers(objects: Objects) -> dict[str, str]:
    """By the path of dressing that rests on a piece, the path of that piece."""
    nodes = {item[NODE_KEY]: piece_of(path) for path, item in objects.items() if NODE_KEY in item}
    carrier_of = {
        path: nodes.get(item.get(RESTS_KEY, ""), "")
        for path, item in objects.items()
        if is_piece(path)
    }
    return {path: piece for path, piece in carrier_of.items() if piece in objects and piece != path}


def with_resting(objects: Objects, path: str) -> list[str]:
    """The path of a piece, and the paths of pieces that rest on it, and on those."""
    paths, rests_on = [path], carriers(objects)
    for below in paths:
        paths += [
            resting
            for resting, piece in rests_on.items()
            if piece == below and resting not in paths
        ]
    return paths


def with_carriers(objects: Objects, path: str) -> list[str]:
    """The path of a piece, and the paths of its carrier, and of the carrier's carrier."""
    paths, rests_on = [path], carriers(objects)
    for above in paths:
        if (piece := rests_on.get(above, "")) and piece not in paths:
            paths.append(piece)
    return paths


def hang_on_carriers(objects: Objects) -> None:
    """Let dressing go with what it rests on when that is moved; it stays where it is."""
    for path, piece in carriers(objects).items():
        item, carrier = objects[path], objects[piece]
        world = item.matrix_world.copy()
        item.parent = carrier
        item.matrix_parent_inverse = carrier.matrix_world.inverted_safe()
        item.matrix_basis = world


def component(objects: Objects, piece: str) -> str:
    """Path of what refers to a piece's model: itself, or the one part of its group that does."""
    for path in (piece, *(p for p in objects if p.rpartition("/")[0] == piece)):
        if path in objects and CATEGORY_KEY in objects[path]:
            return path
    return piece


def arranged(objects: Objects, piece: str) -> str:
    """What rules did to a piece after it was read, in a line; "" where they left it as it was."""
    noted = objects[component(objects, piece)]
    if not noted.get(EDITED_KEY):
        return ""
    return f"{noted[EDITED_KEY]}: moved {100 * float(noted.get(MOVED_KEY, 0.0)):.0f} cm"


def placement(objects: Objects, path: str) -> Matrix:
    """Where an object stands in what is above it in the stage, wherever an artist has hung it."""
    item, above = objects[path], objects.get(path.rpartition("/")[0])
    if item.parent == above:
        placed = item.matrix_local
    else:
        frame = above.matrix_world if above else WorldMatrix.Identity(4)
        placed = frame.inverted_safe() @ item.matrix_world
    return tuple(tuple(row) for row in placed)


def placements(objects: Objects) -> dict[str, Matrix]:
    """Where everything stands that can be moved."""
    return {path: placement(objects, path) for path in objects if is_placed(path)}


def remember(context: bpy.types.Context, house: Path, changes: Changes) -> None:
    """Keep with the scene how the house was that came in, so that undo undoes that, too.

    changes: those it came in with. Raises OSError.
    """
    props, objects = fields(context), own_objects(context)
    props.placed = json.dumps(placements_of_house(placements(objects), changes))
    props.came_with = json.dumps(to_json(changes))
    props.revision = revision(house)
    for path, item in objects.items():
        if is_light(path) and item.type == "LIGHT":
            item[LAMP_KEY] = _brightness(item) / changes.lights.get(path, 1.0)
        if path in changes.locked:
            item[LOCKED_KEY] = True


def house_placements(context: bpy.types.Context) -> dict[str, Matrix]:
    """Where the house itself has its pieces."""
    placed = json.loads(fields(context).placed or "{}")
    return {path: tuple(map(tuple, rows)) for path, rows in placed.items()}


def changes_of(context: bpy.types.Context) -> Changes:
    """What is changed in the house of this scene, against the house itself."""
    if not is_shown(context):
        return Changes()
    came_with = understood(json.loads(fields(context).came_with))
    context.view_layer.update()
    objects = own_objects(context)
    changes = Changes(
        pieces=moves(house_placements(context), placements(objects), came_with.swaps),
        looks=came_with.looks,
        lights={p: s for p, s in _strengths(objects).items() if abs(s - 1.0) > LEAST_LIGHT},
        locked=tuple(sorted(path for path, item in objects.items() if item.get(LOCKED_KEY))),
    )
    return as_saved(changes, came_with)


def set_light(context: bpy.types.Context, room: str, strength: float) -> None:
    """Let the lamps of a room burn so much brighter than the house has them."""
    for path, item in own_objects(context).items():
        if room_of(path) == room and LAMP_KEY in item:
            item.data.energy *= strength * item[LAMP_KEY] / max(_brightness(item), LEAST_LIGHT)


def light_of(objects: Objects, room: str) -> float:
    """How much brighter the lamps of a room burn."""
    return next((s for path, s in _strengths(objects).items() if room_of(path) == room), 1.0)


def show_rooms(context: bpy.types.Context) -> None:
    """Show the chosen room alone, or all rooms up to a storey, and the roof, as the fields say."""
    props = fields(context)
    chosen = chosen_room(context) if props.solo else ""
    parts = {CAMERAS, *(room.name for room in props.rooms)}
    levels = storeys(own_objects(context))
    above = set(levels[props.storey :]) if props.storey else set()
    for layer in _layers(context.view_layer.layer_collection):
        part = layer.collection.get(PART_KEY)
        if part in parts:
            layer.hide_viewport = bool(chosen) and part != chosen
        elif part in levels:
            layer.hide_viewport = part in above
        elif part == ROOF:
            layer.hide_viewport = bool(chosen or above) or not props.show_roof
            layer.collection.hide_render = not props.show_roof


def show_ceilings(context: bpy.types.Context) -> None:
    """Bring the ceilings' visibility in line with the field."""
    hidden = fields(context).hide_ceilings
    for path, item in own_objects(context).items():
        if is_ceiling(path):
            item.hide_set(hidden)


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


def _layers(top: bpy.types.LayerCollection) -> Iterator[bpy.types.LayerCollection]:
    """All collections of a view layer, wherever an artist has put them."""
    for layer in top.children:
        yield layer
        yield from _layers(layer)


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
