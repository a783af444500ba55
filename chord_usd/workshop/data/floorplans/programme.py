"""Which rooms a house has, and how large they are."""

from __future__ import annotations

from dataclasses import dataclass

from chord_usd.base.scene.types import RoomKind
from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.floorplans.sketch import STEP_M

ROOM_COUNT_HISTOGRAM: dict[int, int] = {
    1: 30, 2: 127, 3: 151, 4: 230, 5: 397, 6: 683, 7: 862, 8: 992, 9: 1094, 10: 1168,
    11: 1032, 12: 951, 13: 730, 14: 495, 15: 297, 16: 206, 17: 105, 18: 67, 19: 37, 20: 23,
    21: 14, 22: 8, 23: 3, 24: 3,
}  # fmt: skip
"""Houses by number of rooms (CHOrD supplementary, "Distribution of room counts per house").

The paper's single house of 28 rooms is left out. Mean 9.78.
"""

MOST_ROOMS = max(ROOM_COUNT_HISTOGRAM)

_GOLDEN = 0.6180339887498949

AREA_M2: dict[RoomKind, tuple[float, float]] = {
    "living": (15.0, 38.0),
    "dining": (8.0, 16.0),
    "bedroom": (8.5, 20.0),
    "kitchen": (4.5, 13.0),
    "bathroom": (3.0, 7.0),
    "study": (6.0, 12.0),
    "store": (2.0, 5.0),
}
"""Usual floor areas; the layouts stretch them by up to a quarter."""


@dataclass(slots=True)
class Programme:
    """How many rooms of each kind a house has."""

    living: int = 1
    dining: int = 0
    bedroom: int = 0
    kitchen: int = 0
    bathroom: int = 0
    balcony: int = 0
    corridor: int = 0
    study: int = 0
    store: int = 0

    @property
    def total(self) -> int:
        """Rooms in all."""
        return (
            self.living + self.dining + self.bedroom + self.kitchen + self.bathroom
            + self.balcony + self.corridor + self.study + self.store
        )  # fmt: skip


def floor_area(dice: Dice, kind: RoomKind) -> float:
    """A usual floor area of such a room, in square steps."""
    low, high = AREA_M2[kind]
    return dice.about(low, high) / (STEP_M * STEP_M)


# Weight of the first, second, ... room of a kind among the rooms that are added one by one. Tuned
# so that the shares follow the paper's counts of non-empty rooms (table "non-empty room
# statistics"): 4.2 bedrooms (every kind of private room), 1.7 bathrooms, 0.85 kitchens and 0.85
# balconies a house, 1.6 living rooms (dining rooms among them).
_EXTRA_WEIGHTS: dict[str, tuple[float, ...]] = {
    "bedroom": (9.0, 5.0, 3.5, 1.6, 1.2, 1.0, 0.8, 0.6, 0.5),
    "bathroom": (2.2, 0.9, 0.5, 0.5, 0.3),
    "balcony": (2.6, 0.9, 0.3),
    "dining": (2.0,),
    "study": (0.9, 0.3),
    "store": (0.8, 0.4, 0.3),
}


def room_count(dice: Dice) -> int:
    """A number of rooms, distributed as in the paper."""
    return dice.weighted(list(ROOM_COUNT_HISTOGRAM.items()))


def spread_room_count(seed: int) -> int:
    """The number of rooms of the house of this seed: any run of seeds has the paper's shares.

    Seeds step through the distribution by the golden ratio, so that even a hundred houses in a row
    hold each number about as often as the paper's thousands do.
    """
    left = seed * _GOLDEN % 1.0 * sum(ROOM_COUNT_HISTOGRAM.values())
    for rooms, houses in ROOM_COUNT_HISTOGRAM.items():
        left -= houses
        if left < 0.0:
            return rooms
    return MOST_ROOMS


def draw_programme(dice: Dice, rooms: int) -> Programme:
    """A sensible set of this many rooms, 1 to MOST_ROOMS."""
    programme = Programme(bathroom=int(rooms >= 2), kitchen=int(rooms >= 3))
    programme.bedroom = int(rooms >= 5 or (rooms == 4 and dice.chance(0.8)))
    programme.corridor = _corridors(dice, rooms)
    while programme.total < rooms:
        name = dice.weighted(_candidates(programme))
        setattr(programme, name, getattr(programme, name) + 1)
    return programme


def _corridors(dice: Dice, rooms: int) -> int:
    if rooms < 6:
        return 0
    if rooms < 9:
        return int(dice.chance(0.55))
    return 1 if rooms < 12 or dice.chance(0.5 if rooms < 16 else 0.0) else 2


def _candidates(programme: Programme) -> list[tuple[str, float]]:
    candidates = []
    for name, weights in _EXTRA_WEIGHTS.items():
        placed = getattr(programme, name) - (name == "bathroom")
        weight = weights[placed] if placed < len(weights) else 0.0
        if name == "bathroom" and placed >= programme.bedroom:
            weight = 0.0
        if name == "balcony" and placed > programme.bedroom:
            weight = 0.0
        candidates.append((name, weight))
    candidates.append(("bedroom", 0.05))
    return candidates
