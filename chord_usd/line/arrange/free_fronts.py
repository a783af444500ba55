"""Fronts that nobody can stand before are freed: the piece that can best be done without goes, one
before the front or the shut piece.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from chord_usd.base.metrics.fronts import shut_fronts
from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.line.arrange.arrangement import Arrangement


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
