"""dataset keep: chosen houses -> one compact file that networks learn from."""

from __future__ import annotations

import argparse
from pathlib import Path

from chord_usd.base.runtime.counting import counted
from chord_usd.faces.commands.common import Outcome, Verbs, add_output, add_verb, stopwatch


def add(group: Verbs) -> None:
    """Adds the verb to those of dataset."""
    keep = add_verb(group, "keep", run_keep, "pack chosen houses into one file to learn from")
    keep.add_argument("houses", type=Path, metavar="HOUSES", help="folder of CHOrD JSON")
    add_output(keep, "the kept set, a .jsonl.gz; train --furnished reads it", suffixes=(".gz",))
    keep.add_argument(
        "--add", action="store_true", help="add to the kept set that lies there already"
    )


def run_keep(options: argparse.Namespace) -> Outcome:
    """Runs dataset keep."""
    from chord_usd.workshop.data.kept_set import KeptHouse, read_kept, write_kept
    from chord_usd.workshop.evaluation.cases import folder_cases

    with stopwatch(options).step("keep"):
        before = read_kept(options.output) if options.add else []
        cases = folder_cases(options.houses, "all")
        chosen = [
            KeptHouse(case.id, case.furnished) for case in cases.cases if case.furnished is not None
        ]
        count = write_kept([*before, *chosen], options.output)
    size = options.output.stat().st_size
    data = {
        "kept": str(options.output), "houses": count, "added": count - len(before), "bytes": size,
    }  # fmt: skip
    houses = counted(count, "house")
    text = f"{options.output}: {houses}, {count - len(before)} of them new, {size} bytes"
    return Outcome(text, data, warnings=cases.warnings)
