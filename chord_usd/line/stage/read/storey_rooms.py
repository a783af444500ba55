"""One storey of a house that is read back from its stage, with the rooms that are on it."""

from __future__ import annotations

from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path

from pxr import Usd

from chord_usd.base.errors import StageError
from chord_usd.base.runtime.stages import open_stage, reading, room_prims, storey_prims
from chord_usd.base.scene.stair_cells import CELL
from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.stage.author.names import printable
from chord_usd.line.stage.author.stage_levels import SHAFT
from chord_usd.line.stage.check.check_scene import CATEGORY, read_scene, read_storeys


def storey_names(path: Path) -> dict[str, str]:
    """What the storeys of the house at path are called, the lowest first, by the name of a room on
    each; one without a name in a house of one storey. Raises StageError."""
    titles = {}
    with reading(path):
        stage = open_stage(path)  # prims live as long as it does
        for group in storey_prims(stage):
            names = [room.GetName() for room in group.GetChildren()
                     if room.GetAttribute(CATEGORY).Get() != SHAFT]  # fmt: skip
            if names:
                titles[names[0]] = printable(group.GetDisplayName()) or group.GetName()
    return titles or {"": ""}


def storey_of(stage: Usd.Stage, path: Path, room_name: str) -> tuple[SceneGraph, str]:
    """The storey that a room is on, its stairs as rooms of their own, and the name of its group; ""
    in a house of one storey. Raises StageError."""
    groups = storey_prims(stage)
    if not groups or not room_name:
        return read_scene(stage).graph, ""
    for scene, group in zip(read_storeys(stage), groups, strict=True):
        if any(room.name == room_name for room in scene.graph.rooms):
            shafts = (replace(shaft, extra={CELL: True}) for shaft in scene.shafts)
            rooms = (*scene.graph.rooms, *shafts)
            return replace(scene.graph, rooms=rooms), group.GetName()
    names = [room.GetName() for room in room_prims(stage)]
    near = get_close_matches(room_name, names, n=1)
    raise StageError(
        f"has no room {room_name!r} that is furnished", where=str(path),
        expected=f"one of {', '.join(names)}", try_=f"<room={near[0]}>" if near else "",
    )  # fmt: skip
