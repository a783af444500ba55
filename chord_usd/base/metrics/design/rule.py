"""What a planning rule is: a published number, where it is asked, and how it is measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from chord_usd.base.metrics.design.view import HomeView, Point, View
from chord_usd.base.scene.types import RoomKind

Seen = TypeVar("Seen", View, HomeView)
RuleKind = RoomKind | Literal["dining table", "home"]
"""What rules are asked of."""
Unit = Literal["m", "count", "deg", "share", "m2"]

ROUNDING = {"m": 0.02, "count": 0.0, "deg": 0.5, "share": 0.0, "m2": 0.5}
"""By unit, what a measured value may miss: pieces are painted and snapped to about so much."""
FINE_M = 0.005
"""The same of rows of units, whose widths are exact."""


@dataclass(frozen=True)
class Measured:
    """One value of a rule."""

    have: float
    at: Point
    """In the world, metres."""
    items: tuple[str, ...] = ()
    """Ids of the pieces that it is about."""


@dataclass(frozen=True)
class Rule(Generic[Seen]):
    """A row of the table."""

    name: str
    need: float
    unit: Unit
    source: str
    measure: Callable[[Seen], Iterable[Measured]]
    """Nothing where the rule is not asked, else a value for each place where it is."""
    at_most: bool = False
    """Whether need is the largest value allowed, not the least."""
    weight: float = 1.0
    """Beside the other rules of the room."""
    from_m2: float = 0.0
    below_m2: float = float("inf")
    """Rooms of an area from the one to below the other are asked."""
    is_fine: bool = False
    """Whether a length may miss FINE_M only."""

    def keeps(self, have: float) -> bool:
        """Whether a value keeps the number."""
        rest = FINE_M if self.is_fine else ROUNDING[self.unit]
        return have <= self.need + rest if self.at_most else have >= self.need - rest


@dataclass(frozen=True)
class Finding:
    """A value that does not keep its rule."""

    rule: str
    source: str
    unit: Unit
    need: float
    have: float
    at: Point
    items: tuple[str, ...]

    @property
    def missed(self) -> float:
        """By how much it misses the number."""
        return abs(self.have - self.need)

    def as_json(self) -> dict[str, Any]:
        """As reports give it: lengths under keys that name metres, None for endless ones and under
        these keys for other units."""
        need, have = (round(each, 3) if math.isfinite(each) else None
                      for each in (self.need, self.have))  # fmt: skip
        if self.unit == "m":
            values = {"need_m": need, "have_m": have}
        else:
            values = {"need_m": None, "have_m": None, "need": need, "have": have}
        return {
            "rule": self.rule, "source": self.source, "unit": self.unit, **values,
            "at": [round(each, 3) for each in self.at], "items": list(self.items),
        }  # fmt: skip

    @property
    def said(self) -> str:
        """In words, lengths in whole centimetres."""
        return f"{self.rule}: {_value(self.have, self.unit)}, not {_value(self.need, self.unit)}"


def _value(value: float, unit: Unit) -> str:
    if value == float("inf"):
        return "none"
    if unit == "m":
        return f"{value * 100:.0f} cm"
    if unit == "deg":
        return f"{value:.0f} degrees"
    if unit == "m2":
        return f"{value:.1f} m2"
    return f"{value:.0%}" if unit == "share" else f"{value:g}"


@dataclass(frozen=True)
class Judged:
    """What one room, table or home keeps."""

    place: str
    """Id of the room; empty for the home."""
    kind: RuleKind
    kept: tuple[str, ...]
    """Names of rules."""
    findings: tuple[Finding, ...]
    won: float
    """Weights of the rules that are kept."""
    weight: float
    """Weights of all rules that were asked."""

    @property
    def asked(self) -> int:
        """How many rules were asked."""
        return len(self.kept) + len({finding.rule for finding in self.findings})

    def as_json(self) -> dict[str, Any]:
        """As reports give it."""
        return {
            "path": self.place, "kind": self.kind, "rules_kept": len(self.kept),
            "rules": self.asked, "findings": [finding.as_json() for finding in self.findings],
        }  # fmt: skip

    @property
    def share(self) -> float:
        """Weights of rules kept / of rules asked, [0, 1]; 1 where none was asked."""
        return self.won / self.weight if self.weight else 1.0


def judge(
    rules: Iterable[Rule[Seen]],
    seen: Seen,
    place: str,
    kind: RuleKind,
    area_m2: float,
) -> Judged:
    """A room or home by these rules."""
    kept, findings, won, asked = [], [], 0.0, 0.0
    for rule, values in _asked(rules, seen, area_m2):
        broken = [value for value in values if not rule.keeps(value.have)]
        asked += rule.weight
        if broken:
            findings += [
                Finding(
                    rule.name, rule.source, rule.unit, rule.need, value.have, value.at, value.items
                )
                for value in broken
            ]
        else:
            won += rule.weight
            kept.append(rule.name)
    return Judged(place, kind, tuple(kept), tuple(findings), won, asked)


def broken_weight(
    rules: Iterable[Rule[Seen]], seen: Seen, area_m2: float, most: float = math.inf
) -> tuple[float, float]:
    """Weights of the rules that are broken, and of those that are asked, as judge counts them.

    most: no rule is asked any more once this much is broken.
    """
    broken, asked = 0.0, 0.0
    for rule, values in _asked(rules, seen, area_m2):
        asked += rule.weight
        broken += rule.weight * (not all(rule.keeps(value.have) for value in values))
        if broken > most:
            break
    return broken, asked


def _asked(
    rules: Iterable[Rule[Seen]], seen: Seen, area_m2: float
) -> Iterator[tuple[Rule[Seen], list[Measured]]]:
    """The rules that are asked, with all that they measure."""
    for rule in rules:
        if rule.from_m2 <= area_m2 < rule.below_m2 and (values := list(rule.measure(seen))):
            yield rule, values


def flag(is_broken: bool, at: Point, *items: str) -> Measured:
    """A value of a rule that is kept or not: how many things are wrong, at most 0."""
    return Measured(float(is_broken), at, items)
