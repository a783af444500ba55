"""edit: stage and a sentence -> stage, changed as the sentence says."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.files import deliver
from chord_usd.base.runtime.inputs import STAGE_SUFFIXES
from chord_usd.faces.commands.certified import holds, reported
from chord_usd.faces.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_verb,
    add_view,
    existing_file,
    stopwatch,
)
from chord_usd.faces.commands.house_options import add_options
from chord_usd.faces.commands.paths import in_place_of, output_file, with_suffixes

if TYPE_CHECKING:
    from chord_usd.line.pipeline.edit_house import Reading


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "edit", run, "change a house as a sentence says, and nothing else")
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda or house.usdz")
    sentence = parser.add_argument(
        "sentence", metavar="SENTENCE", default="",
        help='the change in English: "put a plant in bedroom 1, no rug in the hall"',
    )  # fmt: skip
    sentence.required = False  # with --state; nargs="?" would end it before later options
    parser.add_argument(
        "--dry-run", action="store_true",
        help="only say what is understood and whether it can be done; change nothing",
    )  # fmt: skip
    parser.add_argument(
        "--force", action="store_true",
        help="do it also where the certificate would not hold, or a room lack what it needs",
    )  # fmt: skip
    parser.add_argument(
        "--storey", default="", metavar="NAME",
        help="which one is meant, by name or by number from 0, where a house has several and the "
        "sentence means something on more than one",
    )  # fmt: skip
    parser.add_argument(
        "--edits", type=Path, metavar="LAYER",
        help="a layer over STAGE that moves things: the sentence means the house as it is seen "
        "there, and the rooms that it changes are written so",
    )  # fmt: skip
    target = parser.add_argument(
        "-o", "--output", type=output_file, metavar="PATH", help="the new stage (STAGE itself)"
    )
    in_place_of(target, "STAGE")
    with_suffixes(target, STAGE_SUFFIXES)
    add_options(parser, "state", "asset_folders")
    add_view(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.base.scene.settings import Settings
    from chord_usd.line.pipeline.edit_house import edit
    from chord_usd.line.stage.check.check_stage import certificate

    if bool(options.sentence) == bool(options.state):
        raise UsageError("needs a sentence or a state", where="edit",
                         expected='SENTENCE, or --state "doors: closed"')  # fmt: skip
    source = existing_file(options.stage)
    if options.state:
        return _set_states(source, options.output or source, options)
    edits = existing_file(options.edits) if options.edits else None
    target = options.output or source
    watch = stopwatch(options)
    settings = Settings(style="", asset_folders=tuple(options.asset_folders))
    reading, done, report = edit(
        source, options.sentence, target, settings, watch, edits, options.storey,
        force=options.force, dry_run=options.dry_run,
    )  # fmt: skip
    is_written = reading.is_change and not options.dry_run
    if options.view and is_written:
        from chord_usd.line.stage.export.gltf import write_view

        with watch.step("view"), deliver() as delivery:
            write_view(target, delivery.place(options.view))
    check = certificate(report)
    data = {
        "stage": str(target), **_data(reading), "added": list(done.added),
        "removed": list(done.removed), "moved": list(done.moved),
        "notes": list(done.notes), "taken_over": list(done.taken_over), "states": [],
        "written": is_written,
        "seconds": watch.seconds, "certificate": check,
    }  # fmt: skip
    counts = ", ".join(
        f"{len(ids)} {change}"
        for change, ids in (("new", done.added), ("gone", done.removed), ("moved", done.moved))
        if ids
    )
    written = "nothing is written" if not is_written else counts or "done"
    written = "a dry run, nothing is written" if options.dry_run else written
    notes = [
        f"so that it can be done: {note}" if "instead" in note else note for note in done.notes
    ]
    text = reported(check, *_told(reading), *notes, f"{target}: {written}")
    return Outcome(text, data, holds(check))


def _set_states(source: Path, target: Path, options: argparse.Namespace) -> Outcome:
    """Gives doors and lamps the states of an option."""
    from chord_usd.line.pipeline.house_states import set_states
    from chord_usd.line.stage.check.check_stage import certificate, check_stage

    watch = stopwatch(options)
    with watch.step("stage"):
        stated = set_states(source, target, options.state, dry_run=options.dry_run)
    with watch.step("check"):
        check = certificate(check_stage(source if options.dry_run else target))
    data = {
        "stage": str(target), "understood": [], "answer": "", "read_as": [], "rooms": [],
        "added": [],
        "removed": [], "moved": [], "notes": [], "taken_over": [],
        "states": [{"subject": state.subject, "state": state.state, "paths": list(state.paths)}
                   for state in stated],
        "written": not options.dry_run, "seconds": watch.seconds, "certificate": check,
    }  # fmt: skip
    states = [f"{state.subject}: {state.state} ({len(state.paths)})" for state in stated]
    written = "a dry run, nothing is written" if options.dry_run else "done"
    return Outcome(reported(check, *states, f"{target}: {written}"), data, holds(check))


def _told(reading: Reading) -> list[str]:
    read_as = [f"read {slip}" for slip in reading.understood.read_as]
    return [*read_as, *reading.understood.told]


def _data(reading: Reading) -> dict[str, Any]:
    intents = reading.understood.intents
    return {
        "understood": [
            {
                "action": intent.action, "rooms": list(intent.rooms), "pieces": list(intent.items),
                "new": intent.new.category if intent.new and intent.action != "remove" else "",
                "count": intent.count, "relation": intent.relation, "to": list(intent.anchors),
                "style": intent.style, "coat": intent.coat.name if intent.coat else "",
                "surface": intent.surface, "told": intent.wording,
            }
            for intent in intents
        ],
        "answer": reading.understood.answer,
        "read_as": list(reading.understood.read_as),
        "rooms": list(reading.rooms),
    }  # fmt: skip
