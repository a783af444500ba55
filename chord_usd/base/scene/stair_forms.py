"""How the steps of a stair lie, to rule: straight, with a turn of a quarter (L) or a half (U), or
as modules beside this one divide it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Protocol

import numpy as np
from shapely import remove_repeated_points
from shapely.geometry import LineString, Polygon, box
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import polygons_of, to_world
from chord_usd.base.scene.stair_spirals import RIM_M, least_spiral_m, spirals
from chord_usd.base.scene.stair_winders import half_winders, quarter_winders
from chord_usd.base.scene.storeys import (
    CEILING_TO_FLOOR_M,
    HEADROOM_M,
    TO_RULE,
    WELL_M,
    Flight,
    Stair,
    StairForm,
    StairRule,
    Tread,
)
from chord_usd.base.scene.types import FloatArray

_L_WIDTH_M = 0.95
"""Of the flights of an L, whose box does not give it; less where the box is narrower."""

_TOO_SMALL: dict[StairForm, str] = {
    "L": "its flights would be too narrow, or its turn too short",
    "spiral": "its treads would be too narrow, or its own turns too low overhead",
}

_BEYOND_M = 0.35
"""How far the line that one walks begins before the first step and ends after the last."""

_CLEAR_M = 0.03
"""The floor above ends so far before the first step over which one needs it open."""

_STEP_M = 0.1
"""Thickness of a step that lies within the floor above."""

_STRIDE_M = 0.63
"""Twice the rise and the going, of the stair that is easiest to walk (Blondel)."""


@dataclass(frozen=True, eq=False)
class BuiltStair:
    """A stair with its steps."""

    stair: Stair
    height_m: float
    """From floor to floor."""
    rise_m: float
    going_m: float
    treads: tuple[Tread, ...]
    """From below."""
    flights: tuple[Flight, ...]
    turn_m: tuple[tuple[float, float], ...] = ()
    """The line one walks from one flight to the next, in the stair's own frame."""

    @property
    def area_m(self) -> Polygon:
        """What it takes up, in the world; an L leaves a part of its box free."""
        return self._in_world(self._own_area)

    @property
    def hole_m(self) -> Polygon:
        """Where the floor above must be open, in the world: all but the lower steps of the first
        flight, over which one stands upright below the ceiling; over a spiral stair, its circle."""
        if self.is_spiral:
            return self._in_world(self._steps_m)
        low = [
            tread.area_m for tread in self.treads
            if tread.edges_m is None and tread.top_m <= self.ceiling_m - HEADROOM_M + 1e-6
        ]  # fmt: skip
        area = self._own_area
        grown = [area.buffer(1e-6, join_style="mitre") for area in low]
        open_m = remove_repeated_points(area.difference(unary_union(grown)), 1e-6)
        return self._in_world(open_m.buffer(_CLEAR_M, join_style="mitre").intersection(area))

    @property
    def above_m(self) -> Polygon:
        """What it takes up of the upper storey, in the world: the hole, and the strip around a
        round one."""
        return self.area_m if self.is_spiral else self.hole_m

    @property
    def landing_m(self) -> Polygon | None:
        """What lies in the hole at the height of the upper floor, in the world; nothing but the
        landing of a spiral stair does."""
        return self._in_world(self.treads[-1].area_m) if self.is_spiral else None

    @property
    def approach_m(self) -> Polygon | None:
        """What must be floor within its area, in the world: where one steps on a spiral stair."""
        if not self.is_spiral:
            return None
        (x, y), (u, v) = (self.treads[0].edges_m[0].coords[at] for at in (0, -1))  # type: ignore[index]
        return self._in_world(Polygon([(x, y), (u, v), (-u, v), (-x, y)]))

    @property
    def is_spiral(self) -> bool:
        """Whether it winds round a pole."""
        return self.stair.form == "spiral"

    @property
    def under_m(self) -> Polygon:
        """What it takes up of the lower storey: the last step may lie within the floor above."""
        if self.is_spiral:
            return self.area_m
        within = [t.area_m for t in self.treads if t.top_m >= self.ceiling_m + _STEP_M - 1e-6]
        return self._in_world(self._own_area.difference(unary_union(within).buffer(1e-4)))

    @property
    def ceiling_m(self) -> float:
        """Its height over the lower floor."""
        return self.height_m - CEILING_TO_FLOOR_M

    @property
    def _steps_m(self) -> Polygon:
        """What lies below treads and landings, and between them, in its own frame."""
        union = unary_union([tread.area_m.buffer(1e-6) for tread in self.treads])
        return Polygon(union.exterior)

    @property
    def _own_area(self) -> Polygon:
        area = self._steps_m
        if self.is_spiral:
            return area.buffer(RIM_M, join_style="mitre").envelope
        if self.stair.form == "U":
            return area.envelope
        if self.stair.form == "winder_U":
            first, last = self.flights
            x, half = first.end_m[0], first.width_m / 2
            aside = 1.0 if last.start_m[0] > x else -1.0
            well = sorted((x + aside * half, last.start_m[0] - aside * half))
            front = max(first.start_m[1], last.end_m[1])
            area = area.union(box(well[0], front, well[1], self.stair.box.size_m[1] / 2 - 1e-6))
            return Polygon(area.exterior)
        return area

    def _in_world(self, local: BaseGeometry) -> Polygon:
        """Its largest part, to a tenth of a millimetre."""
        part = max(polygons_of(local), key=lambda polygon: polygon.area)
        tidy = part.simplify(1e-5)
        return Polygon(to_world(self.stair.box, np.asarray(tidy.exterior.coords)[:-1]).round(4))

    @property
    def departure_m(self) -> LineString:
        """The edge in the world over which one steps on below."""
        return self._edge(self.flights[0], self.flights[0].start_m)

    @property
    def arrival_m(self) -> LineString:
        """The edge in the world over which one steps off above."""
        return self._edge(self.flights[-1], self.flights[-1].end_m)

    @property
    def stepped_m(self) -> tuple[list[LineString], list[LineString]]:
        """The edges in the world over which one steps on below, and off above: of the stair, and
        of the treads of a spiral one, which begin and end within it."""
        edges = [self.departure_m], [self.arrival_m]
        if self.is_spiral:
            for ways, tread, at in ((edges[0], self.treads[0], 0), (edges[1], self.treads[-2], 1)):
                ways.append(LineString(to_world(self.stair.box, tread.edges_m[at].coords)))  # type: ignore[index]
        return edges

    @property
    def walk_m(self) -> FloatArray:
        """(N, 3) the line one walks, in the world, heights over the lower floor; from an arm's
        length before the first step to as far beyond the last."""
        points = list(_walking_line(self.flights, self.turn_m))
        places = to_world(self.stair.box, [point[:2] for point in points])
        return np.column_stack([places, [point[2] for point in points]])

    def _edge(self, flight: Flight, at_m: tuple[float, float]) -> LineString:
        (x, y), (ux, uy), half = at_m, flight.ahead, flight.width_m / 2
        ends = [(x - uy * half, y + ux * half), (x + uy * half, y - ux * half)]
        return LineString(to_world(self.stair.box, ends))


