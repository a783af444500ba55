"""Pieces that shut a room off from the front door step aside, along the wall that they stand at.

What paints a room does not know that the bathroom behind it has no other door.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from chord_usd.arrange.arrangement import Arrangement
from chord_usd.metrics.violations import violations
from chord_usd.metrics.walk import walk
from chord_usd.scene.places import places_near
from chord_usd.scene.types import Item, SceneGraph

_STEP_M, _FARTHEST_M = 0.05, 1.0
_SIDEWAYS = np.array([[1.0, 0.0], [-1.0, 0.0]])


def open_ways(work: Arrangement) -> SceneGraph:
    """The house with as many rooms within reach as one piece after the other can open.

    Each time the piece moves that has to move the least, and nothing else becomes wrong by it. What
    no move helps stays.
    """
    graph = work.graph
    while shut := _shut_off(graph):
        opened = next(_opened(work.holding(graph), shut), None)
        if opened is None:
            break
        graph = opened
    return graph


def _shut_off(graph: SceneGraph) -> int:
    return len(walk(graph).unreachable)


def _opened(work: Arrangement, shut: int) -> Iterator[SceneGraph]:
    """Houses with fewer rooms shut off, the shortest move first."""
    graph = work.graph
    culprits = [
        item
        for item in graph.items
        if work.may_move(item) and _shut_off(graph.without([item.id])) < shut
    ]
    moves = [(item, moved) for item in culprits for moved in _moved(work, item)]
    wrong = len(violations(graph))
    for item, moved in sorted(moves, key=lambda move: _way_m(*move)):
        items = tuple(moved if one is item else one for one in graph.items)
        house = replace(graph, items=items)
        if _shut_off(house) < shut and len(violations(house)) <= wrong:
            yield house


def _way_m(before: Item, after: Item) -> float:
    return math.dist(before.box.center_m, after.box.center_m)


def _moved(work: Arrangement, item: Item) -> Iterator[Item]:
    free = work.free_places(item, work.graph.items)
    for box in places_near(item.box, _SIDEWAYS, _STEP_M, _FARTHEST_M):
        if free.has(box):
            yield replace(item, box=box)
