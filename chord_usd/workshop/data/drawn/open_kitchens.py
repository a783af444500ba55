"""Kitchens that lie open to the living or dining room, as in most homes built today."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.polygon import orient

from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import WALL_THICKNESS_M, Plan, Room, frozen_array

_OVERLAP_M = 0.02
_HALF_WALL_M = (WALL_THICKNESS_M + _OVERLAP_M) / 2
"""Rooms grown by so much overlap in the middle of their wall."""
_LEAST_M = 1.2
"""Of wall that is taken away."""
_GRID_M = 1e-3


def with_open_kitchen(plan: Plan, rng: np.random.Generator) -> Plan:
    """The plan with a kitchen reaching across the wall to a living or dining room, where one lies
    beside it; the two touch then. Some of the wall may stay."""
    kitchens = [room for room in plan.rooms if room.kind == "kitchen"]
    others = [room for room in plan.rooms if room.kind in ("living", "dining")]
    pairs = list(product(kitchens, others))
    for index in rng.permutation(len(pairs)):
        kitchen, other = pairs[index]
        grown = _across_wall(kitchen, other, rng.uniform(0.5, 1.3))
        if grown is None:
            continue
        corners = frozen_array(orient(grown).exterior.coords[:-1])
        opened = replace(kitchen, polygon_m=corners)
        rooms = tuple(opened if room is kitchen else room for room in plan.rooms)
        both = {kitchen.id, other.id}
        kept = tuple(opening for opening in plan.openings if set(opening.room_ids) != both)
        return replace(plan, rooms=rooms, openings=kept)
    return plan


def _across_wall(room: Room, other: Room, share: float) -> Polygon | None:
    """A room with a share of the wall to another one, at most all; None without a straight wall."""
    floors = [room_polygon(room), room_polygon(other)]
    grown = [floor.buffer(_HALF_WALL_M, join_style="mitre") for floor in floors]
    middle = grown[0].intersection(grown[1])
    if middle.geom_type != "Polygon" or floors[0].distance(floors[1]) < WALL_THICKNESS_M / 2:
        return None
    low, high = np.reshape(middle.bounds, (2, 2))
    sides = high - low
    length = float(sides.max()) - 2 * _HALF_WALL_M
    if sides.min() > 3 * _OVERLAP_M or length * share < _LEAST_M:
        return None  # slanted or bent, or too short
    reach = np.where(sides == sides.max(), length * min(share, 1.0), WALL_THICKNESS_M) / 2
    bridge = shapely.box(*((low + high) / 2 - reach), *((low + high) / 2 + reach))
    whole = shapely.union(floors[0], bridge, grid_size=_GRID_M)
    if not isinstance(whole, Polygon) or whole.interiors:
        return None
    return whole
