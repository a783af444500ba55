"""What takes the space of a room: pieces and the floor before them, openings, sides without a wall.

Each function adds boxes with their reason to a TakenSpace.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from chord_usd.base.metrics.clear_floor import WAY_M, clearance_boxes, is_open_border
from chord_usd.base.metrics.fronts import FRONT, STRIP_M, USED_SIDES, floor_before
from chord_usd.base.metrics.walk import WALKER_RADIUS_M
from chord_usd.base.places.swept import Leaf, swept_box
from chord_usd.base.places.taken_space import TOUCH_M, TakenSpace
from chord_usd.base.places.wall_frames import WallFace
from chord_usd.base.raster.relief import Relief
from chord_usd.base.scene.geometry import in_world, to_world
from chord_usd.base.scene.palette import CATEGORIES, Mount, having
from chord_usd.base.scene.types import ROOM_HEIGHT_M, Box, Item, Opening

ReliefOf = Callable[[Item], Relief]

_CASING_M = 0.075
"""Beside and over a door's hole."""

_FRAME_M = 0.05
"""Beside and round a window's hole, its board included."""

_PROUD_M = 0.045
_OPEN_M = 0.3
"""Nothing stands so near to where a room goes on into another."""

RISING = having("rises")
"""Categories whose meshes may rise above their nominal height: a television, a tap."""

_RISES_M = 0.02

_KNEE_M = 0.3
"""What begins higher keeps nobody from standing before a front."""


def take_pieces(taken: TakenSpace, pieces: Iterable[Item], reliefs: ReliefOf) -> None:
    """Take the space of furniture, of what rises from it and of what stands on it."""
    for item in pieces:
        row = CATEGORIES.get(item.category)
        is_rug = row is not None and row.mount is Mount.UNDERFOOT
        taken.add(item.box, "rug" if is_rug else "piece", item.id)
        if item.category in RISING:
            risen = _risen(item, reliefs(item))
            if risen is not None:
                taken.add(risen, "piece", item.id)
        for child in item.children:
            taken.add(in_world(child.box, item.box), "piece", child.id)


def take_fronts(taken: TakenSpace, pieces: Iterable[Item]) -> None:
    """Take the floor before the fronts of furniture, where people stand to use it.

    It is as deep as a walker is wide, or the strip that is measured where nobody has to stand.
    """
    for item in pieces:
        row = CATEGORIES.get(item.category)
        if row is None or row.mount is not Mount.FLOOR or item.category in having("any_side"):
            continue
        depth_m = 2 * WALKER_RADIUS_M if item.category in USED_SIDES else STRIP_M[1]
        floor = floor_before(item.box, FRONT, 0.0, depth_m)
        low = replace(floor, size_m=(*floor.size_m[:2], _KNEE_M))
        taken.add(low, "front", item.id)


def take_swings(
    taken: TakenSpace, pieces: Iterable[Item], leaves_of: Callable[[Item], Sequence[Leaf]]
) -> None:
    """Take what doors, drawers and flaps of furniture pass on their way."""
    for item in pieces:
        for leaf in leaves_of(item):
            taken.add(swept_box(leaf, item.box), "swing", item.id)


def _risen(item: Item, relief: Relief) -> Box | None:
    """The box of what rises above a piece's nominal height."""
    high = relief.heights_m > item.box.size_m[2] + _RISES_M
    if not high.any():
        return None
    rows, columns = np.flatnonzero(high.any(axis=1)), np.flatnonzero(high.any(axis=0))
    cell_x = item.box.size_m[0] / high.shape[1]
    cell_y = item.box.size_m[1] / high.shape[0]
    x0, x1 = columns[0] * cell_x, (columns[-1] + 1) * cell_x
    y0, y1 = rows[0] * cell_y, (rows[-1] + 1) * cell_y
    middle = ((x0 + x1 - item.box.size_m[0]) / 2, (item.box.size_m[1] - y0 - y1) / 2)
    x, y = to_world(item.box, middle)
    base_m = item.box.top_m
    rise_m = float(relief.heights_m.max()) - item.box.size_m[2]
    return Box((float(x), float(y), base_m), (x1 - x0, y1 - y0, rise_m), item.box.yaw_deg)


def take_walls(taken: TakenSpace, faces: Iterable[WallFace]) -> None:
    """Take the holes in walls, the casings round them, and sides without a wall."""
    for face in faces:
        for low, high in face.gaps_m:
            size_m = (high - low, _OPEN_M + 0.1, ROOM_HEIGHT_M)
            taken.add(face.box((low + high) / 2, 0.0, size_m, -0.1), "open")
        for hole in face.holes:
            beside = _CASING_M if hole.opening.kind == "door" else _FRAME_M
            low = 0.0 if hole.low_m < 0.1 else hole.low_m - beside
            size_m = (hole.width_m + 2 * beside, 0.1 + _PROUD_M, hole.high_m + beside - low)
            taken.add(face.box(hole.middle_m, low, size_m, -0.1), "pane", hole.opening.id)


def take_clearances(taken: TakenSpace, openings: Iterable[Opening]) -> None:
    """Take what openings keep clear, on both sides, and the breadth of a touch beside it.

    Across an open border there is room for a way beside what stands there, unless it is short.
    """
    for opening in openings:
        if is_open_border(opening) and opening.box.size_m[0] > 2 * WAY_M:
            continue
        for box in clearance_boxes(opening):
            length, depth, height = box.size_m
            kept = replace(box, size_m=(length + 2 * TOUCH_M, depth + 2 * TOUCH_M, height))
            taken.add(kept, "pane" if opening.kind == "window" else "clear", opening.id)
