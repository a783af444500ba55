"""Places near a piece of furniture that it could move to, and whether they are free.

Seen from above; the caller passes what counts as taken. Metres.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np
import numpy.typing as npt
import shapely

from chord_usd.base.metrics.clear_floor import (
    ClearFloor,
    border_sides,
    floor_across,
    has_way,
    is_high_enough,
)
from chord_usd.base.metrics.complete import ESSENTIALS
from chord_usd.base.metrics.design.price import beyond_walls
from chord_usd.base.metrics.design.shell import APART_M, TOUCH_M, Rects, Shell, shells
from chord_usd.base.metrics.fronts import standing_places
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2, overlaps_by_nature
from chord_usd.base.metrics.walk import SEAM_M, WALKER_RADIUS_M, ways_shut
from chord_usd.base.places.wall_frames import WallFrame
from chord_usd.base.scene.geometry import footprint_polygon, polygons_of, to_world
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Box, FloatArray, Item, SceneGraph

_IN_ROOM_M = 1e-3
"""A piece flush with a wall is in its room, whatever was rounded."""


def places_near(box: Box, ways: FloatArray, step_m: float, farthest_m: float) -> Iterator[Box]:
    """Where a piece may go, from near to far.

    ways: (N, 2) directions of length 1 in its own frame; of equal distances the first comes first.
    """
    for step in range(1, round(farthest_m / step_m) + 1):
        distance_m = round(step * step_m, 3)
        for way in ways:
            yield _moved(box, way * distance_m)


def _moved(box: Box, by_m: npt.ArrayLike) -> Box:
    """The box moved by (x, y) of its own frame."""
    x_m, y_m = to_world(box, by_m)
    center_m = (round(float(x_m), 6), round(float(y_m), 6), box.center_m[2])
    return replace(box, center_m=center_m)


class FreePlaces:
    """Floor of a piece's room on which nothing stands that it must not run into."""

    def __init__(
        self,
        box: Box | None,
        floor: shapely.Polygon | None,
        others: Sequence[shapely.Geometry],
        *,
        touch_m2: float,
    ) -> None:
        """box: the piece as it stands; what it stands on of others is no worse for its moving on.
        None for a new piece.

        floor: of its room; None where it may stand anywhere. touch_m2: shapes that share no more
        than this only touch.
        """
        self._floor = floor.buffer(_IN_ROOM_M) if floor else None
        taken = shapely.union_all(others)
        self._taken = taken.difference(footprint_polygon(box)) if box else taken
        self._touch_m2 = touch_m2

    def has(self, box: Box) -> bool:
        """Whether the piece may stand here."""
        shape = footprint_polygon(box)
        if self._floor is not None and not self._floor.covers(shape):
            return False
        return bool(self._taken.intersection(shape).area <= self._touch_m2)


def free_places(
    item: Item,
    floor: shapely.Polygon | None,
    items: Iterable[Item],
    clear: Iterable[ClearFloor],
    *,
    is_new: bool = False,
) -> FreePlaces:
    """Places in an item's room where it is in no other item and before no opening.

    floor: of its room, None where it is in none. items: all of the house; items that overlap it by
    nature do not count. It comes no farther before openings that it stands before; is_new: it
    comes before none.
    """
    others = [
        footprint_polygon(other.box)
        for other in items
        if other.id != item.id and not overlaps_by_nature(item, other)
    ]
    kept_free = [ground for opening, ground in clear if is_high_enough(item, opening)]
    here = None if is_new else item.box
    return FreePlaces(here, floor, [*others, *kept_free], touch_m2=MIN_OVERLAP_M2)


# Which of many boxes stand free in a room, and what an empty room can hold at least: -------------

# anything, its plan makes it a passage.

_STEP_M = 0.1
_WALKED = 12
"""Places of one size that are enough to choose from."""


def free_boxes(shell: Shell, rest: Sequence[Item], boxes: Sequence[Box]) -> list[int]:
    """Numbers of the boxes that stand in none of the pieces that stay, within the room, and before
    no opening; boxes without height stand before any."""
    if not boxes:
        return []
    fresh = Rects.of_boxes(boxes)
    wrong = beyond_walls(fresh.corners, shell) > TOUCH_M
    if rest:
        there = Rects.of_boxes([item.box for item in rest])
        wrong |= (fresh.depths(there) > APART_M).any(axis=1)
    high = np.array([box.center_m[2] + box.size_m[2] for box in boxes])
    blocks = fresh.depths(shell.clear) > TOUCH_M
    wrong |= (blocks & (high[:, None] > shell.clear_from_m + TOUCH_M)).any(axis=1)
    return [int(at) for at in np.flatnonzero(~wrong)]


