"""Which looks of floors and walls each style wears: families and ranges of their parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from chord_usd.scene.types import RoomKind

Value = float | str | tuple[float, float] | tuple[str, ...]
"""One value, a range that is drawn from evenly, or words of which one is drawn."""

HOME_WOOD = "home"
"""In place of a wood: the one that the home agrees on."""


@dataclass(frozen=True)
class Ranges:
    """A family of looks and what its parameters may be; the rest keep their defaults."""

    family: str
    """Name of a family (assets.look_families)."""
    weight: float = 1.0
    """How often it is taken, next to the others of its list."""
    parameters: Mapping[str, Value] = field(default_factory=dict)


GROUP_OF: dict[RoomKind, str] = {
    "living": "living", "dining": "living", "study": "living", "unknown": "living",
    "bedroom": "bedroom", "corridor": "corridor", "store": "corridor",
    "kitchen": "kitchen", "bathroom": "bathroom", "balcony": "balcony",
}  # fmt: skip
"""Rooms of a group wear the same looks."""

Looks = Mapping[str, Mapping[str, Sequence[Ranges]]]
"""Style, group of rooms, families."""

_NONE: dict[str, Sequence[Ranges]] = {}
FLOOR_LOOKS: Looks = dict.fromkeys(
    ("modern", "scandinavian", "classic", "industrial", "japanese"), _NONE
)
WALL_LOOKS: Looks = FLOOR_LOOKS
ACCENT_LOOKS: Looks = FLOOR_LOOKS
