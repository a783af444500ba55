"""Pieces that were painted too small to be built grow to the smallest usual size of their kind.

The model loses a row of pixels or two of what is small, and paints a toilet of 28 cm. A mesh for
such a box would be a doll's. Where the room has the few centimetres, the piece gets them; its back
stays at its wall.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from chord_usd.arrange.arrangement import Arrangement
from chord_usd.graph.fit import is_built_in
from chord_usd.scene.geometry import resized
from chord_usd.scene.palette import Mount, category
from chord_usd.scene.places import FreePlaces
from chord_usd.scene.types import Box, Item, SceneGraph

_SIDES = (0.0, -0.5, 0.5)
"""Where what is added to the length goes, as shares of it: both ends alike, the left, the right."""


def grow_to_usual(work: Arrangement) -> SceneGraph:
    """The graph with floor pieces no smaller than the palette's usual ones, where there is room.

    A piece grows neither into another one nor out of its room nor farther before an opening; where
    it can grow in one direction alone, it does that. Panels, units of a kitchen's run and scraps,
    of which nobody knows what they were to be, stay as they are. Meshes are to be matched after it.
    """
    small = [item for item in work.graph.items if _is_small(item)]
    items = {item.id: item for item in work.graph.items}
    # Larger pieces first: a room is what it is for by them.
    for item in sorted(small, key=lambda one: (-one.box.size_m[0] * one.box.size_m[1], one.id)):
        free = work.free_places(item, items.values(), may_share=_are_apart)
        items[item.id] = replace(item, box=_grown(item, free))
    return replace(work.graph, items=tuple(items.values()))


def _is_small(item: Item) -> bool:
    row, size_m = category(item.category), item.box.size_m
    if row.mount is not Mount.FLOOR or is_built_in(row) or row.is_scrap(size_m):
        return False
    return size_m[0] < row.length_m[0] or size_m[1] < row.width_m[0]


def _are_apart(one: Item, other: Item) -> bool:
    """Whether one piece hangs where the other stands; no table grows over its chairs."""
    return category(one.category).mount is not category(other.category).mount


def _grown(item: Item, free: FreePlaces) -> Box:
    """The first of the larger boxes that is free; the item's own, if none is."""
    return next((box for box in _larger(item) if free.has(box)), item.box)


def _larger(item: Item) -> Iterator[Box]:
    """Boxes of the usual length and depth, then of one of them, the back where it was."""
    row = category(item.category)
    length_m, depth_m, _ = item.box.size_m
    usual = max(length_m, row.length_m[0]), max(depth_m, row.width_m[0])
    for size_m in dict.fromkeys((usual, (usual[0], depth_m), (length_m, usual[1]))):
        for side in _SIDES:
            middle_m = side * (size_m[0] - length_m), (depth_m - size_m[1]) / 2
            yield resized(item.box, size_m, middle_m)
