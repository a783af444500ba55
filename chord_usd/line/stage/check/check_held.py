"""What carries a thing that stands on nothing: walls, ceilings, windows, and what it rests on."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import shapely

from chord_usd.base.metrics.footprints import is_underfoot
from chord_usd.base.scene.geometry import footprint, footprint_polygon, room_polygon
from chord_usd.base.scene.palette import CATEGORIES, Level, Mount, having
from chord_usd.base.scene.types import ROOM_HEIGHT_M, Item
from chord_usd.line.stage.check.check_contact import Body
from chord_usd.line.stage.check.check_scene import StageScene

WALL_GAP_M = 0.01
"""Furniture that has its back no further than this from the wall can hang on it."""

DRESSING_WALL_GAP_M = 0.002
"""The same of dressing, which hangs on walls and on splashbacks."""

LEANING_GAP_M = 0.05
"""From a wall to the nearest of what leans against it, at its foot."""

CEILING_GAP_M = 0.02

WINDOW_GAP_M = 0.3
"""From a window's hole to what hangs at it: beside it, and as far from the wall as a rail holds."""

RESTS_GAP_M = 0.02
"""Between the bounds of dressing and of the piece that it lies on."""


def underfoot(dressing: Iterable[Item]) -> frozenset[str]:
    """Ids of rugs and mats, which furniture stands on and doors sweep over."""
    return frozenset(item.id for item in dressing if is_underfoot(item))


def soft(dressing: Iterable[Item]) -> frozenset[str]:
    """Ids of cushions and throws, which sink into what they lie on and hang around it."""
    return frozenset(item.id for item in dressing if item.category in having("soft"))


class Held:
    """Whether a body is of a kind that something else than the floor carries, and that is there."""

    def __init__(self, scene: StageScene) -> None:
        graph = scene.graph
        self._items: dict[str, Item] = {item.id: item for item in (*graph.items, *graph.dressing)}
        self._bodies = {body.path: body for body in scene.items}
        self._floors = {room.id: room_polygon(room) for room in graph.rooms}
        # Curtains hang beside glass doors, too.
        windows = [
            footprint_polygon(opening.box)
            for opening in graph.openings
            if opening.kind != "passage"
        ]
        self._windows = shapely.union_all(windows)
        self._panels = shapely.union_all(
            [
                footprint_polygon(item.box)
                for item in graph.dressing
                if item.category == "splashback"
            ]
        )

    def __call__(self, body: Body) -> bool:
        item = self._items.get(body.path)
        row = CATEGORIES.get(item.category) if item else None
        if item is None or row is None:
            return False
        if row.level is not Level.DRESSING:
            hangs = row.mount is Mount.WALL or "hung" in row.traits
            return hangs and self._has_back_at_wall(item, WALL_GAP_M)
        if row.mount is Mount.WALL or "leans" in row.traits:
            leans = "leans" in row.traits
            return self._has_back_at_wall(item, LEANING_GAP_M if leans else DRESSING_WALL_GAP_M)
        if row.mount is Mount.CEILING:
            return bool(abs(body.bounds_m[1, 2] - ROOM_HEIGHT_M) <= CEILING_GAP_M)
        if row.mount is Mount.WINDOW:
            return bool(self._windows.distance(footprint_polygon(item.box)) <= WINDOW_GAP_M)
        return row.mount is Mount.PIECE and self._lies_on(body)

    def _has_back_at_wall(self, item: Item, gap_m: float) -> bool:
        if item.room_id not in self._floors:
            return False
        floor = self._floors[item.room_id]
        back = shapely.points(footprint(item.box)[[0, 3]])
        panels_m = shapely.distance(self._panels, back)  # not a number where there is none
        near = np.fmin(shapely.distance(floor.exterior, back), panels_m) <= gap_m
        return bool(np.all(near | ~floor.contains(back)))

    def _lies_on(self, body: Body) -> bool:
        carrier = self._bodies.get(body.parent)
        if carrier is None:
            return False
        apart_m = np.maximum(body.bounds_m[0], carrier.bounds_m[0]) - np.minimum(
            body.bounds_m[1], carrier.bounds_m[1]
        )
        return bool(apart_m.max() <= RESTS_GAP_M)
