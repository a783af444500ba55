"""edit: stage and a sentence -> stage, changed as the sentence says."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.commands.common import (
    Outcome,
    Verbs,
    add_assets,
    add_verb,
    existing_file,
    stopwatch,
)
from chord_usd.commands.paths import in_place_of, output_file

if TYPE_CHECKING:
    from chord_usd.pipeline.edit_house import Reading


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "edit", run, "change a house as a sentence says, and nothing else")
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda or house.usdz")
    parser.add_argument(
        "sentence", metavar="SENTENCE",
        help='what shall be changed: "turn the sofa to the window, no rug in the hall"',
    )  # fmt: skip
    parser.add_argument(
        "--dry-run", action="store_true", help="only say what is understood; change nothing"
    )
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
    add_assets(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.pipeline.edit_house import edit, read_sentence
    from chord_usd.pipeline.settings import Settings

    source = existing_file(options.stage)
    edits = existing_file(options.edits) if options.edits else None
    target = options.output or source
    watch = stopwatch(options)
    if options.dry_run:
        with watch.step("read"):
            reading = read_sentence(source, options.sentence, edits, options.storey)
        return Outcome("\n".join(_told(reading)), _data(reading))
    settings = Settings(style="", asset_folders=tuple(options.assets))
    reading, done = edit(
            source, options.sentence, target, settings, watch, edits, options.storey
        )  # fmt: skip
    data = {
        "stage": str(target), **_data(reading), "added": list(done.added),
        "removed": list(done.removed), "moved": list(done.moved),
        "taken_over": list(done.taken_over), "seconds": watch.seconds,
        "certificate": "holds in the rooms that were changed",
    }  # fmt: skip
    counts = ", ".join(
        f"{len(own)} {told}"
        for told, own in (("new", done.added), ("gone", done.removed), ("moved", done.moved))
        if own
    )
    lines = [*_told(reading), f"{target}: {counts or 'done'}; the certificate holds there"]
    return Outcome("\n".join(lines), data)


def _told(reading: Reading) -> list[str]:
    read_as = [f"read {slip}" for slip in reading.understood.read_as]
    return [*read_as, *reading.understood.told]


def _data(reading: Reading) -> dict[str, Any]:
    intents = reading.understood.intents
    return {
        "understood": [
            {
                "action": one.action, "rooms": list(one.rooms), "pieces": list(one.items),
                "new": one.new.category if one.new and one.action != "remove" else "",
                "count": one.count, "relation": one.relation, "to": list(one.anchors),
                "style": one.style, "told": one.told,
            }
            for one in intents
        ],
        "read_as": list(reading.understood.read_as),
        "rooms": list(reading.rooms),
    }  # fmt: skip
