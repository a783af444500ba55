"""Whether people can walk from door to door and up to every piece of a room.

The floor is a grid with one Python integer per row, one bit per cell: erosion and flood fill are
then a few integer operations per row, fast enough to run for every room of a training stream.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from chord_usd.data.furnish.floor import Door, Floor, Placed

CELL_M = 0.1

PATH_CELLS = 6
"""A path is free where a square of this many cells a side is: 0.6 m, 0.5 m at worst."""

STAND_M = 0.55
"""Somebody who uses a piece stands within this distance of its front."""

NEEDS_NO_ACCESS = frozenset(
    ("bed_background", "sofa_background", "bedside_table", "side_coffee_table", "tv_cabinet",
     "chair", "coffee_table", "dining_table", "table")
)  # fmt: skip
"""Pieces that are reached over their neighbours: a bedside table from the bed."""

Rows = list[int]
Point = tuple[float, float]


def unreachable(floor: Floor) -> tuple[bool, list[Placed]]:
    """(whether all doors connect, pieces nobody can walk up to)."""
    x0 = min(x for x, _ in floor.corners)
    y0 = min(y for _, y in floor.corners)
    height = max(y for _, y in floor.corners) - y0
    free = _floor_rows(floor.corners, x0, y0, math.ceil(height / CELL_M) + 1)
    for piece in floor.placed:
        if not piece.category.endswith("_background"):
            _clear(free, _footprint(piece), x0, y0)
    standing = _runs(_eroded(free))
    doors = [_box_rows(_door_box(door), x0, y0, len(free)) for door in floor.doors]
    walk = _flood(standing, next((rows for rows in doors if _meets(standing, rows)), None))
    connected = all(_touch(walk, rows) for rows in doors)
    lost = [
        piece
        for piece in floor.placed
        if piece.category not in NEEDS_NO_ACCESS
        and not _touch(walk, _box_rows(_front_box(piece), x0, y0, len(free)))
    ]
    return connected, lost


def _floor_rows(corners: Sequence[Point], x0: float, y0: float, count: int) -> Rows:
    """Cells whose centre is inside the outline."""
    if len(corners) == 4 and all(
        abs(corners[i][0] - corners[i - 1][0]) < 1e-6
        or abs(corners[i][1] - corners[i - 1][1]) < 1e-6
        for i in range(4)
    ):
        top = max(y for _, y in corners)
        bits = _bits(x0, max(x for x, _ in corners), x0)
        return [bits if y0 + (j + 0.5) * CELL_M < top else 0 for j in range(count)]
    return [_row(_crossings(corners, y0 + (j + 0.5) * CELL_M), x0) for j in range(count)]


def _crossings(corners: Sequence[Point], y: float) -> list[float]:
    """Where a horizontal line crosses the outline, from left to right."""
    xs = []
    ax, ay = corners[-1]
    for bx, by in corners:
        if (ay > y) != (by > y):
            xs.append(ax + (y - ay) * (bx - ax) / (by - ay))
        ax, ay = bx, by
    xs.sort()
    return xs


def _row(xs: Sequence[float], x0: float) -> int:
    row = 0
    for i in range(0, len(xs) - 1, 2):
        row |= _bits(xs[i], xs[i + 1], x0)
    return row


def _bits(x_from: float, x_to: float, x0: float) -> int:
    """Cells of a row whose centre lies in [x_from, x_to]."""
    first = max(0, math.ceil((x_from - x0) / CELL_M - 0.5))
    last = math.floor((x_to - x0) / CELL_M - 0.5)
    return ((1 << (last - first + 1)) - 1) << first if last >= first else 0


def _clear(rows: Rows, corners: Sequence[Point], x0: float, y0: float) -> None:
    """Take a convex footprint out of the free cells."""
    ys = [y for _, y in corners]
    first = max(0, math.ceil((min(ys) - y0) / CELL_M - 0.5))
    last = min(len(rows) - 1, math.floor((max(ys) - y0) / CELL_M - 0.5))
    (ax, ay), (bx, by) = corners[0], corners[1]
    if abs(ax - bx) < 1e-6 or abs(ay - by) < 1e-6:
        xs = [x for x, _ in corners]
        keep = ~_bits(min(xs), max(xs), x0)
        for j in range(first, last + 1):
            rows[j] &= keep
        return
    for j in range(first, last + 1):
        rows[j] &= ~_row(_crossings(corners, y0 + (j + 0.5) * CELL_M), x0)


def _footprint(piece: Placed) -> list[Point]:
    half_length, half_width = piece.size[0] / 2, piece.size[1] / 2
    lx, ly = piece.ux * half_length, piece.uy * half_length
    wx, wy = -piece.uy * half_width, piece.ux * half_width
    x, y = piece.x, piece.y
    return [
        (x - lx + wx, y - ly + wy),
        (x - lx - wx, y - ly - wy),
        (x + lx - wx, y + ly - wy),
        (x + lx + wx, y + ly + wy),
    ]


def _eroded(free: Rows) -> Rows:
    """Where the middle of a square of PATH_CELLS may be; cell (i, j) stands for its lower corner."""
    narrow = []
    for row in free:
        row &= row >> 1
        row &= row >> 2
        narrow.append((row & row >> 2) << 3)
    pairs = [a & b for a, b in zip(narrow, narrow[1:], strict=False)]
    fours = [a & b for a, b in zip(pairs, pairs[2:], strict=False)]
    sixes = [a & b for a, b in zip(fours, fours[2:], strict=False)]
    return [0, 0, 0, *sixes, *([0] * (len(free) - 3 - len(sixes)))]


def _runs(rows: Rows) -> list[list[int]]:
    """Each row as its unbroken runs."""
    result = []
    for row in rows:
        runs = []
        while row:
            rest = row & (row + (row & -row))
            runs.append(row & ~rest)
            row = rest
        result.append(runs)
    return result


def _flood(standing: list[list[int]], seed: Rows | None) -> Rows:
    """Everything that connects to the seed; to the widest row where there is none."""
    walk = [0] * len(standing)
    if seed is None:
        sums = [sum(runs) for runs in standing]
        widest = max(range(len(sums)), key=lambda j: sums[j].bit_count())
        seed = [0] * len(standing)
        seed[widest] = sums[widest]
    last = len(standing) - 1
    changed = True
    upward = range(last + 1)
    while changed:
        changed = False
        for order in (upward, reversed(upward)):
            before = 0
            for j in order:
                touched = walk[j] | seed[j] | before
                row = 0
                for run in standing[j]:
                    if run & touched:
                        row |= run
                if row != walk[j]:
                    walk[j] = row
                    changed = True
                before = row
    return walk


def _box_rows(box: tuple[float, float, float, float], x0: float, y0: float, count: int) -> Rows:
    bits = _bits(box[0] - CELL_M / 2, box[2] + CELL_M / 2, x0)
    first = math.ceil((box[1] - y0) / CELL_M - 1.0)
    last = math.floor((box[3] - y0) / CELL_M)
    return [bits if first <= j <= last else 0 for j in range(count)]


def _door_box(door: Door) -> tuple[float, float, float, float]:
    width = door.s_to - door.s_from
    deep = min(width, 1.0)
    return _bounds(door.wall.world(s, t) for s in (door.s_from, door.s_to) for t in (0.2, deep))


def _front_box(piece: Placed) -> tuple[float, float, float, float]:
    near, far = piece.size[1] / 2, piece.size[1] / 2 + STAND_M
    half = piece.size[0] / 2
    return _bounds(
        (piece.x + piece.ux * a + piece.uy * d, piece.y + piece.uy * a - piece.ux * d)
        for a in (-half, half)
        for d in (near, far)
    )


def _bounds(points: Iterable[Point]) -> tuple[float, float, float, float]:
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def _meets(standing: list[list[int]], rows: Rows) -> bool:
    return any(run & row for runs, row in zip(standing, rows, strict=True) if row for run in runs)


def _touch(walk: Rows, rows: Rows) -> bool:
    return any(a & b for a, b in zip(walk, rows, strict=True))
