"""Rules of living rooms: seats, television, table, the talking circle."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from chord_usd.base.metrics.design.rule import Measured, Rule, flag
from chord_usd.base.metrics.design.screens import Screen
from chord_usd.base.metrics.design.view import View, clipped
from chord_usd.base.scene.palette import having

SINGLES = having("easy_chair")
_SEAT_M, _ARMS_M = 0.62, 0.3


def _id(view: View, *numbers: int) -> tuple[str, ...]:
    return tuple(view.items[at].id for at in numbers)


def _seen(view: View, sofa: int, screen: Screen) -> tuple[str, ...]:
    return (view.items[sofa].id, screen.id) if screen.id else (view.items[sofa].id,)


def seats(view: View) -> int:
    """Places to sit on sofas and armchairs."""
    sofas = sum(max(2, int((view.length[at] - _ARMS_M) / _SEAT_M)) for at in view.of("sofa"))
    return int(sofas) + len(view.of(*SINGLES))


def _sofa(view: View) -> int | None:
    """The longest."""
    return max(view.of("sofa"), key=lambda at: view.length[at], default=None)


def _television(view: View) -> Screen | None:
    """That nearest to the sofa."""
    sofa = _sofa(view)
    if sofa is None:
        return next(iter(view.televisions), None)
    return min(view.televisions, default=None,
               key=lambda one: float(np.hypot(*(one.at - view.at[sofa]))))  # fmt: skip


def _has_sofa(view: View) -> Iterator[Measured]:
    yield Measured(len(view.of("sofa")), view.middle)


def _has_television(view: View) -> Iterator[Measured]:
    if view.shell.is_largest:
        yield Measured(len(view.televisions), view.middle)


def _has_table(view: View) -> Iterator[Measured]:
    yield Measured(len(view.of("coffee_table")), view.middle)


def _seats(view: View) -> Iterator[Measured]:
    if view.shell.is_largest:
        yield Measured(seats(view), view.middle)


def _turned(view: View) -> Iterator[tuple[int, Screen, float, float]]:
    """Sofa, television, how many degrees aside it is, and how far its screen."""
    sofa, screen = _sofa(view), _television(view)
    if sofa is None or screen is None:
        return
    u, v = view.own(sofa, screen.at)
    angle = math.degrees(math.atan2(abs(u), v)) if v > 0 else 180.0
    if float(view.front[sofa] @ screen.front) >= -0.8:
        angle = 180.0
    yield sofa, screen, angle, float(v - screen.depth / 2)


def _aside(view: View) -> Iterator[Measured]:
    for sofa, screen, angle, _ in _turned(view):
        yield Measured(angle, screen.point, _seen(view, sofa, screen))
    if _sofa(view) is None:
        yield Measured(math.inf, view.middle)


def _far(nearest: bool) -> Callable[[View], Iterator[Measured]]:
    """The television's distance from the middle of the sofa, where that faces it."""

    def measure(view: View) -> Iterator[Measured]:
        for sofa, screen, angle, away in _turned(view):
            lost = 0.0 if nearest else math.inf
            yield Measured(away if angle <= 35.0 else lost, screen.point,
                           _seen(view, sofa, screen))  # fmt: skip
        if _sofa(view) is None:
            yield Measured(0.0 if nearest else math.inf, view.middle)

    return measure


def _glare(view: View) -> Iterator[Measured]:
    screen = _television(view)
    if screen is not None:
        half, back = screen.length / 2, screen.depth / 2
        lit = any(clipped(screen.own(hole.ends), (-half, half), (-back - 0.4, 0.1 - back)) > 0.3
                  for hole in view.shell.windows)  # fmt: skip
        yield flag(lit, screen.point, *([screen.id] if screen.id else []))


def _bare(view: View) -> Iterator[Measured]:
    """Cabinets for a television without one, also where it hangs on another wall."""
    bare = view.bare
    yield flag(bool(bare), view.point(bare[0]) if bare else view.middle, *_id(view, *bare))


