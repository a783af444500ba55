"""Published standards as tables of clauses: what a home is planned to, and what nobody checked.

A row of standards/*.tsv names a measure, its number and the text that was read. A clause without a
number is "not checked". The report is a planner's, no certificate.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

from chord_usd.base.errors import ChordError
from chord_usd.base.metrics.design import EVERY_ROOM, ROOM_RULES, access, dining_rules
from chord_usd.base.metrics.design.price import CLAUSES
from chord_usd.base.metrics.design.rule import Finding, Measured, Rule, Unit, judge
from chord_usd.base.metrics.design.view import HomeView, View, view_home
from chord_usd.base.scene.types import WET_KINDS, SceneGraph

FOLDER = Path(__file__).parent / "standards"

HOME, TABLE = "home", "dining table"
"""Kinds of clauses that no kind of room is."""

OF_PLAN: Mapping[str, Callable[[View], Iterable[Measured]]] = {
    "door width": access.door_width,
    "door height": access.door_height,
    "way width": access.way_width,
    "turning circle": access.turning_circle,
    "turning square": access.turning_square,
}
"""Measures that an empty room already limits."""

OF_ROOM: Mapping[str, Callable[[View], Iterable[Measured]]] = {
    **{rule.name: rule.measure for rules in (*ROOM_RULES.values(), EVERY_ROOM, dining_rules.RULES)
       for rule in rules},
    **OF_PLAN,
    "beside the bed, lesser side": access.beside_bed(0),
    "beside the bed, greater side": access.beside_bed(1),
    "before furniture": access.before_furniture,
    "beside the toilet, lesser side": access.beside_toilet(0),
    "beside the toilet, greater side": access.beside_toilet(1),
    "height of the basin": access.basin_height,
}  # fmt: skip
OF_HOME: Mapping[str, Callable[[HomeView], Iterable[Measured]]] = {
    "entrance door width": access.entrance_width,
}


@dataclass(frozen=True)
class Clause:
    """A row of a standard."""

    name: str
    kinds: tuple[str, ...]
    measure: str
    """Key of OF_ROOM or OF_HOME; empty where nothing is checked."""
    need: float
    unit: Unit
    at_most: bool
    text: str
    source: str

    @property
    def rule(self) -> Rule[Any]:
        """The clause as a row of the planning table."""
        measure = OF_HOME[self.measure] if HOME in self.kinds else OF_ROOM[self.measure]
        return Rule(self.text, self.need, self.unit, self.source, measure, at_most=self.at_most)

    def contradicts(self, other: Clause) -> bool:
        """Whether no value keeps both."""
        if self.measure != other.measure or not {*self.kinds} & {*other.kinds}:
            return False
        least = [each.need for each in (self, other) if not each.at_most]
        most = [each.need for each in (self, other) if each.at_most]
        return bool(self.measure and least and most and least[0] > most[0])


@dataclass(frozen=True)
class Standard:
    """A table of clauses."""

    name: str
    title: str
    clauses: tuple[Clause, ...]


NAMES: Mapping[str, str] = {
    "NKBA": "nkba", "DIN 18040-2": "din_18040_2", "DIN 18040-2 R": "din_18040_2_r", "M4(3)": "m4_3",
}  # fmt: skip
"""Files by the names of standards."""


def standards_named(names: Iterable[str]) -> tuple[Standard, ...]:
    """Standards by their names, each once. Raises ChordError for an unknown name, and for two
    standards of which clauses contradict each other."""
    files = {_plain(name): name for name in NAMES}
    chosen: dict[str, Standard] = {}
    for name in names:
        known = files.get(_plain(name))
        if known is None:
            raise ChordError(
                f"knows no standard {name!r}", where="<standard>", value=name,
                expected=f"one of {', '.join(NAMES)}",
            )  # fmt: skip
        chosen[known] = _read(known)
    for first, second in combinations(chosen.values(), 2):
        for clause in first.clauses:
            against = next((each for each in second.clauses if clause.contradicts(each)), None)
            if against is not None:
                raise ChordError(
                    f"{first.name} and {second.name} contradict each other: {_asks(clause)}, "
                    f"and {_asks(against)}",
                    where="<standard>", expected="standards that one home can keep",
                    try_="one of them",
                )  # fmt: skip
    return tuple(chosen.values())


def standards_in(names: str) -> tuple[Standard, ...]:
    """Standards by their names, with commas between them. Raises ChordError, as standards_named
    does."""
    return standards_named(name for name in names.split(",") if name.strip())


@contextmanager
def planning_to(standards: Iterable[Standard]) -> Iterator[None]:
    """In the block, drafts cost more that break a clause of the standards (price.broken_share)."""
    rules: dict[str, list[Rule[View]]] = {}
    for standard in standards:
        for clause in standard.clauses:
            for kind in clause.kinds if clause.measure and HOME not in clause.kinds else ():
                rules.setdefault(kind, []).append(clause.rule)
    token = CLAUSES.set({kind: tuple(clauses) for kind, clauses in rules.items()})
    try:
        yield
    finally:
        CLAUSES.reset(token)


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _asks(clause: Clause) -> str:
    value = f"{clause.need * 100:.0f} cm" if clause.unit == "m" else f"{clause.need:g}"
    return f"{clause.text} {'at most' if clause.at_most else 'at least'} {value}"


@cache
def _read(name: str) -> Standard:
    lines = (FOLDER / f"{NAMES[name]}.tsv").read_text(encoding="utf-8").splitlines()
    rows = csv.DictReader(lines[1:], delimiter="\t", quoting=csv.QUOTE_NONE)
    return Standard(name, lines[0].removeprefix("# "), tuple(_clause(row) for row in rows))


def _clause(row: Mapping[str, str]) -> Clause:
    named = row["kinds"].split() if row["kinds"] != TABLE else [TABLE]
    # Standards ask the same of all rooms with plumbing.
    kinds = tuple(wet for kind in named for wet in (WET_KINDS if kind == "bathroom" else (kind,)))
    unit: Unit = "m" if row["unit"] == "m" else "count"
    need = float(row["need"]) if row["need"] else 0.0
    return Clause(row["clause"], kinds, row["measure"], need, unit, row["limit"] == "most",
                  row["text"], row["source"])  # fmt: skip


@dataclass(frozen=True)
class Kept:
    """How a home keeps one standard."""

    standard: Standard
    kept: tuple[str, ...]
    """Names of clauses that all rooms keep in which they are asked."""
    findings: tuple[tuple[Clause, str, Finding], ...]
    """Clause, id of the room or empty for the home, and the value that does not keep it."""
    idle: tuple[str, ...]
    """Names of clauses that no room of the home is asked."""

    @property
    def unchecked(self) -> tuple[Clause, ...]:
        """Clauses without a number that was read."""
        return tuple(clause for clause in self.standard.clauses if not clause.measure)

    @property
    def holds(self) -> bool:
        """Whether no clause that is checked is broken."""
        return not self.findings

    @property
    def lines(self) -> list[str]:
        """What does not keep the standard, a line each."""
        return [self.line(*finding) for finding in self.findings]

    def line(self, clause: Clause, place: str, finding: Finding) -> str:
        """What a value misses. place: name of the room, or empty for the home."""
        return (f"{place or 'home'}: {finding.said} ({self.standard.name}, {clause.name}), "
                f"at {finding.at[0]:.2f}, {finding.at[1]:.2f} m")  # fmt: skip

    @property
    def summary(self) -> str:
        """In one line."""
        broken = len({clause.name for clause, _, _ in self.findings})
        return (f"planned to {self.standard.name}: {len(self.kept)} of {len(self.kept) + broken} "
                f"clauses kept, {len(self.unchecked)} not checked")  # fmt: skip

    def as_json(self) -> dict[str, Any]:
        """As reports give it."""
        return {
            "standard": self.standard.name, "title": self.standard.title,
            "summary": self.summary, "holds": self.holds,
            "kept": list(self.kept), "idle": list(self.idle),
            "findings": [{"clause": clause.name, "path": place, **finding.as_json()}
                         for clause, place, finding in self.findings],
            "not_checked": [{"clause": clause.name, "text": clause.text, "source": clause.source}
                            for clause in self.unchecked],
        }  # fmt: skip


def keeping(standard: Standard, graphs: Sequence[SceneGraph], *, of_plan: bool = False) -> Kept:
    """How a home keeps a standard. graphs: its storeys, the lowest first.

    of_plan: ask only what empty rooms already limit.
    """
    views = [view_home(graph) for graph in graphs]
    front = next((view.entrance for view in views if view.entrance is not None), None)
    home = HomeView(tuple(room for view in views for room in view.rooms), front)
    kept, idle, findings = [], [], []
    for clause in standard.clauses:
        if not clause.measure or (of_plan and clause.measure not in {*OF_PLAN, *OF_HOME}):
            continue
        judged = [judge([clause.rule], seen, place, "home", 0.0) for place, seen in
                  _asked(clause, home)]  # fmt: skip
        judged = [each for each in judged if each.asked]
        broken = [(clause, each.place, finding) for each in judged for finding in each.findings]
        findings += broken
        if not judged:
            idle.append(clause.name)
        elif not broken:
            kept.append(clause.name)
    return Kept(standard, tuple(kept), tuple(findings), tuple(idle))


def _asked(clause: Clause, home: HomeView) -> Iterator[tuple[str, View | HomeView]]:
    if HOME in clause.kinds:
        yield "", home
        return
    for view in home.rooms:
        room = view.shell.room
        if room.kind in clause.kinds or (TABLE in clause.kinds and view.of("dining_table")):
            yield room.id, view
