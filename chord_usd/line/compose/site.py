"""A room as somebody who plans a kitchen sees it: walls, what stands before them, ways through.

Everything along a wall is asked in the wall's frame: s runs along the wall from its first corner,
t into the room, both metres. Rooms run counter-clockwise, so that t points to the left of s.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
import shapely

from chord_usd.base.metrics.clear_floor import clearances, is_open_border, open_borders, sides_of
from chord_usd.base.metrics.fronts import FRONT, USED_SIDES, floor_before
from chord_usd.base.places.wall_frames import WallFrame
from chord_usd.base.scene.geometry import footprint, footprint_polygon, gaps, room_polygon
from chord_usd.base.scene.trim import DRIP_M, boards, casings
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    Box,
    FloatArray,
    Item,
    Opening,
    Room,
    SceneGraph,
)

Span = tuple[float, float]

LEAST_WALL_M = 0.3
"""Nothing stands along a shorter side."""
_OPENED_M = 0.45
"""Before the front of a unit, at least, so that its door or flap opens by half."""
_WALLS = 16
"""Sides of a room that are looked at, the longest ones."""
TOUCH_M = 1e-4
_TRIM_GAP_M = 0.003
"""Between units and casings or boards."""
BEFORE_M = 0.6
"""Depth of the floor before what is used."""
_AT_WALL_M = WALL_THICKNESS_M / 2 + 0.1
_FAR_M = 4.0
"""Nothing looks farther into a room."""
_OUT = -1.0
"""Sill of what keeps out pieces of every height."""


@dataclass(frozen=True, eq=False)
class Wall(WallFrame):
    """One side of a room; s is its u, t its v."""

    index: int
    blocks: FloatArray
    """(K, 5) s from and to, t from and to, sill: what is higher than the sill stands elsewhere."""
    edges: FloatArray
    """(E, 4) s and t of both ends of the other sides."""
    windows: tuple[Span, ...] = ()
    """Along this wall."""
    doors: tuple[Span, ...] = ()

    def rectangle(self, s_from: float, s_to: float, t_from: float, t_to: float) -> FloatArray:
        """(4, 2) corners in the world."""
        return np.array([self.at(s, t) for s, t in (
            (s_from, t_from), (s_to, t_from), (s_to, t_to), (s_from, t_to)
        )])  # fmt: skip

    def spans(self, depth: float, height: float, least: float) -> list[Span]:
        """Where something so deep and high may stand with its back to the wall."""
        low, high = TOUCH_M, depth - TOUCH_M
        s_from, s_to, t_from, t_to, sill = self.blocks.T
        taken = (t_from < high) & (t_to > low) & (sill < height)
        cuts = [*zip(s_from[taken].tolist(), s_to[taken].tolist(), strict=True)]
        cuts += self._cut_by_edges(low, high)
        return [(a, b) for a, b in gaps(cuts, self.length_m) if b - a >= least - TOUCH_M]

    def _cut_by_edges(self, low: float, high: float) -> list[Span]:
        """What the room's other sides take of the strip between two distances from the wall."""
        s0, t0, s1, t1 = self.edges.T
        rise = np.where(np.abs(t1 - t0) < 1e-9, 1e-9, t1 - t0)
        ends = np.sort(np.stack([(low - t0) / rise, (high - t0) / rise]), axis=0)
        first, last = np.maximum(ends[0], 0.0), np.minimum(ends[1], 1.0)
        level = np.abs(t1 - t0) < 1e-9
        inside = np.where(level, (t0 > low) & (t0 < high), first < last)
        first, last = np.where(level, 0.0, first), np.where(level, 1.0, last)
        both = np.sort(np.stack([s0 + (s1 - s0) * first, s0 + (s1 - s0) * last]), axis=0)
        return [*zip(both[0][inside].tolist(), both[1][inside].tolist(), strict=True)]


