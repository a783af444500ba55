"""describe: stage -> what it holds and what can be chosen."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.files import deliver
from chord_usd.faces.commands.common import Outcome, Verbs, add_verb, existing_file, stopwatch
from chord_usd.faces.commands.paths import output_file

if TYPE_CHECKING:
    from chord_usd.line.stage.read.describe import Looks, Piece, RoomContents


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "describe", run, "list a stage's rooms, pieces and choosable looks")
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda or house.usdz")
    parser.add_argument(
        "--preview", type=output_file, metavar="PNG",
        help="also draw the house from above, labelled",
    )  # fmt: skip


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.line.stage.read.describe import describe_stage

    with stopwatch(options).step("describe"), deliver() as delivery:
        contents = describe_stage(existing_file(options.stage))
        if options.preview:
            from chord_usd.line.image.preview import draw_storeys
            from chord_usd.line.stage.export.exchange.built_house import read_built

            storeys = [house.drawn_graph for house in read_built(options.stage)]
            draw_storeys(storeys, delivery.place(options.preview))
    lines = [f"{options.stage}: {counted(len(contents.rooms), 'room')}{_choices(contents.looks)}"]
    for room in contents.rooms:
        lines += _room_lines(room)
    return Outcome("\n".join(lines), {"stage": str(options.stage), **asdict(contents)})


def _room_lines(room: RoomContents) -> list[str]:
    lines = [f"  {room.name}{_choices(room.looks)}"]
    lines += [_piece_line(piece) for piece in room.furniture]
    return lines + [_piece_line(piece, "  ") for piece in room.dressing]


def _piece_line(piece: Piece, indent: str = "") -> str:
    name = piece.path.split("/")[-1]
    return f"    {indent}{name:<24} {piece.asset}{_choices(piece.looks)}"


def _choices(looks: Looks) -> str:
    """What is chosen, of how many."""
    choices = [
        f"{name} {choice.chosen or 'none'} (of {len(choice.offered)})"
        for name, choice in looks.items()
    ]
    return f": {', '.join(choices)}" if choices else ""
