"""Buttons that change the house at hand: its pieces, looks and what is selected."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from functools import partial
from typing import Any

import bpy

from .core import commands, report, swaps
from .core.edits import Changes, Edit, Size, Swap, size_of, with_look
from .core.errors import InputError
from .core.layer import edits_file
from .core.tree import piece_of
from .house import (
    CATEGORY_KEY,
    DENSITY_KEY,
    LOCKED_KEY,
    SIZE_KEY,
    Objects,
    chosen_path,
    component,
    house_placements,
    objects_at,
    own_objects,
    placement,
    select,
    with_carriers,
    with_resting,
)
from .jobs import JobOperator, rebuild, save_changes
from .previews import pictures_folder
from .properties import fields, parsed
from .session import Finish

ON_TOP_M = 0.02
"""What rests no lower than this under the top of a piece rests on its top."""


class ChordSaveEdits(bpy.types.Operator):
    """Keep what was changed in a layer over the house; the house itself stays as it is"""

    bl_idname = "chord.save_edits"
    bl_label = "Save edits"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Writes the layer beside the house."""
        try:
            seen = save_changes(context)
        except (InputError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        changes = seen.changes
        count = len(changes.pieces) + len(changes.looks) + len(changes.lights)
        fields(context).note = f"{count} changes kept in {edits_file(seen.house).name}"
        self.report({"INFO"}, fields(context).note)
        return {"FINISHED"}


class _PieceOperator:
    """Does something with the piece at a USD path."""

    path: bpy.props.StringProperty()  # type: ignore[valid-type]

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Finds the piece."""
        objects = own_objects(context)
        if self.path not in objects:
            self.report({"ERROR"}, "This piece is not in the scene any more.")
            return {"CANCELLED"}
        self.change(context, objects)
        return {"FINISHED"}

    def change(self, context: bpy.types.Context, objects: Objects) -> None:
        """What is done with it."""
        raise NotImplementedError


class ChordSelectPiece(_PieceOperator, bpy.types.Operator):
    """Select the piece and look at it"""

    bl_idname = "chord.select_piece"
    bl_label = "Select"
    bl_options = {"UNDO"}

    def change(self, context: bpy.types.Context, _objects: Objects) -> None:
        """Selects, and frames where there is a 3-D view."""
        select(context, objects_at(context, [self.path]))


class ChordLockPiece(_PieceOperator, bpy.types.Operator):
    """Let the piece stay, or not, when its room is furnished again, with its carrier"""

    bl_idname = "chord.lock_piece"
    bl_label = "Lock"
    bl_options = {"UNDO"}

    def change(self, _context: bpy.types.Context, objects: Objects) -> None:
        """Turns the lock; what rests on nothing that stays cannot stay either."""
        locked = not objects[self.path].get(LOCKED_KEY)
        others = with_carriers if locked else with_resting
        for path in others(objects, self.path):
            objects[path][LOCKED_KEY] = locked


class ChordDeletePiece(_PieceOperator, bpy.types.Operator):
    """Take the piece out of the house, with what stands and lies on it"""

    bl_idname = "chord.delete_piece"
    bl_label = "Delete"
    bl_options = {"UNDO"}

    def change(self, context: bpy.types.Context, objects: Objects) -> None:
        """Removes its objects; saving the edits makes it last."""
        for item in objects_at(context, with_resting(objects, self.path)):
            bpy.data.objects.remove(item, do_unlink=True)


class ChordFindModels(JobOperator, bpy.types.Operator):
    """Offer the models that come next to the piece in size"""

    bl_idname = "chord.find_models"
    bl_label = "Swap"

    path: bpy.props.StringProperty()  # type: ignore[valid-type]

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line, and the list that follows it."""
        objects = own_objects(context)
        path = component(objects, self.path)
        if path not in objects or CATEGORY_KEY not in objects[path]:
            raise InputError("This piece is not in the scene any more.")
        changes = save_changes(context).changes
        category = str(objects[path][CATEGORY_KEY])
        slot = _slot(objects[path], changes, path)
        assets = bpy.path.abspath(fields(context).asset_folders)

        finish = partial(_offer, path)
        return commands.nearest(category, slot, pictures_folder(), assets), finish


class ChordSwap(JobOperator, bpy.types.Operator):
    """Put this model in the piece's place"""

    bl_idname = "chord.swap"
    bl_label = "Swap"

    index: bpy.props.IntProperty()  # type: ignore[valid-type]

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """Saves the swap, and brings the house in again."""
        props = fields(context)
        offered = swaps.candidates(parsed(props.swap_models))
        objects = own_objects(context)
        if props.swap_path not in objects or not 0 <= self.index < len(offered):
            raise InputError("This piece is not in the scene any more.")
        seen = save_changes(context)
        chosen = offered[self.index]
        usd = swaps.bring_model(chosen.usd, seen.house, chosen.shared)
        slot = _slot(objects[props.swap_path], seen.changes, props.swap_path)
        density = float(objects[props.swap_path].get(DENSITY_KEY, 0.0))
        swap = swaps.swap_for(chosen, slot, usd, _colour(context, props.swap_path), density)
        return rebuild(seen, _with_swap(context, seen.changes, swap, chosen.size_m))


class ChordChooseLook(JobOperator, bpy.types.Operator):
    """Another look: a floor, walls, a colour, or the time of day"""

    bl_idname = "chord.choose_look"
    bl_label = "Choose look"

    path: bpy.props.StringProperty()  # type: ignore[valid-type]
    variant_set: bpy.props.StringProperty()  # type: ignore[valid-type]
    variant: bpy.props.StringProperty()  # type: ignore[valid-type]

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """Saves the choice, and brings the house in again."""
        contents = parsed(fields(context).contents)
        if not report.is_offered(contents, self.path, self.variant_set, self.variant):
            raise InputError("There is no such look. Choose one of those in the panel.")
        seen = save_changes(context)
        after = with_look(seen.changes, self.path, self.variant_set, self.variant)
        return rebuild(seen, after)


class ChordShuffleLooks(JobOperator, bpy.types.Operator):
    """Draw another floor and other walls for the chosen room"""

    bl_idname = "chord.shuffle_looks"
    bl_label = "Shuffle"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """Saves the choices, and brings the house in again."""
        room = chosen_path(context)
        seen = save_changes(context)
        after = seen.changes
        for look in report.looks(parsed(fields(context).contents)):
            if look.path == room:
                others = [variant for variant in look.offered if variant != look.chosen]
                after = with_look(after, room, look.variant_set, random.choice(others))
        return rebuild(seen, after)


class ChordFrameRoom(bpy.types.Operator):
    """Select the chosen room's furniture and look at it"""

    bl_idname = "chord.frame_room"
    bl_label = "Frame room"
    bl_options = {"UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Selects, and frames where there is a 3-D view."""
        objects = objects_at(context, [chosen_path(context)])
        if not objects:
            self.report({"ERROR"}, "The room is not in this scene any more.")
            return {"CANCELLED"}
        select(context, objects)
        return {"FINISHED"}


class ChordShowFinding(bpy.types.Operator):
    """Select the culprits and look at them"""

    bl_idname = "chord.show_finding"
    bl_label = "Show"
    bl_options = {"UNDO"}

    index: bpy.props.IntProperty()  # type: ignore[valid-type]

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Selects, and frames where there is a 3-D view."""
        props = fields(context)
        if not 0 <= self.index < len(props.findings):
            return {"CANCELLED"}
        props.finding_index = self.index
        paths = props.findings[self.index].paths.splitlines()
        select(context, objects_at(context, paths))
        return {"FINISHED"}


def _offer(path: str, context: bpy.types.Context, data: dict[str, Any]) -> None:
    """Show the models that could take the place of a piece."""
    props = fields(context)
    props.swap_path, props.swap_models = path, json.dumps(data)


def _slot(item: bpy.types.Object, changes: Changes, path: str) -> Size:
    """What a model may fill here: the size of the piece that the house itself has."""
    if path in changes.swaps:
        return changes.swaps[path].slot_m
    return size_of(item[SIZE_KEY])


def _colour(context: bpy.types.Context, path: str) -> str:
    """The colour that a piece has now."""
    looks = report.looks(parsed(fields(context).contents))
    mine = (look for look in looks if look.path == path and look.variant_set == swaps.COLOUR)
    return next((look.chosen for look in mine), "")


def _with_swap(context: bpy.types.Context, changes: Changes, swap: Swap, own_m: Size) -> Changes:
    """The changes with a swap; what stands on the piece is raised or lowered with its top."""
    path, objects = fields(context).swap_path, own_objects(context)
    was = house_placements(context)
    here = placement(objects, path)
    stands = swaps.placed(here, changes.swaps.get(path), swap, own_m)
    pieces = {**changes.pieces, path: Edit(was[path], stands, swap)}
    carried = f"{path.rpartition('/')[0]}/Items"
    own_height_m = float(objects[path][SIZE_KEY][2])
    by_m = swap.size_m[2] - own_height_m
    if carried in objects:
        raised = swaps.raised(placement(objects, carried), by_m)
        pieces[carried] = Edit(was[carried], raised)
    top_m = placement(objects, piece_of(path))[2][3] + own_height_m
    for resting in with_resting(objects, piece_of(path))[1:]:
        its = placement(objects, resting)
        if its[2][3] >= top_m - ON_TOP_M:
            pieces[resting] = Edit(was[resting], swaps.raised(its, by_m))
    # The swap states its own colour.
    looks = {key: chosen for key, chosen in changes.looks.items() if key != path}
    return replace(changes, pieces=pieces, looks=looks)


_CLASSES = (
    ChordSaveEdits,
    ChordSelectPiece,
    ChordLockPiece,
    ChordDeletePiece,
    ChordFindModels,
    ChordSwap,
    ChordChooseLook,
    ChordShuffleLooks,
    ChordFrameRoom,
    ChordShowFinding,
)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
