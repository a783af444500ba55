"""Bathrooms, washrooms and WCs composed along their walls by the clearances of the planning rules.

Every fixture has places along all walls, in a few sizes, each with the floor that people need to
use it. Places of all fixtures are combined, the cheapest first: what stands in other pieces or
before openings is left out, floor that is missed costs what its rule weighs. The best combinations
are changes, which improve.improved weighs by all rules.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from chord_usd.base.metrics.complete import ESSENTIALS, FEWER_BELOW_M2, lacking
from chord_usd.base.metrics.design.bathroom_rules import (
    BASIN_FROM_M2,
    BASINS,
    WET,
    faces_door,
)
from chord_usd.base.metrics.design.price import beyond_walls, conflicts
from chord_usd.base.metrics.design.shell import TOUCH_M, Rects
from chord_usd.base.metrics.design.view import View
from chord_usd.base.places.wall_frames import Size, WallFrame
from chord_usd.base.scene.palette import CATEGORIES, having
from chord_usd.base.scene.types import Box, FloatArray, Item
from chord_usd.line.lists.changes import Change, new_piece
from chord_usd.line.lists.improve import free_of_clashes

LAUNDRY = having("laundry")
FIXTURES = ("toilet", *WET, *BASINS, *LAUNDRY)
_SIZES: Mapping[str, tuple[tuple[float, float], ...]] = {
    "toilet": (), "washing_set": (),
    "washbasin": ((0.55, 0.4), (0.5, 0.36), (0.6, 0.45), (0.45, 0.3)),
    "shower": ((0.9, 0.9), (0.8, 0.8), (1.2, 0.8)),
    "bathtub": ((1.7, 0.75), (1.5, 0.7), (1.4, 0.7)),
    "washing_machine": ((0.6, 0.6),),
}  # fmt: skip
"""Length and depth that a fixture is tried in beside those it has."""
_NEW_M: Mapping[str, Size] = {
    "toilet": (0.38, 0.62, 0.78), "washbasin": (0.5, 0.4, 0.85), "shower": (0.8, 0.8, 2.0),
    "bathtub": (1.5, 0.7, 0.55), "washing_machine": (0.6, 0.6, 0.85),
}  # fmt: skip
_NEEDS: Mapping[str, tuple[tuple[float, float, float], ...]] = {
    "toilet": ((0.80, 0.60, 2.0), (0.92, 0.76, 0.6)),
    "washbasin": ((0.76, 0.70, 1.5), (1.02, 0.76, 0.3)),
    "washing_set": ((0.0, 0.70, 1.0),), "washing_machine": ((0.0, 0.60, 0.3),),
}  # fmt: skip
"""Width and depth of the floor before a fixture, and what the rules about it weigh."""
_ENTRY_M, _ENTRY = 0.6, ((0.60, 1.0), (0.76, 0.3))
"""Width of the floor at one side of a bath or shower; depths, and what their rules weigh."""
_LEAST: Mapping[str, tuple[float, float]] = {
    "washbasin": (0.5, 0.0), "shower": (0.8, 0.8), "bathtub": (1.5, 0.0),
}  # fmt: skip
_STEP_M, _WET_STEP_M, _SLACK_M = 0.1, 0.3, 0.015
_IN_MID_WALL = 0.25
"""Of a bath or shower that stands in no corner."""
_PLACES, _BEAM, _OFFERED = 40, 200, 22
"""Of a fixture; of combinations on the way; of rooms that are weighed by all rules, all together.
"""
_MOST_FIXTURES = 4


@dataclass(frozen=True, eq=False)
class _Places:
    """Where one fixture may stand, the cheapest places first."""

    items: list[Item]
    rects: Rects
    zones: list[tuple[Rects, float]]
    """Floor that is needed before each, and what it weighs."""
    cost: FloatArray


def composed(view: View) -> Iterator[Change]:
    """The room with its fixtures placed together, the cheapest rooms first."""
    fixtures = [item for item in view.items if item.category in FIXTURES and not item.facts.locked]
    rest = tuple(item for item in view.items if item not in fixtures)
    kept = list(_rooms(view, rest, list(_wanted(view, fixtures))))
    yield from kept
    if not any(_stands_free(view, room) for room in kept):
        yield from _rooms(view, rest, list(_exchanged(view, fixtures)))


def _rooms(view: View, rest: Change, programmes: Sequence[list[Item]]) -> Iterator[Change]:
    programmes = [programme for programme in programmes if 0 < len(programme) <= _MOST_FIXTURES]
    for wanted in programmes:
        places = [_places(view, rest, item) for item in wanted]
        if all(len(place.items) for place in places):
            for chosen in islice(_combined(places), _OFFERED // max(2, len(programmes))):
                yield (*rest, *(place.items[at] for place, at in zip(places, chosen, strict=True)))


def _stands_free(view: View, room: Change) -> bool:
    return bool((conflicts(View(view.shell, room)) <= TOUCH_M).all())


def _wanted(view: View, fixtures: Sequence[Item]) -> Iterator[list[Item]]:
    """What the room holds with what it lacks; without; with a shower in a bathroom that has nothing
    to wash in; in a small WC, the toilet alone."""
    kind, area_m2 = view.shell.kind, view.shell.area_m2
    missing = lacking(kind, area_m2, view.categories)
    by_name = {essential.name: essential.categories for essential in ESSENTIALS.get(kind, ())}
    new = [min(by_name[name] & _NEW_M.keys(), key=[*_NEW_M].index) for name in missing]
    if new:
        more = [new_piece(view, name, Box((0.0, 0.0, 0.0), _NEW_M[name], 0.0)) for name in new]
        yield _sorted([*fixtures, *more])
    yield _sorted(fixtures)
    if {"toilet", *WET} & {*view.categories} > {"toilet"} and not {*BASINS} & {
        *view.categories,
        *new,
    }:
        yield from _with_basin(view, fixtures)
    if kind == "bathroom" and not {*WET} & {*view.categories}:
        # What a home has a bathroom for: rather than a washing machine or a basin, where there is
        # no room for both.
        place = Box((0.0, 0.0, 0.0), _NEW_M["shower"], 0.0)
        shower = new_piece(view, "shower", place)
        yield _sorted([*fixtures, shower])
        for spare in (LAUNDRY, (*BASINS, *LAUNDRY)):
            yield _sorted([shower, *(item for item in fixtures if item.category not in spare)])
    if kind == "wc" and area_m2 < FEWER_BELOW_M2["wc"][0][0] and len(fixtures) > 1:
        yield [item for item in fixtures if item.category == "toilet"][:1]


def _with_basin(view: View, fixtures: Sequence[Item]) -> Iterator[list[Item]]:
    """Fixtures with a basin beside the toilet; with a shower, which takes less floor, in place of a
    bath."""
    if view.shell.area_m2 < BASIN_FROM_M2:
        return
    place = Box((0.0, 0.0, 0.0), _NEW_M["washbasin"], 0.0)
    basin = new_piece(view, "washbasin", place)
    yield _sorted([*fixtures, basin])
    if any(item.category == "bathtub" for item in fixtures):
        shower = new_piece(view, "shower", replace(place, size_m=_NEW_M["shower"]))
        yield _sorted([basin, shower, *(item for item in fixtures if item.category not in WET)])


def _exchanged(view: View, fixtures: Sequence[Item]) -> Iterator[list[Item]]:
    """A bath for a shower before an opening, or the other way round."""
    for at in np.flatnonzero(conflicts(view)[:, 1] > TOUCH_M):
        # A bath may stand before a window that a shower would cover, a shower beside a door.
        item = view.items[at]
        if item in fixtures and item.category in WET:
            name = next(name for name in WET if name != item.category)
            other = new_piece(view, name, Box((0.0, 0.0, 0.0), _NEW_M[name], 0.0))
            yield _sorted([other, *(fixture for fixture in fixtures if fixture is not item)])


def _sorted(items: Sequence[Item]) -> list[Item]:
    return sorted(items, key=lambda item: -item.box.size_m[0] * item.box.size_m[1])


def _places(view: View, rest: Change, item: Item) -> _Places:
    dear = dict(_boxes(view, item))
    options = [(*rest, replace(item, box=box)) for box in dear]
    items = [change[-1] for change in free_of_clashes(view, options)]
    if not items:
        return _Places([], Rects.of_boxes(()), [], np.zeros(0))
    entries = (0, -1, 1) if item.category in WET else (0,)
    # A bath or shower is entered over its front or over one of its sides.
    items = [item for item in items for _ in entries]
    rects = Rects.of_boxes([item.box for item in items])
    zones = _zones(item.category, rects, np.tile(entries, len(items) // len(entries)))
    standing = Rects.of_boxes([item.box for item in rest])
    cost = _own_cost(view, item.category, items) + [dear[item.box] for item in items]
    for zone, weight in zones:
        short = beyond_walls(zone.corners, view.shell)
        if rest:
            short = np.maximum(short, zone.depths(standing).max(axis=1))
        cost += _priced(short, weight)
    best = np.argsort(cost, kind="stable")[:_PLACES]
    return _Places([items[at] for at in best], rects.of(best),
                   [(zone.of(best), weight) for zone, weight in zones], cost[best])  # fmt: skip


def _boxes(view: View, item: Item) -> Iterator[tuple[Box, float]]:
    """Places along each wall and in its middle, and what a bath or shower costs out of a corner."""
    row = CATEGORIES[item.category]
    length, depth, height = item.box.size_m
    is_wet = item.category in WET
    for wide, deep in dict.fromkeys(((length, depth), *_SIZES[item.category])):
        size = (wide, deep, height)
        if row.is_undersized(size):
            continue
        for start, end in view.shell.walls:
            frame = WallFrame.between(start, end)
            boxes = list(frame.boxes(size, _WET_STEP_M if is_wet else _STEP_M))
            for nth, box in enumerate(boxes):
                yield box, _IN_MID_WALL * (is_wet and 0 < nth < len(boxes) - 1)
            if boxes and not is_wet:
                yield frame.box(frame.length_m / 2, 0.0, size, 0.0), 0.0


def _zones(category: str, rects: Rects, entries: FloatArray) -> list[tuple[Rects, float]]:
    if category not in WET:
        return [(_zone(rects, np.zeros(len(rects.at)), wide, deep), weight)
                for wide, deep, weight in _NEEDS[category]]  # fmt: skip
    return [(_zone(rects, entries, 0.0, deep), weight) for deep, weight in _ENTRY]


def _zone(rects: Rects, entries: FloatArray, wide_m: float, deep_m: float) -> Rects:
    """Floor before the front of pieces (0), as wide as these or wider and reaching to their back
    where it is; or beside them (-1 left, 1 right), as wide as an entry."""
    side = np.asarray(entries, float)[:, None]
    is_side = side != 0.0
    half = rects.half.copy()
    if wide_m > 0.0:
        half[:, 0] = np.maximum(half[:, 0], wide_m / 2)
        half[:, 1] += deep_m / 2
        return Rects(rects.at + rects.front * deep_m / 2, rects.right, rects.front, half - _SLACK_M)
    ahead = rects.front * (rects.half[:, 1:] + deep_m / 2)
    beside = rects.right * side * (rects.half[:, :1] + deep_m / 2)
    front = np.stack([np.minimum(half[:, 0], _ENTRY_M / 2), np.full(len(half), deep_m / 2)], axis=1)
    aside = np.stack([np.full(len(half), deep_m / 2), half[:, 1] - 0.1], axis=1)
    return Rects(rects.at + np.where(is_side, beside, ahead), rects.right, rects.front,
                 np.where(is_side, aside, front) - _SLACK_M)  # fmt: skip


def _own_cost(view: View, category: str, items: Sequence[Item]) -> FloatArray:
    """Sizes, and a toilet that faces the door."""
    cost = np.zeros(len(items))
    least = _LEAST.get(category)
    if least:
        sizes = np.array([item.box.size_m[:2] for item in items])
        cost += ((sizes < np.array(least) - 1e-6).any(axis=1)) * 1.0
    if category == "shower":
        cost += 0.3 * (np.array([min(item.box.size_m[:2]) for item in items]) < 0.9 - 1e-6)
    if category == "washbasin":
        # The painter leaves basins up to 5 cm shorter than they are listed.
        cost += 0.1 * (np.array([item.box.size_m[0] for item in items]) < 0.55 - 1e-6)
    if category == "toilet":
        seen = View(view.shell, tuple(items))
        cost += [1.0 * faces_door(seen, at) for at in range(len(items))]
    return cost


def _priced(short: FloatArray, weight: float) -> FloatArray:
    """What missed floor costs: most of it for any, the rest by how much is missed."""
    return np.where(short > TOUCH_M, weight * (0.6 + np.minimum(short, 0.8) / 2), 0.0)


def _combined(places: Sequence[_Places]) -> Iterator[tuple[int, ...]]:
    """Numbers of places of all fixtures together, the cheapest first."""
    chosen = np.arange(len(places[0].items))[:, None]
    cost = places[0].cost
    for nth, choices in enumerate(places[1:], 1):
        total = cost[:, None] + choices.cost[None]
        for before, other in enumerate(places[:nth]):
            total = total + _together(other, choices)[chosen[:, before]]
        order = np.argsort(total, axis=None, kind="stable")[:_BEAM]
        order = order[np.isfinite(total.ravel()[order])]
        first, second = np.unravel_index(order, total.shape)
        chosen, cost = np.column_stack([chosen[first], second]), total.ravel()[order]
    seen: set[tuple[int, ...]] = set()
    for row in chosen[:_BEAM].tolist():
        # Places that differ in the entry alone are one.
        key = tuple(id(place.items[at]) for place, at in zip(places, row, strict=True))
        if key not in seen:
            seen.add(key)
            yield tuple(row)


def _together(places: _Places, other: _Places) -> FloatArray:
    """(N, M) what places of two fixtures cost beside each other; infinite where they overlap."""
    cost = np.where(places.rects.depths(other.rects) > TOUCH_M, np.inf, 0.0)
    for zone, weight in places.zones:
        cost += _priced(zone.depths(other.rects), weight)
    for zone, weight in other.zones:
        cost += _priced(zone.depths(places.rects), weight).T
    return cost