def first_pieces(graph: SceneGraph, room_id: str) -> Iterator[Item]:
    """Pieces, each alone, that an empty room can hold of what its kind cannot do without, the most
    needed first: of a modest size at a wall, with every way through the room left open."""
    shell = shells(graph.rooms, graph.openings)[room_id]
    for essential in ESSENTIALS.get(shell.kind, ()):
        for name in sorted(essential.categories & CATEGORIES.keys()):
            row = CATEGORIES[name]
            size = (_modest(*row.length_m), _modest(*row.width_m), row.height_m[0])
            boxes = [box for start, end in shell.walls
                     for box in WallFrame.between(start, end).boxes(size, _STEP_M)]  # fmt: skip
            free = free_boxes(shell, (), boxes)
            step = 1 + len(free) // _WALKED
            order = sorted(range(len(free)), key=lambda nth: nth % step)  # evenly first, then all
            pieces = (Item(f"{room_id}/{name}_0", name, boxes[free[nth]], room_id) for nth in order)
            yield from islice(
                (piece for piece in pieces
                 if not ways_shut(SceneGraph(graph.rooms, graph.openings, (piece,)), shell.room)),
                _WALKED,
            )  # fmt: skip


def _modest(least_m: float, most_m: float) -> float:
    """A size that models come in: few are as small as their kind can be."""
    return least_m + (most_m - least_m) / 4


def is_passage(graph: SceneGraph, room_id: str) -> bool:
    """Whether nothing that its kind cannot do without fits into an empty room without shutting one
    of its doors or the way between them."""
    return next(first_pieces(graph, room_id), None) is None


# Where one walks and stands in a house, and whether a thing on the floor leaves that free --------

_AROUND_M = 0.8
"""How far beyond a room one looks."""

_PART_M2 = 0.02
"""Smaller parts of the walkable floor are nothing to walk on."""

_LOST = 0.12
"""Share of the walkable floor near it that one thing may take."""

_COMFORT_M = 0.28
"""Half of a way on which nobody has to turn sideways."""


_SLIM_M = 0.1
"""Half the width of a small robot, which cleans where nobody walks."""


class Borders:
    """Where rooms lie open to each other: a way across each border that has one stays."""

    def __init__(self, graph: SceneGraph) -> None:
        self._taken = [item.box for item in graph.items]
        self._open = [
            [(side, floor_across(side)) for side in sides]
            for sides in border_sides(graph)
            if any(has_way(side, self._taken) for side in sides)
        ]

    def stay_with(self, box: Box) -> bool:
        """Whether ways across all borders stay with a thing here."""
        shape, taken = footprint_polygon(box), [*self._taken, box]
        return all(
            any(has_way(side, taken) for side, _ in sides)
            for sides in self._open
            if any(shape.intersects(floor) for _, floor in sides)
        )

    def take(self, box: Box) -> None:
        """A thing stands there."""
        self._taken.append(box)


class Walkways:
    """The free floor about one room."""

    def __init__(
        self,
        free: shapely.Geometry,
        floor: shapely.Polygon,
        pieces: Iterable[Item],
        borders: Borders,
    ) -> None:
        """free: the floor of the house that nothing stands on. pieces: of the room. borders: of
        the house."""
        self._borders = borders
        self._places = [
            shapely.union_all(places) for item in pieces if (places := standing_places(item))
        ]
        around = floor.buffer(_AROUND_M, join_style="mitre")
        self._free = free.intersection(around)
        self._eroded: dict[float, shapely.Geometry] = {}

    def stay_with(self, box: Box, *, at_ease: bool = True) -> bool:
        """Whether people and small robots reach all that they reached before with a thing here.

        at_ease: people without turning sideways, too.
        """
        shape = footprint_polygon(box)
        radii_m = (_SLIM_M, WALKER_RADIUS_M, *((_COMFORT_M,) if at_ease else ()))
        return self._borders.stay_with(box) and all(self._stays(shape, r) for r in radii_m)

    def _stays(self, shape: shapely.Polygon, radius_m: float) -> bool:
        before = self._walkable(radius_m)
        reach = shape.buffer(radius_m + SEAM_M, quad_segs=2)
        if not reach.intersects(before):
            return True
        after = before.difference(reach)
        if after.area < (1.0 - _LOST) * before.area:
            return False
        near = [place for place in self._places if place.intersects(reach)]
        if any(before.intersects(place) and not after.intersects(place) for place in near):
            return False
        left = _parts(after)
        return all(sum(part.intersects(remnant) for remnant in left) < 2 for part in _parts(before))

    def take(self, box: Box) -> None:
        """Nobody walks there any more."""
        self._borders.take(box)
        self._free = self._free.difference(footprint_polygon(box))
        self._eroded.clear()

    def _walkable(self, radius_m: float) -> shapely.Geometry:
        if radius_m not in self._eroded:
            self._eroded[radius_m] = self._free.buffer(-radius_m - SEAM_M, quad_segs=2)
        return self._eroded[radius_m]


def _parts(area: shapely.Geometry) -> list[shapely.Polygon]:
    return [part for part in polygons_of(area) if part.area > _PART_M2]
