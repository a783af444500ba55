"""train next: the network that is farthest from its target, trained on where its run stopped."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from chord_usd.base.runtime import console
from chord_usd.faces.commands.common import Outcome, UsageError, Verbs, add_verb, positive
from chord_usd.faces.commands.paths import output_run

_VERBS = {
    "detector_items": ("detector", "--kind", "items"),
    "detector_rooms": ("detector", "--kind", "rooms"),
    "things": ("lists", "--of", "things"),
}
"""Verbs of networks that are not named as their verb."""
_LEARN_FROM_FLATS = ("plan2layout", "lists", "reader", "bubbles", "text2plan", "outline2plan")
_PAINTERS = ("plan2layout", "table", "text2plan", "outline2plan")
_NO_START = ("bubbles",)


def add(group: Verbs) -> None:
    """Adds the verb to train."""
    verb = add_verb(
        group, "next", run_next, "train on the network that is farthest from its target"
    )
    verb.add_argument(
        "-o", "--output", type=output_run, default=Path("runs"), metavar="DIR",
        help="folder of runs, one a network (runs)",
    )  # fmt: skip
    verb.add_argument("--minutes", type=positive, default=30.0, metavar="N", help="budget (30)")
    verb.add_argument("--network", metavar="NAME", help="this one instead")
    verb.add_argument("--flats", type=Path, metavar="JSONL", help="real floor plans beside our own")
    verb.add_argument("--device", default="cpu", metavar="NAME", help="cpu or cuda (cpu)")
    verb.add_argument("--dry-run", action="store_true", help="print the command, train nothing")


def run_next(options: argparse.Namespace) -> Outcome:
    """Runs train next: replaces this process by that of the network's verb, at low priority."""
    from chord_usd.base.runtime.locations import shipped_checkpoints
    from chord_usd.workshop.training.next_network import standings

    folder = shipped_checkpoints()
    rows = {row.network: row for row in standings(folder)}
    name = options.network or next(iter(rows))
    if name not in rows:
        raise UsageError(
            f"unknown network {name!r}", where="--network", expected=f"one of {', '.join(rows)}"
        )
    row = rows[name]
    text = f"{name}: {row.score} {row.value:g}, target {row.target:g} (measured {row.measured})"
    arguments = _arguments(name, options, folder / name)
    command = ["chord-usd", *arguments]
    if options.dry_run:
        data = {"network": name, "excess": round(row.excess, 3), "command": command}
        return Outcome(f"{text}\n{' '.join(command)}", data)
    if options.is_guest:
        raise UsageError(
            "would replace the process that calls it", where="train next",
            expected="a process for this command line alone",
            try_="--dry-run, and the command that it prints",
        )  # fmt: skip
    from chord_usd.workshop.training import loop  # noqa: F401 (a missing extra is one line; nothing begins)

    console.stderr().write(text + "\n")
    # What this verb keeps from libraries, the next process needs.
    for number, stream in ((1, console.stdout()), (2, console.stderr())):
        stream.flush()
        os.dup2(stream.fileno(), number)
    os.nice(10)
    os.execv(sys.executable, [sys.executable, "-m", *_launcher(name, options.device), *arguments])


def _launcher(name: str, device: str) -> list[str]:
    """Module that runs the verb: torchrun with a process a core for pictures on a CPU."""
    from chord_usd.base.runtime.networks import usable_cores

    cores = usable_cores()
    if device != "cpu" or name not in _PAINTERS or cores == 1:
        return ["chord_usd"]
    return [
        "torch.distributed.run", "--standalone", f"--nproc-per-node={cores}",
        "-m", "--", "chord_usd",  # its own --start-method would take --start
    ]  # fmt: skip


def _arguments(name: str, options: argparse.Namespace, checkpoint: Path) -> list[str]:
    """The command line of the network's own verb."""
    arguments = ["train", *_VERBS.get(name, (name,)), "-o", str(options.output / name)]
    arguments += ["--minutes", f"{options.minutes:g}", "--device", options.device]
    if name not in _NO_START:
        arguments += ["--start", str(checkpoint)]
    if options.flats and name in _LEARN_FROM_FLATS:
        arguments += ["--flats", str(options.flats)]
    if name in _PAINTERS and options.device == "cpu":
        arguments += ["--workers", "0"]  # a process a core makes the data that it learns from
    return arguments
