"""What somebody wants of a house: how many rooms of which kinds, how large. Base module."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from chord_usd.geometry import room_polygon
from chord_usd.types import ROOM_KINDS, Plan, RoomKind

WISHED_KINDS: tuple[RoomKind, ...] = tuple(kind for kind in ROOM_KINDS if kind != "unknown")

_DINING_KINDS = ("living", "dining")
"""What an open kitchen is open to."""


@dataclass(frozen=True)
class Wish:
    """A programme in an architect's sense; what is not mentioned is left to the planner."""

    counts: Mapping[RoomKind, int] = field(default_factory=dict)
    """Rooms by kind, of the kinds that were mentioned; 0 says that there shall be none."""
    area_m2: float | None = None
    """Sum of the rooms' floors."""
    open_kitchen: bool = False
    """Whether the kitchen shall be joined to a living or dining room without a door."""

    @property
    def rooms(self) -> int:
        """Rooms that were mentioned."""
        return sum(self.counts.values())


def room_counts(plan: Plan) -> dict[RoomKind, int]:
    """How many rooms of each kind a plan has; every kind is in it."""
    found = Counter(room.kind for room in plan.rooms)
    return {kind: found[kind] for kind in WISHED_KINDS}


def floor_area_m2(plan: Plan) -> float:
    """Sum of the floors of all rooms."""
    return float(sum(room_polygon(room).area for room in plan.rooms))


def has_open_kitchen(plan: Plan) -> bool:
    """Whether a passage joins a kitchen to a living or dining room."""
    kind_of = {room.id: room.kind for room in plan.rooms}
    return any(
        opening.kind == "passage"
        and "kitchen" in (kinds := {kind_of[room_id] for room_id in opening.room_ids})
        and not kinds.isdisjoint(_DINING_KINDS)
        for opening in plan.openings
    )
