"""Rules of bedrooms: beside and before the bed, its wall, wardrobes, the desk."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from chord_usd.base.metrics.design.rule import Measured, Rule, flag
from chord_usd.base.metrics.design.shell import Hole
from chord_usd.base.metrics.design.view import DOUBLE_M, View, distances, sleepers_of

WARDROBE_RULES = ("wardrobe", "wardrobe a sleeper", "before a wardrobe")
"""Names of the rules by which bedrooms have place for clothes."""
TALL_M = 1.5
"""A cabinet at least so high is a wardrobe."""
_BESIDE_M = 0.35
"""A bedside table stands no farther from its bed."""
_HEAD_M = 0.55
"""Beside the head stand tables: people get in and out from here on."""


def _id(view: View, *numbers: int) -> tuple[str, ...]:
    return tuple(view.items[at].id for at in numbers)


def _bed(view: View) -> int | None:
    return next(iter(view.of("bed")), None)


def _is_double(view: View, at: int) -> bool:
    return bool(view.length[at] >= DOUBLE_M)


def bedside(view: View, at: int) -> list[int]:
    """Bedside tables of a bed."""
    away = view.gaps(at)
    return [table for table in view.of("bedside_table") if away[table] < _BESIDE_M]


def wardrobes(view: View) -> list[int]:
    """Tall cabinets."""
    return [at for at in view.of("cabinet", "wardrobe")
            if view.height[at] >= TALL_M or view.categories[at] == "wardrobe"]  # fmt: skip


def _has_bed(view: View) -> Iterator[Measured]:
    yield Measured(len(view.of("bed")), view.middle)


def _sides(double: bool, which: int) -> Callable[[View], Iterator[Measured]]:
    def measure(view: View) -> Iterator[Measured]:
        at = _bed(view)
        if at is None or _is_double(view, at) != double:
            return
        low, high = _HEAD_M - view.depth[at] / 2, view.depth[at] / 2 - 0.05
        tables = bedside(view, at)
        free = [(view.beside(at, side, low, high, tables), side) for side in (-1, 1)]
        width, side = sorted(free)[which]
        yield Measured(width, view.point(at, side * view.length[at] / 2), _id(view, at))

    return measure


def _tables(double: bool) -> Callable[[View], Iterator[Measured]]:
    def measure(view: View) -> Iterator[Measured]:
        at = _bed(view)
        if at is not None and _is_double(view, at) == double:
            yield Measured(len(bedside(view, at)), view.point(at), _id(view, at))

    return measure


def _pair(view: View) -> Iterator[Measured]:
    """How much two bedside tables differ in size."""
    at = _bed(view)
    if at is None:
        return
    tables = bedside(view, at)
    if len(tables) == 2:
        sizes = np.array([view.items[table].box.size_m for table in tables])
        yield Measured(float(np.abs(sizes[0] - sizes[1]).max()), view.point(at),
                       _id(view, *tables))  # fmt: skip


def _foot(view: View) -> Iterator[Measured]:
    at = _bed(view)
    if at is not None:
        half = view.length[at] / 2 - 0.05
        yield Measured(view.before(at, -half, half, bedside(view, at)),
                       view.point(at, 0, view.depth[at] / 2), _id(view, at))  # fmt: skip


def _dressing_place(view: View) -> Iterator[Measured]:
    """The widest free floor at a side or the foot."""
    values = [
        value for measure in (_sides(True, 1), _sides(False, 1), _foot) for value in measure(view)
    ]
    if values:
        yield max(values, key=lambda value: value.have)


def _head_window(view: View) -> Iterator[Measured]:
    at = _bed(view)
    if at is not None:
        yield flag(bool(view.windows_behind(at)), view.point(at), *_id(view, at))


def before_window(view: View, at: int, least_m2: float) -> bool:
    """Whether a piece takes floor within half a metre of a window."""
    area = view.length[at] * view.depth[at]
    half = np.array([view.length[at], view.depth[at]]) / 2
    for hole in view.shell.windows:
        if view.from_line(at, hole.ends) < 0.5:
            points = view.grid(at, (-half[0], half[0]), (-half[1], half[1]))
            near = distances(points, hole.ends[None])[:, 0] < 0.5
            if near.mean() * area > least_m2:
                return True
    return False


def _blocks_window(view: View) -> Iterator[Measured]:
    at = _bed(view)
    if at is not None:
        yield flag(before_window(view, at, 0.15), view.point(at), *_id(view, at))


def _faces_hole(view: View, at: int, hole: Hole) -> bool:
    """Whether a piece's front points at a door, in line with it."""
    u, v = view.own(at, hole.middle)
    ahead = float(view.front[at] @ hole.inward) < -0.8
    return bool(ahead and v > view.depth[at] / 2 and abs(u) < view.length[at] / 2 + 0.1)


