"""Which network to train next: the one whose score misses its target by most."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

from chord_usd.base.errors import CheckpointError

TARGETS_FILE = "targets.tsv"
"""In the folder of checkpoints: a row a network, its score and target as shares in [0, 1]."""


@dataclass(frozen=True)
class Standing:
    """How far a network is."""

    network: str
    score: str
    """Name of the score, and over which cases."""
    value: float
    target: float
    command: str
    """What measures it, after chord-usd."""
    measured: str
    """Date, ISO."""

    @property
    def excess(self) -> float:
        """Errors made, over errors that the target leaves: 1 or less where it is met."""
        return (1.0 - self.value) / (1.0 - self.target)


def standings(folder: Path) -> list[Standing]:
    """The networks of TARGETS_FILE, farthest from its target first.

    Raises CheckpointError where the file is missing or a row of it is wrong.
    """
    path = folder / TARGETS_FILE
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = [_standing(row) for row in csv.DictReader(file, delimiter="\t")]
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise CheckpointError(
            f"no table of targets ({error})",
            where=str(path),
            expected="columns network, score, value, target, command, measured",
        ) from error
    return sorted(rows, key=lambda row: -row.excess)


def _standing(row: dict[str, str]) -> Standing:
    value, target = float(row["value"]), float(row["target"])
    if not (0.0 <= value <= 1.0 and 0.0 <= target < 1.0):
        raise ValueError(f"{row['network']}: shares are in [0, 1]")
    return Standing(row["network"], row["score"], value, target, row["command"], row["measured"])