def build_stair(stair: Stair, height_m: float) -> BuiltStair:
    """The steps of a stair that rises so much. Raises PlanError where no stair to rule fits."""
    width_m, depth_m = stair.box.size_m[:2]
    rule = stair.rule
    layouts = list(_layouts(stair.form, width_m, depth_m, height_m, rule))
    fitting = [layout for layout in layouts if layout.going_m >= rule.going_m[0] - 1e-6]
    if not fitting:
        raise PlanError(
            f"a {stair.form} stair of {width_m:.2f} by {depth_m:.2f} m cannot rise {height_m:.2f} m"
            + (f": its steps would be {max(layout.going_m for layout in layouts) * 100:.0f} cm deep"
               if layouts else f": {_TOO_SMALL.get(stair.form, _TOO_SMALL['L'])}"),
            where=stair.id,
            expected=f"rises of {rule.rise_m[0] * 100:.0f} to {rule.rise_m[1] * 100:.0f} cm, "
            f"goings of {rule.going_m[0] * 100:.0f} to {rule.going_m[1] * 100:.0f} cm, flights of "
            f"{rule.width_m * 100:.0f} cm or more"
            + (f": a square of {least_square_m(height_m):.2f} m" if stair.form == "spiral" else ""),
        )  # fmt: skip
    best = min(fitting, key=lambda layout: (_strain(layout, height_m), layout.risers))
    rise_m = height_m / best.risers
    flights, others, turn = best.drawn(rise_m)
    treads = sorted([*_steps(flights, rise_m), *others], key=lambda tread: tread.top_m)
    if stair.turn == "left":
        flights = tuple(map(_mirrored_flight, flights))
        treads = [_mirrored(tread) for tread in treads]
        turn = [(-x, y) for x, y in turn]
    return BuiltStair(stair, height_m, rise_m, best.going_m, tuple(treads), flights, tuple(turn))


