"""Pieces moved a little off obstacles of their doors and drawers.

A drawer beside a door's casing, a cabinet whose leaf meets the next piece: both need centimetres.
Where no place helps, as in a closet no longer than its cabinet, another model opens: with sliding
doors, or none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import shapely

from chord_usd.base.places.swept import Boxes, Leaf, way_of
from chord_usd.base.scene.geometry import footprint_polygon, resized
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.types import Box, Item, SceneGraph
from chord_usd.library.asset_shapes import collider_boxes, leaves_of
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.off_trim import is_in_trim, trim_of
from chord_usd.line.graph.match import fitted_box

_STEPS_M = (0.02, 0.03, 0.05, 0.08, 0.12, 0.2, 0.3, 0.45, 0.6)
"""How far a piece may go along its wall."""
_MOST_CUT = 0.05
"""Of its length, as much as meshes are stretched (graph.fit)."""
_REACH_M = 1.0
"""Leaves pass nothing farther from their piece."""
_WALL_M = 1e-3
_MODELS, _LEAST_LONG = 24, 0.75
"""So many models nearest in size are tried, none of which is shorter than this share."""


def free_leaves(work: Arrangement) -> SceneGraph:
    """The house with pieces beside the place where a leaf of theirs opens less than it has to."""
    graph = work.graph
    leaves = {item.id: leaves_of(item) for item in graph.items if work.may_move(item)}
    opening = [item for item in graph.items if leaves.get(item.id)]
    if not opening:
        return graph
    trim = trim_of(graph)
    floor = shapely.union_all(list(work.floors.values())).buffer(_WALL_M)
    shapely.prepare(floor)
    items = {item.id: item for item in graph.items}
    for item in opening:
        near = _near(item, items, trim)
        if _shut(leaves[item.id], item.box, near, floor):
            items[item.id] = _moved(work, item, items, trim, floor)
    return replace(graph, items=tuple(items.values()))


def _near(item: Item, items: dict[str, Item], trim: Sequence[Box]) -> Boxes:
    """Colliders around a piece."""
    reach = footprint_polygon(item.box).buffer(_REACH_M + max(_STEPS_M))
    around = [other for other in items.values() if other.id != item.id
              and category(other.category).mount is not Mount.UNDERFOOT
              and footprint_polygon(other.box).intersects(reach)]  # fmt: skip
    casing = [Boxes.filling(box) for box in trim if footprint_polygon(box).intersects(reach)]
    return Boxes.joined([*(collider_boxes(other) for other in around), *casing])


def _shut(leaves: Sequence[Leaf], box: Box, near: Boxes, floor: shapely.Geometry) -> float:
    """How much of their ranges leaves miss that do not open as far as they have to."""
    ways = (way_of(leaf, box, near, floor) for leaf in leaves)
    return sum(1.0 - way.share for way in ways if not way.is_free)


def _moved(
    work: Arrangement, item: Item, items: dict[str, Item], trim: Sequence[Box],
    floor: shapely.Geometry,
) -> Item:  # fmt: skip
    """The piece at the nearest place from which all its leaves open; in another model that opens;
    else at the best place."""
    free = work.free_places(item, items.values())
    near = _near(item, items, trim)
    best, least = item, _shut(leaves_of(item), item.box, near, floor)
    for box in _tries(item.box):
        if not free.has(box) or is_in_trim(box, trim):
            continue
        tried = replace(item, box=box)
        missed = _shut(leaves_of(tried), box, near, floor)
        if missed < least - 0.1:
            best, least = tried, missed
        if not least:
            return best
    others = (model for model in _other_models(work, item) if not is_in_trim(model.box, trim))
    opening = (model for model in others if not _shut(leaves_of(model), model.box, near, floor))
    return next(opening, best)


def _other_models(work: Arrangement, item: Item) -> Iterator[Item]:
    """The piece in other models of its category, none larger and not much smaller."""
    if work.database is None or item.children:
        return
    row, size_m = category(item.category), item.box.size_m
    for asset in work.database.ranked(item.category, size_m, _MODELS):
        box = fitted_box(item.box, asset, row, is_guess=True)
        most_m = item.facts.below_sill_m or math.inf
        if box.size_m[0] >= _LEAST_LONG * size_m[0] and box.size_m[2] <= most_m:
            yield replace(item, asset=asset, box=box)


def _tries(box: Box) -> Iterator[Box]:
    """The box along its wall and cut at one end, the least change first."""
    length, depth, _ = box.size_m
    for step in _STEPS_M:
        for side in (-1.0, 1.0):
            if step <= _MOST_CUT * length:
                yield resized(box, (length - step, depth), (side * step / 2, 0.0))
            yield resized(box, (length, depth), (side * step, 0.0))
