"""The walls between rooms, and the openings in them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import WALL_THICKNESS_M, BoolArray, FloatArray, Room

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
        own = self._room[nearest]
        behind = self._is_behind(center_m + outward * 0.75 * WALL_THICKNESS_M)
        order = dict.fromkeys(int(room) for room in self._room[near])
        joined = [self.rooms[room].id for room in order if room == own or behind[room]]
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
