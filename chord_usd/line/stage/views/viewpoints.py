"""Which view of a room a photographer would take: where to stand, where to look, how to shift.

Plane geometry and boxes only. A view stands either inside the room, by preference in a corner, or
behind one of its walls, which then lies before the near clipping plane: so small rooms are seen
through a lens that does not stretch them. Views are judged by how much of the floor they hold and
how many pieces whole, by how openly they look into the room, and by what fills the picture: walls
and things close to the lens, and doors, are nothing to look at; windows are.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon

from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.types import ROOM_HEIGHT_M, BoolArray, Box, FloatArray, Item, Opening
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.views.view_places import NEAR_M, THOROUGH, Effort, Stand, stands

EYE_M = 1.5
SENSOR_MM = (36.0, 20.25)
"""Width and height: a full-frame sensor cut to 16 : 9."""

_LENSES_MM = ((28.0, 1.0), (24.0, 1.0), (20.0, 0.88))
"""What a photographer of interiors has with them, and what a view through it is worth: wider
lenses stretch what is near the edges."""

_SHIFTS_MM = ((-2.4, 1.0), (-3.6, 1.0), (-5.0, 0.97), (-6.5, 0.93), (-8.0, 0.87))
"""How far the lens may be shifted, as architecture is photographed, and what a view is worth then.
A shift shows more floor and less ceiling while verticals stay straight; much of it looks steep."""

_HIDES_FROM_M = 1.25
"""Items whose top is higher hide the floor behind them; past others one still sees it."""

_ENOUGH_FLOOR = 0.7
"""Share of the floor in the picture from which on more of it is worth nothing."""

_ENOUGH_FLOOR_M2 = 16.0
"""The same, of a room where that is less: nobody steps back to show all of a hall."""

_FLOOR_WORTH = 1.8
_PIECES_WORTH = 1.6
_DEPTH_WORTH = 0.5
_WINDOW_SHARE, _WINDOW_WORTH = 0.1, 1.0
"""Share of the picture from which on more of a window is worth nothing, and what that is worth."""

_FULL_SHARE, _FULL_WORTH = 0.4, 1.0
"""Share of the picture from which on more of things is worth nothing, and what that is worth."""

_ASIDE = 0.3
"""Share of its worth that a piece loses at the edge of the picture."""

_TALL_M, _TALL_WORTH = 1.7, 0.5
"""Wardrobes, refrigerators, showers are large, but little to look at."""

_CROWDING = 0.8
"""Share of its worth that a view loses when all of it is crowded."""

_CROWDED_M = 1.4
"""Walls and tall pieces nearer than this crowd the picture."""

_CLOSE_M = 1.1
"""What is nearer stands before the view."""

_CLOSE_SHARE, _CLOSE_COST = 0.08, 2.5
_DOOR_SHARE, _DOOR_COST = 0.05, 1.5
"""Shares of the picture that close things and doors may fill, and what more of them costs."""

_LENS_MM = np.array([lens for lens, _ in _LENSES_MM for _ in _SHIFTS_MM])
_SHIFT_MM = np.array([shift for _ in _LENSES_MM for shift, _ in _SHIFTS_MM])
_WORTH = np.array([lens * shift for _, lens in _LENSES_MM for _, shift in _SHIFTS_MM])
"""(K,) of each lens with each shift."""

_WITHIN = 0.92
"""Points so far out from the middle of a piece stand for it."""

MOST_PIECES, MOST_BOXES = 64, 256
"""Of a room: the largest are what a view is judged by, and what hides others. Each place compares
all points of the pieces with all boxes, so that a store of thousands would never be through."""

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


def choose_view(
    floor: Polygon,
    items: Sequence[Item],
    openings: Sequence[Opening] = (),
    dressing: Sequence[Item] = (),
    effort: Effort = THOROUGH,
) -> View:
    """The view that shows most of a room's floor and furniture.

    openings: doors, passages and windows of the room. dressing: what nobody comes to see, but
    what may stand or hang before the lens. effort: how many places are tried. The same room always
    has the same view.
    """
    room = _Room(floor, items, openings, dressing)
    best, most = View((0.0, 0.0), 0.0, 24.0, _SHIFTS_MM[0][0]), -math.inf
    sights = [room.sight(stand) for stand in stands(floor, [*items, *dressing], openings, effort)]
    # What fills the picture takes longer to find: only where what is shown is worth more yet.
    for sight in sorted(sights, key=lambda sight: -sight.at_most):
        if sight.at_most <= most:
            break
        candidate = room.best(sight)
        if candidate[1] > most:
            best, most = candidate
    return best


@dataclass(frozen=True, eq=False)
class _Sight:
    """What a place shows through K lenses in H directions."""

    stand: Stand
    floor: FloatArray
    """(K, H) share of the floor."""
    worth: FloatArray
    """(K, H) of floor and pieces; infinitely little for a lens that sees other rooms."""
    at_most: float
    """No view from here is worth more."""


class _Room:
    """What there is to see, and what stands before it."""

    def __init__(
        self,
        floor: Polygon,
        items: Sequence[Item],
        openings: Sequence[Opening],
        dressing: Sequence[Item],
    ) -> None:
        self._side_m = math.sqrt(floor.area)
        self._enough = min(_ENOUGH_FLOOR, _ENOUGH_FLOOR_M2 / max(floor.area, 1e-6))
        self._floor_m = _floor_points(floor)
        items, dressing = _largest(items, MOST_PIECES), _largest(dressing, MOST_BOXES - MOST_PIECES)
        self._pieces_m, self._owners, self._weights = _piece_points(items)
        things = [*items, *dressing]
        self._all = Surroundings(floor, [item.box for item in things], openings)
        tall = [item.box for item in things if item.box.top_m > _HIDES_FROM_M]
        self._tall = Surroundings(floor, tall, ())

    def sight(self, stand: Stand) -> _Sight:
        """Floor and pieces seen from a place."""
        floor, pieces = self._shown(stand)
        worth = _FLOOR_WORTH * np.minimum(floor / self._enough, 1.0) + _PIECES_WORTH * pieces
        if stand.is_behind_wall:
            fits = stand.near_m * SENSOR_MM[0] / 2 / _LENS_MM <= stand.beside_m
            worth = np.where(fits[:, None], worth, -np.inf)
        more = _WINDOW_WORTH * _WINDOW_SHARE + _FULL_WORTH * _FULL_SHARE + _DEPTH_WORTH
        at_most = float(((worth + more) * _WORTH[:, None] * stand.worth).max())
        return _Sight(stand, floor, worth, at_most)

    def best(self, sight: _Sight) -> tuple[View, float]:
        """The best view from a place, and its worth."""
        stand = sight.stand
        crowd, deep, close, full, door, window = self._filling(stand)
        worth = sight.worth + _WINDOW_WORTH * np.minimum(window, _WINDOW_SHARE)
        worth = worth + _FULL_WORTH * np.minimum(full, _FULL_SHARE)
        worth = (worth + _DEPTH_WORTH * deep) * (1.0 - _CROWDING * crowd)
        worth = worth * _WORTH[:, None] * stand.worth
        worth = worth - _CLOSE_COST * np.maximum(close - _CLOSE_SHARE, 0.0)
        worth = (worth - _DOOR_COST * np.maximum(door - _DOOR_SHARE, 0.0)).round(5)
        lens, heading = np.unravel_index(int(np.argmax(worth)), worth.shape)
        x, y = (round(float(value), 3) for value in stand.position_m)
        view = View(
            position_m=(x, y),
            yaw_deg=round(float(TURNS_DEG[heading] + (stand.heading_deg or 0.0)), 3),
            lens_mm=float(_LENS_MM[lens]),
            shift_mm=float(_SHIFT_MM[lens]),
            near_m=round(stand.near_m, 3),
            floor_share=round(float(sight.floor[lens, heading]), 3),
        )
        return view, float(worth[lens, heading])

    def _filling(self, stand: Stand) -> FloatArray:
        """(6, K, H) how crowded pictures are, how deep, their shares of what is close, of things,
        of doors and of windows."""
        eye_m = np.array([*stand.position_m, EYE_M])
        free_m, at_door, at_window, is_box = self._all.panorama(
            eye_m, stand.heading_deg or 0.0, stand.near_m
        )
        begins_m = stand.near_m if stand.is_behind_wall else 0.0
        features = np.stack(
            [
                np.clip((_CROWDED_M - free_m) / _CROWDED_M, 0.0, 1.0),
                np.minimum((free_m - begins_m) / self._side_m, 1.5) / 1.5,
                (free_m < _CLOSE_M) & is_box,
                is_box,
                at_door,
                at_window,
            ]
        ).reshape(6, -1)
        headings = slice(0, 1) if stand.is_behind_wall else slice(None)
        shares = _weights()[:, headings] @ features.T.astype(np.float32)
        return np.moveaxis(shares, 2, 0)

    def _shown(self, stand: Stand) -> tuple[FloatArray, FloatArray]:
        """(K, H) shares of the floor and of the pieces, each of which counts less in part."""
        eye_m = np.array([*stand.position_m, EYE_M])
        sights = np.concatenate([self._floor_m, self._pieces_m]) - eye_m
        seen = self._is_seen(stand, eye_m, sights)
        floor_points = len(self._floor_m)
        in_sight = sights[:floor_points][seen[:floor_points]]
        shown, _ = _in_pictures(stand, in_sight)
        floor = np.count_nonzero(shown, axis=2) / floor_points
        if not len(self._weights):  # then the floor is all there is to see
            return floor, floor
        of_pieces = seen[floor_points:].reshape(len(self._weights), -1)
        some = of_pieces.any(axis=1)
        points = sights[floor_points:].reshape(*of_pieces.shape, 3)[some].reshape(-1, 3)
        shown, aside = _in_pictures(stand, points)
        shown &= of_pieces[some].reshape(-1)
        # What is at the edge is there, but the picture is not of it.
        worth = np.where(shown, 1.0 - _ASIDE * aside, 0.0)
        shares = np.zeros((*shown.shape[:2], len(some)))
        shares[..., some] = worth.reshape(*shown.shape[:2], -1, of_pieces.shape[1]).mean(axis=3)
        return floor, (shares**1.5) @ self._weights

    def _is_seen(self, stand: Stand, eye_m: FloatArray, sights: FloatArray) -> BoolArray:
        """(N,) whether nothing stands before each sight; an item does not hide itself."""
        count = len(self._floor_m)
        begins = np.zeros(len(sights))
        if stand.heading_deg is not None:  # what lies before the clipping plane hides nothing
            turn = math.radians(stand.heading_deg)
            depth = sights[:, :2] @ np.array([math.cos(turn), math.sin(turn)])
            begins = stand.near_m / np.maximum(depth, 1e-6)
        walls = self._all.walls_at(eye_m[:2], sights[:, :2], begins)
        floors = self._tall.boxes_at(eye_m, sights[:count])
        pieces = self._all.boxes_at(eye_m, sights[count:])
        pieces[np.arange(len(pieces)), self._owners] = np.inf
        first = [
            np.where(boxes > start[:, None], boxes, np.inf).min(axis=1, initial=np.inf)
            for boxes, start in ((floors, begins[:count]), (pieces, begins[count:]))
        ]
        seen: BoolArray = np.minimum(walls, np.concatenate(first)) > 0.98
        return seen


def _in_pictures(stand: Stand, sights: FloatArray) -> tuple[BoolArray, FloatArray]:
    """(K, H, N) whether each sight, (N, 3), is in the picture of each lens in each direction, and
    how far from the middle of the picture to its edge."""
    turns = [stand.heading_deg] if stand.heading_deg is not None else TURNS_DEG
    turn = np.radians(turns)
    depth = np.outer(np.cos(turn), sights[:, 0]) + np.outer(np.sin(turn), sights[:, 1])
    across = np.outer(-np.sin(turn), sights[:, 0]) + np.outer(np.cos(turn), sights[:, 1])
    ahead = np.where(depth > stand.near_m, depth, np.nan)
    lens_mm = np.array([lens for lens, _ in _LENSES_MM])[:, None, None, None]
    shift_mm = np.array([shift for shift, _ in _SHIFTS_MM])[:, None, None]
    with np.errstate(invalid="ignore"):
        beside, above = np.abs(across / ahead), sights[:, 2] / ahead
        in_width = beside < SENSOR_MM[0] / 2 / lens_mm
        upright = np.abs(above * lens_mm - shift_mm) < SENSOR_MM[1] / 2
    shown = (in_width & upright).reshape(len(_LENS_MM), *depth.shape)
    aside = np.repeat(beside * lens_mm / (SENSOR_MM[0] / 2), len(_SHIFTS_MM), axis=1)
    return shown, aside.reshape(shown.shape)


def _largest(items: Sequence[Item], count: int) -> list[Item]:
    """The largest items, in their order."""
    sizes = np.array([math.prod(item.box.size_m) for item in items])
    return [items[index] for index in np.sort(np.argsort(-sizes, kind="stable")[:count])]


@cache
def _weights() -> npt.NDArray[np.float32]:
    """Share of each picture that each ray stands for."""
    return picture_weights(_LENS_MM, _SHIFT_MM, SENSOR_MM).astype(np.float32)


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


def _piece_points(items: Sequence[Item]) -> tuple[FloatArray, npt.NDArray[np.intp], FloatArray]:
    """(P * 9, 3) corners and tops of pieces, the (P * 9,) indices of the pieces, and their (P,)
    weights, which sum to 1."""
    points, weights = [np.empty((0, 3))], []
    for item in items:
        corners = footprint(item.box)
        centre = corners.mean(axis=0)
        corners = centre + (corners - centre) * _WITHIN
        base_m, height_m = item.box.center_m[2], item.box.size_m[2]
        low = np.column_stack([corners, np.full(4, base_m + (1.0 - _WITHIN) * height_m)])
        high = np.column_stack([corners, np.full(4, base_m + _WITHIN * height_m)])
        points += [low, high, np.array([[*centre, base_m + height_m]])]
        # Large pieces weigh more, but a basin counts beside a bath.
        weight = math.sqrt(item.box.size_m[0] * item.box.size_m[1])
        weights.append(weight * (_TALL_WORTH if height_m > _TALL_M else 1.0))
    owners = np.repeat(np.arange(len(items)), 9)
    return np.concatenate(points), owners, np.array(weights) / max(sum(weights), 1e-9)


# What one sees from a place in a room: rays in all directions to walls, openings and -------------

TURNS_DEG = np.arange(0.0, 360.0, 7.5)
RISES = np.arange(-1.4, 1.0, 0.2) + 0.1
"""Tangents of the elevation of rays."""

_AT_HOLE_M = 0.4
"""The face of a wall is no farther than this from the middle of its openings, along a sight."""

_GLASS_FROM_M = 1.4
"""Wider doors are of glass."""


class Surroundings:
    """The walls, openings and boxes of a room. Boxes stand upright at any height."""

    def __init__(self, floor: Polygon, boxes: Sequence[Box], openings: Sequence[Opening]) -> None:
        self._walls_m = _edges(floor)
        self._middles_m = np.array([box.center_m for box in boxes]).reshape(-1, 3)
        self._halves_m = np.array([box.size_m for box in boxes]).reshape(-1, 3) / 2
        self._turns = np.array([rotation_2d(box.yaw_deg) for box in boxes]).reshape(-1, 2, 2)
        shut = [
            opening for opening in openings if opening.kind == "window" or _is_solid_door(opening)
        ]
        self._holes_m = np.array([_line_of(opening.box) for opening in shut]).reshape(-1, 2, 2)
        self._sills_m = np.array([opening.box.center_m[2] for opening in shut])
        self._heads_m = self._sills_m + [opening.box.size_m[2] for opening in shut]
        self._is_window = np.array([opening.kind == "window" for opening in shut], dtype=bool)

    def walls_at(
        self, position_m: FloatArray, offset_m: FloatArray, begins: FloatArray | float = 0.0
    ) -> FloatArray:
        """(N,) share of each offset, (N, 2), after which it meets a wall; infinite for never.

        begins: share up to which there is none.
        """
        shares = _crossings(position_m, offset_m, self._walls_m)
        starts = np.broadcast_to(begins, len(offset_m))[:, None]
        nearest: FloatArray = np.where(shares > starts, shares, np.inf).min(axis=1)
        return nearest

    def boxes_at(self, eye_m: FloatArray, offset_m: FloatArray) -> FloatArray:
        """(N, B) share of each offset, (N, 3), after which it meets each box; infinite for never.

        Zero for a box that one is in.
        """
        enters, leaves = self._over(eye_m[:2], offset_m[:, :2])
        low, high = self._between(eye_m[2], offset_m[:, 2])
        return _met(np.maximum(enters, low), np.minimum(leaves, high))

    def _over(self, position_m: FloatArray, offset_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(N, B) shares of offsets, (N, 2), from where to where one is over each box."""
        start = np.squeeze((position_m - self._middles_m[:, :2])[:, None] @ self._turns, axis=1)
        step = np.moveaxis(offset_m @ self._turns, 0, 1)
        step = np.where(np.abs(step) < 1e-9, 1e-9, step)
        first, second = (
            (-self._halves_m[:, :2] - start) / step,
            (self._halves_m[:, :2] - start) / step,
        )
        low, high = np.minimum(first, second), np.maximum(first, second)
        return np.maximum(low[..., 0], low[..., 1]), np.minimum(high[..., 0], high[..., 1])

    def _between(self, eye_m: float, rise_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(N, B) shares of rises, (N,), from where to where one is as high as each box."""
        base_m = self._middles_m[:, 2] - eye_m
        rise = np.where(np.abs(rise_m) < 1e-9, 1e-9, rise_m)[:, None]
        first, second = base_m / rise, (base_m + 2.0 * self._halves_m[:, 2]) / rise
        return np.minimum(first, second), np.maximum(first, second)

    def panorama(
        self, eye_m: FloatArray, turn_deg: float, near_m: float
    ) -> tuple[FloatArray, BoolArray, BoolArray, BoolArray]:
        """Of rays in all directions, each (T, R): how far one sees, metres seen from above, and
        whether that is where a door is, a window, or a box.

        turn_deg: heading of the first. near_m: from where on things are seen.
        """
        turns = np.radians(TURNS_DEG + turn_deg)
        level = np.column_stack([np.cos(turns), np.sin(turns)])
        walls = self.walls_at(eye_m[:2], level, near_m + 0.02)
        ends = np.where(RISES > 0.0, ROOM_HEIGHT_M - eye_m[2], -eye_m[2]) / RISES
        far = np.minimum(walls[:, None], ends)
        enters, leaves = self._over(eye_m[:2], level)
        low, high = self._between(eye_m[2], RISES)
        boxes = _met(np.maximum(enters[:, None], low), np.minimum(leaves[:, None], high))
        first = np.where(boxes > near_m, boxes, np.inf).min(axis=2, initial=np.inf)
        at_door, at_window = self._at_openings(eye_m, level, walls)
        is_wall = (ends >= walls[:, None]) & (first > walls[:, None])
        return np.minimum(far, first), at_door & is_wall, at_window & is_wall, first < far

    def _at_openings(
        self, eye_m: FloatArray, level: FloatArray, walls: FloatArray
    ) -> tuple[BoolArray, BoolArray]:
        """(T, R) whether a wall is met where a door is, and where a window is."""
        crossed = _crossings(eye_m[:2], level, self._holes_m)
        near = (crossed > walls[:, None] - _AT_HOLE_M) & (crossed < walls[:, None] + _AT_HOLE_M)
        heights = eye_m[2] + RISES * np.minimum(walls, 100.0)[:, None]
        is_at = near[:, None] & (heights[..., None] > self._sills_m)
        is_at &= heights[..., None] < self._heads_m
        return is_at[..., ~self._is_window].any(axis=2), is_at[..., self._is_window].any(axis=2)


def _is_solid_door(opening: Opening) -> bool:
    return opening.kind == "door" and opening.box.size_m[0] < _GLASS_FROM_M


def _met(enters: FloatArray, leaves: FloatArray) -> FloatArray:
    """Share after which one is in a box; infinite for never, zero for at once."""
    return np.where((enters < leaves) & (leaves > 0.0), np.maximum(enters, 0.0), np.inf)


def _edges(area: Polygon) -> FloatArray:
    """(E, 2, 2) the sides of an area."""
    rings = [np.asarray(ring.coords)[:, :2] for ring in (area.exterior, *area.interiors)]
    return np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])


def _line_of(box: Box) -> FloatArray:
    """(2, 2) the ends of an opening, seen from above."""
    half = rotation_2d(box.yaw_deg)[:, 0] * box.size_m[0] / 2
    middle = np.array(box.center_m[:2])
    return np.array([middle - half, middle + half])


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


def picture_weights(
    lens_mm: FloatArray, shift_mm: FloatArray, sensor_mm: tuple[float, float]
) -> FloatArray:
    """(K, H, T * R) share of each picture that each ray stands for: K lenses, H headings."""
    off = np.radians(TURNS_DEG[None, :] - TURNS_DEG[:, None])
    ahead = np.cos(off)[:, :, None]
    with np.errstate(divide="ignore"):
        across = np.abs(np.tan(off))[:, :, None]
        up = RISES[None, None, :] / ahead
        size = np.where(ahead > 0.2, 1.0 / ahead**3, 0.0)
    lens, shift = lens_mm[:, None, None, None], shift_mm[:, None, None, None]
    inside = (ahead > 0.2) & (across * lens < sensor_mm[0] / 2)
    inside = inside & (np.abs(up * lens - shift) < sensor_mm[1] / 2)
    weights = np.where(inside, size, 0.0)
    weights /= weights.sum(axis=(2, 3), keepdims=True)
    return weights.reshape(len(lens_mm), len(TURNS_DEG), -1)