def least_run_m(height_m: float, rule: StairRule = TO_RULE) -> float:
    """Length of the shortest straight stair that keeps a rule and rises so much."""
    return (math.ceil(height_m / rule.rise_m[1] - 1e-9) - 1) * rule.going_m[0]


@cache
def least_square_m(height_m: float) -> float:
    """Side of the least square in which a spiral stair to rule rises so much."""
    return least_spiral_m(height_m, _risers(height_m, TO_RULE))


def _risers(height_m: float, rule: StairRule) -> range:
    least_m, most_m = rule.rise_m
    return range(math.ceil(height_m / most_m - 1e-9), math.floor(height_m / least_m + 1e-9) + 1)


class _Division(Protocol):
    """One way to divide a stair that turns right, if at all, into steps."""

    @property
    def risers(self) -> int: ...
    @property
    def going_m(self) -> float: ...
    def drawn(
        self, rise_m: float
    ) -> tuple[tuple[Flight, ...], list[Tread], list[tuple[float, float]]]:
        """Flights, what one steps on between them, and how one walks there."""
        ...


@dataclass(frozen=True)
class _Layout:
    """A division with a landing, if with a turn."""

    form: StairForm
    width_m: float
    depth_m: float
    risers: int
    first: int
    """Of these, in the first flight."""
    going_m: float
    flight_m: float
    """Width of a flight."""

    def drawn(
        self, rise_m: float
    ) -> tuple[tuple[Flight, ...], list[Tread], list[tuple[float, float]]]:
        """Flights, landings and the way over them. The last step ends at the edge of the box."""
        half_x, half_y = self.width_m / 2, self.depth_m / 2
        wide, last = self.flight_m, self.risers - self.first
        top_m, middle_m = self.risers * rise_m, self.first * rise_m
        if self.form == "straight":
            length = (self.risers - 1) * self.going_m
            start = (0.0, half_y - length)
            return (Flight(start, (0, 1), length, wide, 0.0, top_m),), [], []
        left = -half_x + wide / 2
        first_m, last_m = (self.first - 1) * self.going_m, (last - 1) * self.going_m
        if self.form == "U":
            landing = box(-half_x, -half_y + first_m, half_x, half_y)
            flights = (
                Flight((left, -half_y), (0, 1), first_m, wide, 0.0, middle_m),
                Flight((-left, -half_y + last_m), (0, -1), last_m, wide, middle_m, top_m),
            )
            y = -half_y + first_m + wide / 2
            turn = [(left, y), (-left, y)]
            return flights, [Tread(landing, middle_m, is_landing=True)], turn
        landing = box(-half_x, half_y - wide, half_x - last_m, half_y)
        flights = (
            Flight((left, half_y - wide - first_m), (0, 1), first_m, wide, 0.0, middle_m),
            Flight((half_x - last_m, half_y - wide / 2), (1, 0), last_m, wide, middle_m, top_m),
        )
        turn = [(left, half_y - wide / 2)]
        return flights, [Tread(landing, middle_m, is_landing=True)], turn


def _straight(width_m: float, depth_m: float, risers: int, rule: StairRule) -> Iterator[_Layout]:
    if width_m >= rule.width_m - 1e-6 and risers > 1:
        going_m = min(rule.going_m[1], depth_m / (risers - 1))
        yield _Layout("straight", width_m, depth_m, risers, risers, going_m, width_m)


