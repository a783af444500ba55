"""Pieces that somebody else placed, moved out of each other, into their room and off openings.

What paints a room seldom puts one piece into another; what lists boxes one by one often does, by a
little. So first all that stand in each other or in a wall push each other apart, the smaller one
farther. What that leaves goes, from the largest piece on, to the nearest place that is free of
those before it. A piece without a place in reach stays, and is left out later (leave_out).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
import shapely

from chord_usd.base.metrics.overlap import overlaps_by_nature
from chord_usd.base.metrics.violations import Violation, violations
from chord_usd.base.places.free_places import places_near
from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.types import Box, FloatArray, Item, SceneGraph
from chord_usd.line.arrange.arrangement import Arrangement

FARTHEST_M = 1.0
_STEP_M = 0.025
_ANGLES = np.deg2rad(np.arange(0.0, 360.0, 22.5))
_WAYS = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1)

_ROUNDS = 120
_APART_M = 1e-3
"""Pieces are pushed this much farther than they need, or they would come to touch for ever."""


def move_aside(work: Arrangement) -> SceneGraph:
    """The house with every piece that may move where it is in nothing, if there is such a place."""
    apart: dict[str, Item] = {}
    for room in work.graph.rooms:
        pieces = list(work.graph.items_of(room.id))
        shapely.prepare(work.floors[room.id])
        apart |= zip((item.id for item in pieces), _pushed_apart(work, pieces), strict=True)
    items = [apart.get(item.id, item) for item in work.graph.items]
    placed = {item.id: item for item in items if not work.may_move(item)}
    loose = [item for item in items if work.may_move(item)]
    for item in sorted(loose, key=_weight, reverse=True):
        placed[item.id] = replace(item, box=_nearest(work, item, list(placed.values())))
    return replace(work.graph, items=tuple(placed[item.id] for item in items))


def _pushed_apart(work: Arrangement, items: Sequence[Item]) -> list[Item]:
    """The pieces of a room after pushing each other, and being pushed by its walls."""
    pairs = np.array(
        [
            (a, b)
            for a, b in combinations(range(len(items)), 2)
            if not overlaps_by_nature(items[a], items[b])
        ],
        dtype=int,
    ).reshape(-1, 2)
    corners = np.array([footprint(item.box) for item in items]).reshape(-1, 4, 2)
    start = corners.copy()
    loose = np.array([work.may_move(item) for item in items])
    # Of two that push each other, how far each gives way.
    give = np.array([_weight(item) for item in items])[pairs[:, ::-1]] * loose[pairs]
    give /= np.maximum(give.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    homes = [(index, work.floors[item.room_id]) for index, item in enumerate(items) if loose[index]]
    for _ in range(_ROUNDS):
        pushes = np.zeros((len(items), 2))
        away = _ways_out(corners[pairs[:, 0]], corners[pairs[:, 1]])
        np.add.at(pushes, pairs[:, 0], -away * give[:, :1])
        np.add.at(pushes, pairs[:, 1], away * give[:, 1:])
        for index, floor in homes:
            pushes[index] += _way_in(corners[index], floor)
        if not pushes.any():
            break
        corners += pushes[:, None]
    moves = (corners - start)[:, 0]
    return [
        _moved(item, move) if move.any() else item for item, move in zip(items, moves, strict=True)
    ]


def _weight(item: Item) -> float:
    return float(np.sqrt(item.box.size_m[0] * item.box.size_m[1]))


def _moved(item: Item, by_m: FloatArray) -> Item:
    x_m, y_m = np.array(item.box.center_m[:2]) + by_m
    center_m = (round(float(x_m), 6), round(float(y_m), 6), item.box.center_m[2])
    return replace(item, box=replace(item.box, center_m=center_m))


def _ways_out(first: FloatArray, second: FloatArray) -> FloatArray:
    """(N, 2) the shortest way on which each second rectangle leaves the first; 0 for those apart.

    Two are apart where their shadows along a side of either are (separating axes). first, second:
    (N, 4, 2) corners.
    """
    sides = np.concatenate([first[:, 1:3] - first[:, :2], second[:, 1:3] - second[:, :2]], axis=1)
    axes = sides / np.linalg.norm(sides, axis=2, keepdims=True)
    ours, theirs = (np.einsum("nkc,nac->nak", ring, axes) for ring in (first, second))
    ahead = ours.max(axis=2) - theirs.min(axis=2)
    back = theirs.max(axis=2) - ours.min(axis=2)
    depths = np.minimum(ahead, back)
    least = depths.argmin(axis=1)[:, None]
    depth = np.take_along_axis(depths, least, axis=1)
    sign = np.where(np.take_along_axis(ahead <= back, least, axis=1), 1.0, -1.0)
    way = np.take_along_axis(axes, least[..., None], axis=1)[:, 0]
    ways: FloatArray = np.where(depth > 0.0, sign * way * (depth + _APART_M), 0.0)
    return ways


def _way_in(corners: FloatArray, floor: shapely.Polygon) -> FloatArray:
    """(2,) how far the corner that lies farthest out of the room is from it; 0 for none."""
    points = shapely.points(corners)
    if shapely.covers(floor, points).all():
        return np.zeros(2)
    lines = shapely.get_coordinates(shapely.shortest_line(points, floor)).reshape(4, 2, 2)
    ways: FloatArray = lines[:, 1] - lines[:, 0]
    return ways[int((ways**2).sum(axis=1).argmax())]


def _nearest(work: Arrangement, item: Item, among: list[Item]) -> Box:
    free = work.free_places(item, among, is_new=True)
    if free.has(item.box):
        return item.box
    places = places_near(item.box, _WAYS, _STEP_M, FARTHEST_M)
    return next((box for box in places if free.has(box)), item.box)


# Pieces that nobody could build as they stand are left out: the least needed of each -------------

_NEVER_BUILT = ("overlap", "before an opening", "undersized")


def clashes(graph: SceneGraph) -> list[Violation]:
    """Pieces in each other, before openings, and those too small to be pieces."""
    return [violation for violation in violations(graph) if violation.kind in _NEVER_BUILT]


def leave_out(work: Arrangement) -> SceneGraph:
    """The house without undersized pieces, and without those that stand in others or before
    openings and can best be done without.

    Drops, of each conflicting pair, the item whose removal lowers the fault score most; of equal
    items the smaller. What a room cannot do without stays before a window, not before a door or in
    another piece.
    """
    faults, graph = work.faults, work.graph
    assert faults is not None, "no fault score is given"
    floor_m2 = {item.id: item.box.size_m[0] * item.box.size_m[1] for item in graph.items}
    while conflicts := clashes(graph):
        before = faults(graph)
        clashing = {item_id for conflict in conflicts for item_id in conflict.items}
        may_go = (item.id for item in graph.items if item.id in clashing and work.may_move(item))
        tries = sorted(
            (faults(graph.without([item_id])), floor_m2[item_id], item_id) for item_id in may_go
        )
        shut = _shut_in(graph, conflicts)
        worst = next(
            (item_id for left, _, item_id in tries if left < before or item_id in shut), None
        )
        if worst is None:
            break
        graph = graph.without([worst])
    return graph


def _shut_in(graph: SceneGraph, conflicts: Iterable[Violation]) -> set[str]:
    """Ids of pieces that are undersized or in others, or before doors and passages: nobody gets
    by."""
    windows = {opening.id for opening in graph.openings if opening.kind == "window"}
    return {
        item_id
        for conflict in conflicts
        if conflict.other not in windows
        for item_id in conflict.items
    }
