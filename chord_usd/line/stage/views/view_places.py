"""Places from which a room is photographed: in its corners, at its sides, behind its walls."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import footprint_polygon, polygons_of
from chord_usd.base.scene.types import FloatArray, Item, Opening

NEAR_M = 0.05
"""Near clipping plane of a view from inside."""

LOW_M = 1.25
"""Nobody stands over pieces whose top is higher."""

_CLEAR_OF_PIECES_M = (0.4, 0.25, 0.1)
"""How far from furniture to stand; the next one where the first leaves no place."""

_FROM_WALL_M = 0.2
_CUT_M = 0.18
"""What hangs on the wall that one looks through (curtains, pictures) is cut away with it."""

_HIGH_M = 2.0
"""What hangs higher is over the picture where it begins."""

_BEYOND_PIECE_M = 0.06
_UNCUT_M = 0.05
_BEFORE_CUT_M = 0.3
"""Nothing stands so near behind the clipping plane."""

_DEEPEST_CUT_M = 0.75
"""Deeper pieces at the wall that one looks through are not cut away with it."""

_FAR_M = 50.0
_HALF_WIDTH = 0.65
"""Half of what a view through the longest lens holds, by its distance."""


@dataclass(frozen=True)
class Effort:
    """How many places of a room are tried."""

    inside: int
    """At most so many."""
    walls: int
    """The longest; behind these."""
    shares: tuple[float, ...]
    """Of a wall's length, from its beginning."""
    behind_m: tuple[float, ...]
    """How far behind a wall to stand."""


THOROUGH = Effort(200, 40, (0.3, 0.4, 0.5, 0.6, 0.7), (0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8))
QUICK = Effort(16, 8, (0.5,), (0.0, 0.6, 1.5))
"""For buildings of many rooms, whose views are the larger part of the time."""


@dataclass(frozen=True)
class Stand:
    """A place for the camera."""

    position_m: FloatArray
    near_m: float = NEAR_M
    heading_deg: float | None = None
    """Where one looks from behind a wall; None where one may look around."""
    beside_m: float = math.inf
    """Half of the width that the picture may have at the clipping plane: beyond are other rooms."""
    worth: float = 1.0

    @property
    def is_behind_wall(self) -> bool:
        """Whether what is nearer than a clipping plane is cut away."""
        return self.heading_deg is not None


def stands(
    floor: Polygon, things: Sequence[Item], openings: Sequence[Opening], effort: Effort = THOROUGH
) -> Iterator[Stand]:
    """The places that are tried, the same ones for the same room.

    things: furniture, and whatever else stands in the room or hangs in it.
    """
    doors = [opening for opening in openings if opening.kind != "window"]
    standing = [item for item in things if item.box.center_m[2] < 0.1]
    yield from _inside(floor, standing, doors, effort.inside)
    yield from _behind_walls(floor, things, effort)


