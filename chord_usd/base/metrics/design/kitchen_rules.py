"""Rules of kitchens: runs, worktop, the work triangle, what stands before what is used."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from chord_usd.base.metrics.design.rule import Measured, Rule, flag
from chord_usd.base.metrics.design.view import View, distances
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.scene.geometry import hanging_together
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import FloatArray

SINK, COOKER, COLD = "sink_cabinet", "cooker_cabinet", "refrigerator"
CENTRES = (SINK, COOKER, COLD)
LAUNDRY = having("laundry")
TALL_M = 1.2
"""A unit at least so high carries no worktop."""
RUN_GAP_M = 0.1
"""Units no farther apart are one run."""
TOP_M = 0.6
"""A sink or a hob takes so much of its unit's worktop; a corner gives so much."""
BESIDE_M = 0.09

Measure = Callable[[View], Iterator[Measured]]
ISLAND_M = 0.3
"""A unit at least so far from every wall stands in an island."""
SMALL_M2 = 5.0
"""Kitchens below it are asked less: no arrangement could keep the rest."""


@dataclass(eq=False)
class Runs:
    """The units of a kitchen and how they join."""

    view: View
    units: list[int] = field(init=False)
    run_of: dict[int, int] = field(init=False)

    def __post_init__(self) -> None:
        """Runs are groups of units that stand end to end or round a corner."""
        view = self.view
        self.units = [at for at, name in enumerate(view.categories) if is_unit(name)]
        joined = [
            (i, j)
            for i, unit in enumerate(self.units)
            for j, gap in enumerate(view.gaps(unit)[self.units])
            if i < j and gap <= RUN_GAP_M
        ]
        groups = hanging_together(len(self.units), joined)
        self.run_of = {self.units[i]: number for number, group in enumerate(groups) for i in group}
        self._beside: dict[tuple[int, int], int | None] = {}

    def first(self, category: str) -> int | None:
        """The first unit of a category."""
        return next(iter(self.view.of(category)), None)

    def is_top(self, at: int) -> bool:
        """Whether a unit carries plain worktop."""
        return self.view.height[at] < 1.1 and self.view.categories[at] not in CENTRES

    def beside(self, at: int, side: int) -> int | None:
        """The next unit of the same row, right (1) or left (-1)."""
        key = at, side
        if key not in self._beside:
            self._beside[key] = next(self._next(at, side, True), None)
        return self._beside[key]

    def round_corner(self, at: int, side: int) -> int | None:
        """The unit of another row that touches a unit's side."""
        return next(self._next(at, side, False), None)

    def _next(self, at: int, side: int, in_row: bool) -> Iterator[int]:
        view, half = self.view, self.view.length[at] / 2
        for other in self.units:
            if other == at or view.is_upright_to(at, other) != in_row:
                continue
            if in_row:
                u, v = view.own(at, view.at[other])
                edge = side * u - half
                if abs(v) < 0.35 and 0 < edge < view.length[other] / 2 + BESIDE_M:
                    yield other
            else:
                ends = sorted((side * (half + 0.005), side * (half + BESIDE_M)))
                strip = view.grid(at, (ends[0], ends[1]), _span(view.depth[at]))
                if view.covered(strip, [other])[0] > 0.2:
                    yield other

    def worktop(self, at: int, side: int) -> float:
        """Metres of worktop beside a unit, up to what is none."""
        view = self.view
        total = self._rest(at) if view.categories[at] != COLD else 0.0
        seen, here = {at}, at
        while True:
            other = self.beside(here, side)
            if other is None:
                corner = self.round_corner(here, side)
                return total + (TOP_M if corner is not None and self.is_top(corner) else 0.0)
            if other in seen:
                return total
            seen.add(other)
            if not self.is_top(other):
                shares = view.categories[other] in (SINK, COOKER)
                return total + (self._rest(other) if shares else 0.0)
            total += float(view.length[other])
            here = other

    def _rest(self, at: int) -> float:
        """Worktop on each side within the unit of a sink or cooker."""
        is_in = self.view.categories[at] in (SINK, COOKER)
        return max(0.0, (float(self.view.length[at]) - TOP_M) / 2) if is_in else 0.0

    def sides(self, at: int) -> tuple[float, float]:
        """Worktop on the lesser and on the greater side of a unit."""
        left, right = sorted((self.worktop(at, -1), self.worktop(at, 1)))
        return left, right

    def is_island(self, at: int) -> bool:
        """Whether a unit stands free of all walls."""
        there = distances(self.view.corners[at], self.view.shell.sides).min()
        return bool(there > ISLAND_M)


