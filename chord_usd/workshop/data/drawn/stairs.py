"""Flights of stairs as plans show them: straight, with winders, turned, spiral, cut by a break.

A house's flights are placed before it is drawn, since walls of their own may stand beside them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import shapely
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry

from chord_usd.base.raster.page_labels import NOTHING, STAIRS, WRITING
from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.types import FloatArray, RoomKind
from chord_usd.workshop.data.drawn.labelled_canvas import Canvas
from chord_usd.workshop.data.drawn.masonry import Masonry
from chord_usd.workshop.data.drawn.page_looks import Look
from chord_usd.workshop.data.drawn.page_styles import RGB
from chord_usd.workshop.data.drawn.page_words import ink_of

FlightForm = Literal["straight", "winders", "L", "U", "spiral"]
_FORMS: dict[FlightForm, float] = {
    "straight": 0.4, "winders": 0.22, "L": 0.12, "U": 0.2, "spiral": 0.06,
}  # fmt: skip

_ROOMS: dict[RoomKind, float] = {"corridor": 6.0, "store": 2.5, "living": 1.5, "dining": 1.0}
_OTHER_ROOMS = 0.2
"""How likely a room holds the flight, beside others."""
_SECOND = 0.2
"""Houses with stairs that show two flights: up, and down to a cellar."""
_TRIES = 12
_WALLED = 0.5
"""Flights with a wall of their own on the free side."""
_WORDS = (
    "UP",
    "Up",
    "up",
    "DN",
    "Down",
    "dn",
    "auf",
    "ab",
    "upp",
    "ned",
    "sube",
    "baja",
    "S",
    "UP 14R",
)


@dataclass(frozen=True, eq=False)
class Flight:
    """A flight in its own coordinates: x along the first treads' rise, y across, in metres."""

    form: FlightForm
    origin: FloatArray
    along: FloatArray
    """Unit vector of x; y lies to its left, times hand."""
    hand: float
    size_m: tuple[float, float]
    """Of the rectangle that it takes up, along x and y."""
    width_m: float
    """Of a tread."""

    def at(self, points: FloatArray | list[tuple[float, float]]) -> FloatArray:
        """(N, 2) points on the sheet."""
        local = np.asarray(points, np.float64)
        across = np.array([-self.along[1], self.along[0]]) * self.hand
        return np.asarray(self.origin + local[:, :1] * self.along + local[:, 1:] * across)

    def polygon(self, points: list[tuple[float, float]]) -> Polygon:
        """An area on the sheet."""
        return Polygon(self.at(points))

    @property
    def area(self) -> Polygon:
        """What it covers."""
        (long, deep), wide = self.size_m, self.width_m
        if self.form == "spiral":
            return Point(self.at([(long / 2, deep / 2)])[0]).buffer(long / 2)
        if self.form == "L":
            return self.polygon(
                [
                    (0, 0),
                    (long, 0),
                    (long, deep),
                    (long - wide, deep),
                    (long - wide, wide),
                    (0, wide),
                ]
            )
        return self.polygon([(0, 0), (long, 0), (long, deep), (0, deep)])


# Placing -----------------------------------------------------------------------------------------


def with_stairs(
    house: Masonry, look: Look, rng: np.random.Generator
) -> tuple[Masonry, tuple[Flight, ...]]:
    """A house with the walls beside its flights, and the flights."""
    flights: list[Flight] = []
    if rng.random() >= look.stairs:
        return house, ()
    for _ in range(2 if rng.random() < _SECOND else 1):
        chances = np.array([_ROOMS.get(kind, _OTHER_ROOMS) for kind, _ in house.rooms])
        for index in rng.choice(
            len(chances), size=min(4, len(chances)), replace=False, p=chances / chances.sum()
        ):
            taken = shapely.union_all([flight.area for flight in flights])
            flight = _place(house, int(index), taken, rng)
            if flight is not None:
                flights.append(flight)
                house = _with_wall(house, int(index), flight, look, rng)
                break
    return house, tuple(flights)


