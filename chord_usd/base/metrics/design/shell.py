"""Oriented rectangles, and a room without its pieces: walls, openings, what they keep free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.metrics.clear_floor import (
    BORDER_M,
    MAX_CLEARANCE_M,
    WINDOW_CLEARANCE_M,
    open_borders,
    sides_of,
    solid_sides,
)
from chord_usd.base.metrics.design.floor_ways import WIDEST, Cells, Floor, Goal
from chord_usd.base.metrics.rooms import mixed_kind
from chord_usd.base.scene.geometry import room_polygon, room_sides
from chord_usd.base.scene.types import (
    BoolArray,
    Box,
    ByteArray,
    FloatArray,
    Opening,
    OpeningKind,
    Room,
    RoomKind,
)

TOUCH_M = 0.01
"""A piece that reaches so little into a strip leaves it free."""
APART_M = 0.001
"""New pieces reach no deeper into others: more is an overlap (metrics.overlap)."""
CELL_M, _MARGIN_M = 0.05, 0.3
"""Of rasters of a room's floor."""
_OBLIQUE = 1e-9
"""Share of a side along the other axis from which it is oblique."""
_BEHIND_M = 0.3
"""A walker who stands so near to a way has passed it."""
_REACH_M = 0.1
"""An open border or passage is in a wall no farther from it."""


@dataclass(frozen=True, eq=False)
class Rects:
    """Oriented rectangles."""

    at: FloatArray
    """(N, 2) middles."""
    right: FloatArray
    front: FloatArray
    """(N, 2) unit vectors of their axes."""
    half: FloatArray
    """(N, 2) half their extents along these."""

    @classmethod
    def of_boxes(cls, boxes: Sequence[Box]) -> Rects:
        """Their footprints."""
        at = np.array([box.center_m[:2] for box in boxes]).reshape(-1, 2)
        half = np.array([box.size_m[:2] for box in boxes]).reshape(-1, 2) / 2
        turn = np.radians([box.yaw_deg for box in boxes])
        right = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        front = np.stack([np.sin(turn), -np.cos(turn)], axis=-1)
        return cls(at, right, front, half)

    @cached_property
    def corners(self) -> FloatArray:
        """(N, 4, 2)."""
        across = self.right * self.half[:, :1]
        along = self.front * self.half[:, 1:]
        steps = [-across - along, -across + along, across + along, across - along]
        corners: FloatArray = self.at[:, None] + np.stack(steps, axis=1)
        return corners

    @cached_property
    def bounds(self) -> tuple[FloatArray, FloatArray] | None:
        """(N, 2) lowest and (N, 2) highest coordinates; None where sides are oblique."""
        along = np.abs(self.right)
        if len(along) and along.min(axis=1).max() > _OBLIQUE:
            return None
        half = np.where(along[:, :1] > 0.5, self.half, self.half[:, ::-1])
        return self.at - half, self.at + half

    def depths(self, others: Rects) -> FloatArray:
        """(N, M) how deep each reaches into each of others along the axes of both: the least move
        that parts them; 0 where they are apart."""
        if self.bounds and others.bounds:  # in most rooms, and ten times as fast
            (low, high), (other_low, other_high) = self.bounds, others.bounds
            reach = np.minimum(high[:, None] - other_low, other_high - low[:, None])
            deep = np.minimum(reach[..., 0], reach[..., 1])
        else:
            deep = np.minimum(self._into(others), others._into(self).T)
        depths: FloatArray = np.maximum(deep, 0.0)
        return depths

    def of(self, numbers: npt.NDArray[np.intp] | BoolArray) -> Rects:
        """Those of these numbers, or of a mask."""
        return Rects(*(values[numbers] for values in (self.at, self.right, self.front, self.half)))

    def depths_each(self, others: Rects) -> FloatArray:
        """(N,) how deep each reaches into the other of its number, as depths has it."""
        deep = np.full(len(self.at), np.inf)
        for first, second in ((self, others), (others, self)):
            ahead = second.corners - first.at[:, None]
            for axis, half in ((first.right, first.half[:, 0]), (first.front, first.half[:, 1])):
                along = (ahead * axis[:, None]).sum(axis=2)
                reach = half + np.minimum(-along.min(axis=1), along.max(axis=1))
                deep = np.minimum(deep, reach)
        depths: FloatArray = np.maximum(deep, 0.0)
        return depths

    def crossed_by(self, lines: FloatArray) -> BoolArray:
        """(N,) whether any of these lines (L, 2, 2) reaches farther into each than a touch."""
        enter, leave = np.zeros((len(self.at), len(lines))), np.ones((len(self.at), len(lines)))
        for axis, half in ((self.right, self.half[:, :1]), (self.front, self.half[:, 1:])):
            along = lines @ axis.T - (self.at * axis).sum(axis=1)
            first, last = along[:, 0].T, along[:, 1].T
            run = np.where(last == first, 1e-9, last - first)
            reach = np.maximum(half - TOUCH_M, 0.0)
            cuts = (-reach - first) / run, (reach - first) / run
            enter = np.maximum(enter, np.minimum(*cuts))
            leave = np.minimum(leave, np.maximum(*cuts))
        crossed: BoolArray = (enter < leave).any(axis=1)
        return crossed

    def _into(self, others: Rects) -> FloatArray:
        """(N, M) how far the corners of others reach into each along its axes."""
        x = others.corners[..., 0] - self.at[:, 0, None, None]
        y = others.corners[..., 1] - self.at[:, 1, None, None]
        deep = []
        for axis, half in ((self.right, self.half[:, :1]), (self.front, self.half[:, 1:])):
            along = x * axis[:, 0, None, None] + y * axis[:, 1, None, None]
            low = along[..., 0]
            high = low
            for corner in (1, 2, 3):  # faster than reductions over an axis of four
                low = np.minimum(low, along[..., corner])
                high = np.maximum(high, along[..., corner])
            deep.append(half + np.minimum(-low, high))
        return np.minimum(*deep)


