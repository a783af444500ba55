"""history: stage -> what was done to it; --to goes back to any of it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.faces.commands.common import Outcome, Parser, Run, Verbs, add_verb, whole_number

if TYPE_CHECKING:
    from chord_usd.base.runtime.house_history import Change, History


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_house(verbs, "history", run, "list what was done to a house, or go back to it")
    way = parser.add_mutually_exclusive_group()
    way.add_argument(
        "--amend",
        action="store_true",
        help="first take what was changed since the latest change as part of it",
    )
    way.add_argument(
        "--to",
        type=whole_number(1, 10**9),
        metavar="N",
        help="give the house the state after change N of the list",
    )


def add_house(verbs: Verbs, name: str, run: Run, summary: str) -> Parser:
    """A verb whose one argument is a house."""
    parser = add_verb(verbs, name, run, summary)
    parser.add_argument(
        "stage", type=Path, metavar="STAGE", help="house.usda or house.usdz, changed in its place"
    )
    return parser


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.base.runtime.house_history import amend, go_to, read_history
    from chord_usd.faces.commands.common import existing_file

    stage = existing_file(options.stage)
    if options.to is not None:
        return put_back(stage, go_to(stage, options.to), "now as after")
    history = amend(stage) if options.amend else read_history(stage)
    lines = [_line(change, history) for change in history.changes]
    text = "\n".join([f"{stage}:", *lines] if lines else [f"{stage}: no change is kept yet"])
    return Outcome(text, _data(stage, history))


def put_back(stage: Path, change: Change, done: str) -> Outcome:
    """What is said of a house that has another state now."""
    from chord_usd.base.runtime.house_history import read_history

    history = read_history(stage)
    text = f"{stage}: {done}: {change.summary}"
    return Outcome(text, {**_data(stage, history), "done": done, "change": change.number})


def _line(change: Change, history: History) -> str:
    here = ">" if change.number == history.number else " "
    branch = f" (after {change.parent})" if change.parent not in (None, change.number - 1) else ""
    return f"{here} {change.number:>3}  {change.made}  {change.summary}{branch}"


def _data(stage: Path, history: History) -> dict[str, Any]:
    return {
        "stage": str(stage),
        "number": history.number,
        "undo": history.before.number if history.before else None,
        "redo": history.undone.number if history.undone else None,
        "changes": [
            {"number": change.number, "parent": change.parent, "made": change.made,
             "verb": change.verb, "words": change.words}
            for change in history.changes
        ],
    }  # fmt: skip
