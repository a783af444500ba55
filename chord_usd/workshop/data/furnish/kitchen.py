"""Kitchens: a run of floor cabinets along one, two or three walls, touching end to end."""

from __future__ import annotations

import random
from typing import NamedTuple

from chord_usd.base.metrics.complete import lacking
from chord_usd.workshop.data.furnish import sizes
from chord_usd.workshop.data.furnish.appliances import REFRIGERATOR, stand_alone
from chord_usd.workshop.data.furnish.floor import Floor, Spot
from chord_usd.workshop.data.furnish.free_spans import Wall
from chord_usd.workshop.data.furnish.modules import Module, pack

AISLE_M = 0.85
"""Free floor in front of the fronts."""

BLIND_M = 0.95
"""A corner cabinet: hidden for one counter depth, the rest opens."""


class Run(NamedTuple):
    """A stretch of counter along one wall."""

    wall: Wall
    s_from: float
    s_to: float
    blind_start: bool = False
    """Another run stands in front of this one's first counter depth."""
    blind_end: bool = False
    joins_end: bool = False
    """It meets another run at its end; what is tall stands at the other."""
    joins_start: bool = False

    @property
    def length(self) -> float:
        """Metres."""
        return self.s_to - self.s_from


def furnish_kitchen(floor: Floor) -> None:
    """Enough counter for the room's size, in the simplest shape that gives it.

    The refrigerator stands in the row; where that is too short the row is planned around it.
    """
    has_refrigerator = floor.dice.random() < floor.mix.refrigerator
    mark = floor.mark()
    _put_runs(floor, has_refrigerator)
    if not has_refrigerator or floor.has("refrigerator"):
        return
    floor.undo(mark)
    stand_alone(floor, REFRIGERATOR)
    _put_runs(floor, False)
    if lacking("kitchen", floor.area_m2, (piece.category for piece in floor.placed)):
        floor.undo(mark)
        _put_runs(floor, False)


def _put_runs(floor: Floor, has_refrigerator: bool) -> None:
    dice = floor.dice
    height = sizes.between(dice, 0.8, 0.9)
    for depth, aisle in ((0.6, AISLE_M), (0.55, 0.7), (0.5, 0.6)):
        runs = _best_runs(floor, depth, height, aisle)
        if sum(run.length for run in runs) >= 1.2 or (depth == 0.5 and runs):
            _fill(floor, runs, depth, height, has_refrigerator)
            return


def _best_runs(floor: Floor, depth: float, height: float, aisle: float) -> list[Run]:
    least, per_m2, most = floor.mix.worktop_m
    wanted = min(most, least + per_m2 * floor.area_m2) + floor.dice.uniform(-0.3, 0.6)
    best: tuple[float, int, list[Run]] | None = None
    spots = [
        Spot(wall, s_from, s_to)
        for wall in floor.walls
        for s_from, s_to in wall.gaps(depth, height, aisle, 0.6)
    ]
    for i, runs in enumerate(_shapes(floor, spots, depth)):
        total = sum(run.length for run in runs) - depth * sum(
            run.blind_start + run.blind_end for run in runs
        )
        lit = any(run.wall.has_window for run in runs)
        score = min(total, wanted) - 0.25 * max(0.0, total - wanted) - 0.35 * len(runs)
        score += 0.4 * lit + floor.dice.uniform(0.0, 0.5) - _off_hints(floor, runs)
        if best is None or score > best[0]:
            best = (score, i, runs)
    return best[2] if best else []


def _off_hints(floor: Floor, runs: list[Run]) -> float:
    """How far the counter is from where the drawing shows one, metres."""
    away = 0.0
    for _, x, y in floor.hints:
        places = [(run, run.wall.local(x, y)) for run in runs]
        away += min(abs(t) + max(run.s_from - s, 0.0, s - run.s_to) for run, (s, t) in places)
    return away


def _shapes(floor: Floor, spots: list[Spot], depth: float) -> list[list[Run]]:
    """Every I, L and U that the free spans allow."""
    shapes = [[Run(*spot)] for spot in spots]
    corners = []
    for first in spots:
        for second in spots:
            if _meet(floor, first, second):
                corners.append((first, second))
    for first, second in corners:
        shapes += _corner_runs(first, second, depth)
    for first, second in corners:
        for again, third in corners:
            if again is second and third is not first:
                shapes += _u_runs(first, second, third, depth)
    return shapes


def _meet(floor: Floor, first: Spot, second: Spot) -> bool:
    """Whether the second span starts in the square corner where the first one ends."""
    following = (first.wall.index + 1) % len(floor.walls)
    square = abs(first.wall.ux * second.wall.ux + first.wall.uy * second.wall.uy) < 0.03
    return (
        second.wall.index == following
        and square
        and first.wall.ux * second.wall.uy - first.wall.uy * second.wall.ux > 0
        and first.s_to > first.wall.length - 1e-6
        and second.s_from < 1e-6
    )