@dataclass(frozen=True, eq=False)
class Hole:
    """An opening as one room has it."""

    id: str
    kind: OpeningKind
    ends: FloatArray
    """(2, 2) ends of its middle line."""
    inward: FloatArray
    """(2,) unit vector into the room."""
    depth_m: float
    sill_m: float
    height_m: float

    @property
    def middle(self) -> FloatArray:
        """(2,)."""
        middle: FloatArray = self.ends.mean(axis=0)
        return middle

    @property
    def length_m(self) -> float:
        """Along its wall."""
        return float(np.hypot(*(self.ends[1] - self.ends[0])))

    @property
    def is_way(self) -> bool:
        """Whether people go through it."""
        return self.kind != "window"

    @cached_property
    def clear(self) -> Rects:
        """The floor before it that stays free."""
        along = (self.ends[1] - self.ends[0]) / max(self.length_m, 1e-6)
        deep = WINDOW_CLEARANCE_M if not self.is_way else min(self.length_m, MAX_CLEARANCE_M)
        middle = self.middle + self.inward * (self.depth_m + deep) / 2
        half = np.array([[self.length_m / 2, deep / 2]])
        return Rects(middle[None], along[None], self.inward[None], half)


@dataclass(frozen=True, eq=False)
class Ground:
    """The floor of a room as a raster."""

    low: FloatArray
    """(2,) where its first cell is."""
    floor: ByteArray
    """(H, W) 1 in the room."""
    outline: npt.NDArray[np.int32]
    """(N, 2) columns and rows of its corners."""
    ways: tuple[Cells, ...]
    """The cells behind each way into the room."""
    goals: tuple[Goal, ...]
    """More of them, for walkers of any width."""

    @classmethod
    def of(cls, polygon_m: FloatArray, ways: Sequence[Hole]) -> Ground:
        """Of a room with these ways."""
        low = polygon_m.min(axis=0) - _MARGIN_M
        width, height = np.ceil((np.ptp(polygon_m, axis=0) + 2 * _MARGIN_M) / CELL_M).astype(int)
        outline = np.rint((polygon_m - low) / CELL_M).astype(np.int32)
        ground = cls(low, np.zeros((height, width), np.uint8), outline, (), ())
        cv2.fillPoly(ground.floor, [outline], (1,))
        behind = tuple(ground._behind(hole, _BEHIND_M) for hole in ways)
        goals = []
        for hole in ways:
            rows, columns = ground._behind(hole, WIDEST * CELL_M)
            at = low + CELL_M * np.stack([columns, rows], axis=-1)
            goals.append(((rows, columns), (at - hole.middle) @ hole.inward / CELL_M
                          - hole.depth_m / 2 / CELL_M))  # fmt: skip
        return cls(low, ground.floor, outline, behind, tuple(goals))

    def _behind(self, hole: Hole, deep_m: float) -> Cells:
        """The cells so far behind a way into the room."""
        strip = np.zeros_like(self.floor)
        near = hole.inward * hole.depth_m / 2
        far = hole.inward * (hole.depth_m / 2 + deep_m)
        ends = np.concatenate([hole.ends + near, hole.ends[::-1] + far])
        cv2.fillPoly(strip, [self.cells(ends)], (1,))
        rows, columns = np.nonzero(strip)
        return rows, columns

    @cached_property
    def within(self) -> ByteArray:
        """(H, W) the same without the cells at the walls: with pieces, cells at edges are taken."""
        floor = self.floor.copy()
        cv2.polylines(floor, [self.outline], True, (0,))
        return floor

    @cached_property
    def way_m(self) -> float:
        """Width of the widest way that joins all ways into the empty room."""
        return Floor(self.within, self.goals).widest()[0] * CELL_M

    def between(self, floor: ByteArray, outlines_m: FloatArray) -> ByteArray:
        """(H, W) a floor without the cells of these outlines (N, 4, 2)."""
        left = floor.copy()
        for outline in outlines_m:
            cv2.fillPoly(left, [self.cells(outline)], (0,))
        return left

    def cells(self, points_m: FloatArray) -> npt.NDArray[np.int32]:
        """(N, 2) columns and rows of points."""
        return np.rint((points_m - self.low) / CELL_M).astype(np.int32)


