"""dataset keep: chosen houses -> one compact file that networks learn from."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.runtime.counting import counted
from chord_usd.faces.commands.common import (
    Outcome,
    Verbs,
    add_output,
    add_verb,
    share,
    stopwatch,
)

if TYPE_CHECKING:
    from chord_usd.workshop.data.kept_set import KeptHouse


def add(group: Verbs) -> None:
    """Adds the verb to dataset."""
    keep = add_verb(group, "keep", run_keep, "pack chosen houses into one file to learn from")
    keep.add_argument(
        "houses", type=Path, metavar="HOUSES", help="folder of CHOrD JSON, or a kept set"
    )
    add_output(keep, "the kept set, a .jsonl.gz; train --furnished reads it", suffixes=(".gz",))
    keep.add_argument(
        "--add", action="store_true", help="add to the kept set that lies there already"
    )
    keep.add_argument(
        "--repair", action="store_true", help="add what rooms and homes lack by planning rules"
    )
    keep.add_argument(
        "--best", type=share, default=1.0, metavar="SHARE",
        help="keep this share of the houses, those that break the fewest planning rules (1)",
    )  # fmt: skip


def run_keep(options: argparse.Namespace) -> Outcome:
    """Runs dataset keep."""
    from chord_usd.line.pipeline import arrange_given
    from chord_usd.workshop.data.kept_set import best_of, read_kept, write_kept
    from chord_usd.workshop.data.searched import repaired

    with stopwatch(options).step("keep") as progress:
        before = read_kept(options.output) if options.add else []
        chosen, warnings = _given(options.houses)
        if options.repair:
            for at, kept in enumerate(chosen):
                chosen[at] = replace(kept, house=repaired(kept.house, arrange_given))
                progress(at + 1, len(chosen))
        count = write_kept([*before, *best_of(chosen, options.best)], options.output)
    size = options.output.stat().st_size
    data = {
        "kept": str(options.output), "houses": count, "added": count - len(before), "bytes": size,
    }  # fmt: skip
    houses = counted(count, "house")
    text = f"{options.output}: {houses}, {count - len(before)} of them new, {size} bytes"
    return Outcome(text, data, warnings=warnings)


def _given(houses: Path) -> tuple[list[KeptHouse], list[str]]:
    """The furnished houses of a folder or a kept set, and what could not be read."""
    from chord_usd.workshop.data.kept_set import KeptHouse, read_kept
    from chord_usd.workshop.evaluation.cases import folder_cases

    if houses.is_file():
        return read_kept(houses), []
    cases = folder_cases(houses, "all")
    kept = [KeptHouse(case.id, case.furnished) for case in cases.cases if case.furnished]
    return kept, list(cases.warnings)
