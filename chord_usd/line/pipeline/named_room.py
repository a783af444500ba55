"""A room of a written house by whatever name somebody gives it: one resolver for all who ask."""

from __future__ import annotations

import re
import shlex
from difflib import get_close_matches
from pathlib import Path

from chord_usd.base.errors import ChordError, StageError

_PRIM_NAME = re.compile(r"[A-Za-z]+_\d+")


def named_room(stage: Path, said: str) -> str:
    """Name of the prim of the room that is meant.

    said: the name of its prim, a printed name, a kind with its number from 1 ("Bedroom 1"), or a
    kind alone, the largest. Raises StageError where that is no room, or several.
    """
    from chord_usd.line.lists.wishes import rooms_meant
    from chord_usd.line.stage.read.titled_rooms import titled_rooms

    rooms = titled_rooms(stage)
    prims = {name.lower(): name for name in rooms}
    if said.lower() in prims:
        return prims[said.lower()]
    try:
        if _PRIM_NAME.fullmatch(said):
            # Prims count from 0, printed names from 1: "Bedroom_1" is never the first bedroom.
            raise StageError(
                f"there is no room {said!r}",
                where=str(stage),
                expected=f"one of {', '.join(rooms)}",
            )
        meant = rooms_meant(said, rooms, str(stage))
    except ChordError as error:
        near = get_close_matches(said, [*rooms, *(room.name for room in rooms.values())], n=1)
        raise StageError(
            error.what, where=error.where, expected=error.expected,
            try_=f"<room={shlex.quote(near[0])}>" if near else "",
        ) from error  # fmt: skip
    same = [room.id for room in rooms.values() if room.name == meant[0].name]
    several = same if len(same) > 1 else [room.id for room in meant]
    if len(several) > 1:
        raise StageError(
            f"{said!r} means {len(several)} rooms", where=str(stage),
            expected=f"one of {', '.join(several)}",
        )  # fmt: skip
    return meant[0].id
