"""Small changes to a room that may keep more planning rules: wardrobes as long as their sleepers
need, pairs of bedside tables, showers that one can stand in, seats that face the group."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from chord_usd.base.metrics.complete import WALLED
from chord_usd.base.metrics.design.bedroom_rules import bedside
from chord_usd.base.metrics.design.kitchen_rules import LAUNDRY, runs_of
from chord_usd.base.metrics.design.view import View
from chord_usd.base.places.wall_frames import Size, WallFrame
from chord_usd.base.scene.geometry import to_world
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Box, FloatArray, Item
from chord_usd.base.scene.units import wrap_deg

SHOWERS_M = (0.9, 0.8)
TABLE_TO_SOFA_M = 0.4
ARMCHAIRS_OUT_M = (0.25, 0.4, 0.1)
"""From the coffee table, or an end of the sofa."""
SLIDES_M = (0.3, 0.6, 0.9, 1.2)
WALL_STEP_M = 0.3
_WALL_PLACES = 200
"""About so many places along all walls of a room: halls have them farther apart."""
SHARES = (1.0, 0.85, 0.7)
"""Of its length, that a piece at a wall is placed again with."""
_SINGLE, _NARROWEST_M, _WIDEST_M, _TOUCH_M = "single_door_floor_cabinet", 0.15, 0.6, 0.01
"""Units with one door, and their widths."""
NEAR_M = (0.1, 0.2, 0.35, 0.5)
"""Steps from where a piece stood."""

_GROUP = ("sofa", "sofa_background", "coffee_table", "single_sofa", "leisure_sofa")
"""What moves with a sofa."""

Change = tuple[Item, ...]
"""All pieces of a room after a change."""
Propose = Callable[[View], Iterator[Change]]


def placed_again(lost: Item) -> Propose:
    """A piece that is no longer there: near where it stood, or else, in shorter sizes too, at a
    wall."""

    def propose(view: View) -> Iterator[Change]:
        for box in _near(lost.box):
            yield (*view.items, replace(lost, box=box))
        if lost.category not in WALLED:
            return
        length, depth, height = lost.box.size_m
        least = CATEGORIES[lost.category].length_m[0]
        for share in SHARES:
            if length * share >= least:
                for box in at_walls(view, (length * share, depth, height)):
                    yield (*view.items, replace(lost, box=box))

    return propose


def _near(box: Box) -> Iterator[Box]:
    """The same place, and places a step away along each of its axes."""
    yield box
    for step in NEAR_M:
        for u, v in ((step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)):
            yield resized(box, *box.size_m[:2], u, v)


def at_walls(view: View, size: Size, step_m: float = WALL_STEP_M) -> Iterator[Box]:
    """A piece of this size with its back to each wall, every step_m, farther apart in halls."""
    around_m = sum(math.dist(start, end) for start, end in view.shell.walls)
    step_m = max(step_m, around_m / _WALL_PLACES)
    for start, end in view.shell.walls:
        yield from WallFrame.between(start, end).boxes(size, step_m)


def new_piece(view: View, category: str, box: Box, number: int = 0) -> Item:
    room = view.shell.room.id
    return Item(f"{room}/{category}_new_{number}", category, box, room)


def but(view: View, numbers: Sequence[int]) -> tuple[Item, ...]:
    """The pieces of a room without some."""
    return tuple(item for at, item in enumerate(view.items) if at not in numbers)


def loose(view: View, numbers: Iterable[int]) -> list[int]:
    """Those of some pieces that the plan does not show: these may move and go."""
    return [at for at in numbers if not view.items[at].facts.locked]


def with_box(view: View, at: int, box: Box) -> Change:
    items = list(view.items)
    items[at] = replace(items[at], box=box)
    return tuple(items)


def resized(box: Box, length: float, depth: float, u: float, v: float) -> Box:
    """Another size about a point of its own frame, y to the back."""
    x, y = to_world(box, (u, v))
    return replace(box, center_m=(float(x), float(y), box.center_m[2]),
                   size_m=(length, depth, box.size_m[2]))  # fmt: skip


def grown(box: Box, length: float, depth: float) -> Iterator[Box]:
    """A piece of another size with its back where it is: to the left, to both sides, to the
    right."""
    back = (box.size_m[1] - depth) / 2
    for share in (-0.5, 0.0, 0.5):
        yield resized(box, length, depth, share * (length - box.size_m[0]), back)


def _bedsides(view: View) -> Iterator[Change]:
    """Tables of one size on both sides of the bed, at its head."""
    for bed in view.of("bed")[:1]:
        tables = bedside(view, bed)
        sizes = [view.items[at].box.size_m for at in tables] or [(0.45, 0.4, 0.5)]
        box = view.items[bed].box
        rest = but(view, loose(view, tables))
        for size in (*sizes, (0.4, 0.4, 0.5)):
            pair = beside_bed(view, box, size)
            yield (*rest, *pair)
            for table in pair:
                yield (*rest, table)


def beside_bed(view: View, bed: Box, size: Size) -> list[Item]:
    """Tables on both sides of a bed, at its head."""
    back = (bed.size_m[1] - size[1]) / 2
    pair = []
    for nth, side in enumerate((-1, 1)):
        x, y = to_world(bed, (side * (bed.size_m[0] + size[0]) / 2, back))
        place = Box((float(x), float(y), 0.0), size, bed.yaw_deg)
        pair.append(new_piece(view, "bedside_table", place, nth))
    return pair


def _shower(view: View) -> Iterator[Change]:
    """As large as one stands in well, one of its corners or ends in place."""
    for at in view.of("shower")[:1]:
        box = view.items[at].box
        for side in SHOWERS_M:
            length, depth = max(box.size_m[0], side), max(box.size_m[1], side)
            for larger in grown(box, length, depth):
                yield with_box(view, at, larger)


def _basin(view: View) -> Iterator[Change]:
    for at in view.of("washbasin")[:1]:
        box = view.items[at].box
        for length in (0.6, 0.5):
            yield from (with_box(view, at, larger) for larger in grown(box, length, box.size_m[1]))


def longest_sofa(view: View) -> int | None:
    """Number of the sofa that others are arranged about: the longest, of those that the plan shows
    if it shows any."""
    sofas = view.of("sofa")
    return max(sofas, key=lambda at: (view.items[at].facts.locked, view.length[at]), default=None)


def _coffee_table(view: View) -> Iterator[Change]:
    """The table before the middle of the sofa, in easy reach."""
    sofa, tables = longest_sofa(view), view.of("coffee_table")
    if sofa is None:
        return
    box = view.items[sofa].box
    size = view.items[tables[0]].box.size_m if tables else (0.9, 0.55, 0.42)
    ahead = -(box.size_m[1] / 2 + TABLE_TO_SOFA_M + size[1] / 2)
    x, y = to_world(box, (0.0, ahead))
    place = Box((float(x), float(y), 0.0), size, box.yaw_deg)
    if tables:
        yield with_box(view, tables[0], place)
    else:
        yield (*view.items, new_piece(view, "coffee_table", place))


def _armchairs(view: View) -> Iterator[Change]:
    """Armchairs at both ends of the coffee table, turned to it."""
    sofa, tables = longest_sofa(view), view.of("coffee_table")
    if sofa is None:
        return
    box = view.items[sofa].box
    focus = tables[0] if tables else sofa
    u, v = view.own(sofa, view.at[focus])
    chairs = view.of("single_sofa", "leisure_sofa")
    size = view.items[chairs[0]].box.size_m if chairs else (0.8, 0.8, 0.85)
    category = view.categories[chairs[0]] if chairs else "single_sofa"
    rest = but(view, loose(view, chairs))
    reach = max(float(view.length[sofa]), float(view.length[focus])) / 2 + size[1] / 2
    seats = []
    for nth, side in enumerate((-1, 1)):
        for out in ARMCHAIRS_OUT_M:
            x, y = to_world(box, (u + side * (reach + out), -v - 0.1))
            yaw = wrap_deg(box.yaw_deg - 90.0 * side)
            place = Box((float(x), float(y), 0.0), size, yaw)
            seats.append((side, new_piece(view, category, place, nth)))
    for _, seat in seats:
        yield (*rest, seat)
    for side, seat in seats:
        for other_side, other in seats:
            if side < other_side:
                yield (*rest, seat, other)
    for at in chairs:
        yield but(view, [at])


def _slid(category: str) -> Callable[[View], Iterator[Change]]:
    def propose(view: View) -> Iterator[Change]:
        """A piece farther along its wall, as off a window."""
        for at in view.of(category)[:1]:
            box = view.items[at].box
            for length in {float(box.size_m[0]), min(1.2, float(box.size_m[0]))}:
                for step in (0.0, *SLIDES_M):
                    for side in (-1, 1):
                        yield with_box(
                            view, at, resized(box, length, box.size_m[1], side * step, 0)
                        )

    return propose


def _on_axis(view: View) -> Iterator[Change]:
    """The television's cabinet before the middle of the sofa; or the whole group moved aside, to
    the middle of what it faces."""
    sofa = longest_sofa(view)
    if sofa is None or not view.televisions:
        return
    at_sofa = view.at[sofa]
    screen = min(view.televisions, key=lambda candidate: float(np.hypot(*(candidate.at - at_sofa))))
    aside = float(view.own(sofa, screen.at)[0])
    for at in view.of("tv_cabinet"):
        if view.items[at].id == screen.id:
            for share in (1.0, 0.6):
                u = float((view.right[sofa] @ view.right[at]) * -aside * share)
                box = view.items[at].box
                yield with_box(view, at, resized(box, *box.size_m[:2], u, 0.0))
    group = loose(view, view.of(*_GROUP))
    rest = but(view, group)
    for share in (1.0, 0.6, 0.3):
        step = view.right[sofa] * aside * share
        yield (*rest, *(_shifted(view.items[at], step) for at in group))


def _to_wall(view: View) -> Iterator[Change]:
    """The whole group moved back, so that no slit is left behind the sofa."""
    sofa = longest_sofa(view)
    if sofa is None:
        return
    half = float(view.length[sofa]) / 2 - 0.1
    free = view.behind(sofa, -half, half, view.of("sofa_background"))
    group = loose(view, view.of(*_GROUP))
    rest = but(view, group)
    for step in (free - _TOUCH_M, free - 0.6):
        back = -view.front[sofa] * step
        yield (*rest, *(_shifted(view.items[at], back) for at in group))


def _shifted(item: Item, step: FloatArray) -> Item:
    x, y, z = item.box.center_m
    dx, dy = step.tolist()
    return replace(item, box=replace(item.box, center_m=(x + dx, y + dy, z)))


def _without_bare(view: View) -> Iterator[Change]:
    """No cabinet for a television that has no place on it."""
    if view.bare:
        yield but(view, view.bare)


def _washer(view: View) -> Iterator[Change]:
    """The washing machine at an end of a run of units, or in place of plain units there, of which
    one stays narrower between it and the rest."""
    runs, machines = runs_of(view), view.of(*LAUNDRY)[:1]
    if runs is None or not machines:
        return
    machine = view.items[machines[0]]
    length, depth, _ = machine.box.size_m
    for unit, side in product(runs.units, (-1, 1)):
        if runs.beside(unit, side) is not None or runs.round_corner(unit, side) is not None:
            continue
        box = view.items[unit].box
        back, half = (box.size_m[1] - depth) / 2, box.size_m[0] / 2
        beside = _kept_high(machine, box, side * (half + length / 2), back)
        yield (*but(view, machines), beside)
        freed, going, here = 0.0, [*machines], unit
        while freed < length and view.items[here].facts.unit == "" and runs.is_top(here):
            going.append(here)
            freed += float(view.length[here])
            inward = runs.beside(here, -side)
            if inward is None:
                break
            here = inward
        spare = freed - length
        if spare < -_TOUCH_M:
            continue
        inside = _kept_high(machine, box, side * (half - length / 2), back)
        if spare < _NARROWEST_M:  # no unit is so narrow: it stands beside the rest
            inside = _kept_high(machine, box, side * (half - spare - length / 2), back)
            yield (*but(view, going), inside)
        elif spare <= _WIDEST_M:
            narrow = resized(box, spare, box.size_m[1], side * (half - length - spare / 2), 0.0)
            rest = replace(view.items[going[-1]], category=_SINGLE, box=narrow)
            yield (*but(view, going), rest, inside)


def _kept_high(item: Item, box: Box, u: float, v: float) -> Item:
    """A piece about a point in the frame of another box."""
    length, depth, height = item.box.size_m
    there = resized(box, length, depth, u, v)
    return replace(item, box=replace(there, size_m=(length, depth, height)))


BY_KIND = {
    "kitchen": (_washer,),
    "bedroom": (_bedsides,),
    "bathroom": (_shower, _basin),
    "washroom": (_basin,),
    "wc": (_basin,),
    "living": (_slid("tv_cabinet"), _on_axis, _to_wall, _without_bare, _coffee_table, _armchairs),
}
"""By kind of room, in order."""
