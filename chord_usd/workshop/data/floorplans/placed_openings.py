"""Doors, windows and passages: which rooms they join and where in the wall they sit."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass
from operator import itemgetter

from chord_usd.base.scene.types import OpeningKind, RoomKind
from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.floorplans.sketch import (
    HALF_WALL,
    WALL,
    Bounds,
    Cell,
    Face,
    Point,
    Sketch,
    is_free,
)

MARGIN = 10
"""Between an opening and a corner of a room, or the next opening."""

VIEW = 170
"""Before a window or the entrance nothing stands this near."""

_HALLS = ("corridor", "living", "dining")
"""Rooms one walks through."""

# Where a room is entered from, best first; a room of none of these kinds cannot be its entry.
_ENTRY: dict[RoomKind, tuple[RoomKind, ...]] = {
    "bedroom": ("corridor", "living", "dining"),
    "bathroom": ("corridor", "dining", "living", "bedroom"),
    "kitchen": ("dining", "living", "corridor"),
    "study": ("corridor", "living", "dining", "bedroom"),
    "store": ("corridor", "kitchen", "dining", "living", "bedroom"),
    "balcony": ("living", "bedroom", "dining", "kitchen", "study", "corridor"),
    "corridor": ("living", "dining", "corridor"),
    "dining": ("living", "corridor"),
    "living": ("corridor", "dining"),
}


@dataclass(slots=True)
class Stretch:
    """A straight piece of wall in which openings may sit, on its middle line."""

    start: Point
    direction: Point
    length: float
    outward: int = 0
    """+1 where the outside lies towards +x or +y, -1 towards -x or -y, 0 where it is not known."""


@dataclass(slots=True)
class Hole:
    """An opening, in steps."""

    kind: OpeningKind
    rooms: tuple[int, ...]
    center: Point
    direction: Point
    width: float
    base: int
    height: int


@dataclass(slots=True)
class Walls:
    """Every stretch of wall: between pairs of rooms, and between a room and the outside."""

    shared: dict[tuple[int, int], list[Stretch]]
    outer: dict[int, list[Stretch]]


_Span = tuple[float, float, int]
"""Low end, high end, room."""


def find_walls(faces: list[Face]) -> Walls:
    """Match faces across one wall thickness; what faces nothing is an outer wall."""
    walls = Walls(defaultdict(list), defaultdict(list))
    lines: dict[tuple[int, float], tuple[list[_Span], list[_Span]]] = defaultdict(lambda: ([], []))
    for room, face in enumerate(faces):
        corners = face.corners
        for index, is_open in enumerate(face.is_open):
            (x0, y0), (x1, y1) = corners[index], corners[(index + 1) % len(corners)]
            if is_open:
                continue
            if y0 == y1:
                side = x1 > x0
                span = (x0, x1, room) if side else (x1, x0, room)
                lines[0, y0 - HALF_WALL if side else y0 + HALF_WALL][side].append(span)
            elif x0 == x1:
                side = y1 < y0
                span = (y1, y0, room) if side else (y0, y1, room)
                lines[1, x0 - HALF_WALL if side else x0 + HALF_WALL][side].append(span)
            else:
                _add_slanted(walls.outer[room], (x0, y0), (x1, y1))
    for (axis, line), (spans, other) in lines.items():
        _add_line(walls, axis, line, spans, other)
    return walls


def _add_slanted(stretches: list[Stretch], start: Point, end: Point) -> None:
    length = math.dist(start, end)
    ux, uy = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    if length > 2 * MARGIN:
        x, y = start[0] + uy * HALF_WALL, start[1] - ux * HALF_WALL
        at = x + ux * MARGIN, y + uy * MARGIN
        stretches.append(Stretch(at, (ux, uy), length - 2 * MARGIN))


def _add_line(walls: Walls, axis: int, line: float, first: list[_Span], other: list[_Span]) -> None:
    for low, high, room in first:
        for other_low, other_high, neighbour in other:
            start, end = max(low, other_low) + MARGIN, min(high, other_high) - MARGIN
            if end > start:
                pair = (room, neighbour) if room < neighbour else (neighbour, room)
                walls.shared[pair].append(_upright(axis, line, start, end))
    for spans, against, outward in ((first, other, 1), (other, first, -1)):
        for low, high, room in spans:
            start = low
            # A neighbour's own walls reach one thickness beyond its face.
            for other_low, other_high, _ in sorted(against):
                if other_low - WALL < high and other_high + WALL > start:
                    _add_outer(walls, axis, line, start, other_low - WALL, room, outward)
                    start = other_high + WALL
            _add_outer(walls, axis, line, start, high, room, outward)


def _add_outer(
    walls: Walls, axis: int, line: float, low: float, high: float, room: int, outward: int
) -> None:
    if high - low > 2 * MARGIN:
        walls.outer[room].append(_upright(axis, line, low + MARGIN, high - MARGIN, outward))


def _upright(axis: int, line: float, low: float, high: float, outward: int = 0) -> Stretch:
    if axis == 0:
        return Stretch((low, line), (1.0, 0.0), high - low, outward)
    return Stretch((line, low), (0.0, 1.0), high - low, outward)


def _with_view(stretches: list[Stretch], boxes: list[Bounds]) -> list[Stretch]:
    """What remains of outer walls where nothing stands before them for VIEW."""
    clear = []
    for stretch in stretches:
        if not stretch.outward:
            clear += [stretch] if _slanted_has_view(stretch, boxes) else []
            continue
        axis = 0 if stretch.direction[0] else 1
        low, line = stretch.start[axis], stretch.start[1 - axis]
        high = low + stretch.length
        near, far = sorted((line + WALL * stretch.outward, line + VIEW * stretch.outward))
        before = [b for b in boxes if b[3 - axis] > near and b[1 - axis] < far]
        for bounds in sorted(before, key=itemgetter(axis)):
            if bounds[axis + 2] + WALL > low and bounds[axis] - WALL < high:
                if bounds[axis] - WALL > low:
                    clear.append(_upright(axis, line, low, bounds[axis] - WALL))
                low = bounds[axis + 2] + WALL
        if high > low:
            clear.append(_upright(axis, line, low, high))
    return clear


def _slanted_has_view(stretch: Stretch, boxes: list[Bounds]) -> bool:
    """Whether points before both ends and the middle of a slanted wall are free."""
    (x, y), (ux, uy) = stretch.start, stretch.direction
    for along in (0.0, stretch.length / 2, stretch.length):
        for ahead in (VIEW / 2, VIEW):
            px, py = x + along * ux + ahead * uy, y + along * uy - ahead * ux
            if not is_free((px, py, px, py), boxes):
                return False
    return True


# --- placing ---------------------------------------------------------------------------------


class NoPlaceError(Exception):
    """An opening the house cannot do without has no wall to sit in."""


def make_openings(dice: Dice, sketch: Sketch, walls: Walls, *, entrance: bool = True) -> list[Hole]:
    """Entrance, doors, passages and windows. Raises NoPlaceError where a room cannot be reached.

    entrance: upper storeys have none.
    """
    holes = _join_rooms(dice, sketch, walls)
    boxes = sketch.boxes
    for room, stretches in walls.outer.items():
        walls.outer[room] = _with_view(stretches, boxes[:room] + boxes[room + 1 :])
    if entrance:
        holes.append(_entrance(dice, sketch, walls))
    for index, cell in enumerate(sketch.cells):
        windows = _windows(dice, cell, index, walls.outer[index])
        if not windows and cell.kind in _LIT and not _has_balcony(sketch, holes, index):
            raise NoPlaceError("window")
        holes += windows
    return holes


_LIT = ("living", "bedroom", "study")
"""Rooms that need a window, or a door to a balcony."""


def _has_balcony(sketch: Sketch, holes: list[Hole], room: int) -> bool:
    return any(
        sketch.cells[other].kind == "balcony"
        for hole in holes
        if room in hole.rooms
        for other in hole.rooms
    )


def _place(
    dice: Dice, stretches: list[Stretch], width: float, at_end: float, least: float = 0.0
) -> tuple[Point, Point, float] | None:
    """Take a hole out of the longest stretch: centre, direction and width.

    at_end: chance that it sits at one end of the stretch. least: narrower is not worth having.
    """
    longest = max(stretches, key=lambda stretch: stretch.length, default=None)
    if longest is None or longest.length < max(least, min(width, 60)):
        return None
    width = min(width, int(longest.length))
    play = longest.length - width
    along = play * dice.unit()
    if dice.chance(at_end):
        along = min(dice.steps(0, 25), play)
        along = along if dice.chance(0.5) else play - along
    (x, y), (ux, uy) = longest.start, longest.direction
    # Whole steps, so that a door lies between two corners to the step.
    along = int(along)
    stretches.remove(longest)
    if along > MARGIN:
        stretches.append(Stretch((x, y), (ux, uy), along - MARGIN))
    after = along + width + MARGIN
    if longest.length > after:
        rest = Stretch((x + ux * after, y + uy * after), (ux, uy), longest.length - after)
        stretches.append(rest)
    middle = along + width / 2
    return (x + ux * middle, y + uy * middle), (ux, uy), width


def _join_rooms(dice: Dice, sketch: Sketch, walls: Walls) -> list[Hole]:
    cells = sketch.cells
    number = {id(cell): index for index, cell in enumerate(cells)}
    reached = _halls(dice, sketch, walls, number)
    holes = reached.holes
    waiting = [i for i, cell in enumerate(cells) if i not in reached.rooms]
    # Balconies last: the rooms they hang on come first.
    waiting.sort(key=lambda i: (cells[i].kind == "balcony", cells[i].host is not None))
    for room in waiting:
        host = cells[room].host
        entries = [number[id(host)]] if host is not None else _entries(sketch, walls, room, reached)
        if cells[room].kind == "balcony":
            entries = [e for n, e in enumerate(entries) if n == 0 or dice.chance(0.5)]
        else:
            entries = entries[:1]
        for entry in entries:
            holes.append(_joint(dice, sketch, walls, room, entry))
        if not entries:
            raise NoPlaceError(cells[room].kind)
        reached.rooms.add(room)
    return holes


@dataclass(slots=True)
class _Reached:
    rooms: set[int]
    holes: list[Hole]


def _halls(dice: Dice, sketch: Sketch, walls: Walls, number: dict[int, int]) -> _Reached:
    """Join the rooms one walks through, and those open to them."""
    cells = sketch.cells
    touching = {
        frozenset((number[id(first)], number[id(second)])) for first, second in sketch.open_pairs
    }
    halls = [index for index, cell in enumerate(cells) if cell.kind in _HALLS]
    if not halls:
        halls = [index for index, cell in enumerate(cells) if cell.kind == "bedroom"][:1]
    reached = _Reached({halls[0]}, [])
    grown = True
    while grown:
        grown = False
        for pair in touching:
            if len(pair & reached.rooms) == 1:
                reached.rooms |= pair
                grown = True
        for room in halls:
            if grown or room in reached.rooms:
                continue
            entries = [e for e in _entries(sketch, walls, room, reached) if e in halls]
            if entries:
                reached.holes.append(_joint(dice, sketch, walls, room, entries[0]))
                reached.rooms.add(room)
                grown = True
    if not reached.rooms.issuperset(halls):
        raise NoPlaceError("hall")
    return reached


def _entries(sketch: Sketch, walls: Walls, room: int, reached: _Reached) -> list[int]:
    """Reached rooms that share enough wall with this one, the best to enter from first."""
    kinds = _ENTRY[sketch.cells[room].kind]
    entries = []
    for other in reached.rooms:
        stretches = walls.shared.get((min(room, other), max(room, other)), [])
        kind = sketch.cells[other].kind
        if kind in kinds and max((s.length for s in stretches), default=0.0) >= 72:
            entries.append((kinds.index(kind), -max(s.length for s in stretches), other))
    return [other for _, _, other in sorted(entries)]


def _joint(dice: Dice, sketch: Sketch, walls: Walls, room: int, entry: int) -> Hole:
    """The door or passage between two rooms."""
    kind, width, at_end = _joint_form(dice, sketch.cells[room].kind, sketch.cells[entry].kind)
    pair = (room, entry) if room < entry else (entry, room)
    placed = _place(dice, walls.shared[pair], width, at_end)
    if placed is None:
        raise NoPlaceError(sketch.cells[room].kind)
    height = 230 if kind == "passage" else 210
    return Hole(kind, pair, placed[0], placed[1], placed[2], 0, height)


def _joint_form(dice: Dice, room: RoomKind, entry: RoomKind) -> tuple[OpeningKind, int, float]:
    """Kind, width and chance of sitting at the end of its wall."""
    if room == "balcony":
        return "door", dice.steps(150, 240) if entry != "kitchen" else dice.steps(75, 160), 0.2
    if room in _HALLS and entry in _HALLS:
        return ("passage" if dice.chance(0.7) else "door"), dice.steps(95, 220), 0.3
    if room == "kitchen":
        wide = dice.chance(0.5)
        return "door", dice.steps(130, 200) if wide else dice.steps(75, 95), 0.4
    if room in ("bathroom", "store"):
        return "door", dice.steps(70, 80), 0.6
    return "door", dice.steps(80, 95), 0.8


def _entrance(dice: Dice, sketch: Sketch, walls: Walls) -> Hole:
    """The door to the outside: into a corridor where one has an outer wall, else a hall."""
    ranks: list[tuple[RoomKind, float]] = [("corridor", 0.0), ("dining", 1.0), ("living", 2.0)]
    order = dict(ranks)
    entries = []
    for index, cell in enumerate(sketch.cells):
        longest = max((s.length for s in walls.outer[index]), default=0.0)
        if longest >= 95:
            entries.append((order.get(cell.kind, 9.0) + 1.5 * dice.unit(), index))
    halls = [entry for entry in sorted(entries) if entry[0] < 9.0]
    kinds = {cell.kind for cell in sketch.cells}
    if not halls and not kinds.isdisjoint(_HALLS):
        raise NoPlaceError("entrance")
    room = (halls or sorted(entries))[0][1]
    placed = _place(dice, walls.outer[room], dice.steps(90, 105), 0.6, least=90)
    if placed is None:
        raise NoPlaceError("entrance")
    return Hole("door", (room,), *placed, 0, 210)


# Room kind: number of windows wanted, widths, base and height.
_WINDOWS: dict[RoomKind, tuple[int, tuple[int, int], int, int]] = {
    "living": (2, (150, 240), 90, 150),
    "dining": (1, (100, 200), 90, 150),
    "bedroom": (1, (110, 220), 90, 150),
    "study": (1, (100, 180), 90, 150),
    "kitchen": (1, (80, 160), 90, 120),
    "bathroom": (1, (60, 80), 90, 120),
    "corridor": (1, (60, 120), 90, 140),
    "balcony": (1, (170, 400), 90, 140),
}


def _windows(dice: Dice, cell: Cell, room: int, stretches: list[Stretch]) -> list[Hole]:
    wanted, widths, base, height = _WINDOWS.get(cell.kind, (0, (0, 0), 0, 0))
    if cell.kind in ("corridor", "bathroom", "balcony"):
        wanted = int(dice.chance(0.7))
    elif wanted and cell.kind != "kitchen":
        wanted += dice.chance(0.3)
    holes: list[Hole] = []
    for _ in range(wanted):
        placed = None
        if cell.bay and not holes:
            placed = _place(dice, _at_bay(stretches, cell.bay), dice.steps(130, 240), 0.0, least=60)
        if placed is None:
            placed = _place(dice, stretches, dice.steps(*widths), 0.05, least=60)
        if placed is None:
            break
        holes.append(Hole("window", (room,), *placed, base, height))
    return holes


def _at_bay(stretches: list[Stretch], bay: Point) -> list[Stretch]:
    """Takes the front of the bay out of the stretches and returns it alone."""
    for stretch in stretches:
        middle = [stretch.start[i] + stretch.direction[i] * stretch.length / 2 for i in (0, 1)]
        if math.dist(middle, bay) < HALF_WALL:
            stretches.remove(stretch)
            return [stretch]
    return []
