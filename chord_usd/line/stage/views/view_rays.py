"""What one sees from a place in a room: rays in all directions to walls, openings and boxes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.scene.types import ROOM_HEIGHT_M, BoolArray, Box, FloatArray, Opening
from chord_usd.base.scene.units import rotation_2d

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
        shut = [one for one in openings if one.kind == "window" or _is_solid_door(one)]
        self._holes_m = np.array([_line_of(one.box) for one in shut]).reshape(-1, 2, 2)
        self._sills_m = np.array([one.box.center_m[2] for one in shut])
        self._heads_m = self._sills_m + [one.box.size_m[2] for one in shut]
        self._is_window = np.array([one.kind == "window" for one in shut], dtype=bool)

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
        one, other = (-self._halves_m[:, :2] - start) / step, (self._halves_m[:, :2] - start) / step
        low, high = np.minimum(one, other), np.maximum(one, other)
        return np.maximum(low[..., 0], low[..., 1]), np.minimum(high[..., 0], high[..., 1])

    def _between(self, eye_m: float, rise_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(N, B) shares of rises, (N,), from where to where one is as high as each box."""
        base_m = self._middles_m[:, 2] - eye_m
        rise = np.where(np.abs(rise_m) < 1e-9, 1e-9, rise_m)[:, None]
        one, other = base_m / rise, (base_m + 2.0 * self._halves_m[:, 2]) / rise
        return np.minimum(one, other), np.maximum(one, other)

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
