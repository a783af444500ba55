"""Stairs that turn on tapered treads: a quarter turn round one newel, a half turn round two.

Rule: Approved Document K to the Building Regulations of England (2013), 1.25 to 1.27. The going of
tapered treads is measured on the walking line, which is the middle of a flight less than 1 m wide;
all goings on it are alike, in the flights before and after the turn, too; at the narrow
end, by the newel, a tread is 5 cm wide or more.

Edges of treads run from the newel's side through the walking line to the outer side. Both lines are
divided evenly, so that the turn begins some centimetres before the newel, and ends as far after it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
from shapely import remove_repeated_points
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.polygon import orient
from shapely.ops import substring

from chord_usd.base.scene.storeys import (
    WELL_M,
    Flight,
    StairForm,
    StairRule,
    Tread,
)

NARROW_M = 0.05
"""Least width of a tapered tread at the newel."""

_WIDTHS_M = (0.95, 0.8)
"""Of flights, where the box leaves a choice; a winder is walked in the middle below 1 m."""

_MOST_WELL_M = 0.3

_QUARTER, _HALF = (3, 4, 5, 6), (6, 7, 8, 9)
"""Numbers of tapered treads."""

_STEPS_OF_ARC = 12
"""Straight pieces that a quarter of the walking line is drawn with."""

Points = list[tuple[float, float]]


@dataclass(frozen=True)
class WinderLayout:
    """One way to divide a stair that turns right on tapered treads into steps."""

    form: StairForm
    width_m: float
    depth_m: float
    """Of its box."""
    risers: int
    before: int
    """Steps of the first flight; it may have none."""
    tapered: int
    going_m: float
    flight_m: float
    """Width of a flight."""

    @property
    def after(self) -> int:
        """Steps of the last flight; it may have none."""
        return self.risers - 1 - self.before - self.tapered

    @property
    def well_m(self) -> float:
        """Between the newels."""
        return _well_m(self.width_m, self.flight_m) if self.form == "winder_U" else 0.0

    @property
    def early_m(self) -> float:
        """How far before the newel the turn begins."""
        return (self.tapered * self.going_m - _arc_m(self.form, self.flight_m) - self.well_m) / 2

    @property
    def narrow_m(self) -> float:
        """Width of the narrowest tread at its narrow end."""
        inner = np.array(self._lines[1])
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(inner, axis=0).T))])
        at = np.linspace(0.0, along[-1], self.tapered + 1)
        ends = np.column_stack([np.interp(at, along, inner[:, axis]) for axis in (0, 1)])
        return float(np.hypot(*np.diff(ends, axis=0).T).min())

    def drawn(self, rise_m: float) -> tuple[tuple[Flight, ...], list[Tread], Points]:
        """Flights, tapered treads, and the walking line between the flights. The outer corner of
        a quarter turn lies in that of the box, a half turn against its back."""
        x, y = -self.width_m / 2 + self.flight_m, self.depth_m / 2 - self.flight_m
        early_m = self.early_m
        first_m, last_m = self.before * self.going_m, self.after * self.going_m
        turned = (self.before + self.tapered) * rise_m
        first = Flight(
            (x - self.flight_m / 2, y - early_m - first_m), (0, 1), first_m, self.flight_m,
            0.0, (self.before + 1) * rise_m,
        )  # fmt: skip
        quarter = self.form == "winder_L"
        start = (x + early_m, y + self.flight_m / 2)
        if not quarter:
            start = (x + self.well_m + self.flight_m / 2, y - early_m)
        last = Flight(
            start, (1, 0) if quarter else (0, -1), last_m, self.flight_m,
            turned, self.risers * rise_m,
        )  # fmt: skip
        treads = [
            Tread(area, (self.before + 1 + index) * rise_m, edges_m=edges)
            for index, (area, edges) in enumerate(self._tapered())
        ]
        return (first, last), treads, self._lines[0][1:-1]

    @property
    def _lines(self) -> tuple[Points, Points, Points]:
        """The turn's walking line, its inner and its outer side, from the first flight on."""
        wide = self.flight_m
        x, y = wide - self.width_m / 2, self.depth_m / 2 - wide
        early, far, out = self.early_m, x + self.well_m, wide / 2
        walk = [(x - out, y - early), *_arc((x, y), out, 180.0)]
        inner, outer = [(x, y - early), (x, y)], [(x - wide, y - early), (x - wide, y + wide)]
        if self.form == "winder_L":
            return (
                [*walk, (x + early, y + out)], [*inner, (x + early, y)],
                [*outer, (x + early, y + wide)],
            )  # fmt: skip
        walk += [*_arc((far, y), out, 90.0), (far + out, y - early)]
        inner += [(far, y), (far, y - early)]
        return walk, inner, [*outer, (far + wide, y + wide), (far + wide, y - early)]

    @property
    def _edges(self) -> list[LineString]:
        """Of all tapered treads, from the inner side to the outer."""
        walk, inner, outer = map(LineString, self._lines)
        reach = 4 * self.flight_m
        lines = []
        for share in np.linspace(0.0, 1.0, self.tapered + 1):
            near = np.array(inner.interpolate(share, normalized=True).coords[0])
            middle = np.array(walk.interpolate(share, normalized=True).coords[0])
            ahead = (middle - near) / np.hypot(*(middle - near))
            met = LineString([near, near + ahead * reach]).intersection(outer)
            far = met if isinstance(met, Point) else Point(outer.interpolate(share, True))
            lines.append(LineString([near, far.coords[0]]))
        return lines

    def _tapered(self) -> Iterator[tuple[Polygon, tuple[LineString, LineString]]]:
        """Area of each tapered tread, and the edges over which one steps on and off."""
        _, inner, outer = map(LineString, self._lines)
        edges = self._edges
        for edge, other in pairwise(edges):
            sides = []
            for line, end in ((inner, 0), (outer, -1)):
                low, high = (line.project(Point(riser.coords[end])) for riser in (edge, other))
                sides.append(list(substring(line, low, high).coords)[1:-1])
            ring = [*edge.coords, *sides[1], *other.coords[::-1], *sides[0][::-1]]
            yield orient(remove_repeated_points(Polygon(ring), 1e-6)), (edge, other)


