"""Whether what is used can be reached, and stood before: fronts of furniture.

A front is free where at least half of the strip before it is, and a walker can stand before it on
floor that hangs together with a way into the room. Beds are got into from any side but the head.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely

from chord_usd.base.metrics.footprints import GRID_M
from chord_usd.base.metrics.walk import (
    SEAM_M,
    WALKER_RADIUS_M,
    free_floor,
    left_free,
    takes_floor,
    walkable_parts,
)
from chord_usd.base.scene.geometry import (
    footprint_polygon,
    hanging_together,
    in_world,
    room_polygon,
)
from chord_usd.base.scene.palette import CATEGORIES, Side, having
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph

FRONT: Side = (0, -1)
USED_SIDES = {row.name: row.used_from for row in CATEGORIES.values() if row.used_from}
"""By category, the sides of which one has to be free."""

PASSED_BEFORE_SEATS = having("low_table")
"""One sits down past these."""

SWINGS_M = {
    **dict.fromkeys(having("sideboard") | having("laundry") | having("kitchen_unit"), 0.5),
    **dict.fromkeys(("washbasin", "bedside_table"), 0.35),
}
"""By category with doors, drawers or flaps, how far before its front they swing."""

STRIP_M = (0.05, 0.25)
"""From a front: the strip that SceneEval looks at."""
OPEN_SHARE = 0.5
"""Of the strip that is free before a front that can be used."""
STAND_M = 0.55
"""Somebody who uses a piece stands no farther from it."""

Piece = tuple[str, Box]


@dataclass(frozen=True, eq=False)
class _Space:
    """Rooms that no wall parts, and the ways out of them; compared by identity."""

    rooms: tuple[Room, ...]
    floor: shapely.Geometry
    """Without furniture, doorways included."""
    ways: tuple[shapely.Polygon, ...]


@lru_cache(maxsize=64)  # rules and drafts ask for the same rooms again and again
def _spaces(rooms: tuple[Room, ...], openings: tuple[Opening, ...]) -> tuple[_Space, ...]:
    floors = [room_polygon(room) for room in rooms]
    grown = np.array([floor.buffer(SEAM_M, join_style="mitre") for floor in floors], dtype=object)
    near, far = shapely.STRtree(grown).query(grown, predicate="intersects")
    doors = [opening for opening in openings if opening.kind != "window"]
    spaces = []
    for group in hanging_together(len(rooms), zip(near.tolist(), far.tolist(), strict=True)):
        floor = shapely.union_all([grown[index] for index in group])
        leading = tuple(
            door for door in doors if footprint_polygon(door.box).dwithin(floor, 0.05)
        )  # fmt: skip
        inside = tuple(rooms[index] for index in group)
        whole = free_floor(SceneGraph(inside, leading, ()))
        spaces.append(_Space(inside, whole, tuple(footprint_polygon(door.box) for door in leading)))
    return tuple(spaces)


def shut_fronts(graph: SceneGraph) -> dict[str, tuple[str, ...]]:
    """Ids of the pieces that nobody can stand before, with the pieces that stand there instead.

    Without names where only the way to the front is shut. Dressing counts as furniture does.
    """
    fronts: dict[str, tuple[str, ...]] = {}
    by_room: dict[str, list[Item]] = {}
    for item in (*graph.items, *filter(takes_floor, graph.dressing)):
        by_room.setdefault(item.room_id, []).append(item)
    for space in _spaces(graph.rooms, graph.openings):
        items = [item for room in space.rooms for item in by_room.get(room.id, ())]
        for index, before in _shut(space, tuple((item.category, item.box) for item in items)):
            fronts[items[index].id] = tuple(items[other].id for other in before)
    return fronts


@lru_cache(maxsize=512)  # of a house in work, most rooms stay as they are from step to step
def _shut(space: _Space, pieces: tuple[Piece, ...]) -> tuple[tuple[int, tuple[int, ...]], ...]:
    used = [index for index, (category, _) in enumerate(pieces) if category in USED_SIDES]
    if not used:
        return ()
    things = tuple(Item(str(index), *piece) for index, piece in enumerate(pieces))
    floor = _Floor(space, things)
    return tuple(
        (index, floor.before(index)) for index in used if not floor.is_free(index)
    )  # fmt: skip


class _Floor:
    """The floor of a space, as furniture leaves it."""

    def __init__(self, space: _Space, items: tuple[Item, ...]) -> None:
        self._items = items
        self._tables = shapely.union_all(
            [footprint_polygon(item.box) for item in items if item.category in PASSED_BEFORE_SEATS]
        )
        self._free = left_free(space.floor, items)
        parts = walkable_parts(self._free)
        near_m = WALKER_RADIUS_M + 2 * SEAM_M
        led_to = [part for part in parts if any(part.dwithin(way, near_m) for way in space.ways)]
        largest = sorted(parts, key=lambda part: -part.area)[:1]
        self._walkable = shapely.union_all(led_to or largest)
        shapely.prepare(self._walkable)

    def is_free(self, index: int) -> bool:
        """Whether one of the sides that a piece is used from can be stood before."""
        item = self._items[index]
        return any(self._can_stand(item, side) for side in USED_SIDES[item.category])

    def _can_stand(self, item: Item, side: Side) -> bool:
        strip, place = _before(item.box, side, *STRIP_M), _before(item.box, side, 0.0, STAND_M)
        free_m2 = self._free.intersection(strip).area
        if item.category in having("seat"):
            free_m2 += self._tables.intersection(strip).area
            place = place.buffer(WALKER_RADIUS_M)
        return free_m2 >= OPEN_SHARE * strip.area and bool(self._walkable.intersects(place))

    def before(self, index: int) -> tuple[int, ...]:
        """Indices of what stands in the strips before a piece."""
        item = self._items[index]
        strips = shapely.union_all(
            [_before(item.box, side, *STRIP_M) for side in USED_SIDES[item.category]]
        )
        return tuple(
            other
            for other, thing in enumerate(self._items)
            if other != index and footprint_polygon(thing.box).intersection(strips).area > GRID_M
        )


def standing_places(item: Item) -> list[shapely.Polygon]:
    """Where somebody who uses a piece may stand, by side; none for pieces that nobody stands at."""
    return [_before(item.box, side, 0.0, STAND_M) for side in USED_SIDES.get(item.category, ())]


def _before(box: Box, side: Side, from_m: float, to_m: float) -> shapely.Polygon:
    return footprint_polygon(floor_before(box, side, from_m, to_m))


def floor_before(box: Box, side: Side, from_m: float, to_m: float) -> Box:
    """What lies between two distances before a side, metres; as long as the side is."""
    length, depth, height = box.size_m
    middle = (from_m + to_m) / 2
    x_m, y_m = (half * way + middle * way for half, way in zip((length / 2, depth / 2), side,
                                                             strict=True))  # fmt: skip
    deep = to_m - from_m
    size_m = (deep, depth, height) if side[0] else (length, deep, height)
    return in_world(Box((x_m, y_m, 0.0), size_m, 0.0), box)
