"""Rooms as architects draw them, with the stairs that stand in them: stages keep those apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely.geometry import Point, Polygon
from shapely.geometry.polygon import orient

from chord_usd.base.scene.geometry import footprint_polygon, polygons_of, room_polygon
from chord_usd.base.scene.types import Opening, Room, frozen_array
from chord_usd.line.stage.check.check_scene import StageScene

_TOUCH_M = 0.01
_LEAST_SEAM_M = 0.5
"""What touches a stair along less is parted from it by a wall."""

_GRID_M = 1e-4


def whole_rooms(scene: StageScene) -> tuple[StageScene, dict[str, str]]:
    """The storey with its shafts in the rooms around them, and which room each lost part is in now,
    by ids. A shaft that walls part from every room is a room of its own."""
    rooms = list(scene.graph.rooms)
    inside: dict[str, str] = {}
    for shaft in scene.shafts:
        area = room_polygon(shaft)
        parts = [room for room in rooms if _seam_m(area, room_polygon(room)) > _LEAST_SEAM_M]
        if not parts:
            rooms.append(shaft)
            continue
        main = max(parts, key=lambda room: room_polygon(room).area)
        whole = _together([area, *map(room_polygon, parts)])
        lost = [shaft.id, *(room.id for room in parts if room.id != main.id)]
        inside = {part: main.id if to in lost else to for part, to in inside.items()}
        inside |= dict.fromkeys(lost, main.id)
        rooms = [
            replace(room, polygon_m=whole) if room.id == main.id else room
            for room in rooms if room.id not in lost
        ]  # fmt: skip
    if not scene.shafts:
        return scene, {}
    openings = tuple(one for one in scene.graph.openings if not _is_within(one, rooms))
    return replace(scene, graph=replace(scene.graph, rooms=tuple(rooms), openings=openings)), inside


def _seam_m(one: Polygon, other: Polygon) -> float:
    near = one.buffer(_TOUCH_M, join_style="mitre").intersection(other.exterior)
    return float(near.length)


def _together(areas: Sequence[Polygon]) -> np.ndarray:
    """(N, 2) outline of areas that touch."""
    grown = [area.buffer(_TOUCH_M, join_style="mitre") for area in areas]
    joined = shapely.union_all(grown).buffer(-_TOUCH_M, join_style="mitre")
    largest = max(polygons_of(joined), key=lambda part: part.area)
    outline = orient(Polygon(largest.exterior).simplify(_GRID_M * 5))
    corners = np.asarray(outline.exterior.coords)[:-1]
    return frozen_array(np.round(corners / _GRID_M) * _GRID_M)


def _is_within(opening: Opening, rooms: Sequence[Room]) -> bool:
    """Whether it is no way through a wall, but where one steps on a stair within a room."""
    if opening.kind != "passage":
        return False
    middle = Point(opening.box.center_m[:2])
    deep = footprint_polygon(opening.box)
    return any(
        room_polygon(room).covers(middle)
        and room_polygon(room).intersection(deep).area > 0.9 * deep.area
        for room in rooms
    )
