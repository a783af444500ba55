"""What is added to the outline of a house: balconies, bay windows, slanted outer walls."""

from __future__ import annotations

import math

from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.floorplans.sketch import (
    HALF_WALL,
    WALL,
    Bounds,
    Cell,
    Point,
    Sketch,
    clipped,
    edges,
    is_free,
    rectangle,
    tidy,
    twice_area,
)

_BALCONY_HOSTS = (("living", 5.0), ("bedroom", 3.0), ("kitchen", 1.2), ("study", 0.8),
                  ("dining", 1.0))  # fmt: skip
_BAY_HOSTS = ("bedroom", "living", "study", "dining")


def add_balconies(dice: Dice, sketch: Sketch, count: int) -> bool:
    """Hang this many balconies on free outer walls. False where they do not find a place."""
    weights = dict(_BALCONY_HOSTS)
    for _ in range(count):
        boxes = sketch.boxes
        places = [
            (place, weights[cell.kind] * length)
            for cell in sketch.cells
            if cell.kind in weights
            for place, length in _free_sides(cell, boxes, least=200, depth=200)
        ]
        if not places:
            return False
        start, end = dice.weighted(places)
        _hang_balcony(dice, sketch, boxes, start, end)
    return True


def _free_sides(
    cell: Cell, boxes: list[Bounds], least: int, depth: int
) -> list[tuple[tuple[Point, Point], float]]:
    """Upright and level edges with nothing before them for depth, and their lengths."""
    sides = []
    for start, end in edges(cell.corners):
        length = abs(end[0] - start[0]) + abs(end[1] - start[1])
        upright = start[0] == end[0] or start[1] == end[1]
        if upright and length >= least and is_free(_before(start, end, depth), boxes):
            sides.append(((start, end), length))
    return sides


def _before(start: Point, end: Point, depth: float) -> Bounds:
    """The rectangle outside the edge of a counter-clockwise cell."""
    (x0, y0), (x1, y1) = start, end
    if y0 == y1:
        return (x0, y0 - depth, x1, y0) if x1 > x0 else (x1, y0, x0, y0 + depth)
    return (x0, y0, x0 + depth, y1) if y1 > y0 else (x0 - depth, y1, x0, y0)


def _hang_balcony(
    dice: Dice, sketch: Sketch, boxes: list[Bounds], start: Point, end: Point
) -> None:
    x0, y0, x1, y1 = _before(start, end, dice.steps(125, 185))
    level = start[1] == end[1]
    low, high = (x0, x1) if level else (y0, y1)
    trim = dice.pick([0, 0, 0, dice.steps(20, 80)])
    if high - low - trim > 200:
        low, high = (low + trim, high) if dice.chance(0.5) else (low, high - trim)
    stretch = dice.pick([0, 0, dice.steps(120, 320)])
    for longer in ((low - stretch, high), (low, high + stretch)) if stretch else ():
        span = (longer[0], y0, longer[1], y1) if level else (x0, longer[0], x1, longer[1])
        if is_free(span, boxes) and high - low + stretch < 700:
            low, high = longer
            break
    corners = rectangle(low, y0, high, y1) if level else rectangle(x0, low, x1, high)
    sketch.add("balcony", corners)


def add_bays(dice: Dice, sketch: Sketch, share: float) -> None:
    """Push a window out of some rooms' outer walls; share: of the rooms that could have one."""
    for cell in sketch.cells:
        if cell.kind not in _BAY_HOSTS or not dice.chance(share):
            continue
        sides = _free_sides(cell, sketch.boxes, least=260, depth=150)
        if sides:
            _push_out(dice, cell, *dice.weighted(sides))


def _push_out(dice: Dice, cell: Cell, start: Point, end: Point) -> None:
    ux = (end[0] > start[0]) - (end[0] < start[0])
    uy = (end[1] > start[1]) - (end[1] < start[1])
    length = abs(end[0] - start[0]) + abs(end[1] - start[1])
    width = dice.steps(170, min(length - 80, 300))
    first = dice.pick([(length - width) // 2, dice.steps(40, length - width - 40)])
    depth = dice.steps(45, 75)
    slope = depth if dice.chance(0.4) and width > 2 * depth + 110 else 0

    def at(along: float, out: float) -> Point:
        return start[0] + ux * along + uy * out, start[1] + uy * along - ux * out

    bump = [
        at(first, 0), at(first + slope, depth), at(first + width - slope, depth),
        at(first + width, 0),
    ]  # fmt: skip
    index = cell.corners.index(start)
    cell.corners[index + 1 : index + 1] = bump
    cell.bay = at(first + width / 2, depth)


def slant(dice: Dice, sketch: Sketch) -> None:
    """Cut the house by one slanted line: a corner, or a whole side at a slope."""
    x0 = min(cell.bounds[0] for cell in sketch.cells)
    y0 = min(cell.bounds[1] for cell in sketch.cells)
    x1 = max(cell.bounds[2] for cell in sketch.cells)
    y1 = max(cell.bounds[3] for cell in sketch.cells)
    right, up = dice.chance(0.5), dice.chance(0.5)
    corner = (x1 if right else x0, y1 if up else y0)
    if dice.chance(0.5):
        across, along = dice.steps(90, 220), dice.steps(90, 220)
    else:
        across, along = dice.steps(60, 170), int(y1 - y0) + dice.steps(0, 200)
        if dice.chance(0.5):
            across, along = int(x1 - x0) + dice.steps(0, 200), dice.steps(60, 170)
    # The line meets the two sides of the corner at these distances from it.
    a, b = (1 if right else -1) / across, (1 if up else -1) / along
    _cut(sketch, a, b, a * corner[0] + b * corner[1] - 1.0)


def _cut(sketch: Sketch, a: float, b: float, c: float) -> None:
    """Clip every cell, unless one of them would lose too much or be left with a sliver."""
    cuts: list[tuple[Cell, list[Point]]] = []
    for cell in sketch.cells:
        if all(a * x + b * y <= c for x, y in cell.corners):
            continue
        corners = clipped(cell.corners, a, b, c)
        if len(corners) < 4 or not _is_roomy(cell.corners, corners):
            return
        cuts.append((cell, tidy(corners)))
    for cell, corners in cuts:
        cell.corners = corners


def _is_roomy(before: list[Point], after: list[Point]) -> bool:
    if twice_area(after) < 0.72 * twice_area(before):
        return False
    return all(math.dist(start, end) >= WALL + HALF_WALL for start, end in edges(after))
