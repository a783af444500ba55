"""The floor of one room while it is being furnished: its walls, what stands on it, what is kept."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import WET_KINDS, Box, Room, RoomKind
from chord_usd.base.scene.units import wrap_deg
from chord_usd.workshop.data.furnish.free_spans import (
    MARGIN_M,
    NO_SILL_M,
    REACH,
    SOLID,
    ZONE,
    Thing,
    Wall,
)
from chord_usd.workshop.data.furnish.mix import HOMES, Mix

Size = tuple[float, float, float]
"""Length, width (depth), height in metres."""

Bounds = tuple[float, float, float, float]
"""x and y from, x and y to, metres."""


class Placed(NamedTuple):
    """One piece on the floor. The front points along (uy, -ux), u being its length direction."""

    category: str
    x: float
    y: float
    z: float
    size: Size
    yaw_deg: float
    ux: float
    uy: float
    group: int
    """Pieces of one group go together: a desk and its chair."""
    core: bool
    """A room without it would not be that room; never given up for a wider path."""


class Spot(NamedTuple):
    """A free span along a wall."""

    wall: Wall
    s_from: float
    s_to: float

    @property
    def length(self) -> float:
        """Metres."""
        return self.s_to - self.s_from


class Door(NamedTuple):
    """A door or passage, seen from the room."""

    wall: Wall
    s_from: float
    s_to: float
    is_entrance: bool
    beyond: Floor | None
    """The room on the other side."""


class Floor:
    """The state of one room. Mutable; lives only while `furnish` runs."""

    def __init__(self, room: Room, kind: RoomKind, dice: random.Random, mix: Mix = HOMES) -> None:
        self.room = room
        self.mix = mix
        self.kind: RoomKind = kind
        self.dice = dice
        self.corners = straight_corners(room.polygon_m.tolist())
        self.area_m2 = _area_m2(self.corners)
        xs, ys = zip(*self.corners, strict=True) if self.corners else ((0.0,), (0.0,))
        self.bounds_m: Bounds = (min(xs), min(ys), max(xs), max(ys))
        self._things: list[Thing] = []
        self.walls = [
            Wall(i, corner, self.corners[(i + 1) % len(self.corners)], self._things)
            for i, corner in enumerate(self.corners)
        ]
        for wall in self.walls:
            wall.see_edges(self.corners)
        self.doors: list[Door] = []
        self._door_points: list[tuple[float, float]] = []
        self.touching: list[Floor] = []
        self.windows: list[tuple[Wall, float, float, float]] = []
        self.hints: list[tuple[str, float, float]] = []
        """Fixtures the drawing shows here: category and middle."""
        self.is_studio = False
        """Whether people sleep in this living room."""
        self.placed: list[Placed] = []
        self.walked = -1
        """How many pieces stood here when the paths were last found free; -1 where not known."""
        self.squeezed = 0
        """How narrow paths may be; see squeeze."""
        self.cells: Any = None
        """What chord_usd.workshop.data.furnish.walkways knows about the empty room."""
        self._group = 0

    def part(self) -> None:
        """Let go of the neighbours: rooms that point at each other wait for the garbage collector,
        which takes a third of the time in a stream of houses.
        """
        self.touching.clear()
        self.doors.clear()

    def squeeze(self, squeezed: int) -> None:
        """1: narrow paths have to do, and pieces may touch that do not belong together; 2: paths
        that one person just passes.
        """
        self.squeezed, self.walked = squeezed, -1
        is_fitted = self.kind in (*WET_KINDS, "kitchen")  # what stands there touches
        margin_m = 0.0 if squeezed or is_fitted else MARGIN_M
        for wall in self.walls:
            wall.margin_m = margin_m

    @property
    def covered(self) -> float:
        """Share of the floor that pieces cover."""
        return sum(piece.size[0] * piece.size[1] for piece in self.placed) / self.area_m2

    def new_group(self) -> None:
        """What is put down from now on goes together."""
        self._group += 1

    def mark(self) -> tuple[int, int]:
        """A state to come back to with `undo`."""
        return len(self.placed), len(self._things)

    def undo(self, mark: tuple[int, int]) -> None:
        """Take back everything since the mark."""
        self.walked = -1
        del self.placed[mark[0] :]
        del self._things[mark[1] :]
        for wall in self.walls:
            wall.forget(mark[1])

    def restore(self, empty: tuple[int, int], pieces: Sequence[Placed]) -> None:
        """Stand these pieces, as they stood before, in a room that is as it was at the mark."""
        pieces = list(pieces)
        self.undo(empty)
        for piece in pieces:
            self.placed.append(piece)
            half_length, half_width = piece.size[0] / 2, piece.size[1] / 2
            self._take(piece.x, piece.y, piece.ux, piece.uy, half_length, half_width, SOLID,
                       NO_SILL_M)  # fmt: skip

    def put(
        self,
        category: str,
        wall: Wall,
        s: float,
        size: Size,
        *,
        back: float = 0.0,
        reach: float = 0.0,
        core: bool = False,
    ) -> None:
        """Stand a piece with its back to the wall, centred at s, `back` metres off the wall.

        reach: how far in front of it nothing else may stand.
        """
        self.put_turned(category, wall, s, back + size[1] / 2, size, 0, core=core)
        if reach:
            front = back + size[1]
            self.keep(wall, s - size[0] / 2, s + size[0] / 2, front, front + reach, REACH)

    def put_turned(
        self,
        category: str,
        wall: Wall,
        s: float,
        t: float,
        size: Size,
        quarter_turns: int,
        *,
        core: bool = False,
    ) -> None:
        """Stand a piece with its centre at (s, t) of the wall's frame.

        quarter_turns: counter-clockwise from facing away from the wall, 0 to 3; 2 faces the wall.
        """
        length, width, _ = size
        x, y = wall.world(s, t)
        base = CATEGORIES[category].mount_height_m
        # The own x axis of a piece with its back to the wall runs against the wall's direction.
        ux, uy = -wall.ux, -wall.uy
        for _ in range(quarter_turns):
            ux, uy = -uy, ux
        yaw_deg = wrap_deg(wall.yaw_deg + 90.0 * quarter_turns)
        self.placed.append(Placed(category, x, y, base, size, yaw_deg, ux, uy, self._group, core))
        self._take(x, y, ux, uy, length / 2, width / 2, SOLID, NO_SILL_M)

    def put_box(self, category: str, box: Box, *, core: bool = False) -> None:
        """Stand a piece where a box of the world is."""
        (x, y, z), turn = box.center_m, math.radians(box.yaw_deg)
        ux, uy = round(math.cos(turn), 12), round(math.sin(turn), 12)
        self.placed.append(
            Placed(category, x, y, z, box.size_m, box.yaw_deg, ux, uy, self._group, core)
        )
        self._take(x, y, ux, uy, box.size_m[0] / 2, box.size_m[1] / 2, SOLID, NO_SILL_M)

    def keep(
        self,
        wall: Wall,
        s_from: float,
        s_to: float,
        t_from: float,
        t_to: float,
        bits: int = ZONE,
        sill: float = NO_SILL_M,
    ) -> None:
        """Keep a rectangle of the wall's frame free of things higher than sill."""
        x, y = wall.world((s_from + s_to) / 2, (t_from + t_to) / 2)
        half_s, half_t = (s_to - s_from) / 2, (t_to - t_from) / 2
        self._take(x, y, wall.ux, wall.uy, half_s, half_t, bits, sill)

    def _take(
        self, x: float, y: float, ux: float, uy: float,
        half_length: float, half_width: float, bits: int, sill: float,
    ) -> None:  # fmt: skip
        """Add a thing, with its extent along the axes, which most walls run along."""
        along, across = abs(ux), abs(uy)
        half_x = along * half_length + across * half_width
        half_y = across * half_length + along * half_width
        self._things.append((x, y, ux, uy, half_length, half_width, bits, sill, half_x, half_y))

    def spots(
        self, depth: float, height: float, reach: float = 0.0, least: float = 0.3
    ) -> Iterator[Spot]:
        """Free spans along all walls; see Wall.gaps."""
        for wall in self.walls:
            if wall.length >= least:
                for s_from, s_to in wall.gaps(depth, height, reach, least):
                    yield Spot(wall, s_from, s_to)

    def facing(self, wall: Wall) -> list[Wall]:
        """Walls that look at this one, within a degree of parallel."""
        return [
            other
            for other in self.walls
            if other.ux * wall.ux + other.uy * wall.uy < -0.9998
            and wall.local(other.x, other.y)[1] > 0.5
        ]

    def distance_to_door(self, x: float, y: float) -> float:
        """Metres from a world point to the middle of the nearest door; 9 without doors."""
        if len(self._door_points) != len(self.doors):
            self._door_points = [
                door.wall.world((door.s_from + door.s_to) / 2, 0.0) for door in self.doors
            ]
        nearest = 9.0
        for door_x, door_y in self._door_points:
            away = math.hypot(door_x - x, door_y - y)
            if away < nearest:
                nearest = away
        return nearest

    def has(self, category: str) -> bool:
        """Whether a piece of this category stands here."""
        return any(piece.category == category for piece in self.placed)


def straight_corners(corners: Sequence[Sequence[float]]) -> list[tuple[float, float]]:
    """The corners at which the outline really turns (more than 0.2 degrees), in order."""
    kept: list[tuple[float, float]] = []
    count = len(corners)
    for i in range(count):
        (ax, ay), (bx, by), (cx, cy) = corners[i - 1], corners[i], corners[(i + 1) % count]
        ux, uy, vx, vy = bx - ax, by - ay, cx - bx, cy - by
        turn = abs(ux * vy - uy * vx)
        if turn > 0.003 * math.hypot(ux, uy) * math.hypot(vx, vy):
            kept.append((bx, by))
    return kept


def _area_m2(corners: Sequence[tuple[float, float]]) -> float:
    total = 0.0
    for i, (x, y) in enumerate(corners):
        total += corners[i - 1][0] * y - x * corners[i - 1][1]
    return total / 2
