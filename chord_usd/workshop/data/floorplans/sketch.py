"""A sketch: rooms as cells between the middle lines of walls, before walls have a thickness.

All lengths are steps of STEP_M. Corners are whole numbers except where a slanted wall cuts them.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field

from chord_usd.base.scene.types import WALL_THICKNESS_M, RoomKind

STEP_M = 0.01
WALL = round(WALL_THICKNESS_M / STEP_M)
HALF_WALL = WALL // 2

Point = tuple[float, float]
Bounds = tuple[float, float, float, float]
"""x low, y low, x high, y high."""


@dataclass(eq=False, slots=True)
class Cell:
    """A room up to the middle lines of its walls."""

    kind: RoomKind
    corners: list[Point]
    """Counter-clockwise, first not repeated."""
    host: Cell | None = None
    """The room it belongs to and is entered from (a bathroom en suite); None for any."""
    bay: Point | None = None
    """Middle of the front of its bay window, on the wall's middle line."""

    @property
    def bounds(self) -> Bounds:
        """Its bounding rectangle."""
        xs, ys = zip(*self.corners, strict=True)
        return min(xs), min(ys), max(xs), max(ys)


@dataclass(eq=False, slots=True)
class Sketch:
    """The cells of a house, and which of them touch without a wall."""

    cells: list[Cell] = field(default_factory=list)
    open_pairs: list[tuple[Cell, Cell]] = field(default_factory=list)

    def add(self, kind: RoomKind, corners: list[Point], host: Cell | None = None) -> Cell:
        """Append a cell and return it."""
        cell = Cell(kind, corners, host)
        self.cells.append(cell)
        return cell

    @property
    def boxes(self) -> list[Bounds]:
        """Bounds of all cells, in their order."""
        return [cell.bounds for cell in self.cells]


def is_free(area: Bounds, boxes: list[Bounds]) -> bool:
    """Whether none of the boxes reaches into this area."""
    x0, y0, x1, y1 = area
    for left, low, right, high in boxes:
        if left < x1 and right > x0 and low < y1 and high > y0:
            return False
    return True


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[Point]:
    """Corners of an upright rectangle, counter-clockwise."""
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def twice_area(corners: list[Point]) -> float:
    """Twice the signed area; positive when counter-clockwise."""
    total = 0.0
    x0, y0 = corners[-1]
    for x1, y1 in corners:
        total += x0 * y1 - x1 * y0
        x0, y0 = x1, y1
    return total


def tidy(corners: list[Point]) -> list[Point]:
    """Counter-clockwise, without repeated corners and corners on a straight line."""
    count = len(corners)
    kept = []
    for index in range(count):
        (ax, ay), (bx, by) = corners[index - 1], corners[index]
        cx, cy = corners[(index + 1) % count]
        if abs((bx - ax) * (cy - by) - (by - ay) * (cx - bx)) > 1e-6:
            kept.append((bx, by))
    return kept if twice_area(kept) > 0.0 else kept[::-1]


def clipped(corners: list[Point], a: float, b: float, c: float) -> list[Point]:
    """The part where a x + b y <= c."""
    kept: list[Point] = []
    x0, y0 = corners[-1]
    d0 = a * x0 + b * y0 - c
    for x1, y1 in corners:
        d1 = a * x1 + b * y1 - c
        if (d0 > 0.0) != (d1 > 0.0):
            share = d0 / (d0 - d1)
            # An edge along an axis keeps its whole coordinate: shared walls are found by equality.
            x = x0 if x0 == x1 else x0 + share * (x1 - x0)
            y = y0 if y0 == y1 else y0 + share * (y1 - y0)
            kept.append((x, y))
        if d1 <= 0.0:
            kept.append((x1, y1))
        x0, y0, d0 = x1, y1, d1
    return kept


def shared_stretch(first: Cell, second: Cell) -> tuple[Point, Point] | None:
    """The longest upright or level stretch of wall between two cells, along first's direction."""
    best, longest = None, 0.0
    for (ax, ay), (bx, by) in edges(first.corners):
        for (cx, cy), (dx, dy) in edges(second.corners):
            if ay == by == cy == dy and (bx - ax) * (dx - cx) < 0:
                low, high = max(min(ax, bx), min(cx, dx)), min(max(ax, bx), max(cx, dx))
                ends = ((low, ay), (high, ay)) if bx > ax else ((high, ay), (low, ay))
            elif ax == bx == cx == dx and (by - ay) * (dy - cy) < 0:
                low, high = max(min(ay, by), min(cy, dy)), min(max(ay, by), max(cy, dy))
                ends = ((ax, low), (ax, high)) if by > ay else ((ax, high), (ax, low))
            else:
                continue
            if high - low > longest:
                best, longest = ends, high - low
    return best


