"""Which rooms share their light: those joined by a hole without a leaf, or with glass in it, and
those that touch, which have no wall between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from shapely.geometry import Polygon

from chord_usd.base.runtime.stages import open_stage, room_prims
from chord_usd.base.scene.geometry import seams

if TYPE_CHECKING:
    from pxr import Usd

_LEAF = "Leaf"
_GLASS = "Glass"
"""How the names of the parts begin that close an opening, and that let light through."""

_SLIT_M = 0.02
"""Rooms nearer than this touch: there is no thinner wall."""

_LEAST_M = 0.1
"""Along less than this they only meet at a corner."""


def joined_rooms(path: Path) -> tuple[tuple[str, str], ...]:
    """Pairs of names of rooms between which light goes; none on a stage that is not a house.

    Loads the walls, not the furniture. Raises StageError.
    """
    stage = open_stage(path, load=False)
    rooms = room_prims(stage)
    for room in rooms:
        walls = room.GetChild("Architecture")
        if walls:
            walls.Load()
    names = {_node_id(room): room.GetName() for room in rooms}
    storeys: dict[str, dict[str, Polygon]] = {}
    for room in rooms:
        storey = storeys.setdefault(room.GetParent().GetName(), {})
        storey[room.GetName()] = _floor_m(room)
    pairs = {pair for room in rooms for pair in _pairs(room, names)}
    beside = {pair for floors in storeys.values() for pair in touching(floors)}
    return tuple(sorted(pairs | beside))


def touching(floors_m: Mapping[str, Polygon]) -> Iterator[tuple[str, str]]:
    """Pairs of names, in order, of floors along whose edges no wall stands."""
    names = sorted(floors_m)
    for first, second, seam in seams([floors_m[name] for name in names], _SLIT_M):
        if seam.length > _LEAST_M:
            yield names[first], names[second]


def lit_with(room: str, joined: Iterable[tuple[str, str]]) -> set[str]:
    """The room and all that holes join to it, one after the other."""
    pairs = list(joined)
    lit: set[str] = set()
    reached = {room}
    while reached != lit:
        lit = reached
        reached = lit | {b for pair in pairs for a, b in (pair, pair[::-1]) if a in lit}
    return lit


def _pairs(room: Usd.Prim, names: dict[str, str]) -> Iterator[tuple[str, str]]:
    from pxr import Usd

    for prim in Usd.PrimRange(room):
        joined = prim.GetAttribute("chord:rooms").Get() if prim.HasAttribute("chord:rooms") else ()
        known = sorted({names[node] for node in joined or () if node in names})
        if len(known) == 2 and _lets_light_through(prim):
            yield known[0], known[1]


def _lets_light_through(opening: Usd.Prim) -> bool:
    from pxr import Usd

    parts = [part.GetName() for part in Usd.PrimRange(opening)]
    has_leaf = any(part.startswith(_LEAF) for part in parts)
    return not has_leaf or any(part.startswith(_GLASS) for part in parts)


def _floor_m(room: Usd.Prim) -> Polygon:
    name = "chord:polygon_m"
    return Polygon(room.GetAttribute(name).Get() if room.HasAttribute(name) else ())


def _node_id(prim: Usd.Prim) -> str:
    name = "chord:node_id"
    return str(prim.GetAttribute(name).Get()) if prim.HasAttribute(name) else ""
