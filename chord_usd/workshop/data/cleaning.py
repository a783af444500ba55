"""The cleaning that houses of others need before one learns from them.

CHOrD (section on data quality) names what is wrong in them: empty rooms, furniture outside its
room, overlapping furniture, sizes out of nature, doors that something blocks.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import Literal

from chord_usd.base.metrics.rooms import empty_rooms, out_of_room, rooms_to_furnish
from chord_usd.base.metrics.violations import violations
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.workshop.data.nudge import nudged

Fault = Literal["size", "out of room", "colliding", "blocking"]

LEAST_OF_USUAL, MOST_OF_USUAL = 0.5, 1.6
"""A piece shorter, shallower or larger than the usual ones by more than this is no such piece."""

STEPS_M = 0.02, 0.05, 0.1
"""What sticks out by no more than the last is moved in by one of these: skirting, not a fault."""

MOST_EMPTY = 0.5
"""A house is dropped when more than this share of its rooms to furnish is empty."""


@dataclass(frozen=True)
class Cleaned:
    """What is left of a house, and what was taken out of it."""

    house: SceneGraph
    removed: dict[str, Fault]
    """By item id."""
    empty: tuple[str, ...]
    """Rooms to furnish that hold nothing of their kind, before or after cleaning."""
    is_kept: bool
    """Whether it is worth learning from."""

    def counts(self) -> Counter[Fault]:
        """Items taken out, by fault."""
        return Counter(self.removed.values())


def clean(house: SceneGraph) -> Cleaned:
    """The house without items of unnatural size, out of their room, colliding or blocking a door.

    What sticks out of its room by a few centimetres is moved in. Of two that collide the smaller
    goes; overlaps by nature (a chair under its table) may stay.
    """
    removed: dict[str, Fault] = {item.id: "size" for item in house.items if not _is_usual(item)}
    house = _moved_in(house.without(removed))
    removed |= dict.fromkeys(out_of_room(house), "out of room")
    house = house.without(removed)
    removed |= dict.fromkeys(_colliding(house), "colliding")
    house = house.without(removed)
    blocking = (
        violation.item for violation in violations(house) if violation.kind == "before an opening"
    )
    removed |= dict.fromkeys(blocking, "blocking")
    house = house.without(removed)
    empty = tuple(empty_rooms(house))
    most = MOST_EMPTY * len(rooms_to_furnish(house.rooms))
    return Cleaned(house, removed, empty, bool(house.items) and len(empty) <= most)


def _moved_in(house: SceneGraph) -> SceneGraph:
    out = set(out_of_room(house))
    floors = {room.id: room_polygon(room) for room in house.rooms}

    def moved(item: Item) -> Item:
        if item.id not in out or item.room_id not in floors:
            return item
        return replace(item, box=nudged(item.box, floors[item.room_id], STEPS_M))

    return replace(house, items=tuple(moved(item) for item in house.items)) if out else house


def _is_usual(item: Item) -> bool:
    row = CATEGORIES[item.category]
    return all(
        LEAST_OF_USUAL * low <= size <= MOST_OF_USUAL * high
        for size, (low, high) in zip(item.box.size_m[:2], (row.length_m, row.width_m), strict=True)
    )


def _colliding(house: SceneGraph) -> list[str]:
    """The smaller of each colliding pair, the worst offenders first, until none collides."""
    area_m2 = {item.id: item.box.size_m[0] * item.box.size_m[1] for item in house.items}
    pairs = [violation.items for violation in violations(house) if violation.kind == "overlap"]
    gone: list[str] = []
    while pairs:
        often = Counter(item for pair in pairs for item in pair)
        worst = max(often, key=lambda item: (often[item], -area_m2.get(item, 0.0), item))
        gone.append(worst)
        pairs = [pair for pair in pairs if worst not in pair]
    return gone
