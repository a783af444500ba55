"""Furniture beside doors and below windows: off casings and sills, which stand out of the wall.

Whoever draws a piece knows the hole of an opening, not its trim: what is drawn flush with the wall
and beside a door stands in the casing, what is nearly as high as a window in its sill.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely.geometry import Polygon

from chord_usd.base.metrics.clear_floor import sides_of
from chord_usd.base.metrics.walk import is_shut
from chord_usd.base.places.free_places import FreePlaces
from chord_usd.base.scene.geometry import footprint, footprint_polygon, front_direction, to_own
from chord_usd.base.scene.oriented_rect import Edge, Footprint, OrientedRect
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.trim import boards, casings
from chord_usd.base.scene.types import Box, FloatArray, Item, SceneGraph
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.arrange.arrangement import Arrangement

_GAP_M = 0.001
"""Left between a piece and a casing."""

_TOUCH_M2 = 2e-5
"""Casings are as thin as a finger: a corner of a piece that is in one counts."""

_MOST_CUT = 0.05
"""Of a side, where a piece has no room to move: as much as meshes are stretched (graph.fit)."""
_MOST_CUT_ON_WALL = 0.1
"""Of panels, which are made in any width."""


def clear_trim(work: Arrangement) -> SceneGraph:
    """The house with every piece beside or before the trim of openings, where there is room."""
    graph = work.graph
    trim = trim_of(graph)
    if not trim:
        return graph
    tree = shapely.STRtree([footprint_polygon(strip) for strip in trim])
    items = {item.id: item for item in graph.items}
    for item in graph.items:
        mount = category(item.category).mount
        if mount not in (Mount.FLOOR, Mount.WALL) or not work.may_move(item):
            continue
        reach = footprint_polygon(item.box).buffer(max(item.box.size_m[:2]))
        near = [trim[index] for index in sorted(tree.query(reach))]
        if is_in_trim(item.box, near):
            house = replace(graph, items=tuple(items.values()))
            free = work.free_places(item, items.values())
            items[item.id] = _beside(item, near, free, house)
    return replace(graph, items=tuple(items.values()))


def trim_of(graph: SceneGraph) -> list[Box]:
    """Casings and window boards of a house."""
    return [
        strip
        for opening, room in sides_of(graph.openings, graph.rooms)
        for strip in (*casings(opening, room), *boards(opening, room))
    ]


def is_in_trim(box: Box, trim: Sequence[Box]) -> bool:
    """Whether a box shares space with a casing or board."""
    shape = footprint_polygon(box)
    return any(
        box.center_m[2] < strip.top_m
        and box.top_m > strip.center_m[2]
        and shape.intersection(footprint_polygon(strip)).area > _TOUCH_M2
        for strip in trim
    )


def _beside(item: Item, trim: Sequence[Box], free: FreePlaces, house: SceneGraph) -> Item:
    """The piece moved as little as clears all trim, or cut a little; as it is, if nothing does.

    What hangs on a wall moves along it. trim: also what the piece is not in, but may come into.
    house: as it is now; no move shuts a room in it.
    """
    room = next((room for room in house.rooms if room.id == item.room_id), None)
    moves = [
        move
        for strip in trim
        if is_in_trim(item.box, [strip])
        for move in _ways_out(item.box, strip)
    ]
    further = [move for strip in trim for move in _ways_out(item.box, strip)]
    moves += [move + step for move in moves for step in further if abs(move @ step) < 1e-9]
    if category(item.category).mount is Mount.WALL:
        front = front_direction(item.box.yaw_deg)
        moves = [move for move in moves if abs(front @ move) < _GAP_M]
    moves.sort(key=lambda move: float(np.hypot(*move)))
    for box in (*(_moved(item.box, move) for move in moves), *_cuts(item, moves)):
        if free.has(box) and not is_in_trim(box, trim):
            moved = replace(item, box=box)
            option = replace(
                house, items=tuple(moved if i.id == item.id else i for i in house.items)
            )
            if room is None or not is_shut(option, room) or is_shut(house, room):
                return moved
    return item


def _moved(box: Box, move: FloatArray) -> Box:
    x_m, y_m, z_m = box.center_m
    return replace(box, center_m=(x_m + float(move[0]), y_m + float(move[1]), z_m))


def _cuts(item: Item, moves: Sequence[FloatArray]) -> Iterator[Box]:
    """The box without what sticks out of it when it is moved so, as far as it may be cut."""
    box = item.box
    most = _MOST_CUT_ON_WALL if category(item.category).mount is Mount.WALL else _MOST_CUT
    for move in moves:
        cut = np.abs(rotation_2d(box.yaw_deg).T @ move)
        if np.all(cut <= most * np.array(box.size_m[:2])):
            length_m, width_m = np.array(box.size_m[:2]) - cut
            size_m = (float(length_m), float(width_m), box.size_m[2])
            yield replace(_moved(box, move / 2), size_m=size_m)


def _ways_out(box: Box, trim: Box) -> list[FloatArray]:
    """(2,) moves in the world that take a box just off a piece of trim, along each of its sides."""
    corners = to_own(trim, np.asarray(footprint_polygon(box).exterior.coords)[:4])
    low, high = corners.min(axis=0), corners.max(axis=0)
    half = np.array(trim.size_m[:2]) / 2 + _GAP_M
    turn = rotation_2d(trim.yaw_deg)
    ways = []
    for axis in (0, 1):
        for by in (half[axis] - low[axis], -half[axis] - high[axis]):
            ways.append(float(by) * turn[:, axis])
    return ways


# Panels on their walls: the last centimetres between what hangs and what it hangs on -------------

# Where a panel is drawn behind a bed or a sofa, only a strip of it is seen, and its back may end a
# little before the wall or in it. It cannot hang there, so it is moved onto the wall.

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