def is_unit(category: str) -> bool:
    """Whether a category stands in a run."""
    return category in KITCHEN_UNITS or category == COLD


def _span(depth: float) -> tuple[float, float]:
    return -depth / 2, depth / 2


def runs_of(view: View) -> Runs | None:
    """The runs of a kitchen; None where sink or cooker is missing. Made once for a view."""
    if not hasattr(view, "_runs"):
        runs = Runs(view)
        both = runs.first(SINK) is not None and runs.first(COOKER) is not None
        view._runs = runs if both else None  # type: ignore[attr-defined]
    cached: Runs | None = view._runs  # type: ignore[attr-defined]
    return cached


def _id(view: View, *numbers: int) -> tuple[str, ...]:
    return tuple(view.items[at].id for at in numbers)


def _essential(view: View) -> Iterator[Measured]:
    there = sum(bool(view.of(name)) for name in (SINK, COOKER))
    yield Measured(there, view.middle)


def _cold_there(view: View) -> Iterator[Measured]:
    yield Measured(len(view.of(COLD)), view.middle)


def _one_run(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    if runs is None:
        return
    sink, cooker = runs.first(SINK), runs.first(COOKER)
    assert sink is not None
    assert cooker is not None
    same = runs.run_of[sink] == runs.run_of[cooker]
    yield flag(not same and not _across(view, sink, cooker), view.point(sink),
               *_id(view, sink, cooker))  # fmt: skip


def _across(view: View, unit: int, other: int) -> bool:
    """Whether two units face each other over one aisle."""
    u, v = view.own(unit, view.at[other])
    gap = v - view.depth[unit] / 2 - view.depth[other] / 2
    faces = abs((view.yaw[unit] - view.yaw[other] + 360.0) % 360.0 - 180.0) < 15.0
    return bool(faces and 0.84 <= gap <= 1.5 and abs(u) < 2.0)


def _cold_in_run(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    if runs is None:
        return
    cold = runs.first(COLD)
    if cold is None:
        yield Measured(math.inf, view.middle)
        return
    away = view.gaps(cold)
    main = {runs.run_of[at] for at in view.of(SINK)[:1] + view.of(COOKER)[:1]}
    joins = runs.run_of[cold] in main
    near = min((float(away[at]) for at in runs.units if runs.run_of[at] in main), default=0.0)
    yield Measured(0.0 if joins else max(near, RUN_GAP_M + 0.03), view.point(cold),
                   _id(view, cold))  # fmt: skip


def _worktop_at(category: str, which: int) -> Measure:
    def measure(view: View) -> Iterator[Measured]:
        runs = runs_of(view)
        at = runs.first(category) if runs else None
        if runs is not None and at is not None:
            yield Measured(runs.sides(at)[which], view.point(at), _id(view, at))

    return measure


def _landing(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    if runs is None:
        return
    cold = runs.first(COLD)
    if cold is None:
        yield Measured(0.0, view.middle)
        return
    best = 0.0
    for side in (-1, 1):
        other = runs.beside(cold, side)
        if other is not None and runs.is_top(other):
            best = max(best, runs.worktop(cold, side))
    half, edge = view.length[cold] / 2, view.depth[cold] / 2
    tops = [at for at in runs.units if runs.is_top(at)]
    if tops:
        strip = view.grid(cold, (-half, half), (edge, edge + 1.22))
        share_m2 = view.covered(strip, tops) * view.length[cold] * 1.22
        best = max([best, *(float(view.length[at]) for at, area in
                            zip(tops, share_m2, strict=True) if area > 0.05)])  # fmt: skip
    yield Measured(best, view.point(cold), _id(view, cold))


def _frontage(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    if runs is not None:
        low = [at for at in runs.units
               if view.categories[at] in (SINK, COOKER) or runs.is_top(at)]  # fmt: skip
        yield Measured(float(view.length[low].sum()), view.middle)


def _plain(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    if runs is not None:
        tops = [at for at in runs.units if runs.is_top(at)]
        yield Measured(float(view.length[tops].sum()), view.middle)


def _centres(view: View) -> list[int]:
    return [at for name in CENTRES for at in view.of(name)[:1]]


def _aisle(view: View) -> Iterator[Measured]:
    if runs_of(view) is None:
        return
    for at in _centres(view):
        half = view.length[at] * 0.4
        yield Measured(view.before(at, -half, half), view.point(at, 0, view.depth[at] / 2),
                       _id(view, at))  # fmt: skip


def _front_covered(view: View, at: int, among: list[int]) -> float:
    others = [unit for unit in among if unit != at]
    if not others:
        return 0.0
    half, edge = view.length[at] / 2 - 0.02, view.depth[at] / 2
    strip = view.grid(at, (-half, half), (edge + 0.02, edge + 0.45))
    return float(view.covered(strip, others).max())


def _free_fronts(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    if runs is not None:
        for at in _centres(view):
            yield Measured(_front_covered(view, at, runs.units), view.point(at), _id(view, at))


def _hidden_units(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    if runs is not None:
        for at in runs.units:
            if at not in _centres(view):
                share = _front_covered(view, at, runs.units)
                yield Measured(share, view.point(at), _id(view, at))


def _legs(view: View) -> list[float] | None:
    """Legs of the work triangle; None without its three corners."""
    points = [np.array(view.point(at, 0.0, view.depth[at] / 2)) for at in _centres(view)]
    if len(points) < 3:
        return None
    return [float(np.hypot(*(points[i] - points[i - 1]))) for i in range(3)]


def _triangle(low: float, high: float, spared: int) -> Measure:
    def measure(view: View) -> Iterator[Measured]:
        if runs_of(view) is None:
            return
        legs = _legs(view)
        wrong = 3 if legs is None else sum(not low - 0.02 <= leg <= high + 0.02 for leg in legs)
        yield Measured(max(0, wrong - spared), view.middle, _id(view, *_centres(view)))

    return measure


def _legs_sum(view: View) -> Iterator[Measured]:
    legs = _legs(view)
    if runs_of(view) is not None and legs is not None:
        yield Measured(sum(legs), view.middle, _id(view, *_centres(view)))


def _shortest_leg(view: View) -> Iterator[Measured]:
    if runs_of(view) is not None:
        legs = _legs(view)
        yield Measured(min(legs) if legs else 0.0, view.middle, _id(view, *_centres(view)))


def _cooker(view: View) -> Iterator[int]:
    if runs_of(view) is not None:
        yield view.of(COOKER)[0]


def _cooker_window(view: View) -> Iterator[Measured]:
    for at in _cooker(view):
        yield flag(bool(view.windows_behind(at)), view.point(at), *_id(view, at))


def _sink_window(view: View) -> Iterator[Measured]:
    if runs_of(view) is not None and view.shell.windows:
        at = view.of(SINK)[0]
        yield flag(not view.windows_behind(at, wider=0.2), view.point(at), *_id(view, at))


def _cooker_door(view: View) -> Iterator[Measured]:
    for at in _cooker(view):
        near = [view.from_line(at, hole.ends) for hole in view.shell.entries]
        yield Measured(min(near, default=math.inf), view.point(at), _id(view, at))


def _cooker_corner(view: View) -> Iterator[Measured]:
    for at in _cooker(view):
        away = min(view.to_wall(at, side, -0.2, 0.2) for side in (-1, 1))
        yield Measured(away, view.point(at), _id(view, at))


def _idle_runs(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    if runs is not None:
        main = {runs.run_of[at] for at in _centres(view)}
        idle = [at for at in runs.units
                if runs.run_of[at] not in main and not runs.is_island(at)]  # fmt: skip
        yield Measured(len(idle), view.point(idle[0]) if idle else view.middle, _id(view, *idle))


def _cooker_beside(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    for at in _cooker(view):
        assert runs is not None
        beside = [runs.beside(at, side) for side in (-1, 1)]
        wrong = [
            unit for unit in beside if unit is not None and view.categories[unit] in (SINK, COLD)
        ]
        yield flag(bool(wrong), view.point(at), *_id(view, at, *wrong))


def _washer_apart(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    if runs is not None:
        for at in view.of(*LAUNDRY):
            away = float(view.gaps(at)[runs.units].min())
            yield Measured(away, view.point(at), _id(view, at))


def _tall_between(view: View) -> Iterator[Measured]:
    runs = runs_of(view)
    if runs is None:
        return
    for at in runs.units:
        if view.height[at] < TALL_M:
            continue
        beside = [runs.beside(at, side) for side in (-1, 1)]
        low = [unit is not None and view.height[unit] < TALL_M for unit in beside]
        yield flag(all(low), view.point(at), *_id(view, at))


def _way_through(view: View) -> Iterator[Measured]:
    """The straight way between two doors crosses the leg from sink to cooker."""
    ways = view.shell.ways
    if runs_of(view) is None or len(ways) < 2:
        return
    sink, cooker = view.of(SINK)[0], view.of(COOKER)[0]
    leg = np.array([view.point(at, 0.0, view.depth[at] / 2 + 0.3) for at in (sink, cooker)])
    wrong = any(
        _cross(leg, np.array([way.middle, other.middle]))
        for i, way in enumerate(ways) for other in ways[:i]
    )  # fmt: skip
    yield flag(wrong, view.middle, *_id(view, sink, cooker))


def _cross(way: FloatArray, other: FloatArray) -> bool:
    def side(line: FloatArray, point: FloatArray) -> float:
        along, ahead = line[1] - line[0], point - line[0]
        return float(along[0] * ahead[1] - along[1] * ahead[0])

    return (
        side(way, other[0]) * side(way, other[1]) < 0
        and side(other, way[0]) * side(other, way[1]) < 0
    )


_PAGE = "planning guides"

RULES: tuple[Rule[View], ...] = (
    Rule("sink and cooker", 2, "count", "DIN 18022", _essential, weight=2.0),
    Rule("refrigerator", 1, "count", "NKBA 3", _cold_there, weight=2.0),
    Rule("sink and cooker in one run or over one aisle", 0, "count", "NKBA 3", _one_run,
         at_most=True),
    Rule("refrigerator at that run", RUN_GAP_M, "m", "NKBA 16", _cold_in_run, at_most=True,
         from_m2=SMALL_M2),
    Rule("worktop on the lesser side of the cooker", 0.30, "m", "NKBA 17", _worktop_at(COOKER, 0),
         is_fine=True),
    Rule("worktop on the greater side of the cooker", 0.38, "m", "NKBA 17",
         _worktop_at(COOKER, 1), is_fine=True, from_m2=SMALL_M2),
    Rule("worktop on the lesser side of the sink", 0.45, "m", "NKBA 11", _worktop_at(SINK, 0),
         is_fine=True, from_m2=SMALL_M2),
    Rule("worktop on the greater side of the sink", 0.60, "m", "NKBA 11", _worktop_at(SINK, 1),
         is_fine=True),
    Rule("worktop at the refrigerator", 0.38, "m", "NKBA 16", _landing, from_m2=SMALL_M2),
    Rule("worktop frontage", 4.01, "m", "NKBA 25", _frontage, from_m2=7.0),
    Rule("worktop frontage", 3.35, "m", "LSU AgCenter", _frontage, from_m2=5.0, below_m2=7.0),
    Rule("plain worktop", 1.20, "m", "DIN 18022", _plain, from_m2=SMALL_M2),
    Rule("worktop to prepare food beside the sink", 0.91, "m", "NKBA 11", _worktop_at(SINK, 1),
         from_m2=SMALL_M2),
    Rule("free floor before sink, cooker and refrigerator", 1.00, "m", "NKBA 6, 7", _aisle,
         from_m2=SMALL_M2),
    Rule("work aisle", 1.07, "m", "NKBA 6", _aisle, weight=0.5, from_m2=SMALL_M2),
    Rule("share of a front of sink, cooker or refrigerator shut by units", 0.2, "share", "NKBA 2",
         _free_fronts, at_most=True, from_m2=SMALL_M2),
    Rule("share of a unit's front shut by others", 0.75, "share", "NKBA 2", _hidden_units,
         at_most=True, weight=0.5),
    Rule("legs of the work triangle not between 122 and 274 cm", 0, "count", "NKBA 3",
         _triangle(1.22, 2.74, 0), at_most=True, from_m2=8.0),
    Rule("legs of the work triangle not between 122 and 274 cm, but one", 0, "count", "NKBA 3",
         _triangle(1.22, 2.74, 1), at_most=True, from_m2=5.0, below_m2=8.0),
    Rule("sum of the work triangle", 7.92, "m", "NKBA 3", _legs_sum, at_most=True, weight=0.5),
    Rule("shortest leg of the work triangle", 0.90, "m", _PAGE, _shortest_leg, from_m2=SMALL_M2),
    Rule("cooker before a window", 0, "count", "NKBA 20", _cooker_window, at_most=True),
    Rule("sink away from the window", 0, "count", _PAGE, _sink_window, at_most=True,
         from_m2=SMALL_M2),
    Rule("cooker to the edge of a door", 0.30, "m", _PAGE, _cooker_door),
    Rule("cooker to a side wall", 0.15, "m", "NKBA 17", _cooker_corner),
    Rule("units in runs without sink, cooker or refrigerator", 0, "count", _PAGE, _idle_runs,
         at_most=True),
    Rule("cooker beside sink or refrigerator", 0, "count", "NKBA 17", _cooker_beside,
         at_most=True),
    Rule("washing machine from the units", RUN_GAP_M, "m", _PAGE, _washer_apart, at_most=True),
    Rule("tall unit between worktops", 0, "count", "NKBA 4", _tall_between, at_most=True,
         weight=0.5),
    Rule("way between doors through the triangle", 0, "count", "NKBA 5", _way_through,
         at_most=True, weight=0.5),
)  # fmt: skip
