"""Scores of drawn plans, a JSON line each: a long measurement goes on where it was stopped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from chord_usd.workshop.evaluation.plans import PlanScore
from chord_usd.workshop.evaluation.records_file import add_record, read_records


class Records:
    """A file of scores, of drawings known by seed, number and style."""

    def __init__(self, path: Path | None, seed: int, families: Sequence[str]) -> None:
        """path: need not exist; None keeps nothing. Raises OutputError for any other file."""
        self._path, self._seed, self._families = path, seed, families
        self.scores: dict[int, PlanScore] = dict(self._kept(path)) if path else {}
        """By the drawing's number; records of other seeds and styles are skipped."""

    def keep(self, number: int, score: PlanScore) -> None:
        """Add a score, at once."""
        self.scores[number] = score
        if self._path is None:
            return
        add_record(self._path, {"seed": self._seed, "number": number, **asdict(score)})

    def _kept(self, path: Path) -> list[tuple[int, PlanScore]]:
        records = []
        for seed, number, score in read_records(path, _entry, "a drawn plan", "evaluate plans"):
            if (seed, score.family) == (self._seed, self._families[number % len(self._families)]):
                records.append((number, score))
        return records


def _entry(values: dict[str, Any]) -> tuple[int, int, PlanScore]:
    seed, number = int(values.pop("seed")), int(values.pop("number"))
    return seed, number, PlanScore(**values)
