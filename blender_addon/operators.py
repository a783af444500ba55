"""The panel's buttons. Each collects fields, starts a job or selects things; core/ decides."""

from __future__ import annotations

import random
import tempfile
from pathlib import Path
from typing import Any

import bpy

from .core import commands, edits, report
from .core.program import ProgramError
from .importer import fill_rooms, import_house, objects_at, placements, room_collection
from .properties import MAX_SEED, fields
from .session import Finish, session


class _JobOperator:
    """Starts a job; what is missing is told in the panel."""

    def execute(self, context: bpy.types.Context) -> set[str]:
        own = fields(context)
        if session.is_running:
            self.report({"WARNING"}, "A job is running; cancel it or wait.")
            return {"CANCELLED"}
        try:
            arguments, finish = self.job(context)
            session.start(context, arguments, finish)
        except (commands.InputError, ProgramError) as error:
            own.error = str(error)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class ChordGenerate(_JobOperator, bpy.types.Operator):
    """Furnish the plan and bring the house into this scene"""

    bl_idname = "chord.generate"
    bl_label = "Generate"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line, and the import that follows it."""
        own = fields(context)
        plan = bpy.path.abspath(own.plan)
        settings = commands.GenerateSettings(
            source=own.source,
            plan=plan,
            text=own.text,
            seed=own.seed,
            steps=own.steps,
            assets=bpy.path.abspath(own.assets),
        )
        folder = commands.house_folder(bpy.data.filepath, plan, _unsaved_folder())
        folder.mkdir(parents=True, exist_ok=True)
        return commands.generate(settings, folder / "house.usda"), _show_new_house


class ChordRegenerate(_JobOperator, bpy.types.Operator):
    """Furnish the chosen room anew; the others stay as they are"""

    bl_idname = "chord.regenerate"
    bl_label = "Regenerate room"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line, and the import that follows it."""
        own = fields(context)
        if not own.rooms:
            raise commands.InputError("Generate a house first.")
        room = own.rooms[own.room_index]
        room.seed = random.randrange(MAX_SEED)
        _save_edits(context)
        assets = bpy.path.abspath(own.assets)
        return commands.regenerate(_house(context), room.name, room.seed, assets), _show_room


class ChordCheckHouse(_JobOperator, bpy.types.Operator):
    """Look for collisions, blocked doors and other faults"""

    bl_idname = "chord.check_house"
    bl_label = "Check"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line, and the list that follows it."""
        return commands.check(_house(context)), _show_certificate


class ChordRender(_JobOperator, bpy.types.Operator):
    """Render the chosen room into the pictures folder, beside Blender"""

    bl_idname = "chord.render"
    bl_label = "Render here"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line; the pictures are the result."""
        own = fields(context)
        room = own.rooms[own.room_index].name if own.rooms else ""
        size = context.scene.render
        return (
            commands.render(
                _house(context),
                Path(bpy.path.abspath(own.render_folder)),
                [room] if room else [],
                own.samples,
                (size.resolution_x, size.resolution_y),
            ),
            lambda _context, _data: None,
        )


class ChordSaveEdits(bpy.types.Operator):
    """Keep what was moved or removed in a layer over the house; the house itself stays as it is"""

    bl_idname = "chord.save_edits"
    bl_label = "Save edits"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Writes the layer beside the house."""
        try:
            count = _save_edits(context)
        except (commands.InputError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{count} changes kept in {edits.edits_file(_house(context)).name}")
        return {"FINISHED"}


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


class ChordFrameRoom(bpy.types.Operator):
    """Select the chosen room's furniture and look at it"""

    bl_idname = "chord.frame_room"
    bl_label = "Frame room"
    bl_options = {"UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Selects, and frames where there is a 3-D view."""
        own = fields(context)
        if not own.rooms:
            return {"CANCELLED"}
        collection = room_collection(context, own.rooms[own.room_index].name)
        if collection is None:
            self.report({"ERROR"}, "The room is not in this scene any more.")
            return {"CANCELLED"}
        _select(context, list(collection.all_objects))
        return {"FINISHED"}


class ChordShowFinding(bpy.types.Operator):
    """Select the culprits and look at them"""

    bl_idname = "chord.show_finding"
    bl_label = "Show"
    bl_options = {"UNDO"}

    index: bpy.props.IntProperty()  # type: ignore[valid-type]

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Selects, and frames where there is a 3-D view."""
        own = fields(context)
        if not 0 <= self.index < len(own.findings):
            return {"CANCELLED"}
        own.finding_index = self.index
        paths = own.findings[self.index].paths.splitlines()
        _select(context, objects_at(context, paths))
        return {"FINISHED"}


def _house(context: bpy.types.Context) -> Path:
    house = fields(context).house
    if not house:
        raise commands.InputError("Generate a house first.")
    return Path(bpy.path.abspath(house))


def _unsaved_folder() -> Path:
    """Houses of a Blender file without a name."""
    return Path(bpy.app.tempdir or tempfile.gettempdir())


def _show_new_house(context: bpy.types.Context, data: dict[str, Any]) -> None:
    """A new house: changes to the one that was there before do not apply to it."""
    edits.write_edits(Path(str(data["stage"])), {})
    _show_house(context, data)


def _show_house(context: bpy.types.Context, data: dict[str, Any]) -> None:
    house = Path(str(data["stage"]))
    fill_rooms(context, import_house(context, house))
    own = fields(context)
    own.house = str(house)
    if data.get("certificate"):
        _show_certificate(context, data["certificate"])


def _show_room(context: bpy.types.Context, data: dict[str, Any]) -> None:
    """A room was furnished anew: what was changed in it before is gone, the rest is kept."""
    house = Path(str(data["stage"]))
    edits.write_edits(house, edits.without_room(edits.read_edits(house), str(data["room"])))
    _show_house(context, data)


def _save_edits(context: bpy.types.Context) -> int:
    """Write the layer of changes; returns how many pieces it changes."""
    house = _house(context)
    kept = {**edits.read_edits(house), **edits.changes(*placements(context))}
    edits.write_edits(house, kept)
    return len(kept)


def _show_certificate(context: bpy.types.Context, data: dict[str, Any]) -> None:
    own = fields(context)
    own.certificate = report.headline(data)
    own.findings.clear()
    for finding in report.findings(data):
        line = own.findings.add()
        line.name, line.paths = finding.text, "\n".join(finding.paths)


def _select(context: bpy.types.Context, items: list[bpy.types.Object]) -> None:
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


_CLASSES = (
    ChordGenerate,
    ChordRegenerate,
    ChordCheckHouse,
    ChordRender,
    ChordSaveEdits,
    ChordCancel,
    ChordDice,
    ChordFrameRoom,
    ChordShowFinding,
)


def register() -> None:
    """Makes the classes known."""
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    """Stops what runs, and takes them back."""
    session.cancel()
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
