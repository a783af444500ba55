"""undo: stage -> the stage before its latest change."""

from __future__ import annotations

import argparse

from chord_usd.faces.commands.common import Outcome, Verbs
from chord_usd.faces.commands.history import add_house, put_back


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    add_house(verbs, "undo", run, "take back the latest change of a house, byte for byte")


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.base.runtime.house_history import undo

    return put_back(options.stage, undo(options.stage), "undone")
