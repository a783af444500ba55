"""What somebody wants changed in a furnished house: what a sentence was understood as."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Action = Literal[
    "add", "remove", "move", "turn", "face", "swap", "replace", "style", "lock", "unlock"
]
Relation = Literal["", "by", "away from", "nearer to", "between", "under", "above", "before"]
Compass = Literal["", "north", "east", "south", "west"]

COMPASS_DEG: dict[Compass, float] = {"east": 0.0, "north": 90.0, "west": 180.0, "south": 270.0}
"""Counter-clockwise from +x; north is +y, upwards on a plan."""

WINDOW, DOOR, WALL = "window", "door", "wall"
"""What stands for any of the room's own in anchors."""


@dataclass(frozen=True)
class NewPiece:
    """A piece that a room is to get."""

    category: str
    """Name of a row of the palette."""
    length_m: tuple[float, float] = (0.0, math.inf)
    """From, to."""
    size: Literal["", "small", "large"] = ""


@dataclass(frozen=True)
class Intent:
    """One thing to do."""

    action: Action
    room: str
    """Id of the room where it is done."""
    wording: str
    """In words, for whoever said it."""
    items: tuple[str, ...] = ()
    """Ids of the pieces of the house that it is done to; two are swapped."""
    new: NewPiece | None = None
    count: int = 1
    """How many new pieces."""
    relation: Relation = ""
    anchors: tuple[str, ...] = ()
    """What the relation is to: ids of pieces, or WINDOW, DOOR, WALL."""
    way: Compass = ""
    distance_m: float | None = None
    turn_deg: float = 0.0
    """Counter-clockwise."""
    style: str = ""
    to_room: str = ""
    """Id of the room that a piece is moved to, where that is another one."""

    @property
    def rooms(self) -> tuple[str, ...]:
        """Ids of the rooms that it changes."""
        return (self.room, self.to_room) if self.to_room else (self.room,)
