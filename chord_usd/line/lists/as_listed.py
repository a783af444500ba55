"""Pieces that were painted where lists have them, but for what a raster can tell: as listed."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np

from chord_usd.base.metrics.design.price import quick_price
from chord_usd.base.metrics.design.shell import shells
from chord_usd.base.metrics.design.view import View
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.types import Edit, Item, SceneGraph

REACH_M = 0.1
"""Painted corners are no nearer to those of a list than two or three pixels: basins, showers and
wardrobes lose so much, and break the numbers that they were listed by."""
_SAME_M = 1e-6
RULE = "as listed"
"""Name of the edit in pieces that were painted so near."""


def read_as_listed(
    graph: SceneGraph, listed: SceneGraph, rooms: Collection[str], but: Collection[str] = ()
) -> SceneGraph:
    """A house that was read, with pieces of these rooms as they are listed where each of their
    corners was painted within REACH_M of that; rooms that would cost more stay as read.

    but: ids of pieces that stay as they are.
    """
    plan = shells(graph.rooms, graph.openings)
    made = {item.id: item for item in graph.items}
    for room_id in rooms:
        items = list(graph.items_of(room_id))
        free = [item for item in items if item.id not in but]
        near = dict(_near(free, list(listed.items_of(room_id))))
        after = tuple(near.get(item.id, item) for item in items)
        before = View(plan[room_id], tuple(items))
        if near and quick_price(View(plan[room_id], after)) <= quick_price(before):
            made |= near
    return replace(graph, items=tuple(made[item.id] for item in graph.items))


def _near(read: Iterable[Item], listed: Sequence[Item]) -> Iterable[tuple[str, Item]]:
    """Ids of pieces that were painted near listed ones of their category, with their places."""
    left = [item for item in listed if item.category not in KITCHEN_UNITS]
    for item in read:
        same = [piece for piece in left if piece.category == item.category]
        best = min(same, key=lambda piece: _away_m(item, piece), default=None)
        if best is None or _away_m(item, best) > REACH_M:
            continue
        left.remove(best)
        if _away_m(item, best) < _SAME_M:
            continue
        x, y, _ = best.box.center_m
        sill_m = best.facts.below_sill_m
        size = (*best.box.size_m[:2], min(item.box.size_m[2], sill_m or math.inf))
        box = replace(best.box, center_m=(x, y, item.box.center_m[2]), size_m=size)
        edits = (*item.facts.edits, Edit(RULE, item.box))
        facts = replace(item.facts, edits=edits, asset_distance_m=None, below_sill_m=sill_m)
        yield item.id, replace(item, box=box, asset=None, facts=facts)


def _away_m(item: Item, other: Item) -> float:
    """The farthest that a corner is from that of the other, along an axis."""
    return float(np.abs(footprint(item.box) - footprint(other.box)).max())
