"""What somebody wants of a house: how many rooms of which kinds, how large."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import LEARNED_KINDS, WET_KINDS, Plan, RoomKind

NAMES: dict[RoomKind, tuple[str, str]] = {
    "living": ("living room", "living rooms"),
    "dining": ("dining room", "dining rooms"),
    "bedroom": ("bedroom", "bedrooms"),
    "kitchen": ("kitchen", "kitchens"),
    "bathroom": ("bathroom", "bathrooms"),
    "balcony": ("balcony", "balconies"),
    "corridor": ("corridor", "corridors"),
    "study": ("study", "studies"),
    "store": ("storeroom", "storerooms"),
    "washroom": ("washroom", "washrooms"),
    "wc": ("WC", "WCs"),
}
"""What rooms of each kind are called: one of them, several."""

WISHED_KINDS: tuple[RoomKind, ...] = tuple(kind for kind in LEARNED_KINDS if kind != "unknown")

_DINING_KINDS = ("living", "dining")
"""What an open kitchen is open to."""


@dataclass(frozen=True)
class Wish:
    """A programme in an architect's sense; what is not mentioned is left to the planner."""

    counts: Mapping[RoomKind, int] = field(default_factory=dict)
    """Rooms by kind, of the WISHED_KINDS that were mentioned; 0 excludes the kind."""
    area_m2: float | None = None
    """Sum of the rooms' floors."""
    open_kitchen: bool = False
    """Whether the kitchen is to be joined to a living or dining room without a door."""
    wet: Mapping[RoomKind, int] = field(default_factory=dict)
    """How many of the bathrooms are to be washrooms and WCs."""

    @property
    def sentence(self) -> str:
        """The wish in the paper's words (supplementary, "Text-conditioned floor planning")."""
        said = [
            f"{self.counts[kind]} {NAMES[kind][self.counts[kind] != 1]}"
            for kind in WISHED_KINDS
            if kind in self.counts
        ]
        area = "" if self.area_m2 is None else f"{round(self.area_m2)}-square-meter "
        rooms = f" with {listed(said)}" if said else ""
        open_kitchen = ", with an open kitchen" if self.open_kitchen else ""
        return f"This is a {area}flat{rooms}{open_kitchen}."

    @property
    def rooms(self) -> int:
        """Rooms that were mentioned."""
        return sum(self.counts.values())


def listed(parts: list[str]) -> str:
    """Parts of a sentence: "a, b, and c"."""
    if len(parts) < 3:
        return " and ".join(parts)
    return f"{', '.join(parts[:-1])}, and {parts[-1]}"


def room_counts(plan: Plan) -> dict[RoomKind, int]:
    """How many rooms of each kind a plan has; every kind is in it."""
    counts = Counter(room.kind for room in plan.rooms)
    return {kind: counts[kind] for kind in WISHED_KINDS}


def with_wished_wet(plan: Plan, wish: Wish) -> Plan:
    """The plan with its smallest bathrooms as the WCs and washrooms that were wished for; one stays
    a bathroom."""
    baths = sorted((room for room in plan.rooms if room.kind == "bathroom"),
                   key=lambda room: room_polygon(room).area)[:-1]  # fmt: skip
    kinds = [kind for kind in WET_KINDS[:0:-1] for _ in range(wish.wet.get(kind, 0))]
    names = [f"{NAMES[kind][0].capitalize()} {kinds[:at].count(kind) + 1}"
             for at, kind in enumerate(kinds)]  # fmt: skip
    new = {room.id: replace(room, kind=kind, name=name)
           for room, kind, name in zip(baths, kinds, names, strict=False)}  # fmt: skip
    return replace(plan, rooms=tuple(new.get(room.id, room) for room in plan.rooms))


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
