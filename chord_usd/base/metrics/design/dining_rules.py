"""Rules of dining tables: seats, their share of the edge, and the floor behind them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from chord_usd.base.metrics.design.rule import Measured, Rule, flag
from chord_usd.base.metrics.design.view import View
from chord_usd.base.metrics.design.way_rules import unreached
from chord_usd.base.scene.palette import having

_SINGLES = having("easy_chair")
_AT_TABLE_M = 0.45
"""A chair of a table stands no farther from it."""
_CHAIR_M = 0.44
"""Width of the strip that a seat is pulled out through."""
LENGTHS_M = {4: 1.37, 6: 2.01, 8: 2.64}
"""Of tables, by how many sit there, two of them at its ends."""


def _id(view: View, *numbers: int) -> tuple[str, ...]:
    return tuple(view.items[at].id for at in numbers)


def chairs_of(view: View, table: int) -> list[int]:
    """Chairs that stand at a table."""
    away = view.gaps(table)
    return [at for at in view.of("chair") if away[at] < _AT_TABLE_M]


def _side(view: View, table: int, chair: int) -> tuple[int, int]:
    """Axis and sign of the table's side that a chair is at: (1, ±1) is a long side."""
    u, v = view.own(table, view.at[chair])
    is_long = abs(v) - view.depth[table] / 2 > abs(u) - view.length[table] / 2
    return (1, 1 if v > 0 else -1) if is_long else (0, 1 if u > 0 else -1)


def _chairs(view: View) -> Iterator[Measured]:
    for table in view.of("dining_table"):
        yield Measured(len(chairs_of(view, table)), view.point(table), _id(view, table))


def _edge(view: View) -> Iterator[Measured]:
    for table in view.of("dining_table"):
        counts: dict[tuple[int, int], int] = {}
        for chair in chairs_of(view, table):
            key = _side(view, table, chair)
            counts[key] = counts.get(key, 0) + 1
        for (axis, _), count in counts.items():
            edge = view.length[table] if axis else view.depth[table]
            yield Measured(float(edge) / count, view.point(table), _id(view, table))


def _behind(view: View) -> Iterator[Measured]:
    """From the table's edge to what is behind each chair."""
    for table in view.of("dining_table"):
        chairs = chairs_of(view, table)
        for chair in chairs:
            yield Measured(_pull_out(view, table, chair, chairs), view.point(chair),
                           _id(view, chair))  # fmt: skip


def _pull_out(view: View, table: int, chair: int, chairs: list[int]) -> float:
    axis, sign = _side(view, table, chair)
    u, v = view.own(table, view.at[chair])
    at, half = float(u if axis else v), _CHAIR_M / 2
    if axis:
        if sign > 0:
            return view.before(table, at - half, at + half, chairs)
        return view.behind(table, at - half, at + half, chairs)
    return view.beside(table, sign, at - half, at + half, chairs)


def _unreached(view: View) -> Iterator[Measured]:
    """Sides of tables to whose chairs nobody gets."""
    for table in view.of("dining_table"):
        by_side: dict[tuple[int, int], list[int]] = {}
        for chair in chairs_of(view, table):
            by_side.setdefault(_side(view, table, chair), []).append(chair)
        sides = [*by_side.values()]
        shut = [chair for at in unreached(view, sides) for chair in sides[at]]
        yield Measured(len(shut), view.point(table), _id(view, *shut))


def _lounge(view: View) -> Iterator[Measured]:
    """From the table to the nearest sofa or armchair."""
    seats = view.of("sofa", *_SINGLES)
    for table in view.of("dining_table") if seats else ():
        away = view.gaps(table)[seats]
        near = seats[int(np.argmin(away))]
        yield Measured(float(away.min()), view.point(near), _id(view, near, table))


def _next_door(view: View) -> Iterator[Measured]:
    for table in view.of("dining_table"):
        yield flag(not view.shell.joins_kitchen, view.point(table), *_id(view, table))


def _lengths(view: View) -> Iterator[Measured]:
    """How much too short a table is for those who sit there."""
    for table in view.of("dining_table"):
        count = len(chairs_of(view, table))
        needed = [length for seats, length in LENGTHS_M.items() if seats <= count]
        if needed:
            long = float(np.maximum(view.length[table], view.depth[table]))
            yield Measured(max(0.0, max(needed) - long), view.point(table), _id(view, table))


RULES: tuple[Rule[View], ...] = (
    Rule("chairs at the table", 2, "count", "HUD 1973", _chairs, weight=2.0),
    Rule("table edge a seat", 0.60, "m", "NKBA 9", _edge),
    Rule("behind the table's edge to pull a chair out", 0.75, "m", "NKBA 8", _behind),
    Rule("behind the table's edge where nobody passes", 0.81, "m", "NKBA 8", _behind, weight=0.5),
    Rule("behind the table's edge to edge past", 0.91, "m", "NKBA 8", _behind, weight=0.3),
    Rule("from the table to seats of the lounge", 0.61, "m", "HUD 1973", _lounge, weight=0.5),
    Rule("chairs that nobody gets to", 0, "count", "NKBA 8", _unreached, at_most=True),
    Rule("kitchen not next door", 0, "count", "planning guides", _next_door, at_most=True),
    Rule(
        "table too short by", 0.0, "m", "Time-Saver Standards", _lengths, at_most=True, weight=0.3
    ),
)
