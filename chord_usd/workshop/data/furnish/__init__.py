"""Furnish a plan by the rules of thumb of interior design: functional groups, one after another."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

import numpy as np

from chord_usd.base.metrics.clear_floor import shut_borders
from chord_usd.base.metrics.complete import lacking
from chord_usd.base.metrics.rooms import is_studio
from chord_usd.base.scene.types import Box, Item, Plan, SceneGraph
from chord_usd.workshop.data.furnish.appliances import add_appliances
from chord_usd.workshop.data.furnish.attached_openings import (
    attach_open_sides,
    attach_openings,
    keep_ways_in,
)
from chord_usd.workshop.data.furnish.bathroom import furnish_bathroom
from chord_usd.workshop.data.furnish.bedroom import furnish_bedroom, put_bed
from chord_usd.workshop.data.furnish.dining import furnish_dining
from chord_usd.workshop.data.furnish.floor import Floor, Placed
from chord_usd.workshop.data.furnish.guess import guess_kinds
from chord_usd.workshop.data.furnish.hints import attach_fixtures
from chord_usd.workshop.data.furnish.kitchen import furnish_kitchen
from chord_usd.workshop.data.furnish.least import furnish_least
from chord_usd.workshop.data.furnish.living import furnish_living
from chord_usd.workshop.data.furnish.mix import MIXES, Statistics
from chord_usd.workshop.data.furnish.small import (
    furnish_balcony,
    furnish_corridor,
    furnish_store,
    furnish_study,
)
from chord_usd.workshop.data.furnish.walkways import path_faults

__all__ = ["furnish"]

ATTEMPTS = (0, 1, 1)
"""How far a room is squeezed (Floor.squeeze), one attempt after the other, for the sake of what it
needs and of free paths, before groups are given up."""

MISSING = 15
"""Worse than a door that does not connect: a bedroom without a bed, for each essential."""

MOST_REPAIRS = 4
"""Groups given up at most."""


def furnish(plan: Plan, rng: np.random.Generator, statistics: Statistics = "homes") -> SceneGraph:
    """The plan with furniture in every room that should have some.

    Rooms of unknown kind are furnished as what they look like; the rooms of the result keep their
    kind. No two footprints overlap, all are inside their rooms, the space in front of doors and
    windows is free. The same plan and state of rng give the same house. What plan.extra lists as
    "fixtures" ({category, x, y}, the middle in metres) steers bathrooms and kitchens. Every room
    gets what its kind cannot do without (metrics.complete) where that fits, the most needed first;
    statistics says how much comes besides.
    """
    dice = random.Random(int(rng.integers(1 << 62)))
    mix = MIXES[statistics]
    floors = [Floor(room, room.kind, dice, mix) for room in plan.rooms]
    attach_open_sides(floors)
    attach_openings(floors, plan.openings)
    attach_fixtures(floors, plan.extra.get("fixtures", ()))
    guess_kinds(floors)
    for floor in floors:
        floor.is_studio = floor.kind == "living" and is_studio([each.kind for each in floors])
    laundry = _laundry_balcony(floors, dice)
    for floor in floors:
        if len(floor.corners) >= 3:
            _furnish_well(floor, floors, plan, floor is laundry)
    add_appliances(floors, dice, mix)
    items = tuple(item for floor in floors for item in _items(floor))
    for floor in floors:
        floor.part()
    return _open_to_each_other(SceneGraph(plan.rooms, plan.openings, items, extra=plan.extra))


def _open_to_each_other(house: SceneGraph) -> SceneGraph:
    """The house without the pieces, the smallest first, that shut a border of rooms that touch:
    each room is furnished by itself."""
    while shut := {blocked.item for blocked in shut_borders(house)}:
        pieces = [item for item in house.items if item.id in shut]
        house = house.without([min(pieces, key=lambda item: math.prod(item.box.size_m[:2])).id])
    return house


def _furnish_well(floor: Floor, floors: Sequence[Floor], plan: Plan, is_laundry: bool) -> None:
    """The first of a few attempts that leaves the paths free, else the best one repaired."""
    empty = floor.mark()
    best: tuple[int, list[Placed]] | None = None
    for squeezed in ATTEMPTS:
        floor.squeeze(squeezed)
        if not squeezed:
            keep_ways_in(floor)
        _furnish_room(floor, floors, plan, is_laundry)
        faults = _faults(floor)
        if not faults:
            return
        if best is None or faults < best[0]:
            best = faults, floor.placed[:]
        floor.undo(empty)
    if best:
        floor.placed, floor.walked = best[1], -1
        _repair(floor)
        floor.restore(empty, floor.placed)
    if _missing(floor):
        _furnish_least(floor, empty)


def _furnish_least(floor: Floor, empty: tuple[int, int]) -> None:
    """The least a room needs, where that is more of it than what stands there."""
    missing, kept = _missing(floor), floor.placed
    floor.undo(empty)
    floor.squeeze(2)
    furnish_least(floor)
    if kept and _missing(floor) >= missing:
        floor.restore(empty, kept)


def _faults(floor: Floor) -> int:
    return (path_faults(floor) if floor.placed else 0) + MISSING * _missing(floor)


def _missing(floor: Floor) -> int:
    """How many of its essentials a room lacks; a study needs its desk."""
    standing = [piece.category for piece in floor.placed]
    if floor.kind == "study":
        return int("table" not in standing)
    needs_bed = floor.is_studio and "bed" not in standing
    return len(lacking(floor.kind, floor.area_m2, standing)) + needs_bed


def _furnish_room(floor: Floor, floors: Sequence[Floor], plan: Plan, is_laundry: bool) -> None:
    match floor.kind:
        case "bedroom":
            furnish_bedroom(floor)
        case "living":
            if floor.is_studio:
                put_bed(floor)
            furnish_living(floor, with_dining=not any(f.kind == "dining" for f in floors))
        case "dining":
            furnish_dining(floor)
        case "kitchen":
            furnish_kitchen(floor, plan)
        case "bathroom" | "washroom" | "wc":
            furnish_bathroom(floor, has_wc=any(other.kind == "wc" for other in floors))
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
    has_washroom = any(floor.kind == "washroom" for floor in floors)
    if not balconies or has_washroom or dice.random() > 0.98:
        return None
    return dice.choice(balconies)


def _repair(floor: Floor) -> None:
    """Give up groups until people can walk through the room, as few as possible."""
    faults = _faults(floor)
    for _ in range(MOST_REPAIRS):
        kept = floor.placed
        groups = dict.fromkeys(piece.group for piece in reversed(kept))
        best = None
        for group in groups:
            floor.placed = [piece for piece in kept if piece.group != group]
            floor.walked = -1
            left = _faults(floor)
            if left < faults:
                faults, best = left, floor.placed
            if not left:
                break
        floor.placed = best or kept
        if best is None or not faults:
            return


def _items(floor: Floor) -> list[Item]:
    counts: dict[str, int] = {}
    items = []
    for piece in floor.placed:
        number = counts.get(piece.category, 0)
        counts[piece.category] = number + 1
        items.append(_item(floor.room.id, piece, number))
    return items


def _item(room_id: str, piece: Placed, number: int) -> Item:
    box = Box((piece.x, piece.y, piece.z), piece.size, piece.yaw_deg)
    return Item(f"{room_id}/{piece.category}_{number}", piece.category, box, room_id)
