"""Which of many boxes stand free in a room, and what an empty room can hold at least: without
anything, its plan makes it a passage."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from chord_usd.base.metrics.complete import ESSENTIALS
from chord_usd.base.metrics.design.price import beyond_walls
from chord_usd.base.metrics.design.shell import APART_M, TOUCH_M, Rects, Shell, shells
from chord_usd.base.metrics.walk import ways_shut
from chord_usd.base.places.wall_frames import WallFrame
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Box, Item, SceneGraph

_STEP_M = 0.1
_WALKED = 12
"""Places of one size from which ways through the room are looked at, evenly of those that are
free."""


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
            for at in free[:: 1 + len(free) // _WALKED]:
                piece = Item(f"{room_id}/{name}_0", name, boxes[at], room_id)
                alone = SceneGraph(graph.rooms, graph.openings, (piece,))
                if not ways_shut(alone, shell.room):
                    yield piece


def _modest(least_m: float, most_m: float) -> float:
    """A size that models come in: few are as small as their kind can be."""
    return least_m + (most_m - least_m) / 4


def is_passage(graph: SceneGraph, room_id: str) -> bool:
    """Whether nothing that its kind cannot do without fits into an empty room without shutting one
    of its doors or the way between them."""
    return next(first_pieces(graph, room_id), None) is None
