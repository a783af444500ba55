"""Doors that a planned floor lacks: every room can be reached, from one front door.

A label map says where most doors are. Where it leaves a room shut, the room gets a door to the
neighbour that architects would choose: a corridor or a living room rather than a bedroom, never
through a bathroom if there is another way.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from chord_usd.base.metrics.walk import ENTRANCE_KINDS
from chord_usd.base.scene.geometry import gaps
from chord_usd.base.scene.types import Opening, RoomKind

DOOR_M = 0.8
FRONT_DOOR_M = 0.9

THROUGH: tuple[RoomKind, ...] = (
    "corridor", "living", "dining", "kitchen", "study", "bedroom", "store", "balcony", "bathroom",
)  # fmt: skip
"""Rooms that one goes through to another, likeliest first."""

_LEAST_M = 0.65
"""A door may be this narrow where there is no more wall."""


@dataclass(frozen=True)
class Border:
    """A stretch of wall that could take a door: places along it, metres from its start."""

    rooms: tuple[str, ...]
    """Ids of the two rooms, or the one room, on its sides."""
    index: int
    """What the caller knows it by."""
    length_m: float
    taken_m: tuple[tuple[float, float], ...]
    """From where to where there are openings already."""


@dataclass(frozen=True)
class MissingDoor:
    """Where a door is to be put."""

    border: Border
    middle_m: float
    width_m: float


def missing_doors(
    kinds: dict[str, RoomKind], openings: Sequence[Opening], borders: Sequence[Border]
) -> list[MissingDoor]:
    """Doors to add so that a front door leads to every room; fewer where there is no wall for one.

    kinds: of the rooms, by their ids.
    """
    doors: list[MissingDoor] = []
    entered = [
        opening.room_ids[0]
        for opening in openings
        if opening.kind == "door"
        and len(opening.room_ids) == 1
        and kinds[opening.room_ids[0]] in ENTRANCE_KINDS
    ]
    ways: list[tuple[str, ...]] = [
        o.room_ids for o in openings if o.kind != "window" and len(o.room_ids) == 2
    ]
    if not entered:
        outer = [border for border in borders if len(border.rooms) == 1]
        ranked = [(_entrance_rank(kinds[border.rooms[0]]), border) for border in outer]
        front = _best(ranked, FRONT_DOOR_M)
        if front is None:
            return []
        doors.append(front)
        entered = [front.border.rooms[0]]
    reached = _reached(entered[:1], ways)
    while len(reached) < len(kinds):
        between = [b for b in borders if len(set(b.rooms) & reached) == 1 and len(b.rooms) == 2]
        ranked = [(_way_rank(border, reached, kinds), border) for border in between]
        door = _best(ranked, DOOR_M)
        if door is None:
            return doors
        doors.append(door)
        ways.append(door.border.rooms)
        reached = _reached(reached, ways)
    return doors


def _entrance_rank(kind: RoomKind) -> int:
    return ENTRANCE_KINDS.index(kind) if kind in ENTRANCE_KINDS else len(ENTRANCE_KINDS)


def _way_rank(border: Border, reached: Collection[str], kinds: dict[str, RoomKind]) -> int:
    return THROUGH.index(next(kinds[room] for room in border.rooms if room in reached))


def _reached(start: Iterable[str], ways: Sequence[tuple[str, ...]]) -> set[str]:
    """Rooms that these ways lead to from the first ones."""
    reached = set(start)
    while True:
        more = {room for way in ways if reached & set(way) for room in way} - reached
        if not more:
            return reached
        reached |= more


def _best(ranked: Sequence[tuple[int, Border]], width_m: float) -> MissingDoor | None:
    """The border of the best rank with room for a door, the longest of equals."""
    for _, border in sorted(ranked, key=lambda row: (row[0], -row[1].length_m)):
        free = list(gaps(border.taken_m, border.length_m))
        if not free:
            continue
        low, high = max(free, key=lambda gap: gap[1] - gap[0])
        if high - low >= _LEAST_M:
            width = min(width_m, high - low)
            # By the corner, as doors are: the wall stays free for furniture.
            middle = low + width / 2
            return MissingDoor(border, middle, width)
    return None
