"""What a stage holds, counted by walking through it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pxr import Kind, Usd

from chord_usd.base.runtime.stages import open_stage, reading, room_prims

LOADED_OR_NOT = Usd.PrimIsActive & Usd.PrimIsDefined & ~Usd.PrimIsAbstract
"""Which prims count where furniture is not loaded."""


@dataclass(frozen=True)
class StageSummary:
    """How much of everything is in a house."""

    rooms: int
    furniture: int
    """Pieces that stand in a room."""
    items: int
    """Furniture and all that stands on it."""
    dressing: int
    """What hangs, lies and stands in the rooms besides."""
    openings: int
    """Doors, windows and passages."""
    lights: int
    cameras: int


def summary(path: Path) -> StageSummary:
    """Count what is on the stage at path; furniture meshes are not loaded.

    Raises StageError when there is no stage.
    """
    with reading(path):
        return _counted(open_stage(path, load=False))


def _counted(stage: Usd.Stage) -> StageSummary:
    rooms = room_prims(stage)
    for room in rooms:  # openings are behind the payload
        stage.Load(room.GetPath().AppendChild("Architecture"))
    prims = [prim for room in rooms for prim in Usd.PrimRange(room, LOADED_OR_NOT)]
    nodes = [prim for prim in prims if prim.HasAttribute("chord:category")]
    components = [prim for prim in nodes if _is_component(prim)]
    dressing = [prim for prim in components if prim.GetParent().GetName() == "Dressing"]
    pieces = [prim for prim in components if prim not in dressing]
    return StageSummary(
        rooms=len(rooms),
        furniture=sum("Items" not in prim.GetPath().pathString.split("/") for prim in pieces),
        items=len(pieces),
        dressing=len(dressing),
        openings=len(nodes) - len(components),
        lights=sum(prim.GetTypeName() == "RectLight" for prim in prims),
        cameras=sum(prim.GetTypeName() == "Camera" for prim in stage.Traverse()),
    )


def _is_component(prim: Usd.Prim) -> bool:
    return bool(Usd.ModelAPI(prim).GetKind() == Kind.Tokens.component)
