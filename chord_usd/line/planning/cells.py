"""A label map's rooms on a grid of straight lines: what was painted by pixels, as walls run.

Walls of one house share few lines. The borders between painted rooms vote for them; each cell
between the lines goes to the room that has most of its pixels. All rooms then fit each other
without gap or overlap, whatever frayed edges they were painted with.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.raster import plan_labels
from chord_usd.base.scene.types import BoolArray, ByteArray, FloatArray
from chord_usd.line.planning.divide import Seed, divided

Rooms = npt.NDArray[np.int32]
"""(H, W) number of the room a pixel belongs to, 0 outside."""

Sides = tuple[FloatArray, FloatArray]
"""Pixels from line to line: widths of the columns, heights of the rows."""

LEAST_ROOM_M2 = 0.8
"""Smaller spots are no rooms."""

LINE_GAP_M = 0.42
"""Lines closer than this become one: no room and no nook of one is narrower."""

LEAST_LINE_M = 0.7
"""Borders of less length in all are frayed edges."""

_ALL_OUTSIDE = 0.97
"""So much of a cell outside a shell is the rim of walls beside it."""


@dataclass(frozen=True, eq=False)
class CellGrid:
    """Rooms as cells between lines."""

    x_px: FloatArray
    """Continuous pixels of the lines along y."""
    y_px: FloatArray
    rooms: Rooms
    """(len(y_px) - 1, len(x_px) - 1) number of each cell's room, 0 outside."""
    labels: dict[int, int]
    """Label (plan_labels) of each room."""
    in_shell: bool = False
    """Whether the outer walls are known: no cell within them goes to the outside then."""

    @property
    def numbers(self) -> list[int]:
        """Numbers of the rooms that have a cell."""
        return [int(number) for number in np.unique(self.rooms) if number > 0]

    def without(self, number: int) -> CellGrid:
        """The grid with this room's cells given to the neighbour with the longest border."""
        cells, inside = self.rooms.copy(), self.rooms == number
        sides = np.diff(self.x_px), np.diff(self.y_px)
        cells[inside] = _bordering(cells, inside, sides, self.in_shell)
        return replace(self, rooms=_in_one_piece(cells, sides, self.in_shell))


def cell_grid(
    labels: ByteArray,
    house: BoolArray,
    m_per_px: float,
    shell: tuple[Sequence[float], Sequence[float]] | None = None,
    seeds: Mapping[int, Sequence[Seed]] = MappingProxyType({}),
) -> CellGrid:
    """The grid of a label map (H, W).

    house: (H, W) pixels up to the middle of the outer walls; shell: lines, as x and as y, of outer
    walls that are known; seeds: where there are known to be rooms, by their labels.
    """
    fixed, in_shell = shell or ((), ()), shell is not None
    spots, names = _spots(labels, house, m_per_px, seeds)
    rooms = _claimed(spots, house)
    gap_px, least_px = LINE_GAP_M / m_per_px, LEAST_LINE_M / m_per_px
    x_px = _lines((rooms[:, 1:] != rooms[:, :-1]).sum(axis=0), fixed[0], gap_px, least_px)
    y_px = _lines((rooms[1:] != rooms[:-1]).sum(axis=1), fixed[1], gap_px, least_px)
    cells = np.array(
        [
            [
                _most(rooms[_span(top, bottom), _span(left, right)], in_shell)
                for left, right in _pairs(x_px)
            ]
            for top, bottom in _pairs(y_px)
        ],
        np.int32,
    ).reshape(max(len(y_px) - 1, 0), max(len(x_px) - 1, 0))
    cells = _in_one_piece(cells, (np.diff(x_px), np.diff(y_px)), in_shell)
    return CellGrid(x_px, y_px, cells, names, in_shell)


