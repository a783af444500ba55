"""Kinds of rooms as a user says them, by the numbers on the overlay: "3: bedroom, 5: bathroom"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.room_names import LEADING, room_kind, room_kinds
from chord_usd.base.scene.types import Plan, Room, RoomKind
from chord_usd.line.plan.labels import KIND_CONFIDENCE
from chord_usd.line.plan.open_plans import Use, can_share, part_room

_WHERE = "<rooms>"
_EXAMPLE = '"3: bedroom, 5: bathroom"'
_MOST_CHARACTERS = 4000


@dataclass(frozen=True)
class RoomSaid:
    """What a user says of one room."""

    which: str
    """Its number on the overlay, counted from 1, or its id."""
    kind: RoomKind
    name: str = ""
    """As the user calls it, where that says more than the kind."""
    shared: tuple[RoomKind, ...] = ()
    """All kinds, where its floor is to be parted into several: "living / kitchen"."""


def read_rooms(text: str) -> tuple[RoomSaid, ...]:
    """What a text says of rooms. Raises ChordError for what names no room or no kind of room."""
    if len(text) > _MOST_CHARACTERS:
        raise _error(f"has {len(text)} characters", f"at most {_MOST_CHARACTERS}")
    said: dict[str, RoomSaid] = {}
    for part in filter(str.strip, re.split(r"[,;，；、\n]", text)):
        which, colon, word = (piece.strip() for piece in re.sub("[：=]", ":", part).partition(":"))
        if not (which and colon and word):
            raise _error(f"'{_shown(part.strip())}' is not ROOM: KIND", "ROOM: KIND")
        kind: RoomKind = "unknown" if word.casefold() == "unknown" else room_kind(word)
        if kind == "unknown" and word.casefold() != "unknown":
            raise _error(f"'{_shown(word)}' is no kind of room", f"one of {', '.join(LEADING)}")
        if which in said:
            raise _error(f"room {_shown(which)} is named twice", "each room once")
        several = tuple(shared for shared in room_kinds(word) if can_share(shared))
        name = "" if word.casefold() == kind else word
        said[which] = RoomSaid(which, kind, name, several if len(several) > 1 else ())
    if not said:
        raise _error("is empty", "ROOM: KIND")
    return tuple(said.values())


def with_rooms(plan: Plan, said: Sequence[RoomSaid]) -> Plan:
    """The plan with rooms of the kinds that were said; ids stay. Raises ChordError, also where a
    floor has no room for all that is to share it."""
    changed = dict(enumerate(plan.rooms))
    named: dict[int, str] = {}
    for room_said in said:
        index = _index(plan.rooms, room_said.which)
        if index in named:
            raise _error(
                f"{named[index]} and {room_said.which} are the same room", "each room once"
            )
        named[index] = room_said.which
        room = plan.rooms[index]
        extra = {**room.extra, KIND_CONFIDENCE: 1.0}
        changed[index] = replace(room, kind=room_said.kind, name=room_said.name, extra=extra)
    corrected = replace(plan, rooms=tuple(changed.values()))
    for index, room_said in zip(named, said, strict=True):
        if room_said.shared:
            corrected = _parted(corrected, plan.rooms[index].id, room_said)
    return corrected


def on_storeys(said: Sequence[RoomSaid], names: Sequence[str]) -> list[tuple[RoomSaid, ...]]:
    """What is said of the rooms of each storey: "1/3: bedroom" is room 3 on the storey above the
    lowest. names: of the storeys; they stand for the numbers, too. Raises ChordError."""
    by_storey: list[list[RoomSaid]] = [[] for _ in names]
    numbers = {str(index): index for index in range(len(names))}
    numbers |= {name.casefold(): index for index, name in enumerate(names) if name}
    for room_said in said:
        storey, slash, which = (part.strip() for part in room_said.which.partition("/"))
        if not slash or storey.casefold() not in numbers:
            raise _error(
                f"room {_shown(room_said.which)} is on no storey of the house",
                f"STOREY/ROOM: KIND, storeys being 0 to {len(names) - 1}", '"1/3: bedroom"',
            )  # fmt: skip
        by_storey[numbers[storey.casefold()]].append(replace(room_said, which=which))
    return [tuple(storey_rooms) for storey_rooms in by_storey]


def _parted(plan: Plan, room_id: str, said: RoomSaid) -> Plan:
    parted = part_room(plan, room_id, [Use(kind) for kind in said.shared])
    if len(parted.rooms) - len(plan.rooms) != len(said.shared) - 1:
        area_m2 = room_polygon(plan.room(room_id)).area
        raise _error(
            f"room {_shown(said.which)}, of {area_m2:.3g} m², has no room for "
            f"{' and '.join(said.shared)}",
            "a larger room, or fewer kinds",
        )
    return parted


def _index(rooms: Sequence[Room], which: str) -> int:
    if which.isdecimal() and 1 <= int(which[:9]) <= len(rooms):
        return int(which) - 1
    for index, room in enumerate(rooms):
        if room.id == which:
            return index
    raise _error(
        f"there is no room {_shown(which)}", f"1 to {len(rooms)}, or an id such as {rooms[0].id}",
        "<numbers>",
    )  # fmt: skip


def _shown(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= 30 else f"{line[:30]}…"


def _error(what: str, expected: str, try_: str = _EXAMPLE) -> ChordError:
    return ChordError(what, where=_WHERE, expected=expected, try_=try_)
