"""Label map -> Plan: rooms with straight walls of one thickness, and openings that lie in them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon, box
from shapely.ops import unary_union

from chord_usd.base.raster import plan_labels
from chord_usd.base.raster.bubbles import Bubble
from chord_usd.base.scene.geometry import polygons_of, room_polygon, rooms_beside
from chord_usd.base.scene.types import (
    BASE_AND_HEIGHT_M,
    LEARNED_KINDS,
    WALL_THICKNESS_M,
    BoolArray,
    Box,
    ByteArray,
    Opening,
    OpeningKind,
    PixelFrame,
    Plan,
    Room,
    RoomKind,
    frozen_array,
)
from chord_usd.base.scene.units import m_from_px, px_from_m
from chord_usd.line.planning.cells import LEAST_ROOM_M2, CellGrid, Rooms, cell_grid
from chord_usd.line.planning.divide import Seed
from chord_usd.line.planning.faults import LEAST_AREA_M2, LEAST_WIDTH_M
from chord_usd.line.planning.ways import Border, missing_doors

_HALF_WALL_M = WALL_THICKNESS_M / 2

_LABELS: dict[OpeningKind, int] = {
    "door": plan_labels.DOOR,
    "window": plan_labels.WINDOW,
    "passage": plan_labels.PASSAGE,
}

_LEAST_LENGTH_M: dict[OpeningKind, float] = {"door": 0.7, "window": 0.5, "passage": 0.8}
"""What was painted a little short is this long."""

_LEAST_SEEN_M = 0.42
"""Shorter spots are the ends of openings in walls that cross."""

_JAMB_M = 0.06
"""Wall that stays between an opening and a corner of the room."""

_STEP_M = 0.05
"""Openings come in such lengths."""

_OUTSIDE = 0


@dataclass(frozen=True)
class _Stretch:
    """A straight border between two rooms, or of one to the outside, along the wall's middle."""

    upright: bool
    across_px: float
    """x of an upright border, y of a level one."""
    low_px: float
    high_px: float
    rooms: tuple[int, int]


def plan_from_labels(
    labels: ByteArray,
    frame: PixelFrame,
    shell: Plan | None = None,
    bubbles: Sequence[Bubble] = (),
) -> Plan:
    """The plan that a label map (H, W) shows; it has no rooms where none are seen.

    What is too small for a room goes to its neighbour, and rooms that nothing leads to get a door
    (ways.missing_doors). shell: an open plan of one room, whose outer walls and their openings stay
    as they are; bubbles: the diagram that it was painted to, in metres: what was painted as one
    and has two bubbles of its kind are two rooms.
    """
    house, walls = _house(labels, frame, shell)
    grid = cell_grid(labels, house, frame.m_per_px, walls, _seeds(bubbles, frame))
    grid, floors = _without_slivers(grid, frame, shell)
    numbers, rooms = _rooms(grid, floors)
    stretches = list(_stretches(grid))
    openings = [
        opening
        for hole in _holes(labels, stretches, frame)
        if (opening := _opening(hole, frame, rooms, numbers)) is not None
    ]
    if shell is not None and shell.openings:
        inner = [opening for opening in openings if len(opening.room_ids) == 2]
        openings = [*_rejoined(shell.openings, rooms), *inner]
    openings += _missing(stretches, openings, frame, rooms, numbers)
    return Plan(tuple(rooms), tuple(_named(openings)))


def _seeds(bubbles: Sequence[Bubble], frame: PixelFrame) -> dict[int, list[Seed]]:
    """The bubbles that lie on the sheet, by their labels."""
    seeds: dict[int, list[Seed]] = {}
    for bubble in bubbles:
        column, row = np.floor(px_from_m(np.array([[bubble.x_m, bubble.y_m]]), frame)[0])
        if min(column, row) >= 0 and max(column, row) < frame.height_px:
            seed = Seed(int(column), int(row), bubble.radius_m / frame.m_per_px)
            seeds.setdefault(plan_labels.label_of(bubble.kind), []).append(seed)
    return seeds


