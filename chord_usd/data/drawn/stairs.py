"""Flights of stairs: straight, turned, winding and spiral, with the arrow that people draw."""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry

from chord_usd.data.drawn.labelled_canvas import Canvas
from chord_usd.data.drawn.masonry import Masonry
from chord_usd.data.drawn.page_looks import Look
from chord_usd.raster.page_labels import NOTHING, STAIRS
from chord_usd.scene.types import FloatArray

_LEAST_M = 1.6
_ANYWHERE = 0.06
"""Of the share of corridors with stairs, how many other rooms have some."""


def draw_stairs(
    canvas: Canvas, house: Masonry, look: Look, rng: np.random.Generator
) -> BaseGeometry:
    """Draw flights in some rooms, along a wall, clear of doors. Returns where they are."""
    ways = shapely.union_all([gap.shape.buffer(0.7) for gap in house.gaps if gap.kind != "window"])
    found = []
    for kind, room in house.rooms:
        share = look.stairs if kind in ("corridor", "store") else look.stairs * _ANYWHERE
        if rng.random() >= share:
            continue
        place = _place(room, ways, rng)
        if place is not None:
            found.append(_draw_flight(canvas, place, look, rng))
    return shapely.union_all(found)


def _place(room: Polygon, ways: BaseGeometry, rng: np.random.Generator) -> Polygon | None:
    """A rectangle in a corner of the room's bounds."""
    left, low, right, high = room.bounds
    for _ in range(6):
        long, wide = rng.uniform(1.6, 3.6), rng.uniform(0.8, 1.1) * rng.choice([1.0, 1.0, 2.0])
        size = (long, wide) if rng.random() < 0.5 else (wide, long)
        x = left if rng.random() < 0.5 else right - size[0]
        y = low if rng.random() < 0.5 else high - size[1]
        area = shapely.box(x, y, x + size[0], y + size[1])
        if room.buffer(0.02).covers(area) and not area.intersects(ways):
            return area
    return None


def _draw_flight(
    canvas: Canvas, area: Polygon, look: Look, rng: np.random.Generator
) -> BaseGeometry:
    left, low, right, high = area.bounds
    wide, tall = right - left, high - low
    rgb = look.piece_rgb
    going = rng.uniform(0.2, 0.3)
    if min(wide, tall) > 1.3 and rng.random() < 0.4:
        return _draw_spiral(canvas, area, look, rng)
    canvas.fill(area, look.paper_rgb if rng.random() < 0.6 else None, built=STAIRS, laid=NOTHING)
    along = 0 if wide > tall else 1
    turn = min(wide, tall) / 2 if min(wide, tall) > 1.3 else 0.0
    for step in np.arange(going, max(wide, tall) - turn, going):
        ends = (
            [(left + step, low), (left + step, high)] if along == 0
            else [(left, low + step), (right, low + step)]
        )  # fmt: skip
        canvas.line(np.array(ends), rgb)
    if turn:
        _draw_winders(canvas, area, along, turn, rgb)
    if rng.random() < 0.7:
        canvas.outline(area, rgb)
    if rng.random() < 0.6:
        _draw_arrow(canvas, area, along, look, rng)
    return area


def _draw_winders(
    canvas: Canvas, area: Polygon, along: int, turn: float, rgb: tuple[int, int, int]
) -> None:
    """The middle wall of a flight that turns back, and steps about its end."""
    left, low, right, high = area.bounds
    if along == 0:
        pivot, start = np.array([right - turn, (low + high) / 2]), (left, (low + high) / 2)
        reach = [(right, y) for y in np.linspace(low, high, 5)]
    else:
        pivot, start = np.array([(left + right) / 2, high - turn]), ((left + right) / 2, low)
        reach = [(x, high) for x in np.linspace(left, right, 5)]
    canvas.line(np.array([start, pivot]), rgb)
    for end in reach:
        canvas.line(np.array([pivot, end]), rgb)


def _draw_spiral(
    canvas: Canvas, area: Polygon, look: Look, rng: np.random.Generator
) -> BaseGeometry:
    middle = np.array(area.centroid.coords[0])
    radius = min(area.bounds[2] - area.bounds[0], area.bounds[3] - area.bounds[1]) / 2
    disc = Point(*middle).buffer(radius)
    canvas.fill(disc, None, built=STAIRS, laid=NOTHING)
    for angle in np.linspace(0, rng.uniform(4.5, 2 * math.pi), 14):
        way = np.array([math.cos(angle), math.sin(angle)])
        canvas.line(np.array([middle + way * 0.12, middle + way * radius]), look.piece_rgb)
    canvas.outline(disc, look.piece_rgb)
    canvas.outline(Point(*middle).buffer(0.12), look.piece_rgb)
    return disc


def _draw_arrow(
    canvas: Canvas, area: Polygon, along: int, look: Look, rng: np.random.Generator
) -> None:
    left, low, right, high = area.bounds
    middle = np.array([(left + right) / 2, (low + high) / 2])
    way = np.eye(2)[along] * (1.0 if rng.random() < 0.5 else -1.0)
    half = (right - left, high - low)[along] * 0.4
    tip: FloatArray = middle + way * half
    side = np.array([-way[1], way[0]]) * 0.12
    canvas.line(np.array([middle - way * half, tip]), look.piece_rgb)
    canvas.line(np.array([tip - way * 0.2 + side, tip, tip - way * 0.2 - side]), look.piece_rgb)
