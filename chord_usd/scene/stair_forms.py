"""Stairs: straight, with one turn (L) or two (U); how their steps lie, to rule.

A stair is an oriented box seen from above, its front (-y) where one steps on. Numpy and shapely
only. Rules: every rise 16 to 20 cm, all alike; going 24 to 30 cm; flights 80 cm wide or more.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from shapely.geometry import LineString, Polygon, box
from shapely.ops import unary_union

from chord_usd.errors import PlanError
from chord_usd.scene.geometry import to_world
from chord_usd.scene.types import Box, FloatArray

StairForm = Literal["straight", "L", "U"]
Turn = Literal["left", "right"]
Leads = Literal["up", "down"]

RISE_M = (0.16, 0.20)
GOING_M = (0.24, 0.30)
HEADROOM_M = 2.0
LEAST_WIDTH_M = 0.8
"""Of a flight, from side to side."""

WELL_M = 0.1
"""Between the two flights of a U."""

_L_WIDTH_M = 0.95
"""Of the flights of an L, whose box does not tell it; less where the box is narrower."""

_BEYOND_M = 0.35
"""How far the line that one walks begins before the first step and ends after the last."""

_STRIDE_M = 0.63
"""Twice the rise and the going, of the stair that is easiest to walk (Blondel)."""


@dataclass(frozen=True)
class Stair:
    """A stair on the plan of a storey."""

    id: str
    form: StairForm
    box: Box
    """What it takes up; the front faces where one steps on below. Its height is not looked at."""
    turn: Turn = "right"
    """Which way one turns going up an L or U."""
    leads: Leads = "up"
    """To the storey above, or to the one below."""


@dataclass(frozen=True, eq=False)
class Tread:
    """What one steps on: a step or a landing."""

    area_m: Polygon
    """In the stair's own frame, seen from above."""
    top_m: float
    """Over the lower floor."""
    is_landing: bool = False


@dataclass(frozen=True)
class Flight:
    """A straight run of steps, in the stair's own frame."""

    start_m: tuple[float, float]
    """Middle of the edge of its first step."""
    ahead: tuple[int, int]
    """Direction in which it rises: (0, 1), (0, -1), (1, 0) or (-1, 0)."""
    length_m: float
    width_m: float
    low_m: float
    high_m: float
    """Heights of the floors or landings that it joins."""

    @property
    def end_m(self) -> tuple[float, float]:
        """Middle of the edge where it meets what it leads to."""
        (x, y), (ux, uy) = self.start_m, self.ahead
        return x + ux * self.length_m, y + uy * self.length_m


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

    @property
    def area_m(self) -> Polygon:
        """What it takes up, in the world; an L leaves a part of its box free."""
        own = unary_union([tread.area_m.buffer(1e-6) for tread in self.treads])
        if self.stair.form == "U":
            own = own.envelope
        return Polygon(to_world(self.stair.box, np.asarray(own.exterior.coords)[:-1]).round(4))

    @property
    def departure_m(self) -> LineString:
        """The edge in the world over which one steps on below."""
        return self._edge(self.flights[0], self.flights[0].start_m)

    @property
    def arrival_m(self) -> LineString:
        """The edge in the world over which one steps off above."""
        return self._edge(self.flights[-1], self.flights[-1].end_m)

    @property
    def walk_m(self) -> FloatArray:
        """(N, 3) the line one walks, in the world, heights over the lower floor; from an arm's
        length before the first step to as far beyond the last."""
        points = list(_walking_line(self.flights))
        places = to_world(self.stair.box, [point[:2] for point in points])
        return np.column_stack([places, [point[2] for point in points]])

    def _edge(self, flight: Flight, at_m: tuple[float, float]) -> LineString:
        (x, y), (ux, uy), half = at_m, flight.ahead, flight.width_m / 2
        ends = [(x - uy * half, y + ux * half), (x + uy * half, y - ux * half)]
        return LineString(to_world(self.stair.box, ends))


def build_stair(stair: Stair, height_m: float) -> BuiltStair:
    """The steps of a stair that rises so much. Raises PlanError where no stair to rule fits."""
    width_m, depth_m = stair.box.size_m[:2]
    layouts = [
        layout
        for risers in range(math.ceil(height_m / RISE_M[1] - 1e-9),
                            math.floor(height_m / RISE_M[0] + 1e-9) + 1)
        for layout in _LAYOUTS[stair.form](width_m, depth_m, risers)
    ]  # fmt: skip
    fitting = [one for one in layouts if one.going_m >= GOING_M[0] - 1e-6]
    if not fitting:
        raise PlanError(
            f"a {stair.form} stair of {width_m:.2f} by {depth_m:.2f} m cannot rise {height_m:.2f} m"
            + (f": its steps would be {max(one.going_m for one in layouts) * 100:.0f} cm deep"
               if layouts else ": its flights would be too narrow"),
            where=stair.id,
            expected=f"rises of {RISE_M[0] * 100:.0f} to {RISE_M[1] * 100:.0f} cm, goings of "
            f"{GOING_M[0] * 100:.0f} to {GOING_M[1] * 100:.0f} cm, flights of "
            f"{LEAST_WIDTH_M * 100:.0f} cm or more",
        )  # fmt: skip
    best = min(fitting, key=lambda one: (_strain(one, height_m), one.risers))
    rise_m = height_m / best.risers
    flights, landings = best.drawn(rise_m)
    treads = sorted([*_steps(flights, rise_m), *landings], key=lambda tread: tread.top_m)
    if stair.turn == "left":
        flights = tuple(map(_mirrored_flight, flights))
        treads = [_mirrored(tread) for tread in treads]
    return BuiltStair(stair, height_m, rise_m, best.going_m, tuple(treads), flights)


