"""Scores of drawn plans, a JSON line each: a long measurement goes on where it was stopped."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from chord_usd.errors import OutputError
from chord_usd.evaluation.plans import PlanScore


class Records:
    """A file of scores, of drawings known by seed, number and style."""

    def __init__(self, path: Path | None, seed: int, families: Sequence[str]) -> None:
        """path: need not exist; None keeps nothing. Raises OutputError for any other file."""
        self._path, self._seed, self._families = path, seed, families
        self.scores: dict[int, PlanScore] = dict(self._kept(path)) if path else {}
        """By the drawing's number; those of other seeds and styles are passed over."""

    def keep(self, number: int, score: PlanScore) -> None:
        """Add a score, at once."""
        self.scores[number] = score
        if self._path is None:
            return
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"seed": self._seed, "number": number, **asdict(score)}) + "\n")

    def _kept(self, path: Path) -> list[tuple[int, PlanScore]]:
        found = []
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        whole = text[: text.rfind("\n") + 1]
        if whole != text:
            # A run that was stopped may have left half a line.
            path.write_text(whole, encoding="utf-8")
        for place, line in enumerate(whole.splitlines(), 1):
            try:
                entry = json.loads(line)
                seed, number = int(entry.pop("seed")), int(entry.pop("number"))
                score = PlanScore(**entry)
            except (AttributeError, KeyError, TypeError, ValueError) as error:
                raise OutputError(
                    "is no score of a drawn plan",
                    where=f"{path}: line {place}",
                    expected="the file that evaluate plans --records wrote",
                    try_="delete this line",
                ) from error
            if (seed, score.family) == (self._seed, self._families[number % len(self._families)]):
                found.append((number, score))
        return found
