"""Several dwellings on one plan: which rooms are whose, and which are common to all."""

from __future__ import annotations

from dataclasses import replace

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.types import Plan, Room

DWELLING = "dwelling"
"""Key of Room.extra: the number of the room's dwelling, from 1; 0 for common parts, such as stairs
and landings, which stay empty."""

NO_HOME = "this is no home"
"""Begins the warning about a plan of offices, a school or a shop."""


def dwelling_of(room: Room) -> int:
    """The number of a room's dwelling; 1 where the plan shows one, 0 for common parts."""
    number = room.extra.get(DWELLING, 1)
    return number if isinstance(number, int) else 1


def is_common(room: Room) -> bool:
    """Whether a room is common to several dwellings."""
    return dwelling_of(room) == 0


def only_dwelling(plan: Plan, number: int) -> Plan:
    """The plan with the rooms of one dwelling; doors to common parts lead outside.

    Raises PlanError where the plan has no such dwelling.
    """
    rooms = tuple(room for room in plan.rooms if dwelling_of(room) == number)
    if not rooms:
        count = len({dwelling_of(room) for room in plan.rooms} - {0})
        raise PlanError(
            f"dwelling {number} was asked for, but the plan shows {count}",
            expected=f"<dwelling> from 1 to {count}" if count > 1 else "no <dwelling>",
        )
    kept = {room.id for room in rooms}
    openings = [
        replace(opening, room_ids=tuple(room_id for room_id in opening.room_ids if room_id in kept))
        for opening in plan.openings
        if kept & set(opening.room_ids)
    ]
    return replace(plan, rooms=rooms, openings=tuple(openings))