def quarter_winders(
    width_m: float, depth_m: float, risers: int, rule: StairRule
) -> Iterator[WinderLayout]:
    """The ways to divide a box into the flights and tapered treads of a quarter turn."""

    def divided(wide: float) -> Iterator[WinderLayout]:
        spare_m = _arc_m("winder_L", wide) / 2 - wide
        for tapered, before in product(_QUARTER, range(risers)):
            after = risers - 1 - tapered - before
            if after >= 0:
                ways = ((depth_m + spare_m) / (tapered / 2 + before),
                        (width_m + spare_m) / (tapered / 2 + after))  # fmt: skip
                going_m = min(rule.going_m[1], *ways)
                yield WinderLayout(
                    "winder_L", width_m, depth_m, risers, before, tapered, going_m, wide
                )

    yield from _widest(min(width_m, depth_m), divided, rule)


def half_winders(
    width_m: float, depth_m: float, risers: int, rule: StairRule
) -> Iterator[WinderLayout]:
    """The ways to divide a box into the flights and tapered treads of a half turn."""

    def divided(wide: float) -> Iterator[WinderLayout]:
        spare_m = (_arc_m("winder_U", wide) + _well_m(width_m, wide)) / 2 - wide
        for tapered in _HALF:
            straight = risers - 1 - tapered
            longer = straight - straight // 2
            going_m = min(rule.going_m[1], (depth_m + spare_m) / (tapered / 2 + longer))
            for before in {longer, straight - longer}:
                yield WinderLayout(
                    "winder_U", width_m, depth_m, risers, before, tapered, going_m, wide
                )

    yield from _widest((width_m - WELL_M) / 2, divided, rule)


def _widest(
    most_m: float, divided: Callable[[float], Iterator[WinderLayout]], rule: StairRule
) -> Iterator[WinderLayout]:
    """The layouts with flights as wide as can be, of all that are long enough to turn; those whose
    goings are too small only where there is no other.

    most_m: what a flight has room for.
    """
    if most_m < rule.width_m - 1e-6:
        return
    short: list[WinderLayout] = []
    for wide in sorted({min(most_m, wide) for wide in _WIDTHS_M}, reverse=True):
        long = [layout for layout in divided(wide) if layout.early_m >= 0.0]
        fit = [layout for layout in long if layout.going_m >= rule.going_m[0] - 1e-6]
        short += long
        sound = [layout for layout in fit if layout.narrow_m >= NARROW_M - 1e-6]
        if sound:
            yield from sound
            return
    yield from (layout for layout in short if layout.going_m < rule.going_m[0] - 1e-6)


def _well_m(width_m: float, wide: float) -> float:
    """Between the flights of a half turn; what a box has more is left free."""
    return min(width_m - 2 * wide, _MOST_WELL_M)


def _arc_m(form: StairForm, wide: float) -> float:
    """Length of the curved part of the walking line."""
    return math.pi * wide / (4 if form == "winder_L" else 2)


def _arc(around: tuple[float, float], radius: float, from_deg: float) -> Points:
    """A quarter of a circle, clockwise."""
    angles = np.radians(np.linspace(from_deg, from_deg - 90.0, _STEPS_OF_ARC + 1))
    x, y = around
    return [(x + radius * float(np.cos(a)), y + radius * float(np.sin(a))) for a in angles]