@dataclass(frozen=True)
class _Layout:
    """One way to divide a stair that turns right, if at all, into steps."""

    form: StairForm
    width_m: float
    depth_m: float
    risers: int
    first: int
    """Of these, in the first flight."""
    going_m: float
    flight_m: float
    """Width of a flight."""

    def drawn(self, rise_m: float) -> tuple[tuple[Flight, ...], list[Tread]]:
        """Flights and landings. The last step always ends at the edge of the box."""
        half_x, half_y = self.width_m / 2, self.depth_m / 2
        wide, last = self.flight_m, self.risers - self.first
        top_m, middle_m = self.risers * rise_m, self.first * rise_m
        if self.form == "straight":
            length = (self.risers - 1) * self.going_m
            start = (0.0, half_y - length)
            return (Flight(start, (0, 1), length, wide, 0.0, top_m),), []
        left = -half_x + wide / 2
        first_m, last_m = (self.first - 1) * self.going_m, (last - 1) * self.going_m
        if self.form == "U":
            landing = box(-half_x, -half_y + first_m, half_x, half_y)
            flights = (
                Flight((left, -half_y), (0, 1), first_m, wide, 0.0, middle_m),
                Flight((-left, -half_y + last_m), (0, -1), last_m, wide, middle_m, top_m),
            )
            return flights, [Tread(landing, middle_m, is_landing=True)]
        landing = box(-half_x, half_y - wide, half_x - last_m, half_y)
        flights = (
            Flight((left, half_y - wide - first_m), (0, 1), first_m, wide, 0.0, middle_m),
            Flight((half_x - last_m, half_y - wide / 2), (1, 0), last_m, wide, middle_m, top_m),
        )
        return flights, [Tread(landing, middle_m, is_landing=True)]


def _straight(width_m: float, depth_m: float, risers: int) -> Iterator[_Layout]:
    if width_m >= LEAST_WIDTH_M - 1e-6 and risers > 1:
        going_m = min(GOING_M[1], depth_m / (risers - 1))
        yield _Layout("straight", width_m, depth_m, risers, risers, going_m, width_m)


def _u(width_m: float, depth_m: float, risers: int) -> Iterator[_Layout]:
    flight_m = (width_m - WELL_M) / 2
    if flight_m < LEAST_WIDTH_M - 1e-6 or risers % 2 or risers < 4:
        return
    going_m = min(GOING_M[1], (depth_m - flight_m) / (risers // 2 - 1))
    yield _Layout("U", width_m, depth_m, risers, risers // 2, going_m, flight_m)


def _l(width_m: float, depth_m: float, risers: int) -> Iterator[_Layout]:
    flight_m = min(_L_WIDTH_M, width_m / 2, depth_m / 2)
    if flight_m < LEAST_WIDTH_M - 1e-6:
        return
    for first in range(2, risers - 1):
        going_m = min(GOING_M[1], (depth_m - flight_m) / (first - 1),
                      (width_m - flight_m) / (risers - first - 1))  # fmt: skip
        yield _Layout("L", width_m, depth_m, risers, first, going_m, flight_m)


_LAYOUTS = {"straight": _straight, "L": _l, "U": _u}


def _strain(layout: _Layout, height_m: float) -> float:
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


def _walking_line(flights: tuple[Flight, ...]) -> Iterator[tuple[float, float, float]]:
    first, last = flights[0], flights[-1]
    (x, y), (ux, uy) = first.start_m, first.ahead
    yield x - ux * _BEYOND_M, y - uy * _BEYOND_M, 0.0
    for flight, after in zip(flights, (*flights[1:], None), strict=True):
        yield *flight.start_m, flight.low_m
        yield *flight.end_m, flight.high_m
        if after is not None:
            half = flight.width_m / 2
            (x, y), (ux, uy) = flight.end_m, flight.ahead
            yield x + ux * half, y + uy * half, flight.high_m
            if after.ahead == (-ux, -uy):  # over the landing of a U
                yield after.start_m[0] + ux * half, after.start_m[1] + uy * half, flight.high_m
    (x, y), (ux, uy) = last.end_m, last.ahead
    yield x + ux * _BEYOND_M, y + uy * _BEYOND_M, last.high_m


def _mirrored(tread: Tread) -> Tread:
    ring = [(-x, y) for x, y in tread.area_m.exterior.coords][::-1]
    return Tread(Polygon(ring), tread.top_m, tread.is_landing)


def _mirrored_flight(flight: Flight) -> Flight:
    (x, y), (ux, uy) = flight.start_m, flight.ahead
    return Flight((-x, y), (-ux, uy), flight.length_m, flight.width_m, flight.low_m, flight.high_m)
