"""Openings and the room to use them: which rooms they join, and what stands in front of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import groupby, pairwise

import numpy as np
import shapely

from chord_usd.base.metrics.footprints import GRID_M, footprints_of, is_underfoot
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.scene.geometry import (
    footprint_polygon,
    front_direction,
    gaps,
    room_polygon,
    room_sides,
    seams,
    to_own,
)
from chord_usd.base.scene.palette import CATEGORIES, Level, Mount
from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    BoolArray,
    Box,
    FloatArray,
    Item,
    Opening,
    Room,
    SceneGraph,
)

MAX_CLEARANCE_M = 0.9
"""A door needs its own width in front of it, but a leaf is no wider than this."""

WINDOW_CLEARANCE_M = 0.5
"""Depth that stays free in front of a window, above its sill."""

TOUCH_M = 0.01
"""Clearances are smaller by this on every side: standing flush beside a door is fine."""

BEFORE_WINDOWS = (Mount.WINDOW, Mount.BOARD, Mount.PIECE)
"""Mounts of dressing that may be before a window."""

PROBE_M = 0.1
"""How far beyond the wall's face one looks for the room on that side."""


BORDER_M = 0.05
"""A passage less deep goes through no wall: rooms lie open to each other all along it."""

WAY_M = 0.7
"""An open border is used by one way across it, which is at least so wide."""

LEAST_OPEN_M = 0.5
"""Rooms that touch along less than this are not open to each other."""

_BORDER_HEIGHT_M = 2.0


ClearFloor = tuple[Opening, shapely.Geometry]
"""An opening, and floor before it that stays free."""


@dataclass(frozen=True)
class Blocked:
    """An item in the clearance of an opening."""

    opening: str
    item: str


def rooms_beside(
    openings: Sequence[Opening], rooms: Sequence[Room]
) -> list[tuple[Room | None, Room | None]]:
    """For each opening the rooms in front of it (-y side at yaw 0) and behind; None is outside.

    Found from the geometry, so it also holds where Opening.room_ids is empty.
    """
    if not openings or not rooms:
        return [(None, None)] * len(openings)
    boxes = [opening.box for opening in openings]
    center_m = np.array([box.center_m[:2] for box in boxes])
    reach_m = np.array([max(box.size_m[1], WALL_THICKNESS_M) / 2 + PROBE_M for box in boxes])
    step_m = np.array([front_direction(box.yaw_deg) for box in boxes]) * reach_m[:, None]
    # (2, openings, 1, xy) probes against (rooms,) floors
    probes_m = np.stack([center_m + step_m, center_m - step_m])[:, :, None, :]
    # Of object dtype where there is no room, too: the query takes no other.
    floors = np.array([room_polygon(room) for room in rooms], dtype=object)
    inside = shapely.contains_xy(floors, probes_m[..., 0], probes_m[..., 1])

    def holder(row: BoolArray) -> Room | None:
        return rooms[int(row.argmax())] if row.any() else None

    return [(holder(front), holder(back)) for front, back in zip(*inside, strict=True)]


def sides_of(openings: Sequence[Opening], rooms: Sequence[Room]) -> Iterator[tuple[Opening, Room]]:
    """Each opening with each room that it has beside it."""
    for opening, beside in zip(openings, rooms_beside(openings, rooms), strict=True):
        for room in beside:
            if room is not None:
                yield opening, room


def clearance_depth_m(opening: Opening) -> float:
    """How deep the floor in front of an opening stays free, metres."""
    if opening.kind == "window":
        return WINDOW_CLEARANCE_M
    return min(opening.box.size_m[0], MAX_CLEARANCE_M)


def clearance_boxes(opening: Opening) -> tuple[Box, Box]:
    """The boxes in front of and behind an opening that stay free, TOUCH_M smaller all round."""
    box = opening.box
    depth_m = clearance_depth_m(opening)
    step = front_direction(box.yaw_deg) * (box.size_m[1] + depth_m) / 2
    size_m = (
        max(box.size_m[0] - 2 * TOUCH_M, TOUCH_M),
        depth_m - 2 * TOUCH_M,
        box.size_m[2],
    )
    x_m, y_m, z_m = box.center_m
    front = replace(box, center_m=(x_m + step[0], y_m + step[1], z_m), size_m=size_m)
    back = replace(box, center_m=(x_m - step[0], y_m - step[1], z_m), size_m=size_m)
    return front, back


def _open_floors(rooms: Sequence[Room]) -> dict[str, shapely.Geometry]:
    """By room id, the floor one sees without looking through a wall: it and what touches it."""
    # Of object dtype where there is no room, too: the query takes no other.
    floors = np.array([room_polygon(room) for room in rooms], dtype=object)
    near, other = shapely.STRtree(floors).query(floors, predicate="dwithin", distance=TOUCH_M)
    return {
        room.id: shapely.union_all(floors[other[near == index]]) for index, room in enumerate(rooms)
    }


