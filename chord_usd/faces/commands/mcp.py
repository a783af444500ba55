"""mcp: the verbs as tools for agents, over the Model Context Protocol."""

from __future__ import annotations

import argparse
from pathlib import Path

from chord_usd.base.runtime.extras import needed_for
from chord_usd.faces.commands.common import Outcome, UsageError, Verbs, add_verb


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(
        verbs, "mcp", run, "serve houses below a folder to an agent, over standard input and output"
    )
    parser.add_argument(
        "--root", type=Path, required=True, metavar="DIR",
        help="the folder that agents may read and write in, and in no other",
    )  # fmt: skip


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb, until the agent hangs up. Standard output is the protocol's alone."""
    if not options.root.is_dir():
        raise UsageError("is no folder", where=str(options.root), expected="a folder for houses")
    with needed_for("chord-usd mcp"):
        from chord_usd.faces.commands.agent_tools import serve
    serve(options.root)
    return Outcome(None)
