"""Which view of a room a photographer would take: where to stand, where to look, how to shift.

Plane geometry only. A view stands either inside the room, by preference in a corner, or behind one
of its walls, which then lies before the near clipping plane: so small rooms are seen through a lens
that does not stretch them. Views are judged by how much of the floor and of the furniture they
show, by how openly they look into the room, and by what stands close to the lens.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.scene.geometry import footprint, footprint_polygon, polygons_of
from chord_usd.scene.types import BoolArray, FloatArray, Item

EYE_M = 1.5
SENSOR_MM = (36.0, 20.25)
"""Width and height: a full-frame sensor cut to 16 : 9."""

NEAR_M = 0.05
"""Near clipping plane of a view from inside."""

_LENSES_MM = ((28.0, 1.0), (24.0, 1.0), (20.0, 0.85))
"""What a photographer of interiors has with them, and what a view through it is worth: wider
lenses stretch what is near the edges."""

_SHIFTS_MM = ((-2.4, 1.0), (-3.6, 1.0), (-5.0, 0.97), (-6.5, 0.92), (-8.0, 0.85))
"""How far the lens may be shifted, as architecture is photographed, and what a view is worth then.
A shift shows more floor and less ceiling while verticals stay straight; much of it looks steep."""

_CLEAR_OF_PIECES_M = (0.4, 0.25, 0.1)
"""How far from furniture to stand; the next one where the first leaves no place."""

_FROM_WALL_M = 0.2
_BEHIND_WALL_M = (0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8)
"""How far behind a wall to stand."""

_CUT_M = 0.18
"""What hangs on the wall that one looks through (curtains, pictures) is cut away with it."""

_BLOCKS_FROM_M = 1.3
"""Items whose top is higher hide what is behind them, and nobody stands over them."""

_HEADINGS_DEG = np.arange(0.0, 360.0, 7.5)
_ENOUGH_FLOOR = 0.67
"""Share of the floor in the picture from which on more of it is worth nothing."""

_FLOOR_WORTH = 1.6
_PIECES_WORTH = 1.6
_DEPTH_WORTH = 0.5
_DOOR_COST = 0.6
_CROWDING = 0.8
"""Share of its worth that a view loses when all of it is crowded."""

_CROWDED_M = 1.4
"""Walls and tall pieces nearer than this crowd the picture."""

_DOOR_M = 0.9
_RAYS_DEG = np.arange(0.0, 360.0, 7.5)
"""Directions in which the depth of a room is felt."""

_LENS_MM = np.array([lens for lens, _ in _LENSES_MM for _ in _SHIFTS_MM])
_SHIFT_MM = np.array([shift for _ in _LENSES_MM for shift, _ in _SHIFTS_MM])
_WORTH = np.array([one * other for _, one in _LENSES_MM for _, other in _SHIFTS_MM])
"""(K,) of each lens with each shift."""

_SAMPLES = 70
"""Points of a room's floor that a view is judged by."""


@dataclass(frozen=True)
class View:
    """A camera that stands upright and looks horizontally, so that verticals stay straight."""

    position_m: tuple[float, float]
    yaw_deg: float
    """Direction it looks to, counter-clockwise from +x."""
    lens_mm: float
    shift_mm: float
    """Of the lens, upwards; negative shows more floor."""
    near_m: float = NEAR_M
    """Distance of the near clipping plane."""
    floor_share: float = 0.0
    """Share of the floor in the picture, with what stands on it."""


@dataclass(frozen=True)
class _Stand:
    """A place for the camera, and where it may look from there."""

    position_m: FloatArray
    headings_deg: FloatArray
    near_m: float
    worth: float


def choose_view(floor: Polygon, items: Sequence[Item], doors_m: Sequence[FloatArray] = ()) -> View:
    """The view that shows most of a room's floor and furniture.

    doors_m: middles of the room's doors, (2,) each. The same room always has the same view.
    """
    room = _Room(floor, items, doors_m)
    best, most = View((0.0, 0.0), 0.0, 24.0, _SHIFTS_MM[0][0]), -math.inf
    for stand in (*_inside(floor, items, doors_m), *_behind_walls(floor, items)):
        view, worth = room.best(stand)
        if worth > most:
            best, most = view, worth
    return best


