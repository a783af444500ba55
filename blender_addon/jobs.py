"""Jobs of the program, and what the panel does with their answers."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import bpy

from .core import commands, report
from .core.commands import describe, found_house
from .core.edits import Changes, carried_over, without_pieces, without_room
from .core.errors import InputError
from .core.layer import read_changes, write_changes
from .core.program import HAS_HISTORY, ProgramError
from .core.revisions import keep, put_back
from .house import changes_of, is_shown
from .importer import import_house
from .preferences import preferences
from .properties import fields
from .session import Finish, session


class JobOperator:
    """Starts a job; the panel reports missing input."""

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Collects the command line, and starts."""
        props = fields(context)
        if session.is_running:
            self.report({"ERROR"}, "A job is running; cancel it or wait.")
            return {"CANCELLED"}
        try:
            arguments, finish = self.job(context)
            session.start(context, arguments, finish)
        except (InputError, ProgramError, OSError) as error:
            session.claims.drop_empty()
            props.error = str(error)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line and what follows it. Raises InputError for what is missing."""
        raise NotImplementedError


def house_path(context: bpy.types.Context) -> Path:
    """The house of this scene. Raises InputError."""
    house = session.place_of(fields(context).house)
    return found_house(bpy.path.abspath(house), bpy.data.filepath)


def unsaved_folder() -> Path:
    """Houses of a Blender file without a name; Blender empties it when it ends."""
    return Path(bpy.app.tempdir or tempfile.gettempdir())


def claim(house: Path) -> None:
    """Keep other Blenders from a house. Raises InputError where one of them works on it."""
    if not session.claims.take(house.parent):
        raise InputError("Another Blender works on this house. Close it there first.")


@dataclass(frozen=True)
class Seen:
    """The house of a scene, as it was when a job began."""

    house: Path
    revision: str
    """Empty where the scene did not show it."""
    changes: Changes


def save_changes(context: bpy.types.Context) -> Seen:
    """Write the layer of changes, so that the program sees what the artist sees.

    After undo the scene shows an earlier state of the house; that is put back first. Raises
    InputError where another Blender has the house or something else has changed it, OSError.
    """
    house = house_path(context)
    claim(house)
    if not is_shown(context):
        return Seen(house, "", read_changes(house))
    seen = Seen(house, fields(context).revision, changes_of(context))
    put_back(house, seen.revision)
    write_changes(house, seen.changes)
    return seen


def bring_in(
    house: Path,
    made: dict[str, Any] | None = None,
    before: Seen | None = None,
    new_room: str = "",
) -> tuple[list[str], Finish]:
    """The job that lists what a house holds, and the import that follows it.

    made: the report of the program that made it, or furnished a room of it again.
    before: the house as it is in the scene now, where it is this one; what the artist does in the
    meantime is carried over, except in a room that is new. Raises InputError where there is no
    such file.
    """
    return describe(house), partial(_show_house, house, made or {}, before, new_room)


def rebuild(before: Seen, after: Changes) -> tuple[list[str], Finish]:
    """The same with other changes, which are saved; before: as save_changes returns it.

    Raises InputError, OSError.
    """
    write_changes(before.house, after)
    return bring_in(before.house, before=before)


def show_new_house(context: bpy.types.Context, data: dict[str, Any]) -> None:
    """A new house, in a folder of its own: changes to the one before stay with that."""
    session.start(context, *bring_in(Path(str(data["stage"])), data))


def show_room(seen: Seen, context: bpy.types.Context, data: dict[str, Any]) -> None:
    """A room was furnished again: there, only locked pieces keep their changes."""
    room = str(data["room"])
    _show_written(seen, context, lambda changes: without_room(changes, room), data, room)


def show_understood(sentence: str, context: bpy.types.Context, data: dict[str, Any]) -> None:
    """What a sentence means, before it is done."""
    props = fields(context)
    props.understood, props.understood_of = "\n".join(report.understood(data)), sentence


def show_edited(seen: Seen, context: bpy.types.Context, data: dict[str, Any]) -> None:
    """A sentence was done: pieces in its rooms are where the house itself has them."""
    taken_over = [str(path) for path in data["taken_over"]]
    props = fields(context)
    props.sentence = props.understood = props.understood_of = ""
    _show_written(seen, context, lambda changes: without_pieces(changes, taken_over))


def show_certificate(context: bpy.types.Context, data: dict[str, Any]) -> None:
    """Fill the list of findings."""
    props = fields(context)
    props.certificate = report.headline(data)
    props.findings.clear()
    for is_planning, part in ((False, report.findings(data)), (True, report.planning(data))):
        for finding in part:
            line = props.findings.add()
            line.name, line.paths = finding.text, "\n".join(finding.paths)
            line.is_planning = is_planning


def keeps_past(context: bpy.types.Context) -> bool:
    """Whether the program keeps the history of houses."""
    program = session.known_program(preferences(context).program)
    return bool(program and HAS_HISTORY in program.abilities)


def read_past(context: bpy.types.Context, house: Path) -> None:
    """Start the job that lists what was done to a house, where the program keeps that."""
    if keeps_past(context):
        session.start(context, commands.past("history", house), show_past)


def show_past(context: bpy.types.Context, data: dict[str, Any]) -> None:
    """Fill the list of changes."""
    props = fields(context)
    props.past.clear()
    for index, (number, text) in enumerate(report.past(data)):
        line = props.past.add()
        line.number, line.name = number, text
        if number == data["number"]:
            props.past_index = index
    props.can_redo = data["redo"] is not None


def show_earlier(seen: Seen, context: bpy.types.Context, _data: dict[str, Any]) -> None:
    """The house has another state of its history, its layer of changes included."""
    props = fields(context)
    props.certificate = ""
    props.findings.clear()
    _show_written(seen, context)


def show_pictures(context: bpy.types.Context, data: dict[str, Any]) -> None:
    """Open the pictures where Blender's image editor lists them."""
    props, pictures = fields(context), list(map(str, data.get("pictures", ())))
    for picture in pictures:
        bpy.data.images.load(picture, check_existing=True).reload()
    props.note = f"{len(pictures)} pictures in {bpy.path.abspath(props.render_folder)}"