def _inside(
    floor: Polygon, items: Sequence[Item], doors: Sequence[Opening], most: int
) -> Iterator[Stand]:
    """Corners of the free floor, middles of its sides, doorways; never inside an item: where there
    is no room between them one leans over the low ones."""
    tall = unary_union([footprint_polygon(i.box) for i in items if i.box.top_m > LOW_M])
    everything = unary_union([footprint_polygon(item.box) for item in items])
    middles = [shapely.Point(door.box.center_m[:2]) for door in doors]
    for distance_m in _CLEAR_OF_PIECES_M:
        places = _free_places(floor, everything, distance_m, middles)
        if len(places):
            break
    else:
        places = _free_places(floor, tall, 0.1, middles)
    if not len(places):
        places = np.array([floor.representative_point().coords[0]])
    places = np.unique(places.round(3), axis=0)
    for place in places[:: -(-len(places) // most)]:
        yield Stand(place)


def _free_places(
    floor: Polygon,
    obstacles: BaseGeometry,
    distance_m: float,
    doors: Sequence[shapely.Point],
) -> FloatArray:
    """(N, 2) places this far from obstacles, perhaps none."""
    free = floor.buffer(-min(_FROM_WALL_M, distance_m), join_style="mitre")
    free = free.difference(obstacles.buffer(distance_m, join_style="mitre"))
    places = [np.empty((0, 2))]
    for part in polygons_of(free):
        ring = np.asarray(part.exterior.coords)
        places += [ring[:-1], (ring[:-1] + ring[1:]) / 2]
    if not free.is_empty:
        nearest = [shapely.shortest_line(free, door) for door in doors]
        places += [np.array(line.coords[:1]) for line in nearest if line.length < 1.0]
    return np.concatenate(places)


def _behind_walls(floor: Polygon, things: Sequence[Item], effort: Effort) -> Iterator[Stand]:
    """Places before and behind each wall from which one looks straight at the one across."""
    standing = np.array(
        [footprint_polygon(item.box) for item in things if item.box.center_m[2] < _HIGH_M],
        dtype=object,
    )
    clear = floor.difference(unary_union([piece.buffer(_UNCUT_M) for piece in standing]))
    ring = np.asarray(shapely.geometry.polygon.orient(floor).exterior.simplify(0.02).coords)
    lengths_m = np.hypot(*np.diff(ring, axis=0).T)
    longest = np.sort(np.argsort(-lengths_m, kind="stable")[: effort.walls])
    for wall in longest.tolist():
        start, end, length_m = ring[wall], ring[wall + 1], float(lengths_m[wall])
        if length_m < 0.8:
            continue
        along = (end - start) / length_m
        inwards = np.array([-along[1], along[0]])
        heading_deg = math.degrees(math.atan2(inwards[1], inwards[0]))
        cuts = _Cuts(along, inwards, standing, clear)
        for share in effort.shares:
            foot = start + share * (end - start)
            worth = 1.0 if share == 0.5 else 0.97
            for behind_m, cut_m, beside_m in cuts.at(foot, effort.behind_m):
                position, near_m = foot - behind_m * inwards, behind_m + cut_m
                yield Stand(position, near_m, heading_deg, beside_m, worth)


@dataclass(frozen=True, eq=False)
class _Cuts:
    """How much is cut away with a wall that one looks through."""

    along: FloatArray
    """(2,) unit vector of the wall."""
    inwards: FloatArray
    """(2,) unit vector into the room."""
    standing: npt.NDArray[np.object_]
    """Footprints."""
    clear: BaseGeometry
    """The floor beside these."""

    def at(
        self, foot: FloatArray, behind_m: Sequence[float]
    ) -> Iterator[tuple[float, float, float]]:
        """Of distances behind a point of the wall, those from which one sees in: each with the
        depth that is cut away, and with how far clear floor goes on to both sides there."""
        halves_m = [(own_m + _CUT_M) * _HALF_WIDTH for own_m in behind_m]
        beside: dict[float, float] = {}
        for own_m, half_m, cut_m in zip(
            behind_m, halves_m, self._cuts_m(foot, halves_m), strict=True
        ):
            if cut_m is None:
                continue
            if cut_m not in beside:
                beside[cut_m] = self._beside_m(foot + cut_m * self.inwards)
            if half_m <= beside[cut_m]:
                yield own_m, cut_m, beside[cut_m]

    def _beside_m(self, middle: FloatArray) -> float:
        """How far clear floor goes on to both sides of a point, at least."""
        line = shapely.LineString([middle - _FAR_M * self.along, middle + _FAR_M * self.along])
        return float(line.difference(self.clear).distance(shapely.Point(middle)))

    def _cuts_m(self, foot: FloatArray, halves_m: Sequence[float]) -> list[float | None]:
        """How much is cut away for each half width: what stands there whole; None where that is
        too much."""
        cuts_m: list[float | None] = [None] * len(halves_m)
        tried_m = dict.fromkeys(range(len(halves_m)), _CUT_M)
        for _ in range(3):
            strips = [self._strip(foot, halves_m[nth], cut_m) for nth, cut_m in tried_m.items()]
            meets = shapely.intersects(shapely.polygons(strips)[:, None], self.standing[None])
            for nth, met in zip(list(tried_m), meets, strict=True):
                cut_m = tried_m.pop(nth)
                if not met.any():
                    cuts_m[nth] = cut_m
                    continue
                corners = shapely.get_coordinates(self.standing[met])
                cut_m = float(((corners - foot) @ self.inwards).max()) + _BEYOND_PIECE_M
                if cut_m <= _DEEPEST_CUT_M:
                    tried_m[nth] = cut_m
            if not tried_m:
                break
        return cuts_m

    def _strip(self, foot: FloatArray, half_m: float, cut_m: float) -> FloatArray:
        """(4, 2) where nothing may stand."""
        ends = (foot - half_m * self.along, foot + half_m * self.along)
        near, far = cut_m * self.inwards, (cut_m + _BEFORE_CUT_M) * self.inwards
        return np.array([ends[0] + near, ends[1] + near, ends[1] + far, ends[0] + far])
