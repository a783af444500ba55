"""What could not be made, kept beside the houses until it is made: why, and the log of it.

A house that an earlier run made of another plan is still there; it is not what was asked for.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from chord_usd.base.runtime.files import write_atomic
from chord_usd.faces.batch.engine import Result
from chord_usd.faces.batch.work_units import Unit

FAILURES_FOLDER = "failures"


def note_failures(folder: Path, failures: Iterable[Result]) -> None:
    """Write failures/NAME.json for each. Raises OutputError."""
    for result in failures:
        unit = result.unit
        record = {
            "house": unit.name,
            "plan": unit.source,
            "seed": unit.seed,
            "why": result.why,
            "log": result.detail.splitlines(),
        }
        write_atomic(_file(folder, unit.name), json.dumps(record, indent=1) + "\n", asked=False)


def forget_failures(folder: Path, units: Iterable[Unit]) -> None:
    """Of units that are there now."""
    for unit in units:
        _file(folder, unit.name).unlink(missing_ok=True)


def failures_in(folder: Path) -> dict[str, dict[str, Any]]:
    """The failures of all runs that were not mended since, by the name of the house."""
    records = (_read(file) for file in sorted((folder / FAILURES_FOLDER).glob("*.json")))
    return {record["house"]: record for record in records if record}


def _read(file: Path) -> dict[str, Any] | None:
    try:
        record = json.loads(file.read_text())
    except (OSError, ValueError):
        return None
    return (
        record
        if isinstance(record, dict) and {"house", "plan", "seed", "why"} <= set(record)
        else None
    )


def _file(folder: Path, name: str) -> Path:
    return folder / FAILURES_FOLDER / f"{name}.json"