def _feet_to_door(view: View) -> Iterator[Measured]:
    at = _bed(view)
    if at is not None:
        wrong = any(_faces_hole(view, at, hole) for hole in view.shell.entries)
        yield flag(wrong, view.point(at, 0, view.depth[at] / 2), *_id(view, at))


def _door_near(view: View) -> Iterator[Measured]:
    at = _bed(view)
    if at is not None and view.shell.entries:
        away = min(view.from_line(at, hole.ends) for hole in view.shell.entries)
        yield Measured(away, view.point(at), _id(view, at))


def _has_wardrobe(view: View) -> Iterator[Measured]:
    if _bed(view) is not None:
        yield Measured(len(wardrobes(view)), view.middle)


def _wardrobe_metres(view: View) -> Iterator[Measured]:
    """Metres of wardrobe a sleeper; 0 where there is no storage at all."""
    if _bed(view) is None:
        return
    storage = wardrobes(view)
    if storage or not view.of("cabinet", "wardrobe"):
        total = float(view.length[storage].sum())
        yield Measured(total / max(1, sleepers_of(view)), view.middle, _id(view, *storage))


def _wardrobe_front(view: View) -> Iterator[Measured]:
    if _bed(view) is None:
        return
    for at in wardrobes(view):
        half = view.length[at] / 2 - 0.03
        yield Measured(view.before(at, -half, half), view.point(at, 0, view.depth[at] / 2),
                       _id(view, at))  # fmt: skip
    if not view.of("cabinet", "wardrobe"):
        yield Measured(0.0, view.middle)


def _wardrobe_window(view: View) -> Iterator[Measured]:
    if _bed(view) is not None:
        for at in wardrobes(view):
            yield flag(before_window(view, at, 0.05), view.point(at), *_id(view, at))


def _desk(view: View) -> Iterator[Measured]:
    for at in view.of("table")[:1]:
        chairs = [chair for chair in view.of("chair") if view.gaps(at)[chair] < 0.7]
        if chairs:
            yield Measured(view.before(at, -0.3, 0.3, chairs),
                           view.point(at, 0, view.depth[at] / 2), _id(view, at))  # fmt: skip


def _off_centre(view: View) -> Iterator[Measured]:
    """A bed side that is a slit: neither at the wall nor wide enough to walk."""
    at = _bed(view)
    if at is None:
        return
    low, high = _HEAD_M - view.depth[at] / 2, view.depth[at] / 2 - 0.05
    slits = [side for side in (-1, 1)
             if 0.05 < view.beside(at, side, low, high, bedside(view, at)) < 0.30]  # fmt: skip
    yield flag(bool(slits), view.point(at), *_id(view, at))


RULES: tuple[Rule[View], ...] = (
    Rule("bed", 1, "count", "NDSS", _has_bed, weight=2.0),
    Rule("beside a double bed, lesser side", 0.60, "m", "HUD 1973", _sides(True, 0)),
    Rule("beside a single bed, one side", 0.60, "m", "HUD 1973", _sides(False, 1)),
    Rule("bedside tables of a double bed", 2, "count", "NDSS", _tables(True)),
    Rule("bedside tables of a single bed", 1, "count", "NDSS", _tables(False)),
    Rule("bedside tables differ", 0.05, "m", "planning guides", _pair, at_most=True, weight=0.5),
    Rule("at the foot of the bed", 0.75, "m", "AD M4(2)", _foot),
    Rule("to dress at a side or the foot", 1.07, "m", "HUD 1973", _dressing_place, weight=0.5),
    Rule("slit beside the bed", 0, "count", "HUD 1973", _off_centre, at_most=True, weight=0.5),
    Rule("headboard under a window", 0, "count", "planning guides", _head_window, at_most=True),
    Rule("bed before a window", 0, "count", "planning guides", _blocks_window, at_most=True),
    Rule("feet towards a door", 0, "count", "planning guides", _feet_to_door, at_most=True),
    Rule("bed to a door", 0.80, "m", "planning guides", _door_near),
    Rule(WARDROBE_RULES[0], 1, "count", "HUD 1973", _has_wardrobe),
    Rule(WARDROBE_RULES[1], 1.00, "m", "HUD 1973", _wardrobe_metres),
    Rule(WARDROBE_RULES[2], 0.75, "m", "AD M4(2)", _wardrobe_front),
    Rule("before a wardrobe to dress", 0.91, "m", "HUD 1973", _wardrobe_front, weight=0.5),
    Rule("wardrobe before a window", 0, "count", "planning guides", _wardrobe_window,
         at_most=True),
    Rule("behind the edge of a desk", 0.76, "m", "HUD 1973", _desk),
)  # fmt: skip
