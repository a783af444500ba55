"""How far one gets on foot in a house of several storeys: over its stairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import shapely
from shapely.geometry import Point

from chord_usd.metrics.walk import (
    WALKER_RADIUS_M,
    Walk,
    entrance,
    free_floor,
    unreachable_rooms,
    walkable_parts,
)
from chord_usd.scene.geometry import footprint_polygon
from chord_usd.scene.types import WALL_THICKNESS_M, SceneGraph

_NEAR_M = WALKER_RADIUS_M + WALL_THICKNESS_M


@dataclass(frozen=True)
class Ascent:
    """A stair that can be walked."""

    storey: int
    """Index of the lower one."""
    foot_m: tuple[float, float]
    top_m: tuple[float, float]
    """Where one stands before the first step, and after the last."""


def climb(storeys: Sequence[SceneGraph], ascents: Sequence[Ascent]) -> list[Walk]:
    """How far one gets on each storey from the entrance, which is on the lowest that has one.

    Openings by which one steps onto stairs are no entrances: leave them out of the graphs.
    """
    free = [free_floor(graph) for graph in storeys]
    parts = [walkable_parts(one) for one in free]
    reached: list[set[int]] = [set() for _ in storeys]
    doors = [entrance(graph) for graph in storeys]
    first = next((index for index, door in enumerate(doors) if door is not None), 0)
    door = doors[first]
    if door is not None:
        _reach(parts[first], footprint_polygon(door.box), reached[first])
    elif parts[first]:
        largest = max(range(len(parts[first])), key=lambda at: parts[first][at].area)
        reached[first].add(largest)
    grown = True
    while grown:
        grown = False
        for way in ascents:
            low, high = way.storey, way.storey + 1
            for here, there, start, end in (
                (low, high, way.foot_m, way.top_m), (high, low, way.top_m, way.foot_m),
            ):  # fmt: skip
                at: set[int] = set()
                _reach(parts[here], Point(start), at)
                if at & reached[here]:
                    before = len(reached[there])
                    _reach(parts[there], Point(end), reached[there])
                    grown |= len(reached[there]) > before
    return [_told(*one) for one in zip(storeys, free, parts, reached, strict=True)]


def _reach(parts: Sequence[shapely.Polygon], place: shapely.Geometry, reached: set[int]) -> None:
    """Add the part that one stands on at a place, if there is one."""
    nearest = min(range(len(parts)), key=lambda at: place.distance(parts[at]), default=None)
    if nearest is not None and place.distance(parts[nearest]) < _NEAR_M:
        reached.add(nearest)


def _told(
    graph: SceneGraph,
    free: shapely.Geometry,
    parts: Sequence[shapely.Polygon],
    reached: set[int],
) -> Walk:
    areas = [part.area for part in parts]
    start = shapely.union_all([parts[at] for at in sorted(reached)]) if reached else None
    return Walk(
        walkable=max(areas, default=0.0) / sum(areas) if sum(areas) else 0.0,
        walkable_m2=sum(areas),
        unreachable=tuple(unreachable_rooms(graph, free, start)),
        rooms=len(graph.rooms),
    )


def without_openings(graph: SceneGraph, ids: frozenset[str]) -> SceneGraph:
    """The storey without some of its openings."""
    return replace(graph, openings=tuple(one for one in graph.openings if one.id not in ids))