@dataclass(frozen=True, eq=False)
class Shell:
    """A room without its pieces, and what rules ask about the house around it."""

    room: Room
    area_m2: float
    walls: FloatArray
    """(W, 2, 2) what is solid of its sides: passages and open borders are left out."""
    holes: tuple[Hole, ...]
    sides: FloatArray
    """(S, 2, 2) of its polygon."""
    is_largest: bool
    """Of the rooms of its kind."""
    is_lived_in: bool
    """Whether it is a living room, or the largest bedroom of a home without any."""
    joins_kitchen: bool
    """Whether an opening or an open border joins it to a kitchen, or it is one."""
    borders: tuple[Hole, ...] = ()
    """Open borders, by which one goes into rooms beside it."""

    @property
    def kind(self) -> RoomKind:
        """Of the room."""
        return self.room.kind

    @cached_property
    def clear(self) -> Rects:
        """(K,) floors that its openings keep free; borders of an open plan keep none."""
        floors = [hole.clear for hole in self._keeping]
        empty = np.zeros((0, 2))
        arrays = ([getattr(floor, name) for floor in floors] for name in
                  ("at", "right", "front", "half"))  # fmt: skip
        return Rects(*(np.concatenate(parts) if parts else empty for parts in arrays))

    @cached_property
    def middle(self) -> tuple[float, float]:
        """A point of its floor, near the middle."""
        point = room_polygon(self.room).representative_point()
        return float(point.x), float(point.y)

    @cached_property
    def ground(self) -> Ground:
        """Its floor as a raster."""
        return Ground.of(self.room.polygon_m, self.entries)

    @cached_property
    def clear_from_m(self) -> FloatArray:
        """(K,) height above which each of these stays free."""
        return np.array([hole.sill_m for hole in self._keeping])

    @cached_property
    def below_glass(self) -> Rects:
        """(K,) the floors that windows keep free."""
        return self.clear.of(np.array([not hole.is_way for hole in self._keeping], np.bool_))

    @property
    def _keeping(self) -> list[Hole]:
        return [hole for hole in self.holes if not (hole.is_way and hole.depth_m < BORDER_M)]

    @property
    def ways(self) -> list[Hole]:
        """Doors and passages."""
        return [hole for hole in self.holes if hole.is_way]

    @property
    def entries(self) -> list[Hole]:
        """Doors, passages and open borders: all that people come in by."""
        return [*self.ways, *self.borders]

    @property
    def windows(self) -> list[Hole]:
        """Windows."""
        return [hole for hole in self.holes if not hole.is_way]