class _Room:
    """What there is to see, and what stands before it."""

    def __init__(
        self, floor: Polygon, items: Sequence[Item], doors_m: Sequence[FloatArray]
    ) -> None:
        self._area_m2 = floor.area
        self._floor_m = _floor_points(floor)
        self._pieces_m, self._piece_weights, self._owners = _piece_points(items)
        self._shares = _share_matrix(len(self._floor_m), self._piece_weights)
        self._doors_m = np.array([door[:2] for door in doors_m]).reshape(-1, 2)
        edges = [(_edges(floor), -1)]
        edges += [
            (_edges(footprint_polygon(item.box)), index)
            for index, item in enumerate(items)
            if _top_m(item) > _BLOCKS_FROM_M
        ]
        self._edges_m = np.concatenate([lines for lines, _ in edges])
        self._edge_owners = np.concatenate([np.full(len(lines), owner) for lines, owner in edges])

    def best(self, stand: _Stand) -> tuple[View, float]:
        """The best view from a place, and its worth."""
        sights = np.concatenate([self._floor_m, self._pieces_m])
        owners = np.concatenate([np.full(len(self._floor_m), -2), self._owners])
        offset = sights[:, :2] - stand.position_m
        seen = self._is_seen(stand, offset, owners)
        turn = np.radians(stand.headings_deg)
        depth = np.outer(np.cos(turn), offset[:, 0]) + np.outer(np.sin(turn), offset[:, 1])
        across = np.outer(-np.sin(turn), offset[:, 0]) + np.outer(np.cos(turn), offset[:, 1])
        ahead = np.where(depth > stand.near_m, depth, np.nan)
        with np.errstate(invalid="ignore"):
            beside, above = np.abs(across / ahead), (sights[:, 2] - EYE_M) / ahead
        in_width = beside[None] < SENSOR_MM[0] / 2 / _LENS_MM[:, None, None]
        shift_mm = _SHIFT_MM[:, None, None]
        upright = np.abs(above[None] * _LENS_MM[:, None, None] - shift_mm) < SENSOR_MM[1] / 2
        shown = (in_width & upright & seen).astype(np.float32) @ self._shares
        clear, deep, doors = self._openness(stand)
        floor, pieces = shown[..., 0], shown[..., 1]
        worth = _FLOOR_WORTH * np.minimum(floor / _ENOUGH_FLOOR, 1.0) + _PIECES_WORTH * pieces
        worth = (worth + _DEPTH_WORTH * deep) * clear * _WORTH[:, None] * stand.worth
        worth = (worth - _DOOR_COST * doors).round(6)
        lens, heading = np.unravel_index(int(np.argmax(worth)), worth.shape)
        x, y = (round(float(value), 3) for value in stand.position_m)
        view = View(
            position_m=(x, y),
            yaw_deg=round(float(stand.headings_deg[heading]), 3),
            lens_mm=float(_LENS_MM[lens]),
            shift_mm=float(_SHIFT_MM[lens]),
            near_m=round(stand.near_m, 3),
            floor_share=round(float(floor[lens, heading]), 3),
        )
        return view, float(worth[lens, heading])

    def _is_seen(self, stand: _Stand, offset: FloatArray, owners: FloatArray) -> BoolArray:
        """(N,) whether nothing stands before each sight; an item does not hide itself."""
        blocks = self._edge_owners[None, :] != owners[:, None]
        shares = _crossings(stand.position_m, offset, self._edges_m)
        if stand.near_m > NEAR_M:  # what lies before the clipping plane hides nothing
            turn = math.radians(float(stand.headings_deg[0]))
            depth = offset @ np.array([math.cos(turn), math.sin(turn)])
            shares = np.where(shares * depth[:, None] > stand.near_m, shares, np.inf)
        seen: BoolArray = np.where(blocks, shares, np.inf).min(axis=1) > 0.999
        return seen

    def _openness(self, stand: _Stand) -> tuple[FloatArray, FloatArray, FloatArray]:
        """How clear each view is, how deep, and how much of it is a door: (K, H) each."""
        bearing = np.radians(_RAYS_DEG)
        directions = np.column_stack([np.cos(bearing), np.sin(bearing)])
        crossed = _crossings(stand.position_m, directions, self._edges_m)
        free_m = np.where(crossed > stand.near_m + 0.02, crossed, np.inf).min(axis=1)
        free_m = np.minimum(free_m, 50.0) - (stand.near_m if stand.near_m > NEAR_M else 0.0)
        crowd = np.clip((_CROWDED_M - free_m) / _CROWDED_M, 0.0, 1.0)
        depth = np.minimum(free_m / math.sqrt(self._area_m2), 1.5) / 1.5
        half_deg = np.degrees(np.arctan(SENSOR_MM[0] / 2 / _LENS_MM))[:, None, None]
        off_deg = _turn_deg(_RAYS_DEG[None, :], stand.headings_deg[:, None])[None]
        share = np.where(off_deg < half_deg, 1.0 - 0.5 * off_deg / half_deg, 0.0)
        share = share / share.sum(axis=2, keepdims=True)
        to_doors = self._doors_m - stand.position_m
        at_deg = np.degrees(np.arctan2(to_doors[:, 1], to_doors[:, 0]))
        wide_deg = np.degrees(_DOOR_M / np.maximum(np.hypot(*to_doors.T), 0.5))
        in_picture = _turn_deg(at_deg[None, :], stand.headings_deg[:, None])[None] < half_deg
        doors = np.minimum(in_picture @ wide_deg / (2.0 * half_deg[..., 0]), 1.0) ** 2
        return 1.0 - _CROWDING * (share @ crowd), share @ depth, doors


