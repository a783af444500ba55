"""The rooms of a written house as people call them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from pxr import Usd

from chord_usd.base.runtime.stages import open_stage, reading, room_prims
from chord_usd.base.scene.types import Room, frozen_array
from chord_usd.line.stage.author.names import printable, room_title
from chord_usd.line.stage.check.check_scene import POLYGON, room_kind_of


def titled_rooms(path: Path) -> dict[str, Room]:
    """Rooms of all storeys by the names of their prims, which are their ids; `name` is what people
    call them. Raises StageError."""
    with reading(path):
        stage = open_stage(path, load=False)
        storeys: dict[str, list[tuple[Room, str]]] = {}
        for prim in room_prims(stage):
            group = storeys.setdefault(str(prim.GetParent().GetPath()), [])
            group.append((_room(prim), printable(prim.GetDisplayName())))
    titled: dict[str, Room] = {}
    for group in storeys.values():
        rooms = [room for room, _ in group]
        titled |= {room.id: replace(room, name=room_title(room, shown, rooms))
                   for room, shown in group}  # fmt: skip
    return titled


def _room(prim: Usd.Prim) -> Room:
    corners = prim.GetAttribute(POLYGON).Get() if prim.HasAttribute(POLYGON) else None
    polygon_m = np.array(corners if corners else np.zeros((3, 2)), dtype=np.float64)
    return Room(prim.GetName(), room_kind_of(prim), frozen_array(polygon_m), prim.GetName())
