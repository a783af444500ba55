"""Ways through the house are kept open: pieces that shut a room off, or a part of one, are left
out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import shapely

from chord_usd.base.metrics.fronts import shut_fronts
from chord_usd.base.metrics.walk import free_floor, walk
from chord_usd.base.scene.geometry import footprint_polygon, polygons_of, room_polygon
from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.line.arrange.arrangement import Arrangement, Faults

_BESIDE_M = 0.5
"""From a shut room: a piece that shuts it stands in it or in a room beside it."""

_SIDEWAYS_M = 0.1
"""Half of a gap that one passes sideways."""

_LEAST_CUT_M2 = 0.3
"""A smaller part of the floor is left to the piece that cuts it off."""

_FARTHER_M2 = 0.05
"""Where the middle of a walker gets to: in a narrow passage that is little floor."""

_AT_M = 2 * _SIDEWAYS_M
"""From where one passes sideways to a piece that bounds it."""


def open_ways(work: Arrangement) -> SceneGraph:
    """The house without the pieces that shut rooms off, the least wrong first (faults), and without
    those that cut floor off and can be done without, the smaller first."""
    faults = work.faults
    assert faults is not None, "nothing measures how much is wrong"
    return _floor_joined(work, faults, _rooms_opened(work, faults))


def _rooms_opened(work: Arrangement, faults: Faults) -> SceneGraph:
    graph = work.graph
    while shut := walk(graph).shut:
        floors = [work.floors[room_id] for room_id in shut]
        near = {
            room.id for room in graph.rooms
            if any(room_polygon(room).dwithin(floor, _BESIDE_M) for floor in floors)
        }  # fmt: skip
        there = walk(graph).reached.area
        tries: list[tuple[int, str, SceneGraph]] = []
        for item in graph.items:
            if item.room_id in near and work.may_move(item):
                option = graph.without([item.id])
                way = walk(option)
                # Of pieces one after another each shuts the rest: the first of them leads farther.
                farther = way.reached.area > there + _FARTHER_M2
                if len(way.shut) < len(shut) or farther:
                    tries.append((len(way.shut), item.id, option))
        if not tries:
            break
        least = min(count for count, *_ in tries)
        best = [(faults(option), item_id, option) for count, item_id, option in tries
                if count == least]  # fmt: skip
        graph = min(best, key=lambda each: each[:2])[2]
    return graph


def _floor_joined(work: Arrangement, faults: Faults, graph: SceneGraph) -> SceneGraph:
    while cut_m2 := _cut_off(graph)[1]:
        joined = [
            (faults(option), _area_m2(item), item.id, option)
            for item in _around(work, graph)
            for option in [graph.without([item.id])]
            if _cut_off(option)[1] <= cut_m2 - _LEAST_CUT_M2
        ]
        best = min(joined, default=None, key=lambda each: each[:3])
        if best is None or best[0] > faults(graph):
            break
        graph = best[3]
    return graph


def _area_m2(item: Item) -> float:
    return item.box.size_m[0] * item.box.size_m[1]


def _cut_off(graph: SceneGraph) -> tuple[list[list[shapely.Polygon]], float]:
    """The floor in parts, those that one gets to, if only sideways, and the others; and the area of
    the others in m²."""
    reached = walk(graph).reached
    near, far = [], []
    for part in polygons_of(free_floor(graph).buffer(-_SIDEWAYS_M, quad_segs=2)):
        if part.intersects(reached):
            near.append(part)
        elif part.area >= _LEAST_CUT_M2:
            far.append(part)
    return [near, far], sum(part.area for part in far)


def _around(work: Arrangement, graph: SceneGraph) -> Iterator[Item]:
    """Pieces that may move, between floor that is cut off and the rest."""
    sides = [shapely.union_all(parts) for parts in _cut_off(graph)[0]]
    for item in graph.items:
        shape = footprint_polygon(item.box)
        if all(shape.dwithin(side, _AT_M) for side in sides) and work.may_move(item):
            yield item


# Fronts that nobody can stand before are freed: the piece that can best be done without ----------

# before the front or the shut piece.


def free_fronts(work: Arrangement) -> SceneGraph:
    """The house with fronts freed, as long as that leaves less wrong with it."""
    faults, graph = work.faults, work.graph
    assert faults is not None, "nothing measures how much is wrong"
    while shut := shut_fronts(graph):
        least = faults(graph)
        best = graph
        for option in _without(work, graph, shut):
            left = faults(option)
            if left < least:
                least, best = left, option
        if best is graph:
            break
        graph = best
    return graph


def _without(
    work: Arrangement, graph: SceneGraph, shut: dict[str, tuple[str, ...]]
) -> Iterator[SceneGraph]:
    """Each house without a shut piece, or without a piece before one; the smaller pieces first."""
    ids = {*shut, *(other for before in shut.values() for other in before)}
    pieces = [item for item in graph.items if item.id in ids and work.may_move(item)]
    for item in _by_size(pieces):
        yield graph.without([item.id])


def _by_size(items: Sequence[Item]) -> list[Item]:
    return sorted(items, key=lambda item: (item.box.size_m[0] * item.box.size_m[1], item.id))
