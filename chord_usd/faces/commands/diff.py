"""diff: two stages -> what changed, in words. Exit code 0 only if nothing did."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.faces.commands.common import Outcome, Verbs, add_verb, existing_file

if TYPE_CHECKING:
    from chord_usd.faces.commands.results import Changed


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "diff", run, "say what changed between two stages; exits 1 if any did")
    parser.add_argument("before", type=Path, metavar="BEFORE", help="a stage")
    parser.add_argument("after", type=Path, metavar="AFTER", help="the stage it became")


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.line.stage.read.diff import diff_stages

    changes = diff_stages(existing_file(options.before), existing_file(options.after))
    lines = [f"{change.path} {change.text}" for change in changes] or ["nothing changed"]
    data: Changed = {
        "same": not changes,
        "changes": [{"path": change.path, "text": change.text} for change in changes],
    }
    return Outcome("\n".join(lines), data, holds=not changes)
