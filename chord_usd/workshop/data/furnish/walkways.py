"""Whether people can walk from door to door and up to every piece of a room.

The floor is a grid of cells held in one Python integer, one bit per cell, row by row with empty
guard columns between the rows: erosion and flood fill become a few shifts of that integer, fast
enough to run several times for every room of a training stream.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import WET_KINDS
from chord_usd.workshop.data.furnish.floor import Bounds, Door, Floor, Placed

CELL_M = 0.1

PATH_CELLS = 6
"""A path is free where a square of this many cells a side is: 0.6 m, 0.5 m at worst."""

NARROW_PATH_CELLS, NARROWEST_PATH_CELLS = 5, 4
"""The same in bathrooms, where one passes a toilet or basin with half a metre, and wherever
wider paths leave no room for what the room is there for (Floor.squeeze)."""

STAND_M = 0.55
"""Somebody who uses a piece stands within this distance of it."""

REACH_ASIDE_M = 0.15
"""And no farther than this beyond its sides."""

CUT_OFF, CORE_LOST, LOST = 10, 3, 1
"""Weights of path_faults: a door, a piece the room is there for, any other piece."""

NEEDS_NO_ACCESS = having("reached_over")
"""Pieces that are reached over their neighbours: a bedside table from the bed."""

_GUARD_CELLS = 2


class Grid:
    """The cells of a room's bounding box, and what is known about them."""

    def __init__(self, floor: Floor) -> None:
        corners = floor.corners
        self.x0, self.y0, x1, y1 = floor.bounds_m
        self.columns = math.ceil((x1 - self.x0) / CELL_M)
        self.rows = math.ceil((y1 - self.y0) / CELL_M)
        self.stride = self.columns + _GUARD_CELLS
        self._first_cells = ((1 << self.rows * self.stride) - 1) // ((1 << self.stride) - 1)
        """The first cell of every row."""
        fills = floor.area_m2 > (x1 - self.x0) * (y1 - self.y0) - 1e-6
        self.floor = self.inside((self.x0, self.y0, x1, y1)) if fills else self.within(corners)
        self.doors = [self.inside(_door_bounds(door)) for door in floor.doors]
        self._pieces: list[tuple[Placed, int, int]] = []
        self._connected: dict[int, list[int]] = {}

    def inside(self, box: Bounds) -> int:
        """Cells whose centre lies in the box."""
        left = int((box[0] - self.x0) / CELL_M + 0.5) if box[0] > self.x0 else 0
        low = int((box[1] - self.y0) / CELL_M + 0.5) if box[1] > self.y0 else 0
        right = min(self.columns, int((box[2] - self.x0) / CELL_M + 0.5))
        high = min(self.rows, int((box[3] - self.y0) / CELL_M + 0.5))
        if right <= left or high <= low:
            return 0
        row = ((1 << (right - left)) - 1) << left
        rows = self._first_cells & ((1 << (high - low) * self.stride) - 1)
        return (row * rows) << low * self.stride

    def within(self, corners: Sequence[tuple[float, float]]) -> int:
        """Cells whose centre lies in a simple polygon."""
        if all(ax == bx or ay == by for (ax, ay), (bx, by) in pairwise((corners[-1], *corners))):
            return self._within_bands(corners)
        cells = 0
        for j in range(self.rows):
            xs = _crossings(corners, self.y0 + (j + 0.5) * CELL_M)
            for i in range(0, len(xs) - 1, 2):
                left = max(0, int((xs[i] - self.x0) / CELL_M + 0.5))
                right = min(self.columns, int((xs[i + 1] - self.x0) / CELL_M + 0.5))
                if right > left:
                    cells |= ((1 << (right - left)) - 1) << (left + j * self.stride)
        return cells

    def _within_bands(self, corners: Sequence[tuple[float, float]]) -> int:
        """The same for polygons of level and upright sides, which are a few rectangles."""
        cells = 0
        for low, high in pairwise(sorted({y for _, y in corners})):
            xs = _crossings(corners, (low + high) / 2)
            for i in range(0, len(xs) - 1, 2):
                cells |= self.inside((xs[i], low, xs[i + 1], high))
        return cells

    def walkable(
        self, free: int, path_cells: int, doors: Sequence[int], used: Sequence[int] = ()
    ) -> int:
        """Where one can walk on these free cells, from the first door that lets anybody in.

        Complete only where one of the doors or of the used cells cannot be reached.
        """
        standing = _eroded(free, self.stride, path_cells)
        seed = next((door & standing for door in doors if door & standing), standing & -standing)
        return _flooded(standing, seed, self.stride, self.columns, self.rows, [*doors, *used])

    def connected_doors(self, path_cells: int) -> list[int]:
        """The doors that a path of this width joins while the room is empty."""
        if path_cells not in self._connected:
            if len(self.doors) == 1:
                walk = _eroded(self.floor, self.stride, path_cells)
            else:
                walk = self.walkable(self.floor, path_cells, self.doors)
            self._connected[path_cells] = [door for door in self.doors if door & walk]
        return self._connected[path_cells]

    def pieces(self, placed: Sequence[Placed]) -> list[tuple[Placed, int, int]]:
        """Each piece with the cells under it and those from which it is used.

        What was asked about before is remembered as far as the first pieces are the same.
        """
        known = self._pieces
        for i, piece in enumerate(placed):
            if i < len(known) and known[i][0] is piece:
                continue
            del known[i:]
            under = 0 if piece.category.endswith("_background") else _under(self, piece)
            beside = 0 if piece.category in NEEDS_NO_ACCESS else _beside(self, piece)
            known.append((piece, under, beside))
        del known[len(placed) :]
        return known


