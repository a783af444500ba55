"""Balconies: where their outer walls open onto a railing, and the railing.

A plan draws balconies with walls all round. One with windows in its outer walls is glazed and keeps
them; any other is open: between pillars its outer walls are a kerb with a railing on it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import Floors, footprint_polygon, room_polygon, room_sides
from chord_usd.base.scene.types import WALL_THICKNESS_M, Box, FloatArray, Opening, Room
from chord_usd.line.stage.shell.mesh import Face, cuboid

KERB_M = 0.12
"""Height of what is left of the wall under a railing."""

RAIL_M = 1.05
"""Height of the hand rail over the floor."""

_PILLAR_M = 0.2
"""What is left of the wall at either end."""

_LEAST_M = 0.8
"""Shorter stretches stay wall."""

_BESIDE_M = 0.1
"""Wall that stays beside a door."""

_OUT_M = 0.05
"""Beyond a wall nothing may stand for this far, if it is to be an outer wall."""

_HAND_M = (0.06, 0.035)
"""Width and height of the hand rail; the lower rail is as high and half as wide."""

_BAR_M = 0.014
_BARS_EACH_M = 0.11
"""From bar to bar: no more than a child's head."""


def gaps_for_railings(
    rooms: Sequence[Room], openings: Sequence[Opening], height_m: float
) -> Iterator[tuple[int, Opening]]:
    """Index of a balcony, and a hole in one of its outer walls, up to height_m over the floor."""
    house = shapely.STRtree([room_polygon(room).buffer(WALL_THICKNESS_M) for room in rooms])
    taken = shapely.STRtree(
        [footprint_polygon(opening.box).buffer(_BESIDE_M) for opening in openings]
    )
    floors = Floors(rooms)
    windows = [footprint_polygon(opening.box) for opening in openings if opening.kind == "window"]
    panes = shapely.STRtree(windows)
    for index, room in enumerate(rooms):
        if room.kind == "balcony" and not _is_glazed(index, floors, panes):
            for side, (start, end) in enumerate(room_sides(room)):
                yield from (
                    (index, _gap(f"{room.id}/railing_{side}_{part}", piece, height_m))
                    for part, piece in enumerate(_outer_stretches(start, end, house, taken))
                )


def _is_glazed(index: int, floors: Floors, windows: shapely.STRtree) -> bool:
    """Whether there is a window between a balcony and the open air."""
    wall = floors.polygons[index].buffer(WALL_THICKNESS_M)
    for window in windows.geometries[windows.query(wall, predicate="intersects")]:
        around = window.buffer(WALL_THICKNESS_M)
        others = [floors.polygons[other] for other in floors.near(around) if other != index]
        if all(window.distance(other) > WALL_THICKNESS_M / 2 for other in others):
            return True
    return False


def _outer_stretches(
    start: FloatArray, end: FloatArray, house: shapely.STRtree, taken: shapely.STRtree
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """The parts of a side of a room with nothing but air beyond its wall, less the pillars."""
    length = float(np.hypot(*(end - start)))
    if length < _LEAST_M:
        return
    along = (end - start) / length
    out = np.array([along[1], -along[0]])  # rooms run counter-clockwise
    far = LineString([start, end] + out * (WALL_THICKNESS_M + _OUT_M))
    for piece in shapely.get_parts(_less(far, house)):
        near = shapely.transform(piece, lambda at: at - out * (WALL_THICKNESS_M + _OUT_M))
        for free in shapely.get_parts(_less(near, taken)):
            if free.length >= _LEAST_M + 2 * _PILLAR_M:
                first, last = np.asarray(free.coords)[[0, -1]]
                yield first + along * _PILLAR_M, last - along * _PILLAR_M


def _less(line: BaseGeometry, areas: shapely.STRtree) -> BaseGeometry:
    """What of a line lies in none of the areas."""
    return line.difference(unary_union(areas.geometries[areas.query(line)]))


def _gap(name: str, stretch: tuple[FloatArray, FloatArray], height_m: float) -> Opening:
    start, end = stretch
    along = end - start
    length = float(np.hypot(*along))
    out = np.array([along[1], -along[0]]) / length
    x_m, y_m = (start + end) / 2 + out * WALL_THICKNESS_M / 2
    yaw_deg = float(np.degrees(np.arctan2(along[1], along[0])))
    size_m = (length, WALL_THICKNESS_M, height_m - KERB_M)
    return Opening(name, "window", Box((float(x_m), float(y_m), KERB_M), size_m, yaw_deg))


def railing_faces(left_m: float, right_m: float, middle_m: float) -> list[Face]:
    """Two rails and the bars between them, in the frame of a gap whose sill is the kerb.

    left_m, right_m: the ends along x. middle_m: y of the railing's axis.
    """
    wide, high = _HAND_M
    top = RAIL_M - KERB_M
    faces = cuboid((left_m, middle_m - wide / 2, top - high), (right_m, middle_m + wide / 2, top))
    low = (left_m, middle_m - wide / 4, high), (right_m, middle_m + wide / 4, 2 * high)
    faces += cuboid(*low)
    count = max(1, int((right_m - left_m) / _BARS_EACH_M))
    for x in np.linspace(left_m, right_m, count + 2)[1:-1]:
        corner = (x - _BAR_M / 2, middle_m - _BAR_M / 2, 2 * high - 0.005)
        faces += cuboid(corner, (x + _BAR_M / 2, middle_m + _BAR_M / 2, top - high + 0.005))
    return faces


def railing_box(left_m: float, right_m: float, middle_m: float) -> Box:
    """What stops a fall, in the same frame."""
    size_m = (right_m - left_m, _HAND_M[0], RAIL_M - KERB_M)
    return Box(((left_m + right_m) / 2, middle_m, 0.0), size_m, 0.0)
