"""What somebody wants changed in a furnished house: what a sentence was understood as."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Action = Literal[
    "add", "remove", "move", "turn", "face", "swap", "replace", "style", "lock", "unlock", "paint"
]
Relation = Literal[
    "", "by", "away from", "nearer to", "between", "under", "above", "before", "behind", "left of",
    "right of",
]  # fmt: skip
Way = Literal["", "north", "east", "south", "west", "left", "right", "forwards", "backwards"]
Surface = Literal["", "wall", "floor"]

COMPASS_DEG: dict[Way, float] = {"east": 0.0, "north": 90.0, "west": 180.0, "south": 270.0}
"""Counter-clockwise from +x; north is +y, upwards on a plan."""

SEEN_DEG: dict[str, float] = {
    "right": 0.0, "backwards": 90.0, "left": 180.0, "forwards": 270.0,
    "right of": 0.0, "behind": 90.0, "left of": 180.0, "before": 270.0,
}  # fmt: skip
"""The same in a piece's own frame, as somebody sees it who stands before its front."""

WINDOW, DOOR, WALL = "window", "door", "wall"
CORNER, MIDDLE = "corner", "middle"
"""What stands for any of the room's own in anchors; "north wall" is the wall on that side."""


def way_deg(way: str, yaw_deg: float) -> float:
    """Where a way leads, counter-clockwise from +x. yaw_deg: of the piece that goes it."""
    return COMPASS_DEG[way] if way in COMPASS_DEG else SEEN_DEG[way] + yaw_deg  # type: ignore[index]


@dataclass(frozen=True)
class Coat:
    """A colour, a material, or a colour of a material, that something is to have."""

    name: str
    """As it was said."""
    rgb: tuple[int, int, int] | None = None
    """sRGB, 0 to 255."""
    material: str = ""
    """A word for it, such as velvet, oak or tiles; "darker" and "lighter" compare."""


@dataclass(frozen=True)
class NewPiece:
    """A piece that a room is to get."""

    category: str
    """Name of a row of the palette."""
    length_m: tuple[float, float] = (0.0, math.inf)
    """From, to."""
    size: Literal["", "small", "large"] = ""
    coat: Coat | None = None
    style: str = ""
    form: str = ""
    """A word of the names of models, such as round."""
    word: str = ""
    """What it was called."""
    is_other: bool = False
    """Whether it is to be another model than the piece that it replaces."""


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
    way: Way = ""
    distance_m: float | None = None
    turn_deg: float = 0.0
    """Counter-clockwise."""
    style: str = ""
    to_room: str = ""
    """Id of the room that a piece is moved to, where that is another one."""
    coat: Coat | None = None
    surface: Surface = ""
    """Of the room, that gets the coat; "" where items get it."""

    @property
    def rooms(self) -> tuple[str, ...]:
        """Ids of the rooms that it changes."""
        return (self.room, self.to_room) if self.to_room else (self.room,)
