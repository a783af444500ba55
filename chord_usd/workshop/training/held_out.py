"""Scores of the averaged network on held-out data while it trains, and their curve as a picture."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from chord_usd.workshop.training.budget import Budget

LOG_FILE = "held_out.jsonl"
CURVE_FILE = "curve.png"
EVERY_MINUTES = 1.0
_MOST_SHARE = 0.05
"""Of a run that scoring may take: costly scores come less often."""
_FLAT_SHARE = 1.0 / 3.0
"""Last share of a run whose slope says whether more training would help."""


class HeldOut:
    """Scores taken during a run, a line each in LOG_FILE: step, minutes, and the scores by name."""

    def __init__(self, folder: Path, score: Callable[[], Mapping[str, Any]]) -> None:
        """score: of the averaged network; numbers among its values, also one level down, count."""
        self.path = folder / LOG_FILE
        self.score = score
        self.every_minutes = EVERY_MINUTES

    def take_if_due(self, budget: Budget, step: int, minutes_before: float) -> None:
        """Score once the time since the last score is over."""
        if budget.is_due("held out", self.every_minutes):
            self.take(step, minutes_before + budget.spent)

    def take(self, step: int, minutes: float) -> Mapping[str, Any]:
        """Score now, and return what score returned."""
        begun = time.monotonic()
        facts = self.score()
        took_minutes = (time.monotonic() - begun) / 60.0
        self.every_minutes = max(EVERY_MINUTES, took_minutes / _MOST_SHARE)
        row = {"step": step, "minutes": round(minutes, 2), **_numbers(facts)}
        with self.path.open("a", encoding="utf-8") as log:
            log.write(json.dumps(row) + "\n")
        return facts


def _numbers(facts: Mapping[str, Any]) -> dict[str, float]:
    """Those values that are numbers and not counts, also of mappings one level down."""
    values: dict[str, float] = {}
    for name, value in facts.items():
        if isinstance(value, Mapping):
            values |= _numbers(value)
        elif isinstance(value, float):
            values[name] = value
    return values


def curve_of(folder: Path) -> list[dict[str, float]]:
    """The scores of a run so far, oldest first; lines that a cut left incomplete are skipped."""
    path = folder / LOG_FILE
    if not path.is_file():
        return []
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return rows


def slope_left(rows: list[dict[str, float]], name: str) -> float | None:
    """Change of a score over the last third of a run, relative to its change since the start.

    Near 0: training longer would change little. None for fewer than four scores.
    """
    values = [row[name] for row in rows if name in row]
    if len(values) < 4:
        return None
    tail = values[-max(2, round(len(values) * _FLAT_SHARE)) :]
    whole = abs(values[-1] - values[0])
    return abs(tail[-1] - tail[0]) / whole if whole else 0.0


def draw_curve(rows: list[dict[str, float]], target: Path) -> bool:
    """Draw the scores over minutes as a small PNG; False for fewer than two scores."""
    if len(rows) < 2:
        return False
    from matplotlib.figure import Figure

    names = sorted(set().union(*rows) - {"step", "minutes"})
    figure = Figure(figsize=(4.0, 2.4), dpi=80, layout="constrained")
    axes = figure.subplots()
    for name in names:
        points = [(row["minutes"], row[name]) for row in rows if name in row]
        axes.plot(*zip(*points, strict=True), label=name, linewidth=1.0)
    axes.set_xlabel("minutes")
    axes.legend(fontsize=6, frameon=False)
    figure.savefig(target, metadata={"Software": None})
    return True
