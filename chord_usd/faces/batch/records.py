"""What a finished house and its pictures say of themselves: how they were made, and their hashes.

A record is the resume state. It is written with what it speaks of, so a house without one, or
whose files are not those it lists, is not finished. Two runs write the same bytes: what a house
cost stands in costs.json, which no hash covers.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from chord_usd.base.runtime.files import hash_file, write_atomic
from chord_usd.base.runtime.targets import MANIFEST_FILE

HOUSE_RECORD = "house.json"
PICTURES_RECORD = "pictures.json"
PICTURES_FOLDER = "pictures"
COSTS_FILE = "costs.json"


@dataclass(frozen=True)
class Record:
    """What house.json and pictures.json hold."""

    recipe: Mapping[str, Any]
    """All that decides the bytes."""
    files: Mapping[str, str]
    """SHA-256 of each file, by its path in the house's folder."""
    told: Mapping[str, Any] = field(default_factory=dict)
    """What is worth knowing of them; it decides nothing."""


class Digests:
    """SHA-256 of files; those that many houses share are read once."""

    def __init__(self) -> None:
        self._known: dict[tuple[int, ...], str] = {}

    def of(self, path: Path) -> str:
        """Raises OSError where the file cannot be read."""
        stat = path.stat()
        key = (stat.st_dev, stat.st_ino, stat.st_size, stat.st_mtime_ns)
        if key not in self._known:
            self._known[key] = hash_file(path)
        return self._known[key]


def files_in(folder: Path) -> list[Path]:
    """All files below a folder, by name, without manifests, which grow, and without costs."""
    left_out = (MANIFEST_FILE, COSTS_FILE)
    files = (path for path in folder.rglob("*") if path.name not in left_out)
    return sorted(path for path in files if path.is_file())


def hashes_of(files: Iterable[Path], folder: Path) -> dict[str, str]:
    """For a record: hashes of files by their paths in a house's folder."""
    return {file.relative_to(folder).as_posix(): hash_file(file) for file in files}


def write_record(record: Record, path: Path) -> None:
    """Raises OutputError."""
    write_atomic(path, json.dumps(asdict(record), indent=1) + "\n", asked=False)


def write_costs(house: Path, of: str, seconds: Mapping[str, float], cpu_s: float) -> None:
    """Note what a house or its pictures cost.

    of: "house" or "pictures". seconds: of each step, by the clock. cpu_s: of processors. Raises
    OutputError.
    """
    costs = {**read_costs(house), of: {"seconds": seconds, "cpu_s": round(cpu_s, 3)}}
    write_atomic(house / COSTS_FILE, json.dumps(costs, indent=1) + "\n", asked=False)


def read_costs(house: Path) -> dict[str, Any]:
    """What write_costs noted; empty where nothing is noted or the file is damaged."""
    try:
        costs = json.loads((house / COSTS_FILE).read_text())
    except (OSError, ValueError):
        return {}
    return costs if isinstance(costs, dict) else {}


def read_record(path: Path) -> Record | None:
    """None where there is none, or a damaged one."""
    try:
        return Record(**json.loads(path.read_text()))
    except (OSError, ValueError, TypeError):
        return None


def finished(path: Path, recipe: Mapping[str, Any], digests: Digests) -> Record | None:
    """The record in a file, if it is of this recipe and all its files are there unchanged."""
    record = read_record(path)
    if record is None or record.recipe != json.loads(json.dumps(recipe)):
        return None
    try:
        whole = all(
            digests.of(path.parent / name) == digest for name, digest in record.files.items()
        )
    except OSError:
        return None
    return record if whole else None
