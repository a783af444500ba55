"""Scores of planned floors, kept as they are measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from chord_usd.base.runtime.progress import Progress
from chord_usd.workshop.evaluation.floors import (
    FloorCase,
    FloorFacts,
    FloorResult,
    Planner,
    measure,
)
from chord_usd.workshop.evaluation.records_file import add_record, read_records

Key = tuple[str, str]
"""Which networks planned, with which seed; and the case."""


def measure_all(
    cases: Sequence[FloorCase],
    planner: Planner,
    networks: str,
    records: Path | None,
    progress: Progress | None = None,
) -> list[FloorResult]:
    """Every case, planned; those not planned again that these networks are on record with.

    networks: identifies the networks and their settings; records: a file that need not
    exist, None keeps nothing. Raises OutputError for a file of something else.
    """
    kept = dict(read_records(records, _entry, "a planned floor", "evaluate")) if records else {}
    results = []
    for index, case in enumerate(cases):
        result = kept.get((networks, case.id))
        if result is None:
            result = measure(case, planner)
            if records:
                add_record(records, {"networks": networks, "case": case.id, **asdict(result)})
        results.append(result)
        if progress:
            progress(index + 1, len(cases))
    return results


def _entry(values: dict[str, Any]) -> tuple[Key, FloorResult]:
    key = str(values["networks"]), str(values["case"])
    chosen, first = _facts(values["chosen"]), _facts(values["first"])
    return key, FloorResult(chosen, first, int(values["tried"]))


def _facts(values: dict[str, Any]) -> FloorFacts:
    lists = {name: tuple(values[name]) for name in ("missed", "faults", "lit")}
    return FloorFacts(**{**values, **lists})