# --- where to stand -----------------------------------------------------------------------------


def _inside(
    floor: Polygon, items: Sequence[Item], doors_m: Sequence[FloatArray]
) -> Iterator[_Stand]:
    """Corners of the free floor, middles of its sides, doorways; never inside an item: where there
    is no room between them one leans over the low ones."""
    tall = unary_union([footprint_polygon(i.box) for i in items if _top_m(i) > _BLOCKS_FROM_M])
    everything = unary_union([footprint_polygon(item.box) for item in items])
    for distance_m in _CLEAR_OF_PIECES_M:
        places = _free_places(floor, everything, distance_m, doors_m)
        if len(places):
            break
    else:
        places = _free_places(floor, tall, 0.1, doors_m)
    if not len(places):
        places = np.array([floor.representative_point().coords[0]])
    for place in np.unique(places.round(3), axis=0):
        yield _Stand(place, _HEADINGS_DEG, NEAR_M, 1.0)


def _free_places(
    floor: Polygon, obstacles: BaseGeometry, distance_m: float, doors_m: Sequence[FloatArray]
) -> FloatArray:
    """(N, 2) places this far from obstacles, perhaps none."""
    free = floor.buffer(-min(_FROM_WALL_M, distance_m), join_style="mitre")
    free = free.difference(obstacles.buffer(distance_m, join_style="mitre"))
    places = [np.empty((0, 2))]
    for part in polygons_of(free):
        ring = np.asarray(part.exterior.coords)
        places += [ring[:-1], (ring[:-1] + ring[1:]) / 2]
    if not free.is_empty:
        nearest = [shapely.shortest_line(free, shapely.Point(door)) for door in doors_m]
        places += [np.array(line.coords[:1]) for line in nearest if line.length < 1.0]
    return np.concatenate(places)


def _behind_walls(floor: Polygon, items: Sequence[Item]) -> Iterator[_Stand]:
    """Places before and behind each wall from which one looks straight at the one across."""
    standing = [footprint_polygon(i.box) for i in items if i.box.center_m[2] < 2.0]
    ring = np.asarray(shapely.geometry.polygon.orient(floor).exterior.simplify(0.02).coords)
    for start, end in pairwise(ring):
        length_m = float(np.hypot(*(end - start)))
        if length_m < 1.0:
            continue
        along = (end - start) / length_m
        inwards = np.array([-along[1], along[0]])
        heading = np.array([math.degrees(math.atan2(inwards[1], inwards[0]))])
        for share in (0.3, 0.5, 0.7):
            foot = start + share * (end - start)
            for behind_m in _BEHIND_WALL_M:
                # At the clipping plane the picture is this wide: beyond are other rooms.
                half_m = (behind_m + _CUT_M) * SENSOR_MM[0] / 2 / _LENSES_MM[1][0]
                if share * length_m < half_m or (1.0 - share) * length_m < half_m:
                    break
                ends = (foot - half_m * along, foot + half_m * along)
                strip = Polygon([*ends, ends[1] + 0.5 * inwards, ends[0] + 0.5 * inwards])
                # A piece would be cut open there, or hide the room with its back.
                if not any(strip.intersects(piece) for piece in standing):
                    position, near_m = foot - behind_m * inwards, behind_m + _CUT_M
                    yield _Stand(position, heading, near_m, 1.0 if share == 0.5 else 0.97)