@dataclass(frozen=True, eq=False)
class Site:
    """What a composer knows of a room."""

    area_m2: float
    walls: tuple[Wall, ...]
    """Those long enough to stand at, in the room's order."""
    edges: FloatArray
    """(E, 2, 2) both ends of what ends the view: walls and pieces that stay; no open borders."""
    doors: FloatArray
    """(D, 2, 2) both ends of doors, passages and open borders, at the middle of the wall."""
    ways: FloatArray
    """(W, 2, 2) straight ways from each door and passage to each other, from inside the room."""
    swings: tuple[shapely.Polygon, ...]
    """The floor that leaves of doors sweep."""
    pieces: tuple[shapely.Polygon, ...]
    """What stands there and may move."""
    sills: tuple[float, ...]
    """Of the windows."""

    @cached_property
    def way_lines(self) -> tuple[shapely.LineString, ...]:
        """The ways as lines."""
        return tuple(shapely.LineString(way) for way in self.ways)

    def clear_m(self, points_m: FloatArray, ahead: FloatArray, extra: FloatArray) -> FloatArray:
        """(N,) how far one sees from points in one direction. extra: (K, 2, 2) further edges."""
        edges = np.concatenate([self.edges, extra])
        side = edges[:, 1] - edges[:, 0]
        away = edges[None, :, 0] - points_m[:, None]
        across = ahead[0] * side[:, 1] - ahead[1] * side[:, 0]
        across = np.where(np.abs(across) < 1e-9, np.inf, across)
        far = (away[..., 0] * side[:, 1] - away[..., 1] * side[:, 0]) / across
        along = (away[..., 0] * ahead[1] - away[..., 1] * ahead[0]) / across
        meets = (far > 1e-3) & (along >= 0.0) & (along <= 1.0)
        return np.where(meets, far, _FAR_M).min(axis=1, initial=_FAR_M)


def site_of(house: SceneGraph, room: Room, stays: Iterable[Item], moves: Iterable[Item]) -> Site:
    """A room of a house. stays: pieces that units stand beside; moves: pieces that may move."""
    corners = _straight(room.polygon_m)
    floor = room_polygon(room)
    near = [other for other in house.rooms if room_polygon(other).dwithin(floor, TOUCH_M * 100)]
    openings = [
        opening for opening in house.openings if footprint_polygon(opening.box).dwithin(floor, 0.15)
    ]
    clear = [(opening, shape) for opening, shape in clearances(near, openings)
             if shape.intersection(floor).area > TOUCH_M]  # fmt: skip
    touching = [border for border in open_borders(tuple(near), tuple(house.openings))
                if room.id in border.room_ids]  # fmt: skip
    borders = [opening.box for opening in (*touching, *filter(is_open_border, openings))]
    standing = [footprint(item.box) for item in stays]
    holes = [opening for opening in openings if opening.kind != "window"]
    trim = _trim_on(floor, sides_of(openings, near))
    solid = _edges(corners, [footprint_polygon(border) for border in borders], ())
    lengths = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
    longest = sorted(np.argsort(-lengths, kind="stable")[:_WALLS].tolist())
    walls = tuple(
        _wall(
            index,
            corners,
            clear,
            openings,
            [footprint(border) for border in borders],
            standing,
            trim,
            solid,
        )
        for index in longest
        if lengths[index] >= LEAST_WALL_M
    )
    return Site(
        area_m2=float(floor.area),
        walls=walls,
        edges=_edges(corners, [footprint_polygon(border) for border in borders], standing),
        doors=_ends(holes + touching),
        ways=_ways(_ends(holes), floor),
        swings=tuple(shape for opening, shape in clear if opening.kind == "door"),
        pieces=tuple(shape for item in moves for shape in floor_of(item)),
        sills=tuple(opening.box.center_m[2] for opening, _ in clear if opening.kind == "window"),
    )


def _ends(openings: Sequence[Opening]) -> FloatArray:
    """(D, 2, 2)"""
    ends = [[box_end(opening, -0.5), box_end(opening, 0.5)] for opening in openings]
    return np.array(ends).reshape(-1, 2, 2)


def floor_of(item: Item) -> list[shapely.Polygon]:
    """What a piece stands on, and what one stands on who uses it."""
    front = [floor_before(item.box, FRONT, 0.0, BEFORE_M)] if item.category in USED_SIDES else []
    return [footprint_polygon(box) for box in (item.box, *front)]


def box_end(opening: Opening, share: float) -> FloatArray:
    """(2,) a point on the middle line of an opening: -0.5 and 0.5 are its ends."""
    turn = math.radians(opening.box.yaw_deg)
    along = np.array([math.cos(turn), math.sin(turn)])
    end: FloatArray = np.array(opening.box.center_m[:2]) + share * opening.box.size_m[0] * along
    return end


def _straight(polygon_m: FloatArray) -> FloatArray:
    """Corners at which an outline turns by more than 0.2 degrees."""
    before, after = np.roll(polygon_m, 1, axis=0), np.roll(polygon_m, -1, axis=0)
    first, second = polygon_m - before, after - polygon_m
    turn = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    kept: FloatArray = polygon_m[turn > 0.0035 * np.hypot(*first.T) * np.hypot(*second.T)]
    return kept


