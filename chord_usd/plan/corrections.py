"""Kinds of rooms as a user says them, by the numbers on the overlay: "3: bedroom, 5: bathroom"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from chord_usd.errors import ChordError
from chord_usd.plan.labels import KIND_CONFIDENCE
from chord_usd.scene.room_names import LEADING, room_kind
from chord_usd.scene.types import Plan, Room, RoomKind

_WHERE = "--rooms"
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
        said[which] = RoomSaid(which, kind, "" if word.casefold() == kind else word)
    if not said:
        raise _error("is empty", "ROOM: KIND")
    return tuple(said.values())


def with_rooms(plan: Plan, said: Sequence[RoomSaid]) -> Plan:
    """The plan with rooms of the kinds that were said; ids stay. Raises ChordError."""
    changed = dict(enumerate(plan.rooms))
    told: dict[int, str] = {}
    for one in said:
        index = _index(plan.rooms, one.which)
        if index in told:
            raise _error(f"{told[index]} and {one.which} are the same room", "each room once")
        told[index] = one.which
        room = plan.rooms[index]
        extra = {**room.extra, KIND_CONFIDENCE: 1.0}
        changed[index] = replace(room, kind=one.kind, name=one.name, extra=extra)
    return replace(plan, rooms=tuple(changed.values()))


def _index(rooms: Sequence[Room], which: str) -> int:
    if which.isdecimal() and 1 <= int(which[:9]) <= len(rooms):
        return int(which) - 1
    for index, room in enumerate(rooms):
        if room.id == which:
            return index
    raise _error(
        f"there is no room {_shown(which)}", f"1 to {len(rooms)}, or an id such as {rooms[0].id}",
        "--overlay look.png shows the numbers",
    )  # fmt: skip


def _shown(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= 30 else f"{line[:30]}…"


def _error(what: str, expected: str, try_: str = _EXAMPLE) -> ChordError:
    return ChordError(what, where=_WHERE, expected=expected, try_=try_)