def _place(
    house: Masonry, index: int, taken: BaseGeometry, rng: np.random.Generator
) -> Flight | None:
    """A flight in a corner of a room, clear of doors and with a way to its first step."""
    room = house.rooms[index][1]
    ways = [gap.shape.buffer(0.5) for gap in house.gaps if gap.kind != "window"]
    blocked = shapely.union_all([*ways, taken, house.masses])
    free = room.buffer(0.03, join_style="mitre")
    corners = np.array(shapely.geometry.polygon.orient(room).exterior.coords[:-1])
    for _ in range(_TRIES):
        number = int(rng.integers(len(corners)))
        corner, ahead = corners[number], corners[(number + 1) % len(corners)]
        wall = ahead - corner
        if (reach := float(np.hypot(*wall))) < 0.7:
            continue
        flight = _random_flight(corner, wall / reach, room, rng)
        area = flight.area
        if free.covers(area) and not area.intersects(blocked):
            return flight
    return None


def _random_flight(
    corner: FloatArray, along: FloatArray, room: Polygon, rng: np.random.Generator
) -> Flight:
    """From a corner along a wall that has the room on its left, up or towards the corner."""
    form: FlightForm = list(_FORMS)[int(rng.choice(len(_FORMS), p=list(_FORMS.values())))]
    wide = float(rng.uniform(0.72, 1.15))
    across = np.array([-along[1], along[0]])
    depths = (np.array(room.exterior.coords) - corner) @ across
    if 0.7 < depths.max() < 1.25 and form in ("straight", "winders"):
        wide = float(depths.max())  # The whole of a narrow stairwell.
    long = float(rng.uniform(1.9, 3.8))
    deep = wide
    if form == "spiral":
        wide = float(rng.uniform(0.6, 1.0))
        long = deep = 2 * wide
    elif form == "L":
        long, deep = wide + float(rng.uniform(0.7, 2.6)), wide + float(rng.uniform(0.7, 2.2))
    elif form == "U":
        long, deep = (
            wide + float(rng.uniform(1.0, 2.4)),
            2 * wide + float(rng.choice([0, 0.1, 0.3])),
        )
    if rng.random() < 0.5:
        return Flight(form, corner, along, 1.0, (long, deep), wide)
    return Flight(form, corner + along * long, -along, -1.0, (long, deep), wide)


def _with_wall(
    house: Masonry, index: int, flight: Flight, look: Look, rng: np.random.Generator
) -> Masonry:
    """A wall on the free long side of a flight, where it cuts off nothing."""
    if flight.form not in ("straight", "winders", "U") or rng.random() >= _WALLED:
        return house
    long, deep = flight.size_m
    start = long * float(rng.choice([0.0, 0.0, 0.2, 0.4]))
    thick = look.inner_wall_m
    sides = ((start, deep), (long, deep), (long, deep + thick), (start, deep + thick))
    kind, room = house.rooms[index]
    wall = flight.polygon(list(sides)).intersection(room)
    ways = shapely.union_all([gap.shape.buffer(0.6) for gap in house.gaps])
    rest = polygons_of(room.difference(wall))
    if wall.is_empty or wall.intersects(ways) or len(rest) != 1 or rest[0].interiors:
        return house
    if len(polygons_of(rest[0].buffer(-0.3))) != 1:
        return house
    rooms = list(house.rooms)
    rooms[index] = kind, rest[0]
    return replace(
        house, rooms=tuple(rooms), walls=house.walls.union(wall),
        inner_walls=house.inner_walls.union(wall),
    )  # fmt: skip


# Drawing -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Pen:
    rgb: RGB
    width_px: int
    going_m: float


def draw_stairs(
    canvas: Canvas, flights: tuple[Flight, ...], look: Look, rng: np.random.Generator
) -> BaseGeometry:
    """Draw flights, all of a house in one manner. Returns what they cover."""
    rgb = look.piece_rgb if rng.random() < 0.6 else look.ink_rgb
    pen = _Pen(rgb, look.line_px, float(rng.uniform(0.2, 0.3)))
    fill = look.paper_rgb if rng.random() < 0.5 else None
    if rng.random() < 0.1:
        fill = look.body_rgb
    manner = rng.integers(1 << 32)
    areas = []
    for flight in flights:
        canvas.fill(flight.area, fill, built=STAIRS, laid=NOTHING)
        _draw_flight(canvas, flight, pen, look, np.random.default_rng(manner))
        areas.append(flight.area)
    return shapely.union_all(areas)