def path_faults(floor: Floor) -> int:
    """How badly people can walk here; 0 when all doors connect and every piece can be used."""
    if floor.walked == len(floor.placed):
        return 0
    faults = _count_faults(floor)
    floor.walked = -1 if faults else len(floor.placed)
    return faults


def _count_faults(floor: Floor) -> int:
    if floor.cells is None:
        floor.cells = Grid(floor)
    grid: Grid = floor.cells
    free, pieces = grid.floor, grid.pieces(floor.placed)
    for _, under, _ in pieces:
        free &= ~under
    path_cells = _path_cells(floor)
    doors = grid.connected_doors(path_cells)
    used = [(piece, beside) for piece, _, beside in pieces if piece.category not in NEEDS_NO_ACCESS]
    walk = grid.walkable(free, path_cells, doors, [beside for _, beside in used])
    faults = CUT_OFF * sum(not door & walk for door in doors)
    for piece, beside in used:
        if not beside & walk:
            faults += CORE_LOST if piece.core else LOST
    return faults


def _path_cells(floor: Floor) -> int:
    if floor.squeezed > 1:
        return NARROWEST_PATH_CELLS
    return NARROW_PATH_CELLS if floor.squeezed or floor.kind in WET_KINDS else PATH_CELLS


def _crossings(corners: Sequence[tuple[float, float]], y: float) -> list[float]:
    """Where a horizontal line crosses the outline, from left to right."""
    xs = []
    ax, ay = corners[-1]
    for bx, by in corners:
        if (ay > y) != (by > y):
            xs.append(ax + (y - ay) * (bx - ax) / (by - ay))
        ax, ay = bx, by
    xs.sort()
    return xs


def _under(grid: Grid, piece: Placed) -> int:
    """The cells a piece stands on."""
    half_length, half_width = piece.size[0] / 2, piece.size[1] / 2
    if abs(piece.ux * piece.uy) < 1e-6:
        return grid.inside(_bounds(piece, 0.0, 0.0, half_length, half_width))
    lx, ly = piece.ux * half_length, piece.uy * half_length
    wx, wy = -piece.uy * half_width, piece.ux * half_width
    x, y = piece.x, piece.y
    return grid.within((
        (x - lx + wx, y - ly + wy),
        (x - lx - wx, y - ly - wy),
        (x + lx - wx, y + ly - wy),
        (x + lx + wx, y + ly + wy),
    ))  # fmt: skip


def _beside(grid: Grid, piece: Placed) -> int:
    """Where one may stand to use a piece: in front of it, or on either side of a bed."""
    half_length, half_width, half_stand = piece.size[0] / 2, piece.size[1] / 2, STAND_M / 2
    front = _bounds(piece, 0.0, half_width + half_stand, half_length + REACH_ASIDE_M, half_stand)
    cells = grid.inside(front)
    if piece.category == "bed":
        for side in (-half_length - half_stand, half_length + half_stand):
            foot = _bounds(piece, side, half_width / 4, half_stand, half_width * 0.75)
            cells |= grid.inside(foot)
    return cells


def _bounds(
    piece: Placed, along: float, ahead: float, half_along: float, half_ahead: float
) -> Bounds:
    """Bounds of a rectangle in the piece's own frame, given by its middle and half sizes."""
    ux, uy = piece.ux, piece.uy
    x, y = piece.x + ux * along + uy * ahead, piece.y + uy * along - ux * ahead
    ux, uy = abs(ux), abs(uy)
    half_x, half_y = ux * half_along + uy * half_ahead, uy * half_along + ux * half_ahead
    return x - half_x, y - half_y, x + half_x, y + half_y


def _door_bounds(door: Door) -> Bounds:
    """Where somebody stands who has just come in."""
    wall, deep = door.wall, min(door.s_to - door.s_from, 1.0)
    ax, ay = wall.world(door.s_from, 0.2)
    bx, by = wall.world(door.s_to, deep)
    return min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)


def _eroded(free: int, stride: int, cells: int) -> int:
    """Where the middle of a free square of this many cells may be; cells is 4 to 8."""
    rest = cells - 4
    free &= free >> 1
    free &= free >> 2
    free &= free >> rest
    free &= free >> stride
    free &= free >> 2 * stride
    free &= free >> rest * stride
    return free << (cells // 2) * (stride + 1)


def _flooded(
    standing: int, seed: int, stride: int, columns: int, rows: int, wanted: Sequence[int]
) -> int:
    """What connects to the seed, diagonal steps included, until it touches everything wanted.

    Each round runs to the ends of all free rows and columns at once, by steps of 1, 2, 4, ... cells
    over what is free that far; a room without niches needs one or two rounds.
    """
    left = _runs(standing, 1, columns)
    down = _runs(standing, stride, rows)
    walk, before = seed, 0
    while walk != before and not all(cells & walk for cells in wanted):
        before = walk
        walk |= walk << 1 | walk >> 1
        walk |= walk << stride | walk >> stride
        walk &= standing
        for shift, free in left:
            walk |= free & walk >> shift
        # Carries run up through every run of free cells that holds a walked one.
        walk |= standing & ~(standing + walk)
        for shift, free in down:
            walk |= free & walk >> shift
        for shift, free in down:
            walk |= (free & walk) << shift & standing
    return walk


def _runs(standing: int, step: int, most: int) -> list[tuple[int, int]]:
    """Shifts of 1, 2, 4, ... steps, and the cells from which as many in a row are free."""
    runs = []
    while most > 0:
        runs.append((step, standing))
        standing &= standing >> step
        step, most = 2 * step, most // 2
    return runs
