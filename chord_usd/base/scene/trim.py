"""What stands out of the walls around openings: casings of doors, boards and handles of windows.

Who writes it and who keeps clear of it read the same sizes here. Metres.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.ops import nearest_points

from chord_usd.base.scene.geometry import room_polygon, to_own, to_world
from chord_usd.base.scene.tunnels import ON_LINE_M, reach_m
from chord_usd.base.scene.types import Box, Opening, Room

CASING_M = (0.06, 0.017)
"""How far the casing of a door covers the wall beside its hole, and stands out of it."""

BOARD_M = (0.022, 0.035)
"""Thickness of a window board, and how far it stands out into the room and beyond the hole."""

DRIP_M = (0.03, 0.018)
"""How far the sill outside stands out of the facade, no farther than a board, and hangs down."""

BOARD_FROM_M = 0.3
"""Windows whose sill is lower have no board."""

HANDLE_M = 0.088
"""From the middle of the wall to the tip of a window's handle."""


def casings(opening: Opening, room: Room) -> list[Box]:
    """The two legs of a door's casing on the side of a room; none of other openings."""
    if opening.kind != "door":
        return []
    wide, proud = CASING_M
    middle = opening.box.size_m[0] / 2 + wide / 2
    return [
        _at_wall(opening, room, at, (wide, proud, opening.box.size_m[2]))
        for at in (-middle, middle)
    ]


def boards(opening: Opening, room: Room) -> list[Box]:
    """The board of a window on the side of a room, or its sill outside; none of other openings."""
    low_m = opening.box.center_m[2]
    if opening.kind != "window" or low_m < BOARD_FROM_M:
        return []
    thick, proud = BOARD_M
    length = opening.box.size_m[0] + 2 * proud
    board = _at_wall(opening, room, 0.0, (length, proud, thick + DRIP_M[1]))
    x_m, y_m, _ = board.center_m
    return [replace(board, center_m=(x_m, y_m, low_m - DRIP_M[1]))]


def _at_wall(
    opening: Opening, room: Room, along_m: float, size_m: tuple[float, float, float]
) -> Box:
    """A box with its back on the wall, so far along the opening, from its foot up."""
    floor = shapely.transform(room_polygon(room), lambda points: to_own(opening.box, points))
    side = 1.0 if nearest_points(floor, shapely.Point(0.0, 0.0))[0].y > 0 else -1.0
    local = along_m, side * (_face_m(opening, floor, side) + size_m[1] / 2)
    x_m, y_m = to_world(opening.box, local)
    return Box((float(x_m), float(y_m), opening.box.center_m[2]), size_m, opening.box.yaw_deg)


def _face_m(opening: Opening, floor: Polygon, side: float) -> float:
    """From an opening's middle line to the face of its wall towards a room.

    Where the face has a step, trim stands out from the higher part. floor: the room's, in the
    opening's own frame; side: 1 where it lies towards +y, else -1.
    """
    ring = np.asarray(floor.exterior.coords)
    starts, ends = ring[:-1], ring[1:]
    run, rise = np.abs(ends - starts).T
    depths = side * (starts + ends)[:, 1] / 2
    half = opening.box.size_m[0] / 2 - ON_LINE_M
    across = (np.minimum(starts, ends)[:, 0] < half) & (np.maximum(starts, ends)[:, 0] > -half)
    facing = (run > rise) & across & (depths >= 0.0) & (depths <= reach_m(opening))
    middle = float(floor.distance(shapely.Point(0.0, 0.0)))
    return float(depths[facing].max(initial=middle))
