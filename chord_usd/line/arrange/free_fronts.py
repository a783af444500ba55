"""Fronts that nobody can stand before are freed: sinks and cookers leave blind corners.

In a run of kitchen units, two exchange their places. Elsewhere the piece that can best be done
without goes: one before the front, or the shut piece.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from chord_usd.base.metrics.fronts import shut_fronts
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Box, Item, SceneGraph
from chord_usd.line.arrange.arrangement import Arrangement

PLAIN_UNITS = frozenset(("single_door_floor_cabinet", "double_door_floor_cabinet"))
"""Units whose front may lie in a blind corner."""

_DEPTH_APART_M = 0.1
"""Units of one run; a deeper one would stand out from it."""


def free_fronts(work: Arrangement) -> SceneGraph:
    """The house with fronts freed, as long as that leaves less wrong with it."""
    faults, graph = work.faults, work.graph
    assert faults is not None, "nothing measures how much is wrong"
    while shut := shut_fronts(graph):
        least = faults(graph)
        best = graph
        for options in (_exchanged(work, graph, shut), _without(work, graph, shut)):
            for option in options:
                left = faults(option)
                if left < least:
                    least, best = left, option
            if best is not graph:
                break
        if best is graph:
            break
        graph = best
    return graph


def _exchanged(
    work: Arrangement, graph: SceneGraph, shut: dict[str, tuple[str, ...]]
) -> Iterator[SceneGraph]:
    """Each house in which a shut unit and a plain one of its room stand in each other's place."""
    for item in graph.items:
        if item.id not in shut or item.category not in KITCHEN_UNITS or not work.may_move(item):
            continue
        for other in graph.items_of(item.room_id):
            if other.category in PLAIN_UNITS and work.may_move(other) and _may_swap(item, other):
                swapped = {item.id: _at(item, other.box), other.id: _at(other, item.box)}
                items = tuple(swapped.get(each.id, each) for each in graph.items)
                yield replace(graph, items=items)


def _may_swap(item: Item, other: Item) -> bool:
    """Whether each is as large as its category can be where the other stands, and no taller."""
    (length, depth, height), (other_length, other_depth, other_height) = (
        item.box.size_m, other.box.size_m
    )  # fmt: skip
    same_run = abs(depth - other_depth) < _DEPTH_APART_M and height <= other_height + depth
    return (
        same_run
        and not category(item.category).is_undersized((other_length, depth, height))
        and not category(other.category).is_undersized((length, other_depth, other_height))
    )


def _at(item: Item, place: Box) -> Item:
    """The piece in another place, as long as that is; its mesh is chosen again."""
    box = replace(place, size_m=(*place.size_m[:2], item.box.size_m[2]))
    return replace(item, box=box, asset=None)


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