def _middle(shell: Plan) -> Polygon:
    """The area up to the middle of a shell's walls."""
    return room_polygon(shell.rooms[0]).buffer(_HALF_WALL_M, join_style="mitre")


def _house(
    labels: ByteArray, frame: PixelFrame, shell: Plan | None
) -> tuple[BoolArray, tuple[list[float], list[float]] | None]:
    """The pixels up to the middle of the outer walls, and the lines that a shell's walls fix."""
    if shell is None:
        whole = plan_labels.house_mask(labels).astype(np.uint8)
        count, pieces, stats, _ = cv2.connectedComponentsWithStats(whole, connectivity=4)
        if count > 1:
            whole = (pieces == 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())).astype(np.uint8)
        return cv2.erode(whole, np.ones((3, 3), np.uint8)).astype(bool), None
    corners = np.asarray(_middle(shell).exterior.coords)
    corners_px = px_from_m(corners, frame)
    rows, columns = np.indices(labels.shape)
    centers = m_from_px(np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=1), frame)
    inside = shapely.contains_xy(_middle(shell), centers[:, 0], centers[:, 1])
    sides = np.abs(np.diff(corners_px, axis=0))
    upright = corners_px[:-1][(sides[:, 0] < 0.1) & (sides[:, 1] > 0.1), 0]
    level = corners_px[:-1][(sides[:, 1] < 0.1) & (sides[:, 0] > 0.1), 1]
    reach = np.stack([corners_px.min(axis=0), corners_px.max(axis=0)])
    return inside.reshape(labels.shape), (_apart(upright, reach[:, 0]), _apart(level, reach[:, 1]))


def _apart(lines: npt.NDArray[np.float64], ends: npt.NDArray[np.float64]) -> list[float]:
    """Lines and the two ends, each once."""
    return [float(line) for line in np.unique(np.round([*lines, *ends], 3))]


def _without_slivers(
    grid: CellGrid, frame: PixelFrame, shell: Plan | None
) -> tuple[CellGrid, dict[int, Polygon]]:
    """The grid without rooms that are too small for their kind, and the floors of the others."""
    while True:
        floors = {number: _floor(grid, number, frame, shell) for number in grid.numbers}
        small = [n for n, floor in floors.items() if _is_sliver(floor, grid.labels[n])]
        if not small:
            return grid, floors
        grid = grid.without(min(small, key=lambda number: floors[number].area))


def _is_sliver(floor: Polygon, label: int) -> bool:
    least_m2 = LEAST_AREA_M2.get(_kind(label), LEAST_ROOM_M2)
    return floor.area < least_m2 or floor.buffer(-LEAST_WIDTH_M / 2).is_empty


def _kind(label: int) -> RoomKind:
    return LEARNED_KINDS[label - plan_labels.FIRST_ROOM]


def _floor(grid: CellGrid, number: int, frame: PixelFrame, shell: Plan | None) -> Polygon:
    """A room inside its walls; empty where nothing is left."""
    area = unary_union([box(*bounds) for bounds in _cell_bounds(grid, number, frame)])
    if shell is not None:
        area = area.intersection(_middle(shell))
    floors = area.buffer(-_HALF_WALL_M, join_style="mitre")
    if shell is not None:
        # A hair's breadth between a line and a corner of the shell leaves a chamfer there.
        floors = floors.intersection(room_polygon(shell.rooms[0]))
    return max(polygons_of(floors), key=lambda part: part.area, default=Polygon())


