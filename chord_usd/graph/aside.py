"""Pieces that reach a few centimetres before a door or window step aside.

The model sees an edge to a pixel or two, which is as much as a bed may stand in the floor that a
door keeps free. Where a small step clears it, the piece takes it; who stands farther in the way was
meant to stand there.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import shapely

from chord_usd.geometry import room_polygon
from chord_usd.metrics.free_places import free_places
from chord_usd.metrics.openings import ClearFloor, blocked_openings, clearances
from chord_usd.places import moved_to, places_near
from chord_usd.types import Item, SceneGraph

FARTHEST_M = 0.1
"""A pixel or two of a raster."""

_STEP_M = 0.01

_WAYS = np.array([(-1.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])
"""In the piece's own frame: left, right, back, forward. Ties go to the first.

What has its back at a wall goes sideways: forward, it would only come farther before the opening.
"""


def step_aside(graph: SceneGraph) -> SceneGraph:
    """The graph with pieces out of the way of openings that reached before them by a little.

    A piece moves by the least that clears every opening, FARTHEST_M at most. It stays in its room
    and off other pieces; where that cannot be, it stays where it is. How far it moved is noted in
    its extra.
    """
    clear = list(clearances(graph.rooms, graph.openings))
    floors = {room.id: room_polygon(room) for room in graph.rooms}
    items = {item.id: item for item in graph.items}
    for item_id in dict.fromkeys(blocked.item for blocked in blocked_openings(graph)):
        if (item := items[item_id]).room_id in floors:
            items[item_id] = _aside(item, floors[item.room_id], items.values(), clear)
    return replace(graph, items=tuple(items.values()))


def shut_in(graph: SceneGraph) -> tuple[str, ...]:
    """Ids of pieces that stand before a door, or in a passage: nobody gets by."""
    ways = {opening.id for opening in graph.openings if opening.kind != "window"}
    blocked = (one.item for one in blocked_openings(graph) if one.opening in ways)
    return tuple(dict.fromkeys(blocked))


def _aside(
    item: Item, floor: shapely.Polygon, items: Iterable[Item], clear: Sequence[ClearFloor]
) -> Item:
    """The item at the nearest free place; where it is, if there is none."""
    free = free_places(item, floor, items, clear, is_to_clear=True)
    for distance_m, box in places_near(item.box, _WAYS, _STEP_M, FARTHEST_M):
        if free.has(box):
            return moved_to(item, box, distance_m)
    return item
