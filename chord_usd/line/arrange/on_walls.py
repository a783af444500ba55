"""Panels on their walls: the last centimetres between what hangs and what it hangs on.

Where a panel is drawn behind a bed or a sofa, only a strip of it is seen, and its back may end a
little before the wall or in it. It cannot hang there, so it is moved onto the wall.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from chord_usd.base.scene.geometry import footprint, front_direction
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.line.arrange.arrangement import Arrangement

REACH_M = 0.05
"""A panel that ends farther from a wall was meant to stand elsewhere."""

_ASKEW_M = 0.01
"""The two ends of a back that lies along its wall are equally far from it within this."""

_THERE_M = 1e-4

_AT_WALL_M = 0.01
"""What is farther from a wall does not hang on it (stage.check_contact)."""


def hang_on_walls(work: Arrangement) -> SceneGraph:
    """The house with what hangs on walls touching them, where it was within REACH_M of one, and
    without what would hang nowhere.
    """
    items = []
    for item in work.graph.items:
        is_panel = category(item.category).mount is Mount.WALL
        if is_panel and item.room_id in work.floors and work.may_move(item):
            floor = work.floors[item.room_id]
            item = _hung(item, floor)
            if not _hangs(item, floor):
                continue
        items.append(item)
    return replace(work.graph, items=tuple(items))


def _hangs(item: Item, floor: shapely.Polygon) -> bool:
    """Whether both ends of a back are at a wall, or in one."""
    ends = shapely.points(footprint(item.box)[[0, 3]])
    at_wall = shapely.distance(floor.exterior, ends) <= _AT_WALL_M
    return bool(np.all(at_wall | ~shapely.contains(floor, ends)))


def _hung(item: Item, floor: shapely.Polygon) -> Item:
    back = -front_direction(item.box.yaw_deg)
    ends = footprint(item.box)[[0, 3]]
    starts = ends - back * REACH_M
    rays = shapely.linestrings(np.stack([starts, ends + back * REACH_M], axis=1))
    hits = shapely.intersection(rays, floor.exterior)
    if shapely.is_empty(hits).any():
        return item
    # Below 0 where the back is in the wall.
    low_m, high_m = sorted(shapely.distance(shapely.points(starts), hits) - REACH_M)
    if high_m - low_m > _ASKEW_M or abs(low_m) < _THERE_M:
        return item
    x_m, y_m = np.array(item.box.center_m[:2]) + back * low_m
    box = replace(item.box, center_m=(float(x_m), float(y_m), item.box.center_m[2]))
    return replace(item, box=box)
