"""completion: a script that completes verbs and options in a shell."""

from __future__ import annotations

import argparse

from chord_usd.faces.commands.common import Outcome, Verbs, add_verb

SHELLS = ("bash", "zsh")


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "completion", run, "print a script that completes verbs and options")
    parser.add_argument("shell", choices=SHELLS, metavar="SHELL", help=", ".join(SHELLS))


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    import shtab

    script = shtab.complete(options.command_line(), shell=options.shell)
    return Outcome(script, {"shell": options.shell, "script": script})
