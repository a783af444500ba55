"""Panels on their walls: the last centimetres between what hangs and what it hangs on.

Where a panel is drawn behind a bed or a sofa, only a strip of it is seen, and its back may end a
little before the wall or in it. It cannot hang there, so it is moved onto the wall.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from shapely.geometry import Polygon

from chord_usd.base.scene.geometry import footprint, front_direction
from chord_usd.base.scene.oriented_rect import Edge, Footprint, OrientedRect
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


# Footprints cut off at the walls of their room: boxes around torn patches stand out into ---------

# Metres, world axes.

_OUT_SHARE = 0.005
"""Share of a footprint that may lie out of its room..."""
_OUT_M = 0.004
"""...and how deep: a corner of a slanted piece is a small share and in the wall all the same."""
_STEPS = 24
_GRID_M = 1e-9
"""Without a grid GEOS errs now and then where edges lie on each other, as these do."""

_INWARDS: tuple[tuple[Edge, Edge], ...] = (("u0", "u1"), ("u1", "u0"), ("v0", "v1"), ("v1", "v0"))
"""Each edge, and the opposite one."""


def cut_at_walls(footprint: Footprint, room: Polygon) -> Footprint:
    """Cut off what stands out of the room, edge by edge, each time the cut that costs least."""
    rect = footprint.rect
    for _ in range(4):
        if _fits(rect, room):
            break
        cuts = [_cut(rect, *edges, room) for edges in _INWARDS]
        rect = max(cuts, key=lambda cut: (cut[0], cut[1].area))[1]
    return replace(footprint, rect=rect)


def _cut(
    rect: OrientedRect, edge: Edge, opposite: Edge, room: Polygon
) -> tuple[bool, OrientedRect]:
    """One edge moved in by the least that puts the rest into the room, half way at most.

    Also whether that does it.
    """
    start, limit = getattr(rect, edge), getattr(rect, opposite)
    for step in range(1, _STEPS + 1):
        place = start + (limit - start) * 0.5 * step / _STEPS
        cut = rect.moved_edge(edge, place)
        if _fits(cut, room):
            return True, cut
    return False, cut


def _fits(rect: OrientedRect, room: Polygon) -> bool:
    """Whether next to nothing lies out of the room, and that nowhere deep."""
    shape = rect.polygon
    out = shape.difference(room, grid_size=_GRID_M)
    if out.area > _OUT_SHARE * shape.area:
        return False
    return bool(out.buffer(-_OUT_M / 2).is_empty)
