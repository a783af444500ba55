"""Chairs and armchairs as people leave them: a few degrees askew, a few centimetres drawn out.

Rows at exact angles give a picture away as computer-made. A piece turns only where that costs
nothing: it stays in its room, clear of all others and of openings, and narrows no passage.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import shapely

from chord_usd.base.metrics.overlap import overlaps_by_nature
from chord_usd.base.metrics.walk import WALKER_RADIUS_M
from chord_usd.base.scene.geometry import footprint_polygon, to_world
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import Box, Item, SceneGraph
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.chairs_clear import SEAT, has_mesh, runs_into, tables_of

RULE = "left a little askew"
_TURN_DEG = (2.0, 6.0)
_MOST_BACK_M = 0.05
_TRIES = 6

_PASSAGE_M = 2 * WALKER_RADIUS_M
_SPARE_M = 0.1
"""A passage that is this much wider than a walker is passable however the floor is sampled."""


def leave_askew(work: Arrangement) -> SceneGraph:
    """The house with chairs and armchairs turned a little where there is room, each once.

    The same house gives the same turns. Raises StageError for a mesh that cannot be opened.
    """
    items = {item.id: item for item in work.graph.items}
    tables = tables_of(work.graph.items)
    for item in work.graph.items:
        if item.category not in (SEAT, *having("easy_chair")) or not work.may_move(item):
            continue
        if not has_mesh(item) or any(edit.rule == RULE for edit in item.facts.edits):
            continue
        near = [table for table in tables if item.category == SEAT and table.is_near(item)]
        free = work.free_places(item, items.values())
        around = _around(work, item, list(items.values()))
        for box in _askew(item):
            if (
                free.has(box)
                and _leaves_passages(item.box, box, around)
                and not runs_into(box, item, near)
            ):
                items[item.id] = replace(item, box=box)
                break
    return replace(work.graph, items=tuple(items.values()))


def _askew(item: Item) -> Iterator[Box]:
    """What to try, from the item's own random numbers."""
    x, y, _ = item.box.center_m
    rng = np.random.default_rng(zlib.crc32(f"{item.id} {x:.3f} {y:.3f}".encode()))
    for _ in range(_TRIES):
        turn = rng.uniform(*_TURN_DEG) * rng.choice([-1.0, 1.0])
        back = rng.uniform(0.0, _MOST_BACK_M) if item.category == SEAT else 0.0
        x_m, y_m = to_world(item.box, (0.0, back))
        center = (round(float(x_m), 6), round(float(y_m), 6), item.box.center_m[2])
        yaw_deg = wrap_deg(round(item.box.yaw_deg + float(turn), 3))
        yield replace(item.box, center_m=center, yaw_deg=yaw_deg)


def _around(work: Arrangement, item: Item, items: Sequence[Item]) -> list[shapely.Geometry]:
    """What bounds the passages beside a piece."""
    floor = work.floors.get(item.room_id)
    walls = [floor.exterior] if floor is not None else []
    others = [
        footprint_polygon(other.box)
        for other in items
        if other.room_id == item.room_id
        and other.id != item.id
        and not overlaps_by_nature(item, other)
    ]
    return [*walls, *others]


def _leaves_passages(before: Box, after: Box, around: Sequence[shapely.Geometry]) -> bool:
    old, new = footprint_polygon(before), footprint_polygon(after)
    for other in around:
        old_m, new_m = old.distance(other), new.distance(other)
        if new_m < old_m and old_m >= _PASSAGE_M and new_m < _PASSAGE_M + _SPARE_M:
            return False
    return True
