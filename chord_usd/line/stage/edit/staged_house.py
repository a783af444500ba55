"""A house read back from its stage: rooms, openings and items under the ids of their author."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pxr import Usd

from chord_usd.base.errors import StageError
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.runtime.stages import (
    files_of,
    open_stage,
    reading,
)
from chord_usd.base.scene.types import Asset, Item, Room, SceneGraph
from chord_usd.line.stage.author.design_notes import standard_noted
from chord_usd.line.stage.author.furniture import (
    DRESSING,
    FURNITURE,
)
from chord_usd.line.stage.author.names import REQUESTS, printable, room_title
from chord_usd.line.stage.author.stage_levels import ROOMS
from chord_usd.line.stage.author.variants import COLOUR
from chord_usd.line.stage.check.check_rules import NODE_ID
from chord_usd.line.stage.check.check_scene import CATEGORY
from chord_usd.line.stage.read.leaf_states import shut_leaves
from chord_usd.line.stage.read.storey_rooms import storey_of

SEED = "chord:seed"
"""Attribute of a room's Furniture: the seed it was drawn with, where not that of the house."""

LOCKED = "chord:locked"
"""Attribute of a piece, or of the group around it: nothing may change it."""


@dataclass(frozen=True, eq=False)
class StagedHouse:
    """A house read back from its stage."""

    graph: SceneGraph
    """As it stands: boxes from meshes and transforms, ids as the author noted them. Items have no
    assets, so that rules leave them as they are."""
    room_ids: dict[str, str]
    """Id of each room by the name of its prim, such as Bedroom_0."""
    seeds: dict[str, int]
    """The seed each room was furnished with, by the name of its prim."""
    item_ids: dict[str, str]
    """Id of each piece of furniture or dressing by the path of its prim, or of the group around
    it."""
    is_dressed: bool
    """Whether its rooms have groups for dressing."""
    seed: int
    """Seed of the house."""
    assets: dict[str, Asset]
    """By id of an item with an asset; assets packed in an archive are left out."""
    colours: dict[str, str]
    """The colourway of each item that has several, by its id."""
    titles: dict[str, str]
    """What people call each room, by the name of its prim."""
    locked: frozenset[str] = frozenset()
    """Ids of the pieces that nothing may change."""
    storey: str = ""
    """Name of the group of its rooms, in a house of several storeys: all here is of this one."""
    standard: str = ""
    """Names of the standards that it is planned to."""
    requests: Mapping[str, str] = field(default_factory=dict)
    """Pieces that rooms must and must not hold, in words, by the names of their prims."""

    def kept(self, room_name: str, names: Sequence[str], where: Path) -> dict[str, str]:
        """Names of prims of a room's furniture and dressing by their ids: those asked for, and what
        they rest on. Raises StageError."""
        room = f"{self._room_path(room_name)}/"
        id_of = {p.split("/")[-1]: i for p, i in self.item_ids.items() if p.startswith(room)}
        for name in names:
            if name not in id_of:
                near = get_close_matches(name, id_of, n=1)
                raise StageError(
                    f"has no {name!r} in {room_name}",
                    where=str(where),
                    expected=f"one of {', '.join(id_of)}" if id_of else "a room with furniture",
                    try_=f"<keep={near[0]}>" if near else "",
                )
        name_of = {item_id: name for name, item_id in id_of.items()}
        carriers = {item.id: item.facts.rests_on for item in self.graph.dressing}
        chosen: dict[str, str] = {}
        for name in names:
            item_id: str | None = id_of[name]
            while item_id in name_of and item_id not in chosen:
                chosen[item_id] = name_of[item_id]
                item_id = carriers.get(item_id)
        return chosen

    def _room_path(self, name: str) -> str:
        return "/".join(filter(None, (ROOMS, self.storey, name)))

    def locked_in(self, room_name: str) -> list[str]:
        """Names of prims of a room's pieces that nothing may change."""
        room = f"{self._room_path(room_name)}/"
        locked = (path for path, item_id in self.item_ids.items() if item_id in self.locked)
        return [path.split("/")[-1] for path in locked if path.startswith(room)]

    def room(self, name: str, where: Path) -> Room:
        """The room whose prim has this name. Raises StageError, suggesting the nearest."""
        if name not in self.room_ids:
            near = get_close_matches(name, self.room_ids, n=1)
            raise StageError(
                f"has no room {name!r}",
                where=str(where),
                expected=f"one of {', '.join(self.room_ids)}",
                try_=f"<room={near[0]}>" if near else "",
            )
        return self.graph.plan.room(self.room_ids[name])


def read_house(path: Path, room_name: str = "") -> StagedHouse:
    """Read rooms, openings and items of a stage. Raises StageError.

    room_name: of a room whose storey is read, of a house of several.
    """
    with reading(path):
        stage = open_stage(path)
        shut_leaves(stage)
        return _house_of(stage, path, room_name)


def read_edited_house(edits: Path, source: Path, room_name: str = "") -> StagedHouse:
    """The house at source as it is seen with a layer over it. Raises StageError, also where the
    layer points to files that are neither beside it nor beside the house."""
    outside = files_of(edits).outside([absolute(edits).parent, absolute(source).parent])
    if outside is not None:
        raise StageError(
            f"points to {outside}",
            where=str(edits),
            expected=f"a layer over {source.name} whose files lie beside it",
        )
    return read_house(edits, room_name)


