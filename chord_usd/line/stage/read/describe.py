"""What a house holds and what of it can be chosen, without loading a mesh.

For programs that show a house and let people choose: its rooms and pieces by prim path, their
models, and every variant set with its choices.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from pxr import Kind, Usd

from chord_usd.base.errors import StageError
from chord_usd.base.runtime.stages import open_stage, reading, room_prims
from chord_usd.line.stage.author.names import BORDER, REQUESTS

_NODE, _CATEGORY, _SIZE, _KIND = "chord:node_id", "chord:category", "chord:size_m", "chord:kind"
_RESTS_ON = "chord:rests_on"
_GROUPS = ("Furniture", "Dressing")


@dataclass(frozen=True)
class Choice:
    """A variant set: what is chosen, and what could be."""

    chosen: str
    offered: tuple[str, ...]


Looks = dict[str, Choice]
"""By the name of the variant set."""


@dataclass(frozen=True)
class Piece:
    """Something that stands in a room, or on such a thing."""

    path: str
    """Of the prim that carries the placement: the piece, or the group around it."""
    component: str
    """Of the prim that refers to the model."""
    category: str
    size_m: tuple[float, float, float]
    """Length, width, height as placed."""
    asset: str
    """Name of the model, empty where there is none."""
    looks: Looks
    carries: tuple[str, ...]
    """Paths of the tabletop items that stand on it."""
    rests_on: str = ""
    """Of dressing: path of the piece that carries it, empty where none does."""


@dataclass(frozen=True)
class RoomContents:
    """A room, its furniture and its dressing."""

    name: str
    path: str
    kind: str
    looks: Looks
    furniture: tuple[Piece, ...]
    dressing: tuple[Piece, ...] = ()
    requests: str = ""
    """Pieces that it must and must not hold, in words."""


@dataclass(frozen=True)
class HouseContents:
    """A house as it can be browsed."""

    looks: Looks
    rooms: tuple[RoomContents, ...]
    cameras: tuple[str, ...]


def describe_stage(path: Path) -> HouseContents:
    """Read rooms, pieces and choices of a stage, layers over it included.

    Raises StageError for a file that is no stage, or a stage without rooms.
    """
    with reading(path):
        return _described(open_stage(path, load=False), path)


def _described(stage: Usd.Stage, path: Path) -> HouseContents:
    house = stage.GetDefaultPrim()
    rooms = house.GetChild("Rooms") if house else None
    if not rooms:
        raise StageError(
            "holds no rooms",
            where=str(path),
            expected="a house that chord-usd wrote",
            try_=f"<check={path.name}>",
        )
    cameras = house.GetChild("Cameras")
    every = room_prims(stage)
    paths = {node: path for room in every for node, path in _placed(room)}
    return HouseContents(
        looks=_looks(house),
        rooms=tuple(_room(prim, paths) for prim in every),
        cameras=tuple(prim.GetName() for prim in (cameras.GetChildren() if cameras else ())),
    )


def _room(prim: Usd.Prim, paths: Mapping[str, str]) -> RoomContents:
    """paths: of pieces, by node id."""
    kind = prim.GetAttribute(_KIND).Get() if prim.HasAttribute(_KIND) else "unknown"
    furniture, dressing = (tuple(_pieces(prim.GetChild(group), paths)) for group in _GROUPS)
    path = str(prim.GetPath())
    noted = prim.GetAttributeAtPath(f"Furniture.{REQUESTS}")
    asked = str(noted.Get()) if noted else ""
    return RoomContents(prim.GetName(), path, kind, _looks(prim), furniture, dressing, asked)


def _components(group: Usd.Prim) -> Iterator[tuple[Usd.Prim, Usd.Prim]]:
    """What is placed in a group, and of each the prim that refers to the model."""
    for prim in group.GetFilteredChildren(LOADED_OR_NOT) if group else ():
        component = prim if prim.HasAttribute(_NODE) else _component_in(prim)
        if component is not None:
            yield prim, component


def _placed(room: Usd.Prim) -> Iterator[tuple[str, str]]:
    for group in _GROUPS:
        for prim, component in _components(room.GetChild(group)):
            yield str(component.GetAttribute(_NODE).Get()), str(prim.GetPath())


def _pieces(group: Usd.Prim, paths: Mapping[str, str]) -> Iterator[Piece]:
    for prim, component in _components(group):
        items = prim.GetChild("Items")
        size = component.GetAttribute(_SIZE).Get() or (0.0, 0.0, 0.0)
        yield Piece(
            path=str(prim.GetPath()),
            component=str(component.GetPath()),
            category=component.GetAttribute(_CATEGORY).Get() or "",
            size_m=(float(size[0]), float(size[1]), float(size[2])),
            asset=_asset(component),
            looks=_looks(component),
            carries=_paths_in(items),
            rests_on=paths.get(str(component.GetAttribute(_RESTS_ON).Get() or ""), ""),
        )


def _paths_in(group: Usd.Prim) -> tuple[str, ...]:
    below = group.GetFilteredChildren(LOADED_OR_NOT) if group else ()
    return tuple(str(prim.GetPath()) for prim in below)


def _component_in(group: Usd.Prim) -> Usd.Prim | None:
    parts = group.GetFilteredChildren(LOADED_OR_NOT)
    return next((part for part in parts if part.HasAttribute(_NODE)), None)


def _asset(prim: Usd.Prim) -> str:
    arcs = Usd.PrimCompositionQuery.GetDirectReferences(prim).GetCompositionArcs()
    targets = [arc.GetTargetLayer() for arc in arcs]
    return Path(targets[0].identifier).stem if targets else ""


def _looks(prim: Usd.Prim) -> Looks:
    sets = prim.GetVariantSets()
    return {
        name: Choice(
            sets.GetVariantSelection(name), tuple(sets.GetVariantSet(name).GetVariantNames())
        )
        for name in sorted(sets.GetNames())
    }


# What a stage holds, counted by walking through it -----------------------------------------------

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
    nodes = [prim for prim in prims if prim.HasAttribute(_CATEGORY)]
    nodes = [prim for prim in nodes if not prim.GetName().startswith(BORDER)]
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