def _rooms(grid: CellGrid, floors: dict[int, Polygon]) -> tuple[dict[int, str], list[Room]]:
    """The rooms, and their ids by their numbers in the grid."""
    counts: Counter[str] = Counter()
    numbers: dict[int, str] = {}
    rooms = []
    for number, floor in floors.items():
        kind = _kind(grid.labels[number])
        counts[kind] += 1
        numbers[number] = f"{kind}{counts[kind]}"
        corners = shapely.get_coordinates(shapely.orient_polygons(floor).exterior.simplify(1e-6))
        name = f"{kind.capitalize()} {counts[kind]}"
        rooms.append(Room(numbers[number], kind, frozen_array(corners[:-1]), name))
    return numbers, rooms


def _cell_bounds(
    grid: CellGrid, number: int, frame: PixelFrame
) -> Iterator[tuple[float, float, float, float]]:
    """Bounds of a room's cells in metres: x low, y low, x high, y high."""
    for row, column in np.argwhere(grid.rooms == number):
        corners = [
            (grid.x_px[column], grid.y_px[row]),
            (grid.x_px[column + 1], grid.y_px[row + 1]),
        ]
        (left, top), (right, bottom) = m_from_px(np.array(corners), frame)
        yield float(left), float(bottom), float(right), float(top)


@dataclass(frozen=True)
class _Hole:
    """An opening as it was painted."""

    kind: OpeningKind
    stretch: _Stretch
    low_px: float
    high_px: float


def _holes(labels: ByteArray, stretches: Sequence[_Stretch], frame: PixelFrame) -> Iterator[_Hole]:
    """Runs of painted openings along every border."""
    least_px = _LEAST_SEEN_M / frame.m_per_px
    for stretch in stretches:
        for kind, label in _LABELS.items():
            painted = _along(labels == label, stretch)
            for low, high in _runs(painted, round(stretch.low_px)):
                if high - low >= least_px:
                    yield _Hole(kind, stretch, low, high)


def _stretches(grid: CellGrid) -> Iterator[_Stretch]:
    """Borders between cells of two rooms, joined where they go on straight."""
    padded = np.pad(grid.rooms, 1)
    for upright, rooms, across, along in (
        (True, padded[1:-1].T, grid.x_px, grid.y_px),
        (False, padded[:, 1:-1], grid.y_px, grid.x_px),
    ):
        for index, line in enumerate(across):
            yield from _joined(rooms[index], rooms[index + 1], upright, float(line), along)


def _joined(
    before: Rooms, after: Rooms, upright: bool, line: float, along: npt.NDArray[np.float64]
) -> Iterator[_Stretch]:
    start = 0
    for index in range(1, len(before) + 1):
        pair = (int(before[start]), int(after[start]))
        if index < len(before) and (int(before[index]), int(after[index])) == pair:
            continue
        if pair[0] != pair[1]:
            yield _Stretch(upright, line, float(along[start]), float(along[index]), pair)
        start = index


def _along(mask: BoolArray, stretch: _Stretch) -> BoolArray:
    """Whether anything of a mask lies near a border, pixel by pixel along it."""
    turned = mask.T if stretch.upright else mask
    first = max(round(stretch.across_px) - 2, 0)
    band = turned[first : first + 4, round(stretch.low_px) : round(stretch.high_px)]
    return np.asarray(band.any(axis=0))


def _runs(painted: BoolArray, first: int) -> list[tuple[float, float]]:
    """From where to where it is painted; breaks of two pixels are passed over."""
    places = np.flatnonzero(painted)
    if not len(places):
        return []
    parts = np.split(places, np.flatnonzero(np.diff(places) > 3) + 1)
    return [(float(part[0] + first), float(part[-1] + 1 + first)) for part in parts]