def edges(corners: list[Point]) -> list[tuple[Point, Point]]:
    """The edges, from each corner to the next."""
    return list(zip(corners, corners[1:] + corners[:1], strict=True))


@dataclass(slots=True)
class Face:
    """The inner face of a room: corners, and which edges are open to a neighbour."""

    corners: list[Point]
    is_open: list[bool]
    """For the edge from each corner to the next."""


def faces(sketch: Sketch) -> list[Face]:
    """Inner faces of all cells, in their order: half a wall inside the middle lines."""
    openings: dict[int, list[tuple[Point, Point]]] = {}
    ends: Counter[Point] = Counter()
    for first, second in sketch.open_pairs:
        stretch = shared_stretch(first, second)
        if stretch is not None:
            openings.setdefault(id(first), []).append(stretch)
            openings.setdefault(id(second), []).append((stretch[1], stretch[0]))
            ends.update(stretch)
    return [_face(cell, openings.get(id(cell), []), ends) for cell in sketch.cells]


def _face(cell: Cell, openings: list[tuple[Point, Point]], ends: Counter[Point]) -> Face:
    corners: list[Point] = []
    is_open: list[bool] = []
    for start, end in edges(cell.corners):
        corners.append(start)
        opening = next((o for o in openings if _lies_on(o, start, end)), None)
        if opening is None:
            is_open.append(False)
            continue
        is_open.append(opening[0] == start)
        # Where only the neighbour ends, its own wall covers half a wall of the stretch, unless it
        # is open round the corner too.
        ux, uy = _direction(start, end)
        if opening[0] != start:
            x, y = opening[0]
            covered = HALF_WALL if ends[x, y] == 1 else 0
            corners.append((x + covered * ux, y + covered * uy))
            is_open.append(True)
        if opening[1] != end:
            x, y = opening[1]
            covered = HALF_WALL if ends[x, y] == 1 else 0
            corners.append((x - covered * ux, y - covered * uy))
            is_open.append(False)
    return _inset(corners, is_open)


def _direction(start: Point, end: Point) -> Point:
    dx, dy = end[0] - start[0], end[1] - start[1]
    if dx == 0 or dy == 0:
        return float((dx > 0) - (dx < 0)), float((dy > 0) - (dy < 0))
    length = math.hypot(dx, dy)
    return dx / length, dy / length


def _lies_on(stretch: tuple[Point, Point], start: Point, end: Point) -> bool:
    (ax, ay), (bx, by) = stretch
    (sx, sy), (ex, ey) = start, end
    if sx == ex == ax == bx:
        return (by - ay) * (ey - sy) > 0 and min(sy, ey) <= min(ay, by) <= max(ay, by) <= max(
            sy, ey
        )
    if sy == ey == ay == by:
        return (bx - ax) * (ex - sx) > 0 and min(sx, ex) <= min(ax, bx) <= max(ax, bx) <= max(
            sx, ex
        )
    return False


def _inset(corners: list[Point], is_open: list[bool]) -> Face:
    """Move every closed edge half a wall inwards."""
    count = len(corners)
    directions = [_direction(corners[i], corners[(i + 1) % count]) for i in range(count)]
    face = Face([], [])
    for index in range(count):
        (x, y), (ux, uy), (vx, vy) = corners[index], directions[index - 1], directions[index]
        before = 0 if is_open[index - 1] else HALF_WALL
        after = 0 if is_open[index] else HALF_WALL
        turn = ux * vy - uy * vx
        if abs(turn) < 1e-9:
            if before != after:
                face.corners.append((x - before * uy, y + before * ux))
                face.is_open.append(False)
            face.corners.append((x - after * vy, y + after * vx))
        else:
            # Move in by `before`, then along the first edge until the second is `after` away.
            along_u = (before * (ux * vx + uy * vy) - after) / turn
            face_x, face_y = x - before * uy + along_u * ux, y + before * ux + along_u * uy
            # Rounding must not bend a level or upright wall that meets a slanted one.
            if vx == 0.0:
                face_x = x - after * vy
            elif vy == 0.0:
                face_y = y + after * vx
            face.corners.append((face_x, face_y))
        face.is_open.append(is_open[index])
    return face