def _draw_flight(
    canvas: Canvas, flight: Flight, pen: _Pen, look: Look, rng: np.random.Generator
) -> None:
    is_outlined = rng.random() < 0.7
    way = _spiral(canvas, flight, pen, rng) if flight.form == "spiral" else (
        _treads(canvas, flight, pen, rng, is_outlined=is_outlined)
    )  # fmt: skip
    if is_outlined:
        canvas.outline(flight.area, pen.rgb, pen.width_px)
    if rng.random() < 0.65:
        _draw_arrow(canvas, way, pen, rng)
    if rng.random() < 0.25:
        _write(canvas, way, look, pen, rng)


def _spiral(canvas: Canvas, flight: Flight, pen: _Pen, rng: np.random.Generator) -> FloatArray:
    """Radial treads about a newel; returns the walking line."""
    middle, radius = np.array(flight.area.centroid.coords[0]), flight.size_m[0] / 2
    angles = np.linspace(0, rng.uniform(4.2, 2 * math.pi), int(rng.integers(11, 17)))
    angles = angles + rng.uniform(0, 2 * math.pi)
    spokes = np.column_stack([np.cos(angles), np.sin(angles)])
    newel = rng.uniform(0.05, 0.15)
    for spoke in spokes:
        canvas.line(
            np.array([middle + spoke * newel, middle + spoke * radius]), pen.rgb, pen.width_px
        )
    canvas.outline(Point(*middle).buffer(newel), pen.rgb, pen.width_px)
    return np.asarray(middle + spokes[1:-1] * radius * 0.65)


def _treads(
    canvas: Canvas, flight: Flight, pen: _Pen, rng: np.random.Generator, *, is_outlined: bool
) -> FloatArray:
    """The treads of all legs; returns the walking line, upwards."""
    (long, deep), wide, form = flight.size_m, flight.width_m, flight.form
    is_landing = rng.random() < 0.4
    cut = float(rng.uniform(0.4, 0.8)) if rng.random() < 0.3 else 1.0
    # What is left blank looks like stairs within an outline only.
    beyond = str(rng.choice(["none", "dashed"])) if is_outlined else "dashed"
    if form == "straight" and not is_outlined and rng.random() < 0.4:
        cut, beyond = 1.0, "break"
    turn = 0.0 if form == "straight" else wide
    first = long - turn
    _leg(canvas, flight, pen, (0.0, first), (0.0, wide), cut if not turn else 1.0, beyond)
    if form == "straight":
        return flight.at([(pen.going_m / 2, wide / 2), (long * 0.92, wide / 2)])
    if form == "winders":
        pivot, reach = (first, wide), [(first, 0.0), (long, 0.0), (long, wide)]
        _turn(canvas, flight, pen, pivot, reach, is_landing=False, steps=int(rng.integers(2, 4)))
        corner = (first + wide / 2, wide / 2)
        return flight.at([(pen.going_m / 2, wide / 2), corner, (corner[0], wide * 0.9)])
    if form == "L":
        pivot, reach = (first, wide), [(first, 0.0), (long, 0.0), (long, wide)]
        _turn(canvas, flight, pen, pivot, reach, is_landing=is_landing, steps=3)
        for y in np.arange(wide, deep - 0.05, pen.going_m):
            canvas.line(flight.at([(first, y), (long, y)]), pen.rgb, pen.width_px)
        middle = first + wide / 2
        return flight.at([(pen.going_m / 2, wide / 2), (middle, wide / 2), (middle, deep * 0.95)])
    pivot = (first, deep / 2)
    reach = [(first, 0.0), (long, 0.0), (long, deep), (first, deep)]
    _turn(canvas, flight, pen, pivot, reach, is_landing=is_landing, steps=int(rng.integers(4, 7)))
    _leg(canvas, flight, pen, (first, 0.0), (deep - wide, deep), cut, beyond)
    for side in {wide, deep - wide}:
        canvas.line(flight.at([(0.0, side), (first, side)]), pen.rgb, pen.width_px)
    bend = long - wide / 2
    ends = [(pen.going_m / 2, wide / 2), (bend, wide / 2), (bend, deep - wide / 2),
            (pen.going_m, deep - wide / 2)]  # fmt: skip
    return flight.at(ends)


