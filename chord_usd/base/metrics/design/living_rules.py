"""Rules of living rooms: seats, television, table, the talking circle."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import cv2
import numpy as np

from chord_usd.base.metrics.design.rule import Measured, Rule, flag
from chord_usd.base.metrics.design.screens import Screen
from chord_usd.base.metrics.design.shell import CELL_M, Rects
from chord_usd.base.metrics.design.view import View, clipped
from chord_usd.base.scene.palette import having

SINGLES = having("easy_chair")
_GROUP = frozenset(("sofa", "coffee_table", "side_coffee_table", "lounge", *SINGLES))
LARGE_M2 = 24.0
"""From this area on a living room has a second zone beside that of the sofa."""
_USED_M = 1.5
"""Floor so near to a piece serves it."""
_SEAT_M, _ARMS_M = 0.62, 0.3
_ZONE_EDGE_M, _LOW_M = 0.1, 0.55
"""What reaches less into the zone of the group is beside it; lower pieces hide nothing."""


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
               key=lambda screen: float(np.hypot(*(screen.at - view.at[sofa]))))  # fmt: skip


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


def _between(view: View) -> Iterator[Measured]:
    """Other furniture before the sofa, as far as to the television: the dining set has a zone of
    its own."""
    for sofa, screen, _, away in _turned(view):
        edge = float(view.depth[sofa]) / 2
        if away <= edge:
            continue
        middle = view.at[sofa] + view.front[sofa] * (edge + away) / 2
        half = np.array([[view.length[sofa] / 2 - _ZONE_EDGE_M, (away - edge) / 2]])
        zone = Rects(middle[None], view.right[[sofa]], view.front[[sofa]], half)
        within = (view.rects.depths(zone)[:, 0] > _ZONE_EDGE_M) & view.stands
        within &= view.height > _LOW_M
        hiding = (at for at in np.flatnonzero(within).tolist() if view.items[at].id != screen.id)
        others = [at for at in hiding if view.categories[at] not in _GROUP]
        yield Measured(len(others), view.point(sofa), _id(view, *others))


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
    """Floor between armchairs and the nearest coffee or dining table."""
    tables = view.of("coffee_table", "dining_table")
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


def _far_floor(view: View) -> Iterator[Measured]:
    """Floor that is far from every piece, square metres: a part of a large room without a use."""
    ground = view.shell.ground
    pieces = np.ones_like(ground.floor)
    for outline in view.corners[view.stands]:
        cv2.fillPoly(pieces, [ground.cells(outline)], (0,))
    away_m = cv2.distanceTransform(pieces, cv2.DIST_L2, 3) * CELL_M
    far = (away_m > _USED_M) & (ground.floor > 0)
    yield Measured(float(far.sum()) * CELL_M**2, view.middle)


def _sofa_window(view: View) -> Iterator[Measured]:
    at = _sofa(view)
    if at is not None:
        yield flag(bool(view.windows_behind(at)), view.point(at), *_id(view, at))


def _behind_sofa(view: View) -> Iterator[Measured]:
    """A sofa that is neither at a wall nor so far from it that people walk behind it."""
    at = _sofa(view)
    if at is not None:
        half = view.length[at] / 2 - 0.1
        free = view.behind(at, -half, half, view.of("sofa_background"))
        yield flag(0.15 < free < 0.58, view.point(at), *_id(view, at))


RULES: tuple[Rule[View], ...] = (
    Rule("sofa", 1, "count", "planning guides", _has_sofa, weight=2.0),
    Rule("television", 1, "count", "planning guides", _has_television, weight=2.5),
    Rule("coffee table", 1, "count", "planning guides", _has_table),
    Rule("seats", 4, "count", "HUD 1973", _seats),
    Rule("television aside of the sofa's front", 20, "deg", "THX", _aside, at_most=True),
    Rule(
        "television aside of the middle of the sofa's view",
        8,
        "deg",
        "THX",
        _aside,
        at_most=True,
        weight=0.3,
    ),
    Rule(
        "other furniture between sofa and television",
        0,
        "count",
        "planning guides",
        _between,
        at_most=True,
    ),
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
    Rule("armchair to a table", 0.25, "m", "planning guides", _knees, weight=0.5),
    Rule("armchair from the sofa", 3.00, "m", "HUD 1973", _apart, at_most=True),
    Rule("armchair turned from the group", 45, "deg", "HUD 1973", _turned_away, at_most=True),
    Rule("seats to talk to", 1, "count", "HUD 1973", _talk),
    *(
        Rule(
            f"floor of a large room far from all furniture, {share}",
            most_m2,
            "m2",
            "planning guides",
            _far_floor,
            at_most=True,
            weight=0.5,
            from_m2=LARGE_M2,
        )
        for share, most_m2 in (("a part", 6.0), ("most of it", 12.0))
    ),
    Rule("sofa before a window", 0, "count", "planning guides", _sofa_window, at_most=True),
    Rule("slit behind the sofa", 0, "count", "HUD 1973", _behind_sofa, at_most=True, weight=0.5),
)