def is_open_border(opening: Opening) -> bool:
    """Whether no wall is to the left or right of a passage, but the same floor on both sides."""
    return opening.kind == "passage" and opening.box.size_m[1] < BORDER_M


@lru_cache(maxsize=64)  # rules and drafts ask for the same rooms again and again
def open_borders(
    rooms: tuple[Room, ...], openings: tuple[Opening, ...] = ()
) -> tuple[Opening, ...]:
    """Where rooms touch and no wall parts them: a passage for each straight side.

    Sides of one pair of rooms have one id. Left out are pairs that one of the openings joins as an
    open border, and stairs, which one steps onto at their passages alone.
    """
    rooms = tuple(room for room in rooms if not is_cell(room))
    floors = [room_polygon(room) for room in rooms]
    noted = [footprint_polygon(each.box).buffer(BORDER_M) for each in openings
             if is_open_border(each)]  # fmt: skip
    borders = []
    for near, far, seam in seams(floors, TOUCH_M):
        if any(seam.intersects(shape) for shape in noted):
            continue
        ids = rooms[near].id, rooms[far].id
        for line in _straight(seam):
            borders.append(_passage_along(line, ids))
    return tuple(borders)


def _straight(seam: shapely.Geometry) -> Iterator[shapely.LineString]:
    """The straight sides of a seam that are long enough to walk through."""
    merged = shapely.line_merge(seam) if seam.geom_type == "MultiLineString" else seam
    for part in shapely.get_parts(merged):
        corners = shapely.get_coordinates(shapely.simplify(part, TOUCH_M))
        for side in pairwise(corners):
            line = shapely.LineString(side)
            if line.length >= LEAST_OPEN_M:
                yield line


def _passage_along(line: shapely.LineString, ids: tuple[str, str]) -> Opening:
    start, end = shapely.get_coordinates(line)
    x_m, y_m = ((start + end) / 2).tolist()
    yaw_deg = float(np.degrees(np.arctan2(*(end - start)[::-1])))
    box = Box((x_m, y_m, 0.0), (line.length, TOUCH_M, _BORDER_HEIGHT_M), yaw_deg)
    return Opening(f"{ids[0]}_{ids[1].rsplit('/', 1)[-1]}", "passage", box, ids)


@lru_cache(maxsize=256)  # drafts of a house ask for the same rooms again and again
def solid_sides(room: Room, gaps: tuple[Opening, ...]) -> FloatArray:
    """(W, 2, 2) the sides of a room without the spans of passages and open borders, metres."""
    spans = []
    for start, end in room_sides(room):
        length = float(np.hypot(*(end - start)))
        if length < 1e-6:
            continue
        along = (end - start) / length
        left = [(0.0, length)]
        for gap in gaps:
            ahead = np.array(gap.box.center_m[:2]) - start
            turn = np.radians(gap.box.yaw_deg)
            is_along = abs(along @ (np.cos(turn), np.sin(turn))) > 0.9
            away = abs(float(ahead @ (-along[1], along[0])))
            if is_along and away < gap.box.size_m[1] / 2 + PROBE_M:
                s, half = float(ahead @ along), gap.box.size_m[0] / 2
                left = [
                    (low, high)
                    for a, b in left
                    for low, high in ((a, min(b, s - half)), (max(a, s + half), b))
                    if high - low > 1e-3
                ]
        spans += [(start + along * a, start + along * b) for a, b in left]
    return np.array(spans).reshape(-1, 2, 2)


def clearances(rooms: Sequence[Room], openings: Sequence[Opening]) -> Iterator[ClearFloor]:
    """Each opening with the floor that stays free on each of its sides that is a room.

    Open borders keep no floor free: one walks across anywhere (blocked_openings).
    """
    floors = _open_floors(rooms)
    openings = [opening for opening in openings if not is_open_border(opening)]
    beside = rooms_beside(openings, rooms)
    for opening, sides in zip(openings, beside, strict=True):
        for room, box in zip(sides, clearance_boxes(opening), strict=True):
            if room is not None:
                yield opening, footprint_polygon(box).intersection(floors[room.id])


@lru_cache(maxsize=64)
def _clearances(
    rooms: tuple[Room, ...], openings: tuple[Opening, ...]
) -> tuple[ClearFloor, ...]:  # fmt: skip
    return tuple(clearances(rooms, openings))


def enters_height(base_m: float, top_m: float, opening: Opening) -> bool:
    """Whether something from base_m to top_m is before an opening, not below or above it."""
    sill_m = opening.box.center_m[2]
    lintel_m = sill_m + opening.box.size_m[2]
    return bool(top_m > sill_m + TOUCH_M and base_m < lintel_m)


def is_high_enough(item: Item, opening: Opening) -> bool:
    """Whether an item on the clear floor of an opening is in its way, not below it or underfoot.

    Curtains are made to hang before windows, and sills and furniture there carry small things.
    """
    base_m, height_m = item.box.center_m[2], item.box.size_m[2]
    if is_underfoot(item) or not enters_height(base_m, base_m + height_m, opening):
        return False
    row = CATEGORIES.get(item.category)
    if row is None or row.level is not Level.DRESSING or opening.kind != "window":
        return True
    return row.mount not in BEFORE_WINDOWS