def _leg(
    canvas: Canvas, flight: Flight, pen: _Pen, along: tuple[float, float],
    across: tuple[float, float], cut: float, beyond: str,
) -> None:  # fmt: skip
    """Treads from one x to another; where it is cut, a break line and what lies beyond it."""
    start, end = along
    way = 1.0 if end > start else -1.0
    stop = start + (end - start) * cut
    for x in np.arange(start, end + 1e-6 * way, way * pen.going_m):
        is_beyond = (x - stop) * way > 0
        if is_beyond and beyond == "none":
            break
        ends = flight.at([(x, across[0]), (x, across[1])])
        canvas.line(ends, pen.rgb, pen.width_px, 0.08 if is_beyond else 0.0)
    if cut < 1.0 or beyond == "break":
        low, high = across
        lean, middle = 0.18 * way, (low + high) / 2
        zigzag = [
            (stop - lean, low), (stop - lean * 0.1, middle - 0.05), (stop + lean, middle - 0.05),
            (stop - lean, middle + 0.05), (stop + lean * 0.1, middle + 0.05), (stop + lean, high),
        ]  # fmt: skip
        canvas.line(flight.at(zigzag), pen.rgb, pen.width_px)


def _turn(
    canvas: Canvas, flight: Flight, pen: _Pen, pivot: tuple[float, float],
    reach: list[tuple[float, float]], *, is_landing: bool, steps: int,
) -> None:  # fmt: skip
    """A landing, or treads that fan out from a pivot to the outline about it."""
    outline = shapely.LineString(reach)
    for share in (0.0, 1.0) if is_landing else np.linspace(0.0, 1.0, steps + 1):
        end = outline.interpolate(float(share), normalized=True)
        canvas.line(flight.at([pivot, (end.x, end.y)]), pen.rgb, pen.width_px)


def _draw_arrow(canvas: Canvas, way: FloatArray, pen: _Pen, rng: np.random.Generator) -> None:
    """Along the walking line, up or down, from a dot or a ring."""
    if rng.random() < 0.4:
        way = way[::-1]
    canvas.line(way, pen.rgb, pen.width_px)
    ahead = way[-1] - way[-2]
    ahead = ahead / max(float(np.hypot(*ahead)), 1e-6)
    side = np.array([-ahead[1], ahead[0]]) * rng.uniform(0.05, 0.13)
    head = np.array([way[-1] - ahead * 0.2 + side, way[-1], way[-1] - ahead * 0.2 - side])
    if rng.random() < 0.5:
        canvas.fill(Polygon(head), pen.rgb)
    canvas.line(head, pen.rgb, pen.width_px)
    if rng.random() < 0.4:
        dot = Point(*way[0]).buffer(0.06)
        canvas.outline(dot, pen.rgb, pen.width_px)
        if rng.random() < 0.5:
            canvas.fill(dot, pen.rgb)


def _write(
    canvas: Canvas, way: FloatArray, look: Look, pen: _Pen, rng: np.random.Generator
) -> None:
    """A word at the first step."""
    word = _WORDS[int(rng.integers(len(_WORDS)))]
    height = max(7, round(look.letters_m * 0.8 * canvas.px_per_m))
    ink = ink_of(word, height, look.font)
    x, y = canvas.px(way[:1])[0]
    corner = round(x - ink.shape[1] / 2), round(y - ink.shape[0] / 2)
    canvas.blend(corner, ink, pen.rgb, WRITING)
