"""Procedural houses: any number of plans, drawn the way architects draw them, from a seed."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.base.scene.types import WALL_THICKNESS_M, Box, Opening, Plan, Room, frozen_array
from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.floorplans.outer_shape import add_balconies, add_bays, slant
from chord_usd.workshop.data.floorplans.placed_openings import (
    Hole,
    NoPlaceError,
    find_walls,
    make_openings,
)
from chord_usd.workshop.data.floorplans.programme import MOST_ROOMS, draw_programme, room_count
from chord_usd.workshop.data.floorplans.room_layouts import UnsoundError, draw_house
from chord_usd.workshop.data.floorplans.sketch import (
    STEP_M,
    WALL,
    Face,
    Point,
    Sketch,
    faces,
    twice_area,
)

_MOST_DRAWS = 200
"""Draws before giving up; about one in ten is unsound, so this is never reached by chance."""

_LEAST_EDGE = 0.1 / STEP_M

_NAMES = {
    "living": "Living Room", "dining": "Dining Room", "bedroom": "Bedroom", "kitchen": "Kitchen",
    "bathroom": "Bathroom", "balcony": "Balcony", "corridor": "Corridor", "study": "Study",
    "store": "Store",
}  # fmt: skip


def random_plan(rng: np.random.Generator, rooms: int | None = None) -> Plan:
    """A house or flat with doors and windows; the same state of rng gives the same plan.

    rooms: how many rooms, 1 to MOST_ROOMS; None draws it from the paper's distribution.
    Walls are WALL_THICKNESS_M thick, rooms of an open plan touch. Every room can be reached from
    the one entrance, which is the only door that joins a single room. Raises ValueError for a
    number of rooms out of range.
    """
    if rooms is not None and not 1 <= rooms <= MOST_ROOMS:
        raise ValueError(f"rooms must be 1 to {MOST_ROOMS}, not {rooms}")
    dice = Dice(rng)
    count = room_count(dice) if rooms is None else rooms
    for _ in range(_MOST_DRAWS):
        try:
            return _draw(dice, count)
        except (UnsoundError, NoPlaceError):
            continue
    raise RuntimeError(f"no sound house of {count} rooms in {_MOST_DRAWS} draws")


def _draw(dice: Dice, rooms: int) -> Plan:
    programme = draw_programme(dice, rooms)
    sketch = draw_house(dice, programme)
    if not add_balconies(dice, sketch, programme.balcony):
        raise UnsoundError("no wall for a balcony")
    if dice.chance(0.27):
        slant(dice, sketch)
    if dice.chance(0.3):
        add_bays(dice, sketch, share=0.4)
    _turn(dice, sketch)
    inner = faces(sketch)
    _check(sketch, inner)
    return plan_of(sketch, inner, make_openings(dice, sketch, find_walls(inner)))


def plan_of(sketch: Sketch, inner: list[Face], holes: list[Hole]) -> Plan:
    """The plan of a sketch with its inner faces and holes."""
    return Plan(rooms=_rooms(sketch, inner), openings=_openings(holes))


def _turn(dice: Dice, sketch: Sketch) -> None:
    """Mirror and turn by quarters, so that no side of the paper is special; lower left to 0, 0."""
    quarter, mirrored = int(dice.unit() * 4), dice.chance(0.5)

    def turned(points: list[Point]) -> list[Point]:
        points = [(-x, y) for x, y in reversed(points)] if mirrored else points
        for _ in range(quarter):
            points = [(-y, x) for x, y in points]
        return points

    for cell in sketch.cells:
        cell.corners = turned(cell.corners)
    left = math.floor(min(box[0] for box in sketch.boxes)) - WALL // 2
    low = math.floor(min(box[1] for box in sketch.boxes)) - WALL // 2
    for cell in sketch.cells:
        cell.corners = [(x - left, y - low) for x, y in cell.corners]
        if cell.bay:
            ((x, y),) = turned([cell.bay])
            cell.bay = (x - left, y - low)


def _check(sketch: Sketch, inner: list[Face]) -> None:
    least = {"bathroom": 2.2, "store": 1.0, "corridor": 1.0, "balcony": 1.8, "kitchen": 3.4}
    for cell, face in zip(sketch.cells, inner, strict=True):
        area_m2 = twice_area(face.corners) / 2 * STEP_M * STEP_M
        if area_m2 < least.get(cell.kind, 5.0):
            raise UnsoundError(f"{cell.kind} of {area_m2:.1f} m2")
        x0, y0 = face.corners[-1]
        for x1, y1 in face.corners:
            if abs(x1 - x0) + abs(y1 - y0) < _LEAST_EDGE:
                raise UnsoundError("a step in a wall too small to be meant")
            x0, y0 = x1, y1


def _rooms(sketch: Sketch, inner: list[Face]) -> tuple[Room, ...]:
    counts: dict[str, int] = {}
    rooms = []
    for index, (cell, face) in enumerate(zip(sketch.cells, inner, strict=True)):
        counts[cell.kind] = counts.get(cell.kind, 0) + 1
        name = f"{_NAMES[cell.kind]} {counts[cell.kind]}"
        polygon = frozen_array([(x / 100, y / 100) for x, y in face.corners])
        rooms.append(Room(f"room{index + 1}", cell.kind, polygon, name))
    return tuple(rooms)


def _openings(holes: list[Hole]) -> tuple[Opening, ...]:
    return tuple(_opening(index, hole) for index, hole in enumerate(holes))


def _opening(index: int, hole: Hole) -> Opening:
    ux, uy = hole.direction
    yaw_deg = (0.0 if ux else 90.0) if ux == 0.0 or uy == 0.0 else _slope_deg(ux, uy)
    box = Box(
        (hole.center[0] * STEP_M, hole.center[1] * STEP_M, hole.base * STEP_M),
        (hole.width * STEP_M, WALL_THICKNESS_M, hole.height * STEP_M),
        yaw_deg,
    )
    rooms = tuple(f"room{room + 1}" for room in hole.rooms)
    return Opening(f"{hole.kind}{index + 1}", hole.kind, box, rooms)


def _slope_deg(ux: float, uy: float) -> float:
    return math.degrees(math.atan2(uy, ux)) % 180.0