def show_farm_job(context: bpy.types.Context, data: dict[str, Any]) -> None:
    """Say where the bundle is."""
    fields(context).note = f"{data['tasks']} tasks in {data['template']}"


def _show_written(
    seen: Seen,
    context: bpy.types.Context,
    still_meant: Callable[[Changes], Changes] | None = None,
    made: dict[str, Any] | None = None,
    new_room: str = "",
) -> None:
    """Bring in a house that the program has written, with those changes that still mean something.

    made, new_room: as bring_in has them. Without still_meant, its layer of changes is written, too.
    """
    keep(seen.house)
    before = seen
    if still_meant:
        # The artist may have gone on meanwhile.
        before = replace(seen, changes=_changes_now(context, seen) or seen.changes)
        write_changes(seen.house, still_meant(before.changes))
    listed, finish = bring_in(seen.house, made, before, new_room)
    if still_meant and keeps_past(context):
        # The layer has followed what the program did: one change, not two.
        amended = commands.past("history", seen.house, amend=True)
        session.start(context, amended, lambda then, _: session.start(then, listed, finish))
    else:
        session.start(context, listed, finish)


def _show_house(
    house: Path,
    made: dict[str, Any],
    before: Seen | None,
    new_room: str,
    context: bpy.types.Context,
    contents: dict[str, Any],
) -> None:
    now = _changes_now(context, before) if before else None
    if before and now is not None:
        merged = carried_over(read_changes(house), before.changes, now)
        write_changes(house, without_room(merged, new_room) if new_room else merged)
    if before is None:
        _save_last(context, house)
    import_house(context, house)
    props = fields(context)
    props.house, props.contents = str(house), json.dumps(contents)
    props.swap_path = props.swap_models = ""
    if before is None:  # another house, not this one changed
        props.planned = "\n".join(report.planned(made))
        props.warnings = "\n".join(report.warnings(made))
    if made.get("certificate"):
        show_certificate(context, made["certificate"])
    read_past(context, house)


def _save_last(context: bpy.types.Context, house: Path) -> None:
    """Save the edits of the house that makes room for another, where they can be."""
    with suppress(InputError, OSError):
        if is_shown(context) and house_path(context) != house:
            save_changes(context)


def _changes_now(context: bpy.types.Context, seen: Seen) -> Changes | None:
    """The changes in the scene; None where that has come to show something else, as after undo."""
    is_same = is_shown(context) and fields(context).revision == seen.revision
    return changes_of(context) if is_same else None