def _house_of(stage: Usd.Stage, path: Path, room_name: str = "") -> StagedHouse:
    graph, storey = storey_of(stage, path, room_name)
    if not graph.rooms:
        raise StageError(
            "holds no rooms that can be read",
            where=str(path),
            expected="a house that chord-usd wrote",
            try_=f"<check={path.name}>",
        )
    noted = {
        str(prim.GetPath()): prim.GetAttribute(NODE_ID).Get() or str(prim.GetPath())
        for prim in stage.TraverseAll()
        if prim.HasAttribute(NODE_ID)
    }
    chord = noted_settings(stage)
    house_seed = int(chord.get("seed", 0))
    graph = replace(graph, style=str(chord.get("style", "")))
    seeds, requests = {}, {}
    for room in graph.rooms:
        asked = stage.GetAttributeAtPath(f"{room.id}/Furniture.{REQUESTS}")
        if asked and asked.Get():
            requests[room.name] = str(asked.Get())
        seed = stage.GetAttributeAtPath(f"{room.id}/Furniture.{SEED}")
        seeds[room.name] = int(seed.Get()) if seed else house_seed
    room_ids = {room.name: noted.get(room.id, room.id) for room in graph.rooms}
    things = (*graph.items, *graph.dressing)
    item_ids = {_placed(item.id): noted.get(item.id, item.id) for item in things}
    is_dressed = any(stage.GetPrimAtPath(f"{room.id}/{DRESSING}") for room in graph.rooms)
    placed = (
        (item_id, stage.GetAttributeAtPath(f"{path}.{LOCKED}"))
        for path, item_id in item_ids.items()
    )
    locked = frozenset(item_id for item_id, note in placed if note and note.Get())
    named = tuple(replace(room, id=room.name) for room in graph.rooms)
    shown = {
        room.name: printable(stage.GetPrimAtPath(room.id).GetDisplayName()) for room in graph.rooms
    }
    titles = {room.id: room_title(room, shown[room.id], named) for room in named}
    worn = {noted_id: _asset_of(stage.GetPrimAtPath(at)) for at, noted_id in noted.items()}
    assets = {item_id: asset for item_id, asset in worn.items() if asset}
    sets = {noted_id: stage.GetPrimAtPath(at).GetVariantSets() for at, noted_id in noted.items()}
    colours = {item_id: each.GetVariantSelection(COLOUR) for item_id, each in sets.items()
               if each.HasVariantSet(COLOUR)}  # fmt: skip
    graph = _with_noted_ids(graph, noted)
    return StagedHouse(
        graph, room_ids, seeds, item_ids, is_dressed, house_seed, assets, colours, titles, locked,
        storey, standard_noted(chord), requests,
    )  # fmt: skip


def noted_settings(stage: Usd.Stage) -> dict[str, Any]:
    """What a house notes of its making; of the first of its layers that does."""
    layers = (layer for layer in stage.GetUsedLayers())
    notes = [layer.customLayerData["chord"] for layer in layers if "chord" in layer.customLayerData]
    return dict(stage.GetRootLayer().customLayerData.get("chord", notes[0] if notes else {}))


def _asset_of(prim: Usd.Prim) -> Asset | None:
    arcs = Usd.PrimCompositionQuery.GetDirectReferences(prim).GetCompositionArcs()
    if not arcs:
        return None
    layer = arcs[0].GetTargetLayer()
    file = Path(layer.realPath)
    hint = layer.GetAttributeAtPath(f"/{layer.defaultPrim}.extentsHint")
    if hint is None or len(hint.default or ()) < 2 or not file.is_file():
        return None
    length, width, height = (float(side) for side in hint.default[1] - hint.default[0])
    category = str(prim.GetAttribute(CATEGORY).Get() or "")
    return Asset(file.stem, category, (length, width, height), file)


def _placed(path: str) -> str:
    """Path of a piece, or of the group around it: /House/Rooms/Study_0/Furniture/Desk_0."""
    names = path.split("/")
    at = next((at for at, name in enumerate(names) if name in (FURNITURE, DRESSING)), 4)
    return "/".join(names[: at + 2])


def _with_noted_ids(graph: SceneGraph, noted: dict[str, str]) -> SceneGraph:
    """The graph under the ids of its author in place of prim paths."""

    def item(placed: Item) -> Item:
        return replace(
            placed,
            id=noted.get(placed.id, placed.id),
            room_id=noted.get(placed.room_id, placed.room_id),
            children=tuple(map(item, placed.children)),
            facts=replace(placed.facts, rests_on=noted.get(placed.facts.rests_on or "")),
        )

    return replace(
        graph,
        rooms=tuple(replace(room, id=noted.get(room.id, room.id)) for room in graph.rooms),
        openings=tuple(
            replace(
                opening,
                id=noted.get(opening.id, opening.id),
                room_ids=tuple(noted.get(room_id, room_id) for room_id in opening.room_ids),
            )
            for opening in graph.openings
        ),
        items=tuple(map(item, graph.items)),
        dressing=tuple(map(item, graph.dressing)),
    )
