"""Furnish a plan by the rules of thumb of interior design: functional groups, one after another."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence

import numpy as np

from chord_usd.data.furnish.bathroom import furnish_bathroom
from chord_usd.data.furnish.bedroom import furnish_bedroom
from chord_usd.data.furnish.dining import furnish_dining
from chord_usd.data.furnish.floor import Floor, Placed
from chord_usd.data.furnish.guess import guess_kinds
from chord_usd.data.furnish.kitchen import furnish_kitchen
from chord_usd.data.furnish.living import furnish_living
from chord_usd.data.furnish.openings import attach_open_sides, attach_openings
from chord_usd.data.furnish.paths import unreachable
from chord_usd.data.furnish.small import (
    furnish_balcony,
    furnish_corridor,
    furnish_store,
    furnish_study,
)
from chord_usd.types import Box, Item, Plan, SceneGraph

__all__ = ["furnish"]

MOST_REPAIRS = 4
"""Groups given up at most for the sake of free paths."""


def furnish(plan: Plan, rng: np.random.Generator) -> SceneGraph:
    """The plan with furniture in every room that should have some.

    Rooms of unknown kind are furnished as what they look like; the rooms of the result keep their
    kind. No two footprints overlap, all are inside their rooms, the space in front of doors and
    windows is free. The same plan and state of rng give the same house.
    """
    dice = random.Random(int(rng.integers(1 << 62)))
    floors = [Floor(room, room.kind, dice) for room in plan.rooms]
    attach_open_sides(floors)
    attach_openings(floors, plan.openings)
    guess_kinds(floors)
    laundry = _laundry_balcony(floors, dice)
    for floor in floors:
        if len(floor.corners) >= 3:
            _furnish_room(floor, floors, floor is laundry)
            _clear_paths(floor)
    items = tuple(item for floor in floors for item in _items(floor))
    return SceneGraph(rooms=plan.rooms, openings=plan.openings, items=items, extra=plan.extra)


def _furnish_room(floor: Floor, floors: Sequence[Floor], is_laundry: bool) -> None:
    match floor.kind:
        case "bedroom":
            furnish_bedroom(floor)
        case "living":
            furnish_living(floor, with_dining=not any(f.kind == "dining" for f in floors))
        case "dining":
            furnish_dining(floor)
        case "kitchen":
            furnish_kitchen(floor)
        case "bathroom":
            furnish_bathroom(floor)
        case "balcony":
            furnish_balcony(floor, with_laundry=is_laundry)
        case "corridor":
            furnish_corridor(floor)
        case "study":
            furnish_study(floor)
        case "store":
            furnish_store(floor)


def _laundry_balcony(floors: Sequence[Floor], dice: random.Random) -> Floor | None:
    """The balcony with the washing machine, if the house has its laundry on a balcony."""
    balconies = [floor for floor in floors if floor.kind == "balcony"]
    if not balconies or dice.random() > 0.65:
        return None
    return dice.choice(balconies)


def _clear_paths(floor: Floor) -> None:
    """Give up groups, the least important first, until people can walk through the room."""
    for _ in range(MOST_REPAIRS):
        if not floor.placed:
            return
        connected, lost = unreachable(floor)
        if connected and not lost:
            return
        doomed = [p for p in lost if not p.core]
        if connected and not doomed:
            return
        last = [p for p in floor.placed if not p.core]
        if not doomed and not last:
            return
        group = doomed[-1].group if doomed else last[-1].group
        floor.placed = [p for p in floor.placed if p.core or p.group != group]


def _items(floor: Floor) -> list[Item]:
    counts: Counter[str] = Counter()
    items = []
    for piece in floor.placed:
        number = counts[piece.category]
        counts[piece.category] += 1
        items.append(_item(floor.room.id, piece, number))
    return items


def _item(room_id: str, piece: Placed, number: int) -> Item:
    box = Box((piece.x, piece.y, piece.z), piece.size, piece.yaw_deg)
    return Item(f"{room_id}/{piece.category}_{number}", piece.category, box, room_id)
