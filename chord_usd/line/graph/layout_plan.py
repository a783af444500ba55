"""The plan in a layout raster: rooms, doors, windows and passages under and between the items.

For rasters that come alone. Where the plan is known as vectors, those are used instead.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon

from chord_usd.base.errors import SceneError
from chord_usd.base.raster.vectorize import RotatedBox, polygon_from_mask, rotated_box_from_mask
from chord_usd.base.raster.windows import components, label_windows
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.palette import PLAN_CATEGORIES
from chord_usd.base.scene.types import (
    BASE_AND_HEIGHT_M,
    WALL_THICKNESS_M,
    BoolArray,
    Box,
    FloatArray,
    Opening,
    OpeningKind,
    PixelFrame,
    Plan,
    Room,
    frozen_array,
)
from chord_usd.base.scene.units import m_from_px
from chord_usd.line.graph.colours import CLEAR, SHADE_KINDS, LabelArray, LayoutPixels

IntArray = npt.NDArray[np.int32]

_LEAST_ROOM_M2 = 0.5
_LEAST_OPENING_M = 0.3
_STRAIGHT = 0.7
"""A straight bar fills so much of its rotated box; one round a corner does not."""
_WHITE = SHADE_KINDS.index("unknown")
_CLASSES = {row.name: row.detector_class for row in PLAN_CATEGORIES}


def read_plan(pixels: LayoutPixels, frame: PixelFrame) -> Plan:
    """Rooms and openings. Raises SceneError when no enclosed floor is found.

    Walls, doors and windows part rooms, and so do their shades where they touch; kinds come from
    the shades (name_rooms names white ones).
    """
    passages = _passages(pixels, frame)
    labels = _label_rooms(pixels, passages, frame)
    rooms = _rooms(labels, pixels, frame)
    if not rooms:
        raise SceneError(
            "no closed room was found in the layout",
            expected="floors enclosed by black walls",
            try_="<plan draw>",
        )
    bars: list[tuple[OpeningKind, RotatedBox]] = []
    kinds: tuple[OpeningKind, ...] = ("door", "window")
    for kind in kinds:
        for part in _parts(pixels.structure == _CLASSES[kind]):
            bars += [(kind, arm) for arm in _arms(part, WALL_THICKNESS_M / frame.m_per_px)]
    bars += [("passage", part.box()) for part in passages]
    openings = _openings(bars, rooms, frame)
    return Plan(tuple(rooms), tuple(openings))


def _passages(pixels: LayoutPixels, frame: PixelFrame) -> list[_Part]:
    """White bars as thin as a wall between shaded rooms."""
    white = (pixels.structure == CLEAR) & (pixels.shade == _WHITE)
    thickness_px = WALL_THICKNESS_M / frame.m_per_px
    parts = []
    for part in _parts(white):
        if part.touches_border:
            continue
        box = part.box()
        straight = part.size > _STRAIGHT * box.length_px * box.width_px
        if straight and abs(box.width_px - thickness_px) <= 1.5 and box.length_px > box.width_px:
            parts.append(part)
    return parts


def _label_rooms(pixels: LayoutPixels, passages: Sequence[_Part], frame: PixelFrame) -> IntArray:
    """(H, W) number of each room, 0 elsewhere; slivers join the room beside them."""
    floor = pixels.structure == CLEAR
    for passage in passages:
        floor[passage.window] &= ~passage.mask
    labels = np.zeros(floor.shape, dtype=np.int32)
    slivers = np.zeros(floor.shape, dtype=bool)
    least_px = _LEAST_ROOM_M2 / frame.m_per_px**2
    count = 0
    for shade in np.unique(pixels.shade[floor]):
        for part in _parts(floor & (pixels.shade == shade)):
            if shade == _WHITE and part.touches_border:
                continue
            if part.size < least_px:
                slivers[part.window] |= part.mask
                continue
            count += 1
            labels[part.window][part.mask] = count
    return _filled(labels, slivers)


def _filled(labels: IntArray, slivers: BoolArray) -> IntArray:
    """Slivers, one pixel rim after the other, take the number of a room that they touch."""
    labels = labels.copy()
    kernel = np.ones((3, 3), dtype=np.uint8)
    while slivers.any():
        grown = cv2.dilate(labels.astype(np.float32), kernel).astype(np.int32)
        reached = slivers & (grown > 0)
        if not reached.any():
            break
        labels[reached] = grown[reached]
        slivers = slivers & ~reached
    return labels


def _rooms(labels: IntArray, pixels: LayoutPixels, frame: PixelFrame) -> list[Room]:
    """Rooms from top to bottom, left to right."""
    outlines = []
    thickness_px = WALL_THICKNESS_M / frame.m_per_px
    for index, window in enumerate(label_windows(labels)):
        assert window is not None, "labels are 1 to their largest"
        mask = labels[window] == index + 1
        kind = SHADE_KINDS[int(np.bincount(pixels.shade[window][mask]).argmax())]
        outline = outline_of(mask) + np.array([window[1].start, window[0].start])
        outlines.append((kind, settle_faces(outline, pixels.structure, thickness_px)))
    outlines.sort(key=lambda outline: tuple(outline[1].min(axis=0)[::-1]))
    counts: dict[str, int] = {}
    rooms = []
    for kind, polygon_px in outlines:
        name = "room" if kind == "unknown" else kind
        counts[name] = counts.get(name, 0) + 1
        polygon_m = frozen_array(m_from_px(polygon_px, frame))
        rooms.append(Room(f"{name}{counts[name]}", kind, polygon_m))
    return rooms


def _openings(
    bars: Sequence[tuple[OpeningKind, RotatedBox]], rooms: Sequence[Room], frame: PixelFrame
) -> Iterator[Opening]:
    counts: dict[str, int] = {}
    walls = Walls(rooms)
    for kind, box in bars:
        length_m = box.length_px * frame.m_per_px
        if length_m < _LEAST_OPENING_M:
            continue
        base_m, height_m = BASE_AND_HEIGHT_M[kind]
        # Canvas angles run clockwise, yaw counter-clockwise.
        yaw_deg = -box.angle_deg % 180.0
        center, along_deg, joined = walls.place(m_from_px(np.array(box.center_px), frame), yaw_deg)
        counts[kind] = counts.get(kind, 0) + 1
        yield Opening(
            f"{kind}{counts[kind]}",
            kind,
            Box((*center, base_m), (length_m, WALL_THICKNESS_M, height_m), along_deg),
            joined,
        )


def _arms(part: _Part, thickness_px: float) -> list[RotatedBox]:
    """The bar; or its two arms where it runs round a corner, as corner windows do."""
    box = part.box()
    if part.size > _STRAIGHT * box.length_px * box.width_px:
        return [box]
    reach = round(1.5 * thickness_px) + 1
    row = np.ones((1, reach), dtype=np.uint8)
    flat = cv2.morphologyEx(part.mask.astype(np.uint8), cv2.MORPH_OPEN, row) > 0
    rest = part.mask & ~flat
    if not flat.any() or not rest.any():
        return [box]
    return [replace(part, mask=flat).box(), replace(part, mask=rest).box()]


@dataclass(frozen=True, eq=False)
class _Part:
    """A 4-connected region and the window of the canvas that it fills."""

    mask: BoolArray
    window: tuple[slice, slice]
    touches_border: bool

    @property
    def size(self) -> int:
        """Pixels."""
        return int(self.mask.sum())

    def box(self) -> RotatedBox:
        """The rectangle it shows, on the canvas."""
        box = rotated_box_from_mask(self.mask)
        rows, columns = self.window
        x, y = box.center_px
        return replace(box, center_px=(x + columns.start, y + rows.start))


def _parts(mask: BoolArray) -> Iterator[_Part]:
    """4-connected parts of a mask, in the order of their first pixels."""
    labels, windows = components(mask)
    height, width = mask.shape
    for index, window in enumerate(windows):
        rows, columns = window
        outside = rows.start == 0 or columns.start == 0
        outside = outside or rows.stop == height or columns.stop == width
        yield _Part(labels[window] == index + 1, window, outside)


# Inner faces of walls to less than half a pixel, from how thick the walls came out ---------------

# A face lies up to half a pixel beside the drawn edge. The wall's other face does, too, and the two
# are exactly WALL_THICKNESS_M apart: where 3.4 pixels came out as 3, both faces were rounded into
# the wall, by 0.2 pixels each on average; where they came out as 4, out of it, by 0.3.

_END_PX = 2.0
"""Ends of a side that are not looked behind: other walls begin there."""
_AXIS_PX = 1e-6
_LEAST_TURN = 0.2
"""Sine of the least angle at which two sides meet in a point to speak of."""


def settle_faces(polygon_px: FloatArray, structure: LabelArray, thickness_px: float) -> FloatArray:
    """The outline of a room with its upright and level sides moved to where the faces must be.

    polygon_px: (N, 2) canvas pixels, counter-clockwise in the world. structure: (H, W) labels.
    Sides without wall all along, slanted ones and walls of another thickness stay where they are.
    """
    following = np.roll(polygon_px, -1, axis=0)
    along = following - polygon_px
    lengths = np.hypot(along[:, 0], along[:, 1])
    along = along / np.maximum(lengths, 1e-9)[:, None]
    # Counter-clockwise: outside lies to the right of a side, which is (-y, x) where y points down.
    outward = np.stack([-along[:, 1], along[:, 0]], axis=1)
    moves = np.array(
        [
            _move_px(start, stop, out, structure, thickness_px) if length > 2 * _END_PX else 0.0
            for start, stop, out, length in zip(
                polygon_px, following, outward, lengths, strict=True
            )
        ]
    )
    if not moves.any():
        return polygon_px
    moved = _corners(polygon_px + outward * moves[:, None], along, polygon_px)
    return moved if Polygon(moved).is_valid else polygon_px


def _move_px(
    start: FloatArray,
    stop: FloatArray,
    outward: FloatArray,
    structure: LabelArray,
    thickness_px: float,
) -> float:
    """How far outwards the face behind this side is to be looked for."""
    if np.abs(stop - start).min() > _AXIS_PX:
        return 0.0
    length = float(np.hypot(*(stop - start)))
    steps = np.arange(_END_PX + 0.5, length - _END_PX)
    if not len(steps):
        return 0.0
    deep = np.arange(math.ceil(thickness_px) + 2) + 0.5
    points = start + (stop - start) / length * steps[:, None]
    across = points[:, None, :] + outward * deep[None, :, None]
    rows, columns = np.floor(across[..., 1]).astype(int), np.floor(across[..., 0]).astype(int)
    height, width = structure.shape
    if rows.min() < 0 or columns.min() < 0 or rows.max() >= height or columns.max() >= width:
        return 0.0
    solid = structure[rows, columns] != CLEAR
    counts = np.cumprod(solid, axis=1).sum(axis=1)
    if (counts == 0).any():
        # Somewhere the floor goes on: that side is shared with another room, which must not move.
        return 0.0
    fitting = counts[np.abs(counts - thickness_px) < 1.0]
    if 2 * len(fitting) < len(counts):
        return 0.0
    return float(np.median(fitting) - thickness_px) / 2


def _corners(through: FloatArray, along: FloatArray, before: FloatArray) -> FloatArray:
    """(N, 2) where each side, given by a point and a direction, meets the one before it."""
    corners = np.empty_like(through)
    for index in range(len(through)):
        point, direction = through[index], along[index]
        other, turned = through[index - 1], along[index - 1]
        sine = direction[0] * turned[1] - direction[1] * turned[0]
        if abs(sine) < _LEAST_TURN:
            corners[index] = before[index]
            continue
        gap = other - point
        share = (gap[0] * turned[1] - gap[1] * turned[0]) / sine
        corners[index] = point + share * direction
    return corners


# Outlines of upright rooms, straight from the corners of their pixels ----------------------------

# vectorize fits lines to any outline; most rooms have none but upright and level sides, and need it
# not.

_LEAST_SIDE_PX = 3
"""Shorter sides may be the steps of a slanted one."""


def outline_of(mask: BoolArray) -> FloatArray:
    """(N, 2) outline of a 4-connected region of a window, continuous pixels, counter-clockwise in
    the world. Holes are passed over. Raises ValueError for an empty mask."""
    upright = _upright_outline(mask)
    return polygon_from_mask(mask) if upright is None else upright


def _upright_outline(mask: BoolArray) -> FloatArray | None:
    """The outline if it has only upright and level sides, none of them short."""
    whole = np.pad(mask, 1).astype(np.int8)
    # Around each grid point the four pixels; a corner has one or three of the region.
    around = whole[:-1, :-1] + whole[1:, :-1] + whole[:-1, 1:] + whole[1:, 1:]
    crossed = (around == 2) & (whole[:-1, :-1] == whole[1:, 1:])
    if crossed.any():
        return None
    rows, columns = np.nonzero(around % 2)
    corners = np.stack([columns, rows], axis=1)
    across, along = _partners(corners, 0), _partners(corners, 1)
    order: list[int] = []
    at = 0
    # The first corner in reading order is one of the outer outline.
    while not order or at != 0:
        order += [at, int(across[at])]
        at = int(along[across[at]])
    outline = corners[order].astype(np.float64)
    sides = np.abs(np.roll(outline, -1, axis=0) - outline).sum(axis=1)
    if sides.min(initial=0.0 if not len(sides) else np.inf) < _LEAST_SIDE_PX:
        return None
    return outline if _area(outline) < 0.0 else outline[::-1]


def _partners(corners: np.ndarray, axis: int) -> np.ndarray:
    """(N,) the corner that each corner shares a side along this axis with.

    Sides of a region alternate with gaps: along a line, corners pair off from one end.
    """
    order = np.lexsort((corners[:, axis], corners[:, 1 - axis]))
    partners = np.empty(len(corners), dtype=np.intp)
    partners[order[::2]], partners[order[1::2]] = order[1::2], order[::2]
    return partners


def _area(outline: FloatArray) -> float:
    """Signed; below zero where the outline is counter-clockwise in the world (y points down)."""
    x, y = outline.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


# The walls between rooms, and the openings in them -----------------------------------------------

_PARALLEL_DEG = 15.0
_NEAR_M = 1.2 * WALL_THICKNESS_M
_BEHIND_M = 0.1
"""A room this near to a point behind the wall is the one behind it."""


class Walls:
    """The sides of all rooms, as arrays. Metres."""

    def __init__(self, rooms: Sequence[Room]) -> None:
        self.rooms = rooms
        outlines = [room.polygon_m for room in rooms]
        self._start = np.concatenate(outlines)
        self._side = np.concatenate([np.roll(o, -1, axis=0) for o in outlines]) - self._start
        self._room = np.repeat(np.arange(len(rooms)), [len(o) for o in outlines])
        self._along_deg = np.degrees(np.arctan2(self._side[:, 1], self._side[:, 0])) % 180.0
        self._square = np.maximum((self._side**2).sum(axis=1), 1e-12)
        self._floors = np.array([room_polygon(room) for room in rooms])

    def place(
        self, center_m: FloatArray, yaw_deg: float
    ) -> tuple[tuple[float, float], float, tuple[str, ...]]:
        """A bar's centre moved to the middle of its wall, the wall's direction, the rooms it joins.

        center_m: (2,). A bar near no wall stays where it is and joins none.
        """
        apart = np.abs((self._along_deg - yaw_deg + 90.0) % 180.0 - 90.0)
        distance = self._distance(center_m)
        near = np.flatnonzero((apart < _PARALLEL_DEG) & (distance < _NEAR_M))
        if not len(near):
            return (float(center_m[0]), float(center_m[1])), yaw_deg, ()
        near = near[np.argsort(distance[near], kind="stable")]
        nearest = near[0]
        x, y = self._side[nearest] / np.sqrt(self._square[nearest])
        outward = np.array([y, -x])
        # From the wall's inner face, half its thickness out of the room.
        depth = float((center_m - self._start[nearest]) @ outward)
        center_m = center_m + (WALL_THICKNESS_M / 2 - depth) * outward
        owner = self._room[nearest]
        behind = self._is_behind(center_m + outward * 0.75 * WALL_THICKNESS_M)
        order = dict.fromkeys(int(room) for room in self._room[near])
        joined = [self.rooms[room].id for room in order if room == owner or behind[room]]
        middle = float(center_m[0]), float(center_m[1])
        return middle, float(self._along_deg[nearest]), tuple(joined[:2])

    def _distance(self, point_m: FloatArray) -> FloatArray:
        """(S,) distance of a point from every side."""
        offset = point_m - self._start
        share = np.clip((offset * self._side).sum(axis=1) / self._square, 0.0, 1.0)
        gap = offset - share[:, None] * self._side
        distance: FloatArray = np.hypot(gap[:, 0], gap[:, 1])
        return distance

    def _is_behind(self, probe_m: FloatArray) -> BoolArray:
        """(R,) which rooms are at a point behind the wall."""
        near: BoolArray = shapely.distance(self._floors, shapely.Point(probe_m)) < _BEHIND_M
        return near