def _corner_runs(first: Spot, second: Spot, depth: float) -> list[list[Run]]:
    """The corner belongs to one of the two runs; the other starts beside it."""
    runs = []
    if first.length >= BLIND_M and second.length - depth >= 0.6:
        runs.append([
            Run(first.wall, first.s_from, first.s_to, blind_end=True),
            Run(second.wall, depth, second.s_to, joins_start=True),
        ])  # fmt: skip
    if second.length >= BLIND_M and first.length - depth >= 0.6:
        runs.append([
            Run(first.wall, first.s_from, first.s_to - depth, joins_end=True),
            Run(second.wall, second.s_from, second.s_to, blind_start=True),
        ])  # fmt: skip
    return runs


def _u_runs(first: Spot, second: Spot, third: Spot, depth: float) -> list[list[Run]]:
    """The middle run keeps both corners."""
    if second.length < 2 * depth + 0.9 or first.length - depth < 0.6 or third.length - depth < 0.6:
        return []
    return [[
        Run(first.wall, first.s_from, first.s_to - depth, joins_end=True),
        Run(second.wall, second.s_from, second.s_to, blind_start=True, blind_end=True),
        Run(third.wall, depth, third.s_to, joins_start=True),
    ]]  # fmt: skip


def _fill(
    floor: Floor, runs: list[Run], depth: float, height: float, has_refrigerator: bool
) -> None:
    dice = floor.dice
    has_oven = dice.random() < floor.mix.electrical
    runs = _trimmed(runs)
    owns = _shared_out(floor, runs, has_refrigerator, has_oven)
    for run, own in zip(runs, owns, strict=True):
        modules = pack(dice, run.length, own, _window_at(floor, run), run.blind_start,
                       run.blind_end, BLIND_M, _tall_at_end(dice, run),
                       floor.mix.cabinets_m)  # fmt: skip
        _put_modules(floor, run, modules, depth, height)


def _tall_at_end(dice: random.Random, run: Run) -> bool:
    """Whether refrigerator and oven stand at a run's end: the one that is in no corner."""
    if run.blind_start or run.joins_start:
        return True
    return not (run.blind_end or run.joins_end) and dice.random() < 0.5


def _shared_out(
    floor: Floor, runs: list[Run], has_refrigerator: bool, has_oven: bool
) -> list[set[str]]:
    """Which run takes what: the sink where there is light, the cooker on another run where there is
    one, and what is tall where most counter is left.
    """
    free = [run.length - BLIND_M * (run.blind_start + run.blind_end) for run in runs]
    owns: list[set[str]] = [set() for _ in runs]

    def give(category: str, i: int, taken_m: float) -> None:
        owns[i].add(category)
        free[i] -= taken_m

    give("sink_cabinet", runs.index(_sink_run(floor, runs)), 0.7)
    give("cooker_cabinet", max(range(len(runs)), key=lambda i: free[i]), 0.7)
    for category, is_wanted in (
        ("refrigerator", has_refrigerator), ("electrical_floor_cabinet", has_oven),
    ):  # fmt: skip
        open_ends = [i for i, run in enumerate(runs) if not (run.blind_start and run.blind_end)]
        i = max(open_ends, key=lambda i: free[i], default=None)
        if is_wanted and i is not None and free[i] >= 0.6:
            give(category, i, 0.6)
    return owns


def _trimmed(runs: list[Run]) -> list[Run]:
    """Very long runs end where there is enough counter; corners stay joined."""
    longest = 3.6 if len(runs) == 1 else 3.0
    trimmed = []
    for run in runs:
        extra = run.length - longest
        if extra > 0.0 and not (run.blind_start and run.blind_end):
            if run.blind_end or run.joins_end:
                run = run._replace(s_from=run.s_from + extra)
            else:
                run = run._replace(s_to=run.s_to - extra)
        trimmed.append(run)
    return trimmed


def _sink_run(floor: Floor, runs: list[Run]) -> Run:
    lit = [run for run in runs if _window_at(floor, run) is not None]
    return max(lit or runs, key=lambda run: run.length)


def _window_at(floor: Floor, run: Run) -> float | None:
    """Middle of a window over this run, from the run's start."""
    for wall, s_from, s_to, _ in floor.windows:
        middle = (s_from + s_to) / 2
        if wall is run.wall and run.s_from < middle < run.s_to:
            return middle - run.s_from
    return None


def _put_modules(
    floor: Floor, run: Run, modules: list[Module], depth: float, height: float
) -> None:
    floor.new_group()
    s = run.s_from
    if run.joins_end or run.blind_end:
        s = run.s_to - sum(module.length_m for module in modules)
    for module in modules:
        size = (module.length_m, depth, height)
        if module.category == "refrigerator":
            size = (module.length_m, max(depth, 0.6), 1.8)
        low, high = s, s + module.length_m
        if size[2] > height and not run.wall.fits(low, high, 0.0, size[1], size[2]):
            size = (module.length_m, depth, height)
            module = module._replace(category="double_door_floor_cabinet")
        floor.put(module.category, run.wall, (low + high) / 2, size,
                  core=module.category != "refrigerator")  # fmt: skip
        s = high
