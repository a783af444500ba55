"""What every household has one of: where a house has none yet, any room takes it that can."""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import partial

from chord_usd.base.scene.types import RoomKind
from chord_usd.workshop.data.furnish.floor import Floor
from chord_usd.workshop.data.furnish.free_spans import Wall
from chord_usd.workshop.data.furnish.joint import Fitting, place_jointly
from chord_usd.workshop.data.furnish.mix import Mix

MOST_TRIES = 4
"""Places tried in one room."""

REFRIGERATOR = Fitting("refrigerator", (0.6, 0.6, 1.8), 0.5)
WASHING_MACHINE = Fitting("washing_machine", (0.6, 0.6, 0.85), 0.55)

_COOL: tuple[RoomKind, ...] = ("kitchen", "dining")
_WASH: tuple[RoomKind, ...] = ("washroom", "balcony", "bathroom", "kitchen")


def add_appliances(floors: Sequence[Floor], dice: random.Random, mix: Mix) -> None:
    """A refrigerator for a house with a kitchen, a washing machine for any, as often as mix says.

    To be called when the rooms are furnished; nothing is moved for them.
    """
    has_kitchen = any(floor.kind == "kitchen" for floor in floors)
    if has_kitchen and dice.random() < mix.refrigerator_anywhere:
        _add(floors, REFRIGERATOR, _COOL, ("refrigerator",))
    if dice.random() < mix.washing_machine_anywhere:
        _add(floors, WASHING_MACHINE, _WASH, ("washing_machine", "washing_set"))


def stand_alone(floor: Floor, fitting: Fitting) -> bool:
    """Stand an appliance in a corner, near the door. Returns whether it stands."""
    return place_jointly(floor, [fitting], partial(_liking, floor), MOST_TRIES)


def _add(
    floors: Sequence[Floor], fitting: Fitting, kinds: Sequence[RoomKind], any_of: Sequence[str]
) -> None:
    if any(floor.has(category) for floor in floors for category in any_of):
        return
    rooms = [floor for kind in kinds for floor in floors if floor.kind == kind]
    any(stand_alone(floor, fitting) for floor in rooms if len(floor.corners) >= 3)


def _liking(
    floor: Floor, fitting: Fitting, wall: Wall, s: float, corners: int, used: Sequence[Wall]
) -> float:
    del fitting, used
    return 0.8 * corners - 0.2 * floor.distance_to_door(*wall.world(s, 0.3))
