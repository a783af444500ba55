"""redo: stage -> the stage with what was undone last."""

from __future__ import annotations

import argparse

from chord_usd.faces.commands.common import Outcome, Verbs
from chord_usd.faces.commands.history import add_house, put_back


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    add_house(verbs, "redo", run, "do again what undo took back last")


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.base.runtime.house_history import redo

    return put_back(options.stage, redo(options.stage), "done again")