def _u(width_m: float, depth_m: float, risers: int, rule: StairRule) -> Iterator[_Layout]:
    flight_m = (width_m - WELL_M) / 2
    if flight_m < rule.width_m - 1e-6 or risers % 2 or risers < 4:
        return
    going_m = min(rule.going_m[1], (depth_m - flight_m) / (risers // 2 - 1))
    yield _Layout("U", width_m, depth_m, risers, risers // 2, going_m, flight_m)


def _l(width_m: float, depth_m: float, risers: int, rule: StairRule) -> Iterator[_Layout]:
    flight_m = min(_L_WIDTH_M, width_m / 2, depth_m / 2)
    if flight_m < rule.width_m - 1e-6:
        return
    for first in range(2, risers - 1):
        going_m = min(rule.going_m[1], (depth_m - flight_m) / (first - 1),
                      (width_m - flight_m) / (risers - first - 1))  # fmt: skip
        yield _Layout("L", width_m, depth_m, risers, first, going_m, flight_m)


_LAYOUTS: dict[StairForm, Callable[[float, float, int, StairRule], Iterator[_Division]]] = {
    "straight": _straight, "L": _l, "U": _u, "winder_L": quarter_winders, "winder_U": half_winders,
}  # fmt: skip


def _layouts(
    form: StairForm, width_m: float, depth_m: float, height_m: float, rule: StairRule
) -> Iterator[_Division]:
    """All divisions of a box. A spiral stair's depend on how much lies a turn below."""
    for risers in _risers(height_m, rule):
        if form == "spiral":
            yield from spirals(width_m, depth_m, risers, height_m)
        else:
            yield from _LAYOUTS[form](width_m, depth_m, risers, rule)


def _strain(layout: _Division, height_m: float) -> float:
    return round(abs(2 * height_m / layout.risers + layout.going_m - _STRIDE_M), 4)


def _steps(flights: tuple[Flight, ...], rise_m: float) -> Iterator[Tread]:
    """The steps of all flights; the last rise of each leads onto a landing or the upper floor."""
    for flight in flights:
        count = round((flight.high_m - flight.low_m) / rise_m) - 1
        (x, y), (ux, uy), half = flight.start_m, flight.ahead, flight.width_m / 2
        for index in range(count):
            near, far = flight.length_m * index / count, flight.length_m * (index + 1) / count
            xs = sorted((x + ux * near - abs(uy) * half, x + ux * far + abs(uy) * half))
            ys = sorted((y + uy * near - abs(ux) * half, y + uy * far + abs(ux) * half))
            area = box(xs[0], ys[0], xs[1], ys[1])
            yield Tread(area, flight.low_m + (index + 1) * rise_m)


def _walking_line(
    flights: tuple[Flight, ...], turn: tuple[tuple[float, float], ...]
) -> Iterator[tuple[float, float, float]]:
    first, last = flights[0], flights[-1]
    (x, y), (ux, uy) = first.start_m, first.ahead
    yield x - ux * _BEYOND_M, y - uy * _BEYOND_M, 0.0
    for flight in flights:
        if flight is last and turn:
            rises = np.linspace(first.high_m, last.low_m, len(turn) + 2)[1:-1].tolist()
            yield from ((*point, height) for point, height in zip(turn, rises, strict=True))
        yield *flight.start_m, flight.low_m
        yield *flight.end_m, flight.high_m
    (x, y), (ux, uy) = last.end_m, last.ahead
    yield x + ux * _BEYOND_M, y + uy * _BEYOND_M, last.high_m


def _mirrored(tread: Tread) -> Tread:
    ring = [(-x, y) for x, y in tread.area_m.exterior.coords][::-1]
    edges = tread.edges_m
    if edges is not None:
        edges = _mirrored_line(edges[0]), _mirrored_line(edges[1])
    return replace(tread, area_m=Polygon(ring), edges_m=edges)


def _mirrored_line(line: LineString) -> LineString:
    return LineString([(-x, y) for x, y in line.coords])


def _mirrored_flight(flight: Flight) -> Flight:
    (x, y), (ux, uy) = flight.start_m, flight.ahead
    return Flight((-x, y), (-ux, uy), flight.length_m, flight.width_m, flight.low_m, flight.high_m)
