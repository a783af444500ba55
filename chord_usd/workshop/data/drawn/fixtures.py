"""Symbols of fixtures, as architects draw them: WC, bath, basin, hob, sink, shower, bed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from chord_usd.base.scene.types import FloatArray, RoomKind


@dataclass(frozen=True, eq=False)
class Symbol:
    """Lines of one fixture, its back at y = 0 and its front towards +y, x from 0. Metres."""

    size_m: tuple[float, float]
    """Width along the wall, and depth."""
    shapes: tuple[BaseGeometry, ...]

    def lines(self, turn: FloatArray, place: FloatArray) -> list[FloatArray]:
        """(N, 2) each, turned by a (2, 2) matrix and moved."""
        rings: list[BaseGeometry] = []
        for shape in self.shapes:
            rings += [shape.exterior] if isinstance(shape, Polygon) else [shape]
        return [np.array(ring.coords) @ turn.T + place for ring in rings]


def _oval(x: float, y: float, width: float, depth: float) -> Polygon:
    angles = np.linspace(0.0, 2 * np.pi, 33)[:-1]
    round_ = np.stack([np.cos(angles) * width / 2, np.sin(angles) * depth / 2], axis=1)
    return Polygon(round_ + np.array([x, y]))


def _rounded(left: float, low: float, right: float, high: float, radius: float) -> Polygon:
    core = shapely.box(left + radius, low + radius, right - radius, high - radius)
    return core.buffer(radius)


def _wc() -> Symbol:
    return Symbol((0.4, 0.68), (shapely.box(0.0, 0.0, 0.4, 0.18), _oval(0.2, 0.42, 0.36, 0.48)))


def _bath() -> Symbol:
    inner = _rounded(0.07, 0.07, 1.63, 0.63, 0.18)
    return Symbol(
        (1.7, 0.7), (shapely.box(0.0, 0.0, 1.7, 0.7), inner, _oval(0.3, 0.35, 0.07, 0.07))
    )


def _basin() -> Symbol:
    return Symbol((0.6, 0.45), (shapely.box(0.0, 0.0, 0.6, 0.45), _oval(0.3, 0.23, 0.46, 0.32)))


def _shower() -> Symbol:
    cross = LineString([(0.0, 0.0), (0.9, 0.9)]), LineString([(0.9, 0.0), (0.0, 0.9)])
    return Symbol((0.9, 0.9), (shapely.box(0.0, 0.0, 0.9, 0.9), *cross))


def _hob() -> Symbol:
    places = [(x, y) for x in (0.16, 0.44) for y in (0.16, 0.44)]
    rings = [_oval(x, y, 0.2, 0.2) for x, y in places]
    return Symbol((0.6, 0.6), (shapely.box(0.0, 0.0, 0.6, 0.6), *rings))


def _sink() -> Symbol:
    bowl = _rounded(0.06, 0.1, 0.5, 0.5, 0.06)
    ribs = [LineString([(x, 0.12), (x, 0.48)]) for x in (0.62, 0.72, 0.82, 0.92)]
    return Symbol((1.0, 0.6), (shapely.box(0.0, 0.0, 1.0, 0.6), bowl, *ribs))


def _bed(width: float) -> Symbol:
    pillows = [_rounded(x, 0.08, x + 0.6, 0.48, 0.06) for x in _pillow_lefts(width)]
    sheet = LineString([(0.0, 0.7), (width, 0.7)])
    return Symbol((width, 2.0), (shapely.box(0.0, 0.0, width, 2.0), *pillows, sheet))


def _pillow_lefts(width: float) -> list[float]:
    return [(width - 0.6) / 2] if width < 1.3 else [width / 4 - 0.3, 3 * width / 4 - 0.3]


SYMBOLS: dict[RoomKind, tuple[Symbol, ...]] = {
    "bathroom": (_wc(), _bath(), _basin(), _shower()),
    "kitchen": (_hob(), _sink()),
    "bedroom": (_bed(1.6), _bed(0.9)),
}
"""Pieces that show a room's kind where no name is printed; larger ones where there is room."""