def _table_gap(view: View) -> Iterator[Measured]:
    sofa, tables = _sofa(view), view.of("coffee_table")
    if sofa is not None and tables:
        away = view.gaps(sofa)[tables]
        at = tables[int(np.argmin(away))]
        yield Measured(float(away.min()), view.point(at), _id(view, sofa, at))


def _apart(view: View) -> Iterator[Measured]:
    """How far armchairs are from the sofa."""
    sofa = _sofa(view)
    for at in view.of(*SINGLES):
        away = math.inf if sofa is None else float(np.hypot(*(view.at[at] - view.at[sofa])))
        yield Measured(away, view.point(at), _id(view, at))
    if sofa is None and not view.of(*SINGLES):
        yield Measured(math.inf, view.middle)


def _knees(view: View) -> Iterator[Measured]:
    """Floor between armchairs and the coffee table."""
    tables = view.of("coffee_table")
    for at in view.of(*SINGLES) if tables else ():
        yield Measured(float(view.gaps(at)[tables].min()), view.point(at), _id(view, at))


def _turned_away(view: View) -> Iterator[Measured]:
    """How far armchairs are turned from the table, or else the sofa."""
    focus = next(iter(view.of("coffee_table")), _sofa(view))
    if _sofa(view) is None:
        yield Measured(math.inf, view.middle)
        return
    assert focus is not None
    for at in view.of(*SINGLES):
        u, v = view.own(at, view.at[focus])
        yield Measured(abs(math.degrees(math.atan2(u, v))), view.point(at), _id(view, at))


def _talk(view: View) -> Iterator[Measured]:
    """Seats that somebody on the sofa talks to: near, and not in line with it."""
    sofa = _sofa(view)
    if sofa is None:
        yield Measured(0, view.middle)
        return
    others = [at for at in view.of("sofa", *SINGLES) if at != sofa]
    near = [at for at in others if 0.9 <= np.hypot(*(view.at[at] - view.at[sofa])) <= 3.0
            and float(view.front[at] @ view.front[sofa]) < 0.75]  # fmt: skip
    yield Measured(len(near), view.point(sofa), _id(view, sofa))


def _sofa_window(view: View) -> Iterator[Measured]:
    at = _sofa(view)
    if at is not None:
        yield flag(bool(view.windows_behind(at)), view.point(at), *_id(view, at))


RULES: tuple[Rule[View], ...] = (
    Rule("sofa", 1, "count", "planning guides", _has_sofa, weight=2.0),
    Rule("television", 1, "count", "planning guides", _has_television, weight=1.5),
    Rule("coffee table", 1, "count", "planning guides", _has_table),
    Rule("seats", 4, "count", "HUD 1973", _seats),
    Rule("television aside of the sofa's front", 20, "deg", "THX", _aside, at_most=True),
    Rule("nearest television", 1.80, "m", "THX, SMPTE", _far(True)),
    Rule("farthest television", 4.00, "m", "THX, SMPTE", _far(False), at_most=True),
    Rule("television before a window", 0, "count", "planning guides", _glare, at_most=True),
    Rule(
        "television cabinets without a television",
        0,
        "count",
        "planning guides",
        _bare,
        at_most=True,
        weight=0.5,
    ),
    Rule("least from sofa to coffee table", 0.30, "m", "planning guides", _table_gap),
    Rule("from sofa to coffee table", 0.60, "m", "planning guides", _table_gap, at_most=True),
    Rule(
        "from sofa to coffee table in easy reach",
        0.46,
        "m",
        "planning guides",
        _table_gap,
        at_most=True,
        weight=0.3,
    ),
    Rule("armchair to the coffee table", 0.10, "m", "planning guides", _knees, weight=0.5),
    Rule("armchair from the sofa", 3.00, "m", "HUD 1973", _apart, at_most=True),
    Rule("armchair turned from the group", 45, "deg", "HUD 1973", _turned_away, at_most=True),
    Rule("seats to talk to", 1, "count", "HUD 1973", _talk),
    Rule("sofa before a window", 0, "count", "planning guides", _sofa_window, at_most=True),
)
