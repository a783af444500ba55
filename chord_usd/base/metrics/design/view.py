"""A room with its pieces as arrays of oriented rectangles: what planning rules measure in.

Built for speed: a draft of a room is measured in a few milliseconds, so that many can be ranked.
Lengths are metres; a piece's own axes are u to its right and v to its front, from its middle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import TypeVar, cast

import numpy as np

from chord_usd.base.metrics.design.screens import Screen, planned_screen
from chord_usd.base.metrics.design.shell import TOUCH_M, Hole, Rects, Shell, shells
from chord_usd.base.metrics.fronts import SWINGS_M
from chord_usd.base.metrics.walk import entrance
from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import BoolArray, Box, FloatArray, Item, Opening, Room, SceneGraph

MOST_M = 4.0
"""Free floor is not measured farther."""

WALL_TOUCH_M = 0.03
"""A wall that reaches so little into a strip leaves it free: rasters are no finer."""

FLAT = having("panel")
"""Panels: they take no floor."""
_ENDS = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
"""Corners at the ends of the sides of a footprint."""
_HEAD_M = 1.4
"""What hangs above this takes no floor."""

Point = tuple[float, float]
T = TypeVar("T")


@dataclass(eq=False)
class View:
    """A room with what stands in it. Pieces go by their number."""

    shell: Shell
    items: tuple[Item, ...]
    hung: tuple[Box, ...] | None = None
    """Televisions on walls; None where nobody has hung any yet."""
    _near: dict[int, FloatArray] = field(default_factory=dict)
    _measured: dict[tuple[object, ...], float] = field(default_factory=dict)
    """Free depths: several rules ask for the same."""
    _once: dict[Callable[[View], object], object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Arrays of what rules measure."""
        rows = np.array([_measures(item.box) for item in self.items]).reshape(-1, 19)
        self.categories = [item.category for item in self.items]
        self.at, base, (self.length, self.depth, self.height), self.yaw = (
            rows[:, :2], rows[:, 2], rows[:, 3:6].T, rows[:, 6],
        )  # fmt: skip
        self.right, self.front = rows[:, 7:9], rows[:, 9:11]
        self.corners = rows[:, 11:].reshape(-1, 4, 2)
        self.edges = self.corners[:, _ENDS]
        flat = np.array([name in FLAT for name in self.categories], np.bool_)
        self.stands: BoolArray = ~flat & (base < _HEAD_M)
        self.rects = Rects(self.at, self.right, self.front, rows[:, 3:5] / 2)
        self._segments = np.concatenate([self.edges.reshape(-1, 2, 2), self.shell.walls])

    @cached_property
    def swings_m(self) -> FloatArray:
        """(N,) how far before each piece its leaves swing; 0 without leaves."""
        return np.array([SWINGS_M.get(name, 0.0) for name in self.categories])

    def leaf_floors(self, share: float = 1.0) -> Rects:
        """The floor before each piece that its leaves need to open, or a share of it."""
        deep = self.swings_m * share / 2
        half = np.stack([np.maximum(self.length / 2 - 2 * TOUCH_M, 0.0), deep], axis=-1)
        at = self.at + self.front * (self.depth / 2 + deep)[:, None]
        return Rects(at, self.right, self.front, half)

    def once(self, measure: Callable[[View], T]) -> T:
        """The measure of this room, computed once: a home is priced for each draft of each room,
        and its other rooms are the same in all of these. measure: a function of a module."""
        if measure not in self._once:
            self._once[measure] = measure(self)
        return cast(T, self._once[measure])

    def of(self, *categories: str) -> list[int]:
        """Numbers of the pieces of these categories."""
        if len(categories) == 1:
            return list(self._numbers.get(categories[0], ()))
        return sorted(at for name in {*categories} for at in self._numbers.get(name, ()))

    @cached_property
    def _numbers(self) -> dict[str, list[int]]:
        """Numbers of the pieces by category."""
        numbers: dict[str, list[int]] = {}
        for at, name in enumerate(self.categories):
            numbers.setdefault(name, []).append(at)
        return numbers

    @property
    def middle(self) -> Point:
        """Of the room."""
        return self.shell.middle

    def point(self, at: int, u: float = 0.0, v: float = 0.0) -> Point:
        """In the world, of a place in a piece's frame."""
        x, y = self.at[at] + self.right[at] * u + self.front[at] * v
        return float(x), float(y)

    def own(self, at: int, points: FloatArray) -> FloatArray:
        """(..., 2) points in the frame of a piece: u to its right, v to its front."""
        ahead = points - self.at[at]
        return np.stack([ahead @ self.right[at], ahead @ self.front[at]], axis=-1)

    def before(
        self, at: int, low: float, high: float, but: Iterable[int] = (), start: float | None = None
    ) -> float:
        """Free depth before a piece's front, over the band from low to high along u."""
        edge = self.depth[at] / 2 if start is None else start
        return self._free(at, self.front[at], self.right[at], (low, high), edge, but)

    def behind(self, at: int, low: float, high: float, but: Iterable[int] = ()) -> float:
        """The same behind its back."""
        edge = self.depth[at] / 2
        return self._free(at, -self.front[at], self.right[at], (low, high), edge, but)

    def beside(self, at: int, side: int, low: float, high: float, but: Iterable[int] = ()) -> float:
        """Free width beside a piece, right (1) or left (-1), over the band along v."""
        return self._free(
            at, self.right[at] * side, self.front[at], (low, high), self.length[at] / 2, but
        )

    def to_wall(self, at: int, side: int, low: float, high: float) -> float:
        """The same up to the next wall, past other pieces."""
        return self.beside(at, side, low, high, range(len(self.items)))

    def _free(
        self,
        at: int,
        ahead: FloatArray,
        across: FloatArray,
        band: tuple[float, float],
        start: float,
        but: Iterable[int],
    ) -> float:
        but = tuple(but)
        key = (at, *ahead.tolist(), band, start, but)
        if key not in self._measured:
            self._measured[key] = self._depth(at, ahead, across, band, start, but)
        return self._measured[key]

    def _depth(
        self,
        at: int,
        ahead: FloatArray,
        across: FloatArray,
        band: tuple[float, float],
        start: float,
        but: tuple[int, ...],
    ) -> float:
        count = 4 * len(self.items)
        segments = self._segments - self.at[at]
        forward, lateral = segments @ ahead, segments @ across
        low, high = self._between(band)
        first, rise = lateral[:, 0], forward[:, 1] - forward[:, 0]
        run = lateral[:, 1] - first
        flat = np.abs(run) < 1e-9
        safe = np.where(flat, 1.0, run)
        first_cut, last_cut = (low - first) / safe, (high - first) / safe
        enter = np.maximum(np.minimum(first_cut, last_cut), 0.0)
        leave = np.minimum(np.maximum(first_cut, last_cut), 1.0)
        crosses = np.where(flat, (first > low) & (first < high), enter < leave)
        enter, leave = np.where(flat, 0.0, enter), np.where(flat, 1.0, leave)
        first_cut, last_cut = forward[:, 0] + rise * enter, forward[:, 0] + rise * leave
        near = np.where(crosses, np.minimum(first_cut, last_cut), np.inf)
        far = np.where(crosses, np.maximum(first_cut, last_cut), -np.inf)
        least = MOST_M
        counts = self.stands & (far[:count].reshape(-1, 4).max(axis=1) > start + TOUCH_M)
        counts[[at, *but]] = False
        if counts.any():
            least = min(least, float(near[:count].reshape(-1, 4)[counts].min()) - start)
        solid = far[count:] > start - WALL_TOUCH_M  # flush with a wall is no floor at all
        if solid.any():
            least = min(least, float(near[count:][solid].min()) - start + WALL_TOUCH_M)
        return max(0.0, least)

    def _between(self, band: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
        """(S,) both ends of a band, less what pieces and walls may reach into it."""
        low = np.full(len(self._segments), band[0] + WALL_TOUCH_M)
        high = np.full(len(self._segments), band[1] - WALL_TOUCH_M)
        low[: 4 * len(self.items)] += 0.005 - WALL_TOUCH_M
        high[: 4 * len(self.items)] -= 0.005 - WALL_TOUCH_M
        return low, high

    def gaps(self, at: int) -> FloatArray:
        """(N,) distance of each piece's footprint from that of one; 0 where they overlap."""
        if at not in self._near:
            self._near[at] = self._gaps(self.corners[at], at)
        return self._near[at]

    def _gaps(self, corners: FloatArray, at: int) -> FloatArray:
        edges = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
        there = distances(corners, self.edges.reshape(-1, 2, 2)).reshape(4, -1, 4)
        back = distances(self.corners.reshape(-1, 2), edges).reshape(-1, 4, 4)
        away = np.minimum(there.min(axis=(0, 2)), back.min(axis=(1, 2)))
        away[self.overlaps(at)] = 0.0
        return away

    def overlaps(self, at: int) -> BoolArray:
        """(N,) which footprints share more than a line with that of one piece, it included."""
        return (self.depths[at] > 1e-6).astype(np.bool_)

    @cached_property
    def depths(self) -> FloatArray:
        """(N, N) how deep footprints reach into each other (Rects.depths)."""
        return self.rects.depths(self.rects)

    def from_line(self, at: int, ends: FloatArray) -> float:
        """Distance of a piece from a line (2, 2)."""
        there = distances(ends, self.edges[at]).min()
        back = distances(self.corners[at], ends[None]).min()
        u, v = np.abs(self.own(at, ends)).T
        within = ((u <= self.length[at] / 2) & (v <= self.depth[at] / 2)).any()
        return 0.0 if within else float(min(there, back))

    def covered(self, points: FloatArray, among: Sequence[int]) -> FloatArray:
        """(len(among),) share of these points (K, 2) that each of the pieces stands on."""
        ahead = points[None] - self.at[among][:, None]
        u = np.abs(np.einsum("nkd,nd->nk", ahead, self.right[among]))
        v = np.abs(np.einsum("nkd,nd->nk", ahead, self.front[among]))
        within = (u < self.length[among][:, None] / 2) & (v < self.depth[among][:, None] / 2)
        share: FloatArray = within.mean(axis=1)
        return share

    def grid(self, at: int, u: tuple[float, float], v: tuple[float, float]) -> FloatArray:
        """(K, 2) points in the world, evenly over a rectangle in a piece's frame."""
        across, along = np.meshgrid(_spread(*u, 12), _spread(*v, 8))
        return (
            self.at[at]
            + across.reshape(-1, 1) * self.right[at]
            + along.reshape(-1, 1) * self.front[at]
        )

    def windows_behind(self, at: int, depth: float = 0.35, wider: float = 0.0) -> list[Hole]:
        """Windows in the wall behind a piece, along more than 10 cm of it."""
        holes = []
        half, back = self.length[at] / 2 + wider, self.depth[at] / 2
        for hole in self.shell.windows:
            span = clipped(self.own(at, hole.ends), (-half, half), (-back - depth, 0.05 - back))
            if span > 0.1:
                holes.append(hole)
        return holes

    def is_upright_to(self, at: int, other: int, within_deg: float = 15.0) -> bool:
        """Whether two pieces face the same way."""
        return bool(abs((self.yaw[other] - self.yaw[at] + 180.0) % 360.0 - 180.0) < within_deg)

    @cached_property
    def bare(self) -> list[int]:
        """Cabinets for a television without one: those before a window, by however little. The
        same asks which meshes cabinets get (screenless)."""
        cabinets = np.array(self.of("tv_cabinet"), np.intp)
        if not len(cabinets):
            return []
        deep = self.rects.of(cabinets).depths(self.shell.below_glass)
        before: list[int] = cabinets[(deep > TOUCH_M).any(axis=1)].tolist()
        return before

    @cached_property
    def televisions(self) -> list[Screen]:
        """On cabinets and walls. A room that is not dressed yet gets one where a wall has a place
        and no cabinet holds one."""
        bare = self.bare
        screens = [Screen.of(self.items[at].box, self.items[at].id)
                 for at in self.of("tv_cabinet") if at not in bare]  # fmt: skip
        hung = self.hung or ()
        if self.hung is None and self.shell.is_lived_in and not screens and self.screen:
            hung = (self.screen,)
        return screens + [Screen.of(box) for box in hung]

    @cached_property
    def screen(self) -> Box | None:
        """Where a television may hang before the sofa, or else the bed."""
        return planned_screen(self)


@lru_cache(maxsize=20_000)  # drafts of a room hold mostly the same pieces
def _measures(box: Box) -> tuple[float, ...]:
    """Middle, foot, size and yaw, its axes to the right and to the front, and its corners."""
    turn = math.radians(box.yaw_deg)
    right, front = (math.cos(turn), math.sin(turn)), (math.sin(turn), -math.cos(turn))
    corners = footprint(box).ravel().tolist()
    return (*box.center_m, *box.size_m, box.yaw_deg, *right, *front, *corners)


def _spread(low: float, high: float, count: int) -> FloatArray:
    """The middles of so many equal parts."""
    return low + (np.arange(count) + 0.5) * (high - low) / count


def distances(points: FloatArray, segments: FloatArray) -> FloatArray:
    """(N, M) from points (N, 2) to segments (M, 2, 2)."""
    start, run = segments[:, 0], segments[:, 1] - segments[:, 0]
    run_x, run_y = run[:, 0], run[:, 1]
    x = points[:, :1] - start[:, 0]
    y = points[:, 1:] - start[:, 1]
    t = (x * run_x + y * run_y) / np.maximum(run_x * run_x + run_y * run_y, 1e-12)
    t = np.minimum(np.maximum(t, 0.0), 1.0)
    away: FloatArray = np.hypot(x - t * run_x, y - t * run_y)
    return away


def clipped(ends: FloatArray, across: tuple[float, float], along: tuple[float, float]) -> float:
    """Length of a line (2, 2) within an upright rectangle."""
    enter, leave = 0.0, 1.0
    run = ends[1] - ends[0]
    for axis, (low, high) in enumerate((across, along)):
        if abs(run[axis]) < 1e-9:
            if not low < ends[0, axis] < high:
                return 0.0
            continue
        a, b = sorted(((low - ends[0, axis]) / run[axis], (high - ends[0, axis]) / run[axis]))
        enter, leave = max(enter, a), min(leave, b)
    return max(0.0, float(leave - enter)) * float(np.hypot(*run))


@dataclass(frozen=True, eq=False)
class HomeView:
    """All rooms of a home with what stands in them."""

    rooms: tuple[View, ...]
    entrance: Opening | None

    @cached_property
    def sleepers(self) -> int:
        """How many people its beds are for."""
        return sum(room.once(sleepers_of) for room in self.rooms)

    @cached_property
    def watched_in_bed(self) -> View | None:
        """The largest bedroom whose wall has a place for a television, where a home that is not
        dressed yet has none in any other room: rules want one there, and count this one once it
        hangs."""
        if any(room.televisions for room in self.rooms):
            return None
        bare = (r for r in self.rooms if r.shell.kind == "bedroom" and r.hung is None)
        bedrooms = [room for room in bare if room.screen]
        return max(bedrooms, key=lambda room: room.shell.area_m2, default=None)

    def of(self, *categories: str) -> list[tuple[View, int]]:
        """Pieces of these categories, each with its room."""
        return [(room, at) for room in self.rooms for at in room.of(*categories)]


DOUBLE_M = 1.35
"""A bed at least so wide is for two."""


def sleepers_of(room: View) -> int:
    """How many people the beds of a room are for."""
    return sum(2 if room.length[at] >= DOUBLE_M else 1 for at in room.of("bed"))


def view_home(graph: SceneGraph, *, is_dressed: bool = False) -> HomeView:
    """A house as rules see it. is_dressed: whether nothing more will hang on its walls."""
    plan = shells(graph.rooms, graph.openings)
    by_room: dict[str, list[Item]] = {room.id: [] for room in graph.rooms}
    for item in graph.items:
        if item.room_id in by_room:
            by_room[item.room_id].append(item)
    hung: dict[str, tuple[Box, ...]] = {}
    for item in graph.dressing:
        if item.category == "television":
            hung[item.room_id] = (*hung.get(item.room_id, ()), item.box)
    views = tuple(
        View(plan[room.id], tuple(by_room[room.id]), hung.get(room.id, () if is_dressed else None))
        for room in graph.rooms
    )
    return HomeView(views, _entrance(graph.rooms, graph.openings))


def screenless(graph: SceneGraph) -> frozenset[str]:
    """Ids of the television cabinets of a house that have no place for a television."""
    if not any(item.category == "tv_cabinet" for item in graph.items):
        return frozenset()
    return frozenset(room.items[at].id for room in view_home(graph).rooms for at in room.bare)


@lru_cache(maxsize=16)
def _entrance(rooms: tuple[Room, ...], openings: tuple[Opening, ...]) -> Opening | None:
    return entrance(SceneGraph(rooms, openings, ()))