@lru_cache(maxsize=16)  # drafts of a house ask for the same plan again and again
def shells(rooms: tuple[Room, ...], openings: tuple[Opening, ...]) -> dict[str, Shell]:
    """Every room of a plan by its id."""
    holes: dict[str, list[Hole]] = {room.id: [] for room in rooms}
    for opening, room in sides_of(openings, rooms):
        holes[room.id].append(_hole(opening, room))
    borders: dict[str, list[Opening]] = {room.id: [] for room in rooms}
    joined: dict[str, set[str]] = {room.id: set() for room in rooms}
    kinds = {room.id: room.kind for room in rooms}
    for border in open_borders(rooms, openings):
        for room_id in border.room_ids:
            borders[room_id].append(border)
    for way in (*openings, *open_borders(rooms, openings)):
        for room_id in way.room_ids:
            if room_id in joined and way.kind != "window":
                joined[room_id] |= {kinds[other] for other in way.room_ids if other in kinds}
    areas = {room.id: float(room_polygon(room).area) for room in rooms}
    largest = {
        room.id for room in rooms
        if areas[room.id] >= max(areas[same.id] for same in rooms if same.kind == room.kind)
    }  # fmt: skip
    lived_in = "bedroom" if mixed_kind([room.kind for room in rooms]) == "bedroom" else "living"
    return {
        room.id: Shell(
            room,
            areas[room.id],
            solid_sides(room, (*(opening for opening in openings if opening.kind == "passage"),
                               *borders[room.id])),
            tuple(holes[room.id]),
            np.array(room_sides(room)),
            room.id in largest,
            room.kind == lived_in and (room.kind == "living" or room.id in largest),
            room.kind == "kitchen" or "kitchen" in joined[room.id],
            tuple(_hole(border, room) for border in borders[room.id]),
        )
        for room in rooms
    }  # fmt: skip


def _hole(opening: Opening, room: Room) -> Hole:
    turn = np.radians(opening.box.yaw_deg)
    along = np.array([np.cos(turn), np.sin(turn)])
    across = np.array([-along[1], along[0]])
    middle = np.array(opening.box.center_m[:2])
    half, depth = opening.box.size_m[0] / 2, opening.box.size_m[1]
    probe = middle + across * (depth / 2 + _REACH_M)
    inward = across if inside(probe[None], room.polygon_m)[0] else -across
    ends = np.array([middle - along * half, middle + along * half])
    low, height = opening.box.center_m[2], opening.box.size_m[2]
    return Hole(opening.id, opening.kind, ends, inward, depth, low, height)


def inside(points: FloatArray, polygon: FloatArray) -> BoolArray:
    """(N,) which points (N, 2) lie in a polygon (M, 2)."""
    start, end = polygon, np.roll(polygon, -1, axis=0)
    x, y = points[:, :1], points[:, 1:]
    spans = (start[:, 1] > y) != (end[:, 1] > y)
    rise = np.where(end[:, 1] == start[:, 1], 1.0, end[:, 1] - start[:, 1])
    at = start[:, 0] + (y - start[:, 1]) / rise * (end[:, 0] - start[:, 0])
    crossed: BoolArray = (spans & (x < at)).sum(axis=1) % 2 == 1
    return crossed