# --- what to see --------------------------------------------------------------------------------


def _floor_points(floor: Polygon) -> FloatArray:
    """(N, 3) points of a grid on the floor."""
    low_x, low_y, high_x, high_y = floor.bounds
    step = math.sqrt(floor.area / _SAMPLES)
    across = np.arange(low_x + step / 2, high_x, step)
    along = np.arange(low_y + step / 2, high_y, step)
    grid = np.stack(np.meshgrid(across, along), axis=-1).reshape(-1, 2)
    grid = grid[shapely.contains_xy(floor, grid)]
    if not len(grid):
        grid = np.array([floor.representative_point().coords[0]])
    return np.column_stack([grid, np.zeros(len(grid))])


def _piece_points(items: Sequence[Item]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(N, 3) points of pieces, their (N,) weights, and the (N,) indices of the pieces."""
    points, weights, owners = [np.empty((0, 3))], [np.empty(0)], [np.empty(0)]
    for index, item in enumerate(items):
        corners = footprint(item.box)
        centre = corners.mean(axis=0)
        spots = np.concatenate([centre + (corners - centre) * 0.9, [centre]])
        height = item.box.center_m[2] + 0.7 * item.box.size_m[2]
        points.append(np.column_stack([spots, np.full(len(spots), height)]))
        # Large pieces weigh more, but a basin counts beside a bath.
        size_m2 = math.sqrt(item.box.size_m[0] * item.box.size_m[1])
        weights.append(np.full(len(spots), size_m2 / len(spots)))
        owners.append(np.full(len(spots), float(index)))
    return np.concatenate(points), np.concatenate(weights), np.concatenate(owners)


def _share_matrix(floor_points: int, piece_weights: FloatArray) -> npt.NDArray[np.float32]:
    """(N, 2) what each point adds to the shares of floor and pieces that are seen."""
    shares = np.zeros((floor_points + len(piece_weights), 2), dtype=np.float32)
    shares[:floor_points, 0] = 1.0 / floor_points
    shares[floor_points:, 1] = piece_weights / max(float(piece_weights.sum()), 1e-9)
    if not len(piece_weights):  # then the floor is all there is to see
        shares[:, 1] = shares[:, 0]
    return shares


def _edges(area: Polygon) -> FloatArray:
    """(E, 2, 2) the sides of an area."""
    rings = [np.asarray(ring.coords)[:, :2] for ring in (area.exterior, *area.interiors)]
    return np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])


def _crossings(position: FloatArray, offset: FloatArray, edges_m: FloatArray) -> FloatArray:
    """(N, E) share of each offset (N, 2) after which it crosses each edge; infinite for never."""
    start, side = edges_m[:, 0] - position, edges_m[:, 1] - edges_m[:, 0]
    across = offset[:, 0, None] * side[None, :, 1] - offset[:, 1, None] * side[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (start[:, 0] * side[:, 1] - start[:, 1] * side[:, 0])[None, :] / across
        along = (
            start[None, :, 0] * offset[:, 1, None] - start[None, :, 1] * offset[:, 0, None]
        ) / across
    hits = (share > 1e-9) & (along >= 0.0) & (along <= 1.0)
    return np.where(hits, share, np.inf)


def _turn_deg(a_deg: FloatArray, b_deg: FloatArray) -> FloatArray:
    """Angle between two directions, [0, 180]."""
    turn: FloatArray = np.abs((a_deg - b_deg + 180.0) % 360.0 - 180.0)
    return turn


def _top_m(item: Item) -> float:
    return item.box.center_m[2] + item.box.size_m[2]
