"""Buttons that start jobs of the program. Each collects fields; core/ decides."""

from __future__ import annotations

import random
from functools import partial
from pathlib import Path
from typing import Any, Literal

import bpy

from .core import commands
from .core.edits import as_it_was
from .core.errors import InputError
from .core.layer import house_of
from .core.options import ROWS
from .core.program import HAS_HISTORY, WISHES_FROM, ProgramError
from .core.revisions import keep
from .core.tree import is_piece, room_of
from .jobs import (
    JobOperator,
    bring_in,
    claim,
    rebuild,
    save_changes,
    show_certificate,
    show_earlier,
    show_edited,
    show_farm_job,
    show_new_house,
    show_past,
    show_pictures,
    show_room,
    show_understood,
    unsaved_folder,
)
from .preferences import preferences
from .properties import MAX_SEED, chosen_options, chosen_room, fields
from .session import Finish, session


class ChordGenerate(JobOperator, bpy.types.Operator):
    """Furnish the plan and bring the house into this scene"""

    bl_idname = "chord.generate"
    bl_label = "Generate"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line, and the import that follows it."""
        props = fields(context)
        plan = props.outline if props.source == "OUTLINE" else props.plan
        settings = commands.GenerateSettings(
            source=props.source,
            plan=bpy.path.abspath(plan),
            text=props.text,
            options=_chosen(context),
        )
        name = commands.house_name(settings)
        wanted = commands.house_folder(bpy.data.filepath, name, unsaved_folder())
        arguments = commands.generate(settings, wanted / commands.HOUSE)
        session.program(preferences(context).program).check_can(arguments)
        # Only now: what makes no job must not claim anything.
        folder = session.claims.take_new(wanted)
        return commands.generate(settings, folder / commands.HOUSE), show_new_house


class ChordOpenHouse(JobOperator, bpy.types.Operator):
    """Bring in a house that chord-usd made, with the changes saved for it"""

    bl_idname = "chord.open_house"
    bl_label = "Open house"

    filepath: bpy.props.StringProperty(subtype="FILE_PATH")  # type: ignore[valid-type]
    filter_glob: bpy.props.StringProperty(  # type: ignore[valid-type]
        default="*.usda;*.usd;*.usdc", options={"HIDDEN"}
    )

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Asks for the file."""
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def job(self, _context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The list of what it holds, and the import that follows it."""
        house = house_of(Path(bpy.path.abspath(self.filepath)))
        claim(house)
        return bring_in(house)


class ChordRegenerate(JobOperator, bpy.types.Operator):
    """Furnish the chosen room again; locked pieces and the other rooms stay as they are"""

    bl_idname = "chord.regenerate"
    bl_label = "Regenerate room"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line, and the import that follows it."""
        props, name = fields(context), chosen_room(context)
        seen = save_changes(context)
        locked = [path for path in seen.changes.locked if is_piece(path) and room_of(path) == name]
        names = [path.split("/")[-1] for path in locked]
        seed = random.randrange(MAX_SEED)
        settings, wishes = {**_chosen(context), "seed": seed}, commands.RoomWishes()
        if WISHES_FROM in session.program(preferences(context).program).abilities:
            wishes = commands.RoomWishes(props.wanted, props.unwanted)
        arguments = commands.regenerate(seen.house, name, settings, names, wishes)
        keep(seen.house)
        props.rooms[props.room_index].seed = seed
        return arguments, partial(show_room, seen)


class ChordReadSentence(JobOperator, bpy.types.Operator):
    """Say what the sentence means in this house; nothing is changed yet"""

    bl_idname = "chord.read_sentence"
    bl_label = "Understand"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line, and the lines that follow it."""
        sentence, house = fields(context).sentence, save_changes(context).house
        arguments = commands.edit(house, sentence, only_read=True)
        return arguments, partial(show_understood, sentence)


class ChordEditByWords(JobOperator, bpy.types.Operator):
    """Do what was understood; other rooms stay as they are"""

    bl_idname = "chord.edit_by_words"
    bl_label = "Do it"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line, and the import that follows it."""
        props, seen = fields(context), save_changes(context)
        arguments = commands.edit(seen.house, props.sentence, bpy.path.abspath(props.asset_folders))
        keep(seen.house)
        return arguments, partial(show_edited, seen)


class ChordCheckHouse(JobOperator, bpy.types.Operator):
    """Look for collisions, blocked doors and other faults"""

    bl_idname = "chord.check_house"
    bl_label = "Check"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line, and the list that follows it."""
        return commands.check(save_changes(context).house), show_certificate


class ChordRender(JobOperator, bpy.types.Operator):
    """Render into the pictures folder, beside Blender"""

    bl_idname = "chord.render"
    bl_label = "Render here"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line; the pictures are the result."""
        house = save_changes(context).house
        folder = _output_folder(fields(context).render_folder)
        return commands.render(house, folder, render_settings(context)), show_pictures


class ChordWriteFarmJob(JobOperator, bpy.types.Operator):
    """Write the same pictures as an Open Job Description bundle, for a render farm"""

    bl_idname = "chord.write_farm_job"
    bl_label = "Write farm job"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line; the bundle is the result."""
        house = save_changes(context).house
        folder = _output_folder(fields(context).farm_folder)
        return commands.farm(house, folder, render_settings(context)), show_farm_job


class ChordDiscardEdits(JobOperator, bpy.types.Operator):
    """Take back every change in the chosen room: pieces, looks and lamps"""

    bl_idname = "chord.discard_edits"
    bl_label = "Discard edits of room"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """Saves what is left, and brings the house in again."""
        seen = save_changes(context)
        return rebuild(seen, as_it_was(seen.changes, chosen_room(context)))


class _Past(JobOperator):
    """Goes along the history of the house, which is the same on every surface."""

    verb: Literal["undo", "redo", "history"]

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """Saves what is changed, which is a change of its own; the import follows."""
        seen = save_changes(context)
        arguments = commands.past(self.verb, seen.house, self.to(context))
        if lacking := session.program(preferences(context).program).lacking([HAS_HISTORY]):
            raise ProgramError(lacking)
        keep(seen.house)
        return arguments, partial(show_earlier, seen)

    def to(self, _context: bpy.types.Context) -> int:
        """The number of the change to go back to; 0: one step. Raises InputError."""
        return 0


class ChordUndo(_Past, bpy.types.Operator):
    """Take back the latest change of the house, whoever made it: panel, page or program"""

    bl_idname = "chord.undo"
    bl_label = "Undo in the house"
    verb = "undo"


class ChordRedo(_Past, bpy.types.Operator):
    """Do again what was taken back last"""

    bl_idname = "chord.redo"
    bl_label = "Redo in the house"
    verb = "redo"


class ChordGoTo(_Past, bpy.types.Operator):
    """Give the house the state after a change, by default the one that is chosen in the list"""

    bl_idname = "chord.go_to"
    bl_label = "Go to this change"
    verb = "history"

    number: bpy.props.IntProperty(min=0)  # type: ignore[valid-type]

    def to(self, context: bpy.types.Context) -> int:
        """The change named, or chosen in the list."""
        props = fields(context)
        chosen = props.past[props.past_index : props.past_index + 1]
        if not self.number and not chosen:
            raise InputError("Choose a change in the list first; the arrow reads it again.")
        return self.number or chosen[0].number


class ChordReadHistory(JobOperator, bpy.types.Operator):
    """List what was done to the house, by this panel and elsewhere"""

    bl_idname = "chord.read_history"
    bl_label = "Read history"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line, and the list that follows it."""
        arguments = commands.past("history", save_changes(context).house)
        return arguments, show_past


class ChordCancel(bpy.types.Operator):
    """Stop the running job; nothing half-done is left"""

    bl_idname = "chord.cancel"
    bl_label = "Cancel"

    def execute(self, _context: bpy.types.Context) -> set[str]:
        """Asks the program to stop."""
        session.cancel()
        return {"FINISHED"}


class ChordDice(bpy.types.Operator):
    """Another seed"""

    bl_idname = "chord.dice"
    bl_label = "Dice"
    bl_options = {"UNDO", "INTERNAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Draws a seed."""
        fields(context).seed = random.randrange(MAX_SEED)
        return {"FINISHED"}


def _chosen(context: bpy.types.Context) -> dict[str, Any]:
    """Values of the option fields that the program knows."""
    known = session.known_program(preferences(context).program)
    chosen = chosen_options(context)
    return {row["name"]: chosen[row["name"]] for row in ROWS if known is None or known.has(row)}


def _output_folder(field: str) -> Path:
    """A folder beside the Blender file, as its field says. Raises InputError."""
    if not field.strip():
        raise InputError("Choose a folder for the result.")
    if field.startswith("//") and not bpy.data.filepath:
        raise InputError(
            "Save the Blender file first, or choose a folder that does not begin with //."
        )
    return Path(bpy.path.abspath(field))


def render_settings(context: bpy.types.Context) -> commands.RenderSettings:
    """What the fields say of pictures. Raises InputError."""
    props, size = fields(context), context.scene.render
    room = "" if props.all_rooms else props.render_room
    if not props.all_rooms and room not in props.rooms:
        raise InputError("Choose the room to render, or all cameras.")
    share = size.resolution_percentage / 100
    return commands.RenderSettings(
        cameras=(room,) if room else (),
        samples=props.samples,
        resolution=(round(size.resolution_x * share), round(size.resolution_y * share)),
        passes=tuple(name for name in commands.PASSES if name in props.passes),
    )


_CLASSES = (
    ChordGenerate,
    ChordOpenHouse,
    ChordRegenerate,
    ChordReadSentence,
    ChordEditByWords,
    ChordCheckHouse,
    ChordRender,
    ChordWriteFarmJob,
    ChordDiscardEdits,
    ChordUndo,
    ChordRedo,
    ChordGoTo,
    ChordReadHistory,
    ChordCancel,
    ChordDice,
)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