def _spots(
    labels: ByteArray, house: BoolArray, m_per_px: float, seeds: Mapping[int, Sequence[Seed]]
) -> tuple[Rooms, dict[int, int]]:
    """Painted rooms: connected spots of one label that are large enough, one for each seed."""
    least_px = LEAST_ROOM_M2 / m_per_px**2
    spots = np.zeros(labels.shape, np.int32)
    names: dict[int, int] = {}
    for label in range(plan_labels.FIRST_ROOM, plan_labels.WALL):
        mask = ((labels == label) & house).astype(np.uint8)
        count, components, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=4)
        for index in range(1, count):
            if stats[index, cv2.CC_STAT_AREA] < least_px:
                continue
            spot = components == index
            inside = [seed for seed in seeds.get(label, ()) if spot[seed.row, seed.column]]
            for room in divided(spot, inside, least_px):
                names[len(names) + 1] = label
                spots[room] = len(names)
    return spots, names


def _claimed(spots: Rooms, house: BoolArray) -> Rooms:
    """Each pixel of the house to the nearest painted room: walls are shared in their middle."""
    if not spots.any():
        return np.zeros(spots.shape, np.int32)
    _, nearest = cv2.distanceTransformWithLabels(
        (spots == 0).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    room_of = np.zeros(int(nearest.max()) + 1, np.int32)
    room_of[nearest[spots > 0]] = spots[spots > 0]
    return np.where(house, room_of[nearest], 0).astype(np.int32)


def _lines(
    votes: npt.NDArray[np.int64], fixed: Sequence[float], gap_px: float, least_px: float
) -> FloatArray:
    """Positions of lines, in continuous pixels: votes[k] is the border between pixels k, k + 1."""
    left = votes.astype(float)
    places = np.arange(1, len(votes) + 1, dtype=float)
    lines = list(fixed)
    for line in fixed:
        left[np.abs(places - line) < gap_px] = 0.0
    while True:
        around = np.convolve(left, np.ones(3), mode="same")
        best = int(around.argmax())
        near = np.abs(places - places[best]) <= 1.0
        if around[best] < least_px:
            return np.sort(np.array(lines))
        line = float((left * places)[near].sum() / left[near].sum())
        lines.append(line)
        left[np.abs(places - line) < gap_px] = 0.0


def _pairs(lines: FloatArray) -> list[tuple[float, float]]:
    return list(pairwise(lines.tolist()))


def _span(low: float, high: float) -> slice:
    return slice(round(low), max(round(high), round(low) + 1))


def _most(numbers: Rooms, in_shell: bool) -> int:
    """The room with most of a cell's pixels; in a shell, whose slanted walls cut through cells, the
    outside has none but those that are all but empty."""
    if not numbers.size:
        return 0
    counts = np.bincount(numbers.ravel())
    if in_shell and counts[0] < _ALL_OUTSIDE * numbers.size:
        counts[0] = 0
    return int(counts.argmax())


def _in_one_piece(cells: Rooms, sides: Sides, in_shell: bool) -> Rooms:
    """Each room keeps its largest piece; the others go to what they border on most."""
    cells = cells.copy()
    areas = np.outer(sides[1], sides[0])
    for room in np.unique(cells[cells > 0]):
        count, pieces = cv2.connectedComponents((cells == room).astype(np.uint8), connectivity=4)
        sizes = [areas[pieces == piece].sum() for piece in range(1, count)]
        for piece in range(1, count):
            if piece - 1 != int(np.argmax(sizes)):
                inside = pieces == piece
                cells[inside] = _bordering(cells, inside, sides, in_shell)
    return cells


def _bordering(cells: Rooms, inside: BoolArray, sides: Sides, in_shell: bool) -> int:
    """The room with the longest border to these cells; outside is one, too, but in a shell."""
    widths, heights = sides
    padded, within = np.pad(cells, 1), np.pad(inside, 1)
    lengths: dict[int, float] = {}
    for row, column in np.argwhere(inside):
        for down, right, length in (
            (-1, 0, widths[column]),
            (1, 0, widths[column]),
            (0, -1, heights[row]),
            (0, 1, heights[row]),
        ):
            spot = row + 1 + down, column + 1 + right
            room = int(padded[spot])
            if not within[spot] and (room or not in_shell):
                lengths[room] = lengths.get(room, 0.0) + float(length)
    return max(lengths, key=lambda room: lengths[room], default=0)
