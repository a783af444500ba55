"""Living rooms: the sofa group that faces the television, and what stands around it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from chord_usd.workshop.data.furnish import sizes
from chord_usd.workshop.data.furnish.dining import put_dining_table
from chord_usd.workshop.data.furnish.floor import Floor, Size
from chord_usd.workshop.data.furnish.free_spans import MARGIN_M, REACH, Wall
from chord_usd.workshop.data.furnish.mix import count_of
from chord_usd.workshop.data.furnish.storage import (
    put_armchair,
    put_cabinet,
    put_dining_cabinet,
    put_shoe_cabinet,
)
from chord_usd.workshop.data.furnish.workplace import put_desk

NEAREST_M, FARTHEST_M = 2.3, 6.0
"""Distance between the walls of sofa and television."""

LARGE_M2 = 22.0
"""Larger rooms have more than one use."""

PASS_M = 0.4
"""Least gap between the coffee table and the television."""


class Axis(NamedTuple):
    """Sofa against one wall, television against the facing one, both on the same axis."""

    score: float
    sofa_wall: Wall
    sofa_s: float
    tv_wall: Wall
    tv_s: float
    across_m: float


def furnish_living(floor: Floor, *, with_dining: bool) -> None:
    """with_dining: the house has no other place for the dining table."""
    dice, mix = floor.dice, floor.mix
    put_sofa_group(floor)
    dining = mix.living_dining if floor.area_m2 > 24.0 else mix.living_dining_small
    if with_dining and dice.random() < dining:
        put_dining_table(floor)
    if dice.random() < mix.shoe_cabinet:
        put_shoe_cabinet(floor)
    has_table = floor.has("dining_table")
    if dice.random() < (mix.dining_cabinet_at_table if has_table else mix.dining_cabinet_living):
        put_dining_cabinet(floor, dice.uniform(0.9, 1.8))
    if floor.area_m2 > 14.0 and dice.random() < mix.living_armchair:
        put_armchair(floor)
    if floor.area_m2 > 12.0 and dice.random() < mix.living_cabinet:
        put_cabinet(floor, tall=dice.random() < 0.4, longest=dice.uniform(0.8, 1.8))
    if floor.area_m2 > LARGE_M2:
        _put_more(floor)


def _put_more(floor: Floor) -> None:
    """A place to work, one to read, shelves: what a large room is used for beside its sofas."""
    dice = floor.dice
    more: list[Callable[[], bool]] = [
        partial(put_desk, floor),
        partial(put_armchair, floor, beside_table=0.9),
        partial(put_cabinet, floor, tall=True, longest=dice.uniform(1.2, 2.2)),
        partial(put_cabinet, floor, tall=False, longest=dice.uniform(1.2, 2.0)),
    ]
    for put in dice.sample(more, len(more)):
        if floor.covered >= floor.mix.living_covered:
            break
        put()


def put_sofa_group(floor: Floor) -> None:
    """The longest sofa that fits with a television opposite; else a sofa alone; else armchairs."""
    dice = floor.dice
    usual = min(2.6, 1.65 + 0.05 * floor.area_m2)
    for length in (usual + dice.uniform(-0.25, 0.3), 2.2, 1.9, 1.5):
        sofa = _sofa(floor, length)
        panel = sizes.panel(dice, "sofa_background", sofa[0]) if dice.random() < 0.97 else None
        tv_m = min(2.6, sofa[0] + 0.2)
        tv = sizes.sampled(dice, "tv_cabinet", shortest=0.7 * tv_m, longest=tv_m, shallowest=0.4)
        axis = _best_axis(floor, sofa, tv, panel[1] if panel else 0.0)
        if axis:
            _stand_group(floor, axis, sofa, tv, panel)
            return
    sofa = _sofa(floor, 1.5)
    for least in (sofa, (1.4, 0.8, 0.75)):
        if _put_lone_sofa(floor, least):
            return
    put_armchair(floor)


def _sofa(floor: Floor, length: float) -> Size:
    dice = floor.dice
    length = min(3.2, max(1.4, round(length * 20) / 20))
    return length, sizes.between(dice, 0.85, 1.1), sizes.between(dice, 0.75, 0.95)


def _put_lone_sofa(floor: Floor, sofa: Size) -> bool:
    """A sofa against the longest free wall, without a television."""
    spots = list(floor.spots(sofa[1], sofa[2], 0.5, sofa[0]))
    if not spots:
        return False
    spot = max(spots, key=lambda spot: spot.length)
    floor.new_group()
    s = (spot.s_from + spot.s_to) / 2
    floor.put("sofa", spot.wall, s, sofa, core=True)
    front = _put_coffee_table(floor, spot.wall, s, sofa[1], 2.0, sofa[0])
    _put_side_table(floor, spot.wall, s, sofa[0])
    floor.keep(spot.wall, s - sofa[0] / 2, s + sofa[0] / 2, sofa[1], front + 0.4, REACH)
    return True


def _best_axis(floor: Floor, sofa: Size, tv: Size, panel_m: float) -> Axis | None:
    axes = []
    depth = panel_m + sofa[1]
    height = 9.0 if panel_m else sofa[2]
    for wall in floor.walls:
        if wall.length < sofa[0]:
            continue
        spans = wall.gaps(depth, height, 0.6, sofa[0])
        if not spans:
            continue
        for facing in floor.facing(wall):
            across = wall.local(facing.x, facing.y)[1]
            if NEAREST_M <= across <= FARTHEST_M:
                axes += _axes(floor, wall, spans, facing, across, sofa, tv)
    return max(axes, key=lambda axis: axis.score, default=None)


def _axes(
    floor: Floor,
    wall: Wall,
    spans: list[tuple[float, float]],
    facing: Wall,
    across: float,
    sofa: Size,
    tv: Size,
) -> list[Axis]:
    """Every pair of a sofa span and a television span whose axes can meet."""
    axes = []
    mirror = wall.local(facing.x, facing.y)[0]
    for tv_from, tv_to in facing.gaps(tv[1], tv[2], 0.5, tv[0]):
        tv_low, tv_high = mirror - tv_to + tv[0] / 2, mirror - tv_from - tv[0] / 2
        for s_from, s_to in spans:
            low = max(s_from + sofa[0] / 2, tv_low)
            high = min(s_to - sofa[0] / 2, tv_high)
            if low > high + 1e-6:
                continue
            s = min(max(_liked(floor, s_from, s_to, sofa[0]), low), max(low, high))
            score = floor.dice.uniform(0.0, 0.8) - abs(across - 3.3) * 0.5
            score += 0.3 * min(s_to - s_from, 5.0) - 0.8 * wall.has_window - 0.3 * wall.has_door
            score -= 0.7 * facing.has_window
            axes.append(Axis(score, wall, s, facing, mirror - s, across))
    return axes


def _liked(floor: Floor, s_from: float, s_to: float, length: float) -> float:
    """Middle of the span; in very long ones off to the end away from the door."""
    if s_to - s_from < length + 2.5:
        return (s_from + s_to) / 2
    return s_from + length / 2 + 0.8 if floor.dice.random() < 0.5 else s_to - length / 2 - 0.8


def _stand_group(floor: Floor, axis: Axis, sofa: Size, tv: Size, panel: Size | None) -> None:
    dice = floor.dice
    wall, s = axis.sofa_wall, axis.sofa_s
    floor.new_group()
    back = 0.0
    if panel:
        floor.put("sofa_background", wall, s, panel)
        back = panel[1]
    floor.put("sofa", wall, s, sofa, back=back, core=True)
    floor.new_group()
    floor.put("tv_cabinet", axis.tv_wall, axis.tv_s, tv)
    front = back + sofa[1]
    free = axis.across_m - tv[1] - front
    low, high = s - sofa[0] / 2, s + sofa[0] / 2
    if dice.random() < floor.mix.coffee_table:
        front = _put_coffee_table(floor, wall, s, front, free, sofa[0])
    _put_side_table(floor, wall, s, sofa[0])
    if free > 1.6:
        _put_single_sofas(floor, axis, sofa, back)
    # The middle of the group stays open, so that nothing comes between sofa and television.
    floor.keep(wall, low, high, back + sofa[1], axis.across_m - tv[1], REACH)


def _put_coffee_table(
    floor: Floor, wall: Wall, s: float, front: float, free: float, sofa_length: float
) -> float:
    """In front of the sofa. Returns where its far side is."""
    dice = floor.dice
    gap = sizes.between(dice, 0.25, 0.4)
    deepest = free - gap - PASS_M
    if deepest < 0.5:
        return front
    size = sizes.sampled(
        dice, "coffee_table", shortest=0.42 * sofa_length, longest=max(0.7, 0.65 * sofa_length),
        shallowest=0.6, deepest=min(0.9, deepest),
    )  # fmt: skip
    size = (size[0], min(size[1], size[0]), size[2])
    near = front + gap
    if not wall.fits(s - size[0] / 2, s + size[0] / 2, near, near + size[1]):
        return front
    floor.new_group()
    floor.put_turned("coffee_table", wall, s, near + size[1] / 2, size, 0)
    return near + size[1]


def _put_side_table(floor: Floor, wall: Wall, s: float, sofa_length: float) -> None:
    """Beside the sofa, flush with the wall."""
    dice = floor.dice
    if dice.random() > floor.mix.side_table:
        return
    size = sizes.square(dice, "side_coffee_table")
    for side in dice.sample((-1, 1), 2):
        middle = s + side * (sofa_length / 2 + MARGIN_M + size[0] / 2)
        low, high = middle - size[0] / 2, middle + size[0] / 2
        if wall.fits(low, high, 0.0, size[1], size[2]):
            floor.new_group()
            floor.put("side_coffee_table", wall, middle, size)
            return


def _put_single_sofas(floor: Floor, axis: Axis, sofa: Size, back: float) -> None:
    """At the sides of the coffee table, facing it."""
    dice = floor.dice
    wanted = count_of(dice, floor.mix.single_sofas)
    size = sizes.sampled(dice, "single_sofa", longest=0.95, deepest=0.95)
    wall, front = axis.sofa_wall, back + sofa[1]
    for side in dice.sample((-1, 1), 2)[:wanted]:
        for aside, ahead in ((0.1, 0.3), (0.1, 0.05), (-0.35, 0.6)):
            s = axis.sofa_s + side * (sofa[0] / 2 + size[1] / 2 + aside)
            t = front + ahead + size[0] / 2
            half = size[1] / 2, size[0] / 2
            if wall.fits(s - half[0], s + half[0], t - half[1], t + half[1], size[2]):
                floor.new_group()
                floor.put_turned("single_sofa", wall, s, t, size, 1 if side > 0 else 3)
                break