def blocked_openings(graph: SceneGraph) -> list[Blocked]:
    """Openings with an item in the box in front of them, on either side (SceneEval).

    The box is as wide as the opening and clearance_depth_m deep, clipped to the room it lies in.
    Items below the sill, above the lintel or underfoot do not block. Dressing counts as items do
    (is_high_enough). One entry for each pair. An open border, whether the plan notes it or rooms
    touch there, is blocked by all that stands in it where no way of WAY_M is left across it.
    """
    things = (*graph.items, *graph.dressing)
    if not things:
        return []
    prints = footprints_of(things)
    tree = shapely.STRtree(prints.polygons)
    blocked: dict[Blocked, None] = {}
    for opening, clearance in _clearances(graph.rooms, graph.openings):
        for index in sorted(tree.query(clearance, predicate="intersects")):
            item = things[index]
            shared_m2 = prints.polygons[index].intersection(clearance, grid_size=GRID_M).area
            if shared_m2 > MIN_OVERLAP_M2 and is_high_enough(item, opening):
                blocked[Blocked(opening=opening.id, item=item.id)] = None
    blocked.update(dict.fromkeys(shut_borders(graph)))
    return list(blocked)


def border_sides(graph: SceneGraph) -> list[list[Opening]]:
    """The open borders of a house, noted or where rooms touch, each with all of its sides."""
    borders = [*filter(is_open_border, graph.openings), *open_borders(graph.rooms, graph.openings)]
    return [list(sides) for _, sides in groupby(borders, lambda border: border.id)]


def shut_borders(graph: SceneGraph) -> Iterator[Blocked]:
    """Open borders without a way across, each with all that stands in it."""
    borders = border_sides(graph)
    if not borders:
        return
    things = (*graph.items, *graph.dressing)
    tree = shapely.STRtree(footprints_of(things).polygons)
    for sides in borders:
        inside: dict[str, None] = {}
        for side in sides:
            near = sorted(tree.query(floor_across(side), predicate="intersects"))
            standing = [things[index] for index in near if is_high_enough(things[index], side)]
            if has_way(side, [item.box for item in standing]):
                break
            inside.update((item.id, None) for item in standing)
        else:
            yield from (Blocked(sides[0].id, item_id) for item_id in inside)


def floor_across(border: Opening) -> shapely.Polygon:
    """The floor on both sides of an open border that a way across it takes up."""
    length, _, height = border.box.size_m
    return footprint_polygon(replace(border.box, size_m=(length, WAY_M, height)))


def has_way(border: Opening, boxes: Iterable[Box]) -> bool:
    """Whether boxes on the floor leave a way across a side of an open border."""
    strip = floor_across(border)
    length = border.box.size_m[0]
    spans = []
    for box in boxes:
        part = footprint_polygon(box).intersection(strip)
        if not part.is_empty:
            along = to_own(border.box, shapely.get_coordinates(part))[:, 0] + length / 2
            spans.append((float(along.min()), float(along.max())))
    return any(high - low >= min(WAY_M, length) for low, high in gaps(spans, length))


class ClearFloors:
    """The floor that the openings of a house keep free, to be asked for by place."""

    def __init__(self, clear: Sequence[ClearFloor]) -> None:
        self.openings = [opening for opening, _ in clear]
        self._tree = shapely.STRtree([floor for _, floor in clear])
        self._bounds = shapely.bounds([floor for _, floor in clear]).reshape(-1, 4)

    def before(self, box: Box) -> list[tuple[Opening, shapely.Geometry]]:
        """Openings that a box stands before, and their clear floor."""
        reach = np.hypot(*box.size_m[:2]) / 2
        middle = np.array(box.center_m[:2])
        low, high = self._bounds[:, :2] - reach, self._bounds[:, 2:] + reach
        if not ((low < middle) & (middle < high)).all(axis=1).any():
            return []
        shape = footprint_polygon(box)
        near = np.sort(self._tree.query(shape, predicate="intersects"))
        floors = self._tree.geometries[near]
        shared_m2 = shapely.area(shapely.intersection(shape, floors))
        return [
            (self.openings[index], floor)
            for index, floor, area in zip(near, floors, shared_m2, strict=True)
            if area > MIN_OVERLAP_M2
        ]

    def below_sill(self, item: Item) -> Item:
        """The piece as low as the windows it stands before ask, where its category can be."""
        row = CATEGORIES.get(item.category)
        if row is None or row.mount is not Mount.FLOOR:
            return item
        sills = [opening.box.center_m[2] for opening, _ in self.before(item.box)]
        lowest = min((sill for sill in sills if sill >= row.height_m[0]), default=None)
        if lowest is None:
            return item
        length, width, height = item.box.size_m
        box = replace(item.box, size_m=(length, width, min(height, lowest)))
        return replace(item, box=box).with_facts(below_sill_m=lowest)
