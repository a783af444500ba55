"""Stairs that wind round a pole: treads are sectors of a circle, and so is the hole above them.

The pole stands in the middle of a square. A sixth of the circle, before the middle of the front, is
floor: from there one steps on. The sixth that the last rise leads to is a landing at the height of
the floor above, before the middle of that side or of the next one: a stair makes five sixths of a
turn, or a quarter more. So a stair goes on over another one whose landing lies before its front.

Rule: that of every flight. The going is measured on the walking line, which is the middle of a
tread between pole and rim; below what lies a turn higher there are 2 m of headroom.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.polygon import orient

from chord_usd.base.scene.storeys import (
    GOING_M,
    HEADROOM_M,
    LEAST_WIDTH_M,
    Flight,
    Tread,
)
from chord_usd.base.scene.types import FloatArray

POLE_M = 0.07
"""Radius of the pole."""

RIM_M = 0.06
"""Between the rim of the treads and the sides of the square: there a railing stands above."""

SPIRAL_THICK_M = 0.05
"""Of a tread and of the landing."""

_SIXTH_DEG = 60.0
_TURNS_DEG = (300.0, 390.0)
"""Of the treads: one steps off over the front, or over the side that comes after it."""

_CORNERS_OF_QUARTER = 16
_SAME_M = 1e-3
_LARGEST_M = 3.2
_ROUND = 0.85
"""Share of the least circle around it that something round fills."""

Points = list[tuple[float, float]]


@dataclass(frozen=True)
class SpiralLayout:
    """One way to divide a spiral stair that turns right into treads."""

    risers: int
    turn_deg: float
    """Of all treads together."""
    radius_m: float
    """From the middle of the pole to the rim."""

    @property
    def going_m(self) -> float:
        """Of a tread, along the walking line."""
        return math.radians(self.turn_deg) / (self.risers - 1) * self._walk_m

    def headroom_m(self, rise_m: float) -> float:
        """The least height between a tread, or the floor before the first, and what is over it."""
        step_deg = self.turn_deg / (self.risers - 1)

        def tops(at_deg: FloatArray) -> FloatArray:
            steps: FloatArray = np.clip(np.floor(at_deg / step_deg) + 1, 0, self.risers)
            return rise_m * steps

        below = np.arange(-_SIXTH_DEG + 0.25, self.turn_deg, 0.5)
        below = below[below + 360.0 < self.turn_deg + _SIXTH_DEG]
        return float((tops(below + 360.0) - tops(below)).min(initial=np.inf)) - SPIRAL_THICK_M

    def drawn(self, rise_m: float) -> tuple[tuple[Flight, ...], list[Tread], Points]:
        """Where one steps on and off, treads and landing, and the line over their middles."""
        first_deg = 270.0 - _SIXTH_DEG / 2
        stops = first_deg - np.linspace(0.0, self.turn_deg, self.risers)
        treads = [
            Tread(
                self._sector(start, end), number * rise_m,
                edges_m=(self._edge(start), self._edge(end)),
            )
            for number, (start, end) in enumerate(pairwise(stops.tolist()), start=1)
        ]  # fmt: skip
        top_m, last_deg = self.risers * rise_m, float(stops[-1])
        landing = self._sector(last_deg, last_deg - _SIXTH_DEG)
        x, y = map(round, _at(last_deg - _SIXTH_DEG / 2, 1.0))
        side_m = self.radius_m + RIM_M
        flights = (
            Flight((0.0, -side_m), (0, 1), 0.0, LEAST_WIDTH_M, 0.0, 0.0),
            Flight((x * side_m, y * side_m), (x, y), 0.0, LEAST_WIDTH_M, top_m, top_m),
        )
        middles = [_at(angle, self._walk_m) for angle in (stops[:-1] + stops[1:]) / 2]
        return flights, [*treads, Tread(landing, top_m, is_landing=True)], middles

    @property
    def _walk_m(self) -> float:
        return (POLE_M + self.radius_m) / 2

    def _edge(self, at_deg: float) -> LineString:
        return LineString([_at(at_deg, POLE_M), _at(at_deg, self.radius_m)])

    def _sector(self, from_deg: float, to_deg: float) -> Polygon:
        """What lies between two edges, clockwise, in the circle that the hole is."""
        reach = 2 * self.radius_m
        corners = [_at(angle, reach) for angle in np.linspace(from_deg, to_deg, 4)]
        sector = Polygon([(0.0, 0.0), *corners]).intersection(self._ring)
        return orient(shapely.remove_repeated_points(sector, _SAME_M))

    @property
    def _ring(self) -> Polygon:
        middle = Point(0.0, 0.0)
        pole = middle.buffer(POLE_M, quad_segs=_CORNERS_OF_QUARTER)
        return middle.buffer(self.radius_m, quad_segs=_CORNERS_OF_QUARTER).difference(pole)


def spirals(width_m: float, depth_m: float, risers: int, height_m: float) -> Iterator[SpiralLayout]:
    """The ways to divide the largest circle in a box, or as much of it as goings may be deep."""
    most_m = min(width_m, depth_m) / 2 - RIM_M
    for turn_deg in _TURNS_DEG if risers > 1 else ():
        step = math.radians(turn_deg) / (risers - 1)
        radius_m = min(most_m, 2 * GOING_M[1] / step - POLE_M)
        made = SpiralLayout(risers, turn_deg, radius_m)
        is_wide = radius_m - POLE_M >= LEAST_WIDTH_M - 1e-6
        if is_wide and made.headroom_m(height_m / risers) >= HEADROOM_M - 1e-6:
            yield made


def least_spiral_m(height_m: float, risers: range) -> float:
    """Side of the least square, to a centimetre, in which a spiral stair to rule rises so much."""
    for side_m in np.arange(2 * (LEAST_WIDTH_M + POLE_M + RIM_M), _LARGEST_M, 0.01).round(2):
        layouts = (
            layout for count in risers for layout in spirals(side_m, side_m, count, height_m)
        )
        if any(layout.going_m >= GOING_M[0] - 1e-6 for layout in layouts):
            return float(side_m)
    return _LARGEST_M


def is_round(area: Polygon) -> bool:
    """Whether something is about a circle, seen from above."""
    around = shapely.minimum_bounding_circle(area).area
    return bool(Polygon(area.exterior).area > _ROUND * around > 0.0)


def _at(angle_deg: float, radius_m: float) -> tuple[float, float]:
    angle = math.radians(angle_deg)
    return radius_m * math.cos(angle), radius_m * math.sin(angle)