def _wall(
    index: int,
    corners: FloatArray,
    clear: Sequence[tuple[Opening, shapely.Geometry]],
    openings: Sequence[Opening],
    borders: Sequence[FloatArray],
    standing: Sequence[FloatArray],
    trim: Sequence[tuple[Box, float]],
    solid: FloatArray,
) -> Wall:
    """solid: (E, 2, 2) the room's sides without open borders."""
    side = WallFrame.between(corners[index], corners[(index + 1) % len(corners)])
    others = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    edges = side.local(np.delete(others, index, axis=0)).reshape(-1, 4)
    blocks = []
    for opening, shape in clear:
        sill = opening.box.center_m[2] - DRIP_M[1] if opening.kind == "window" else _OUT
        blocks.append([*side.extent(shapely.get_coordinates(shape)), sill])
    for part, low in trim:
        s_from, s_to, t_from, t_to = side.extent(footprint(part))
        gap = _TRIM_GAP_M
        # Drawers and doors of a unit pass before its front.
        blocks.append([s_from - gap, s_to + gap, t_from - gap - BEFORE_M, t_to + gap, low])
    blocks += [[*side.extent(shape), _OUT] for shape in standing]
    blocks += _facing(side.local(solid).reshape(-1, 4))
    # No wall is behind what would stand at an open border.
    blocks += [[low, high, 0.0, 0.1, _OUT] for low, high in _along(side, borders)]
    windows = [footprint(opening.box) for opening in openings if opening.kind == "window"]
    doors = [footprint(opening.box) for opening in openings if opening.kind != "window"]
    return Wall(
        side.start_m, side.along, side.inward, side.length_m, index,
        np.array(blocks).reshape(-1, 5), edges,
        tuple(_along(side, windows)), tuple(_along(side, doors)),
    )  # fmt: skip


def _trim_on(
    floor: shapely.Polygon, sides: Iterable[tuple[Opening, Room]]
) -> list[tuple[Box, float]]:
    """Casings and window boards on a floor, and the height from which they keep pieces out.

    sides: openings with rooms beside them; trim of an open neighbour may reach over the border.
    """
    trim = [
        strip
        for opening, room in sides
        for strip in (
            *((leg, _OUT) for leg in casings(opening, room)),
            *((board, board.center_m[2]) for board in boards(opening, room)),
        )
    ]
    return [(box, low) for box, low in trim if footprint_polygon(box).intersects(floor)]


def _facing(edges: FloatArray) -> Iterator[list[float]]:
    """Blocks before walls, (E, 4) in the frame of another, that stand so near before that one that
    units between them could not be opened."""
    for s_from, t_from, s_to, t_to in edges.tolist():
        if abs(t_from - t_to) < 0.05 and t_from > _AT_WALL_M:
            low, high = sorted((s_from, s_to))
            yield [low - _TRIM_GAP_M, high + _TRIM_GAP_M, t_from - _OPENED_M, t_from, _OUT]


def _along(wall: WallFrame, shapes: Iterable[FloatArray]) -> Iterator[Span]:
    """The stretches of a wall that openings lie in."""
    for shape in shapes:
        low, high, near, far = wall.extent(shape)
        is_in_wall = abs((near + far) / 2) < _AT_WALL_M and far - near < 2 * _AT_WALL_M
        if is_in_wall and high > 0.0 and low < wall.length_m:
            yield max(low, 0.0), min(high, wall.length_m)


def _edges(
    corners: FloatArray, borders: Sequence[shapely.Polygon], standing: Sequence[FloatArray]
) -> FloatArray:
    ring = shapely.LinearRing(corners)
    opened = shapely.union_all([border.buffer(0.02, cap_style="square") for border in borders])
    lines = [shapely.get_coordinates(part) for part in shapely.get_parts(ring.difference(opened))]
    lines += [np.concatenate([shape, shape[:1]]) for shape in standing]
    return np.concatenate(
        [np.stack([line[:-1], line[1:]], axis=1) for line in lines] or [np.zeros((0, 2, 2))]
    )


def _ways(doors: FloatArray, floor: shapely.Polygon) -> FloatArray:
    inside = [_step_in(ends, floor) for ends in doors]
    ways = [
        [first, other] for first, other in combinations(inside, 2) if math.dist(first, other) > 0.5
    ]
    return np.array(ways).reshape(-1, 2, 2)


def _step_in(ends: FloatArray, floor: shapely.Polygon) -> FloatArray:
    """A place in the room, behind a door."""
    middle, side = ends.mean(axis=0), ends[1] - ends[0]
    normal = np.array([-side[1], side[0]]) / max(math.hypot(*side), 1e-9)
    both = [middle + way * normal * (_AT_WALL_M + 0.2) for way in (1.0, -1.0)]
    return min(both, key=lambda point: floor.distance(shapely.Point(point)))
