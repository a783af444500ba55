"""Outlines that symbols of furniture and fixtures are drawn with.

A symbol of a length and a depth lies about the origin, its back at +y; its first shape is the body.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

Shapes = list[BaseGeometry]
Draw = Callable[[float, float, np.random.Generator], Shapes]

_LETTERS: dict[str, tuple[tuple[tuple[float, float], ...], ...]] = {
    "F": (((0, 0), (0, 1), (0.6, 1)), ((0, 0.55), (0.5, 0.55))),
    "R": (((0, 0), (0, 1), (0.6, 0.9), (0.6, 0.6), (0, 0.5), (0.6, 0)),),
    "W": (((0, 1), (0.2, 0), (0.4, 0.7), (0.6, 0), (0.8, 1)),),
    "M": (((0, 0), (0.1, 1), (0.4, 0.3), (0.7, 1), (0.8, 0)),),
    "D": (((0, 0), (0, 1), (0.4, 0.9), (0.6, 0.5), (0.4, 0.1), (0, 0)),),
    "K": (((0, 0), (0, 1)), ((0.6, 1), (0, 0.5), (0.6, 0))),
    "L": (((0, 1), (0, 0), (0.6, 0)),),
    "S": (((0.6, 0.9), (0.1, 1), (0, 0.7), (0.6, 0.4), (0.5, 0), (0, 0.1)),),
    "E": (((0.6, 1), (0, 1), (0, 0), (0.6, 0)), ((0, 0.5), (0.5, 0.5))),
}


def box(left: float, low: float, right: float, high: float) -> Polygon:
    """An upright rectangle."""
    return shapely.box(min(left, right), min(low, high), max(left, right), max(low, high))


def oval(x: float, y: float, wide: float, deep: float) -> Polygon:
    """An ellipse by its half axes."""
    return affinity.translate(affinity.scale(Point(0, 0).buffer(1.0, 8), wide, deep), x, y)


def soft(left: float, low: float, right: float, high: float, radius: float) -> Polygon:
    """A rectangle with round corners."""
    body = box(left, low, right, high)
    radius = min(radius, 0.49 * (body.bounds[2] - left), 0.49 * (body.bounds[3] - low))
    return body.buffer(-radius, join_style="mitre").buffer(radius, 4)


def line(*points: tuple[float, float]) -> LineString:
    """A stroke along points."""
    return LineString(points)


def rectangle(length: float, depth: float) -> Polygon:
    """The whole box of a piece."""
    return box(-length / 2, -depth / 2, length / 2, depth / 2)


def inset(body: Polygon, by: float, radius: float = 0.0) -> Polygon:
    """A body made smaller all round, its corners round or not."""
    inner = body.buffer(-by, join_style="mitre")
    left, low, right, high = inner.bounds
    return soft(left, low, right, high, radius) if radius else inner


def diagonals(length: float, depth: float) -> tuple[LineString, LineString]:
    """From corner to corner, both ways."""
    return (
        line((-length / 2, -depth / 2), (length / 2, depth / 2)),
        line((-length / 2, depth / 2), (length / 2, -depth / 2)),
    )


def word_of(word: str, length: float, depth: float) -> Shapes:
    """Capital letters in the middle."""
    high = min(0.4 * depth, 0.8 * length / len(word))
    shapes: Shapes = []
    for index, letter in enumerate(word):
        left = (index - len(word) / 2) * 0.9 * high
        for stroke in _LETTERS[letter]:
            points = [(left + 0.9 * high * x, high * (y - 0.5)) for x, y in stroke]
            shapes.append(LineString(points))
    return shapes


def tap_of(y: float, rng: np.random.Generator) -> Shapes:
    """At the back of a bowl: a dot, a spout, two handles, or nothing."""
    kind = int(rng.integers(5))
    spout = line((0, y), (0, y - 0.12))
    choices: tuple[Shapes, ...] = (
        [oval(0, y, 0.03, 0.03)], [spout], [box(-0.02, y - 0.14, 0.02, y)],
        [spout, oval(-0.08, y, 0.025, 0.025), oval(0.08, y, 0.025, 0.025)], [],
    )  # fmt: skip
    return choices[kind]


def taper(wide: float, narrow: float, back: float, front: float) -> Polygon:
    """A bowl: wide at the back, round at the front."""
    angles = np.linspace(math.pi, 2 * math.pi, 9)
    turn = front + narrow
    tip = [(narrow * math.cos(a), turn + narrow * math.sin(a)) for a in angles]
    return Polygon([(wide, back), (-wide, back), *tip])


def scaled(shape: Polygon, share: float) -> Polygon:
    """A shape about its middle."""
    return affinity.scale(shape, share, share, origin="centroid")