def _opening(
    hole: _Hole, frame: PixelFrame, rooms: list[Room], numbers: dict[int, str]
) -> Opening | None:
    """The opening in its wall; None where it makes no sense there or the wall is too short."""
    stretch = hole.stretch
    ids = tuple(numbers[room] for room in stretch.rooms if room in numbers)
    kinds = [room.kind for room in rooms if room.id in ids]
    outer = len(ids) == 1
    if not ids or (hole.kind == "passage" and outer):
        return None
    if hole.kind == "window" and not outer and "balcony" not in kinds:
        return None
    margin_m = _HALF_WALL_M + (0.0 if hole.kind == "passage" else _JAMB_M)
    room_m = (stretch.high_px - stretch.low_px) * frame.m_per_px - 2 * margin_m
    wanted_m = (hole.high_px - hole.low_px) * frame.m_per_px
    length_m = max(round(wanted_m / _STEP_M) * _STEP_M, _LEAST_LENGTH_M[hole.kind])
    length_m = min(length_m, room_m)
    if length_m < _LEAST_SEEN_M:
        return None
    half_px = (length_m / 2 + margin_m) / frame.m_per_px
    middle_px = (hole.low_px + hole.high_px) / 2
    middle_px = min(max(middle_px, stretch.low_px + half_px), stretch.high_px - half_px)
    spot = (stretch.across_px, middle_px) if stretch.upright else (middle_px, stretch.across_px)
    x_m, y_m = m_from_px(np.array(spot), frame)
    base_m, height_m = BASE_AND_HEIGHT_M[hole.kind]
    placed = Box(
        (float(x_m), float(y_m), base_m),
        (length_m, WALL_THICKNESS_M, height_m),
        90.0 if stretch.upright else 0.0,
    )
    return Opening("", hole.kind, placed, ids)


def _missing(
    stretches: Sequence[_Stretch],
    openings: Sequence[Opening],
    frame: PixelFrame,
    rooms: list[Room],
    numbers: dict[int, str],
) -> Iterator[Opening]:
    """Doors that lead to rooms which nothing leads to."""
    margin_px = (_HALF_WALL_M + _JAMB_M) / frame.m_per_px
    borders = []
    for index, stretch in enumerate(stretches):
        ids = tuple(numbers[room] for room in stretch.rooms if room in numbers)
        free_px = stretch.high_px - stretch.low_px - 2 * margin_px
        taken = tuple(_taken(stretch, margin_px, openings, frame))
        borders.append(Border(ids, index, free_px * frame.m_per_px, taken))
    for door in missing_doors({room.id: room.kind for room in rooms}, openings, borders):
        stretch = stretches[door.border.index]
        first_px = stretch.low_px + margin_px
        low, high = (
            first_px + (door.middle_m + side * door.width_m / 2) / frame.m_per_px
            for side in (-1, 1)
        )
        opening = _opening(_Hole("door", stretch, low, high), frame, rooms, numbers)
        if opening is not None:
            yield opening


def _taken(
    stretch: _Stretch, margin_px: float, openings: Sequence[Opening], frame: PixelFrame
) -> Iterator[tuple[float, float]]:
    """From where to where openings lie in a stretch, with a jamb's width of wall between."""
    for opening in openings:
        x, y = px_from_m(np.array(opening.box.center_m[:2]), frame)
        across, along = (x, y) if stretch.upright else (y, x)
        half_m = opening.box.size_m[0] / 2 + _JAMB_M
        if abs(across - stretch.across_px) * frame.m_per_px < _HALF_WALL_M:
            middle_m = (along - stretch.low_px - margin_px) * frame.m_per_px
            yield float(middle_m - half_m), float(middle_m + half_m)


def _rejoined(openings: tuple[Opening, ...], rooms: list[Room]) -> Iterator[Opening]:
    """A shell's openings with the rooms that are beside them now."""
    for opening in openings:
        ids = rooms_beside(opening.box, rooms)
        yield Opening(opening.id, opening.kind, opening.box, ids[:1], opening.extra)


def _named(openings: list[Opening]) -> Iterator[Opening]:
    """Openings with ids that count them by kind."""
    counts: Counter[str] = Counter()
    for opening in openings:
        counts[opening.kind] += 1
        name = f"{opening.kind}{counts[opening.kind]}"
        yield Opening(name, opening.kind, opening.box, opening.room_ids, opening.extra)
