"""What somebody asked for has candidates: the thing itself, and what comes nearest to it.

A piece that has no place half a metre to the left may have one 30 cm to the left, or with its
bedside tables, or where a plant gives way. The first candidate that makes nothing worse is done.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

from chord_usd.base.metrics.complete import homely_rooms
from chord_usd.base.metrics.footprints import is_underfoot
from chord_usd.base.metrics.fronts import FRONT, SWINGS_M, floor_before
from chord_usd.base.metrics.walk import walk
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.intents import Intent, NewPiece
from chord_usd.base.scene.palette import Level, Mount, category
from chord_usd.base.scene.types import Item, SceneGraph

_SOME = (1.0, 0.8, 0.6, 0.4, 0.2)
"""Shares of "a little", the largest first."""

_MEASURED = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5)
"""Shares of a way or a growth that was said in numbers: half of it is still what was meant."""

_LEAF_M2 = 1e-3
_ABOUT_M = 0.2

_BELONGS: dict[str, tuple[str, ...]] = {
    "bed": ("bedside_table", "bed_background"), "sofa": ("sofa_background",),
}  # fmt: skip
_BELONGS_M = 0.35
"""Greatest distance from a piece of what belongs to it."""

Judge = Callable[[SceneGraph, SceneGraph], Sequence[str]]
"""What is worse in the second house than in the first, a line each."""


@dataclass(frozen=True)
class Leeway:
    """How far what is done may differ from what was asked."""

    share: float = 1.0
    """Of the way that a piece goes, or of its growth."""
    is_together: bool = False
    """Whether what belongs to a piece goes where it goes."""
    gives_way: bool = False
    """Whether small things go elsewhere, where the piece is to stand."""
    is_anywhere: bool = False
    """Whether any place will do that has what was asked for, such as nearer to a window."""


def leeways(intent: Intent) -> Iterator[Leeway]:
    """Candidates for what was asked, the nearest to its meaning first."""
    if intent.action not in ("add", "move", "replace", "turn", "face"):
        yield Leeway()
        return
    is_way = bool(intent.way) or intent.relation in ("nearer to", "away from")
    is_sized = intent.new is not None and math.isfinite(intent.new.length_m[1])
    shares: tuple[float, ...] = (1.0,)
    if intent.action == "move" and (intent.distance_m is not None or is_way):
        shares = _SOME if intent.distance_m is None else _MEASURED
    elif intent.action == "replace" and intent.new is not None and is_sized:
        shares = _MEASURED if is_measured(intent.new) else (1.0, 0.5)
    together = (False, True) if intent.action == "move" else (False,)
    for share, gives_way, is_together in product(shares, (False, True), together):
        yield Leeway(share, is_together, gives_way)
    if intent.action == "move" and intent.distance_m is None and is_way and not intent.way:
        yield Leeway(is_anywhere=True)


def is_measured(new: NewPiece) -> bool:
    """Whether a length was said in numbers, not as "bigger"."""
    return new.length_m[1] - new.length_m[0] < _ABOUT_M


def belongings(graph: SceneGraph, item: Item) -> list[Item]:
    """What belongs to a bed or a sofa: on other walls it would be of no use."""
    shape, kinds = footprint_polygon(item.box), _BELONGS.get(item.category, ())
    return [piece for piece in graph.items_of(item.room_id)
            if piece.category in kinds
            and footprint_polygon(piece.box).distance(shape) < _BELONGS_M]  # fmt: skip


def small_things(graph: SceneGraph, intent: Intent, locked: set[str]) -> frozenset[str]:
    """Ids of what may go elsewhere: things on the floor and on walls, and what belongs to a piece
    that another one replaces."""
    kept = {*locked, *intent.items, *intent.anchors}
    things = [
        thing for thing in graph.dressing
        if thing.room_id in intent.rooms and not thing.facts.rests_on and not is_underfoot(thing)
        and category(thing.category).mount in (Mount.WALL, Mount.FLOOR)
    ]  # fmt: skip
    if intent.action == "replace":
        old = [item for item in graph.items if item.id in intent.items]
        things += [piece for item in old for piece in belongings(graph, item)]
    return frozenset(thing.id for thing in things) - kept


def flaws(graph: SceneGraph) -> set[tuple[str, ...]]:
    """Pieces that rooms lack, and pieces that are misplaced."""
    rooms = homely_rooms(graph)
    lacks = {(room.room, name) for room in rooms for name in room.missing}
    return lacks | {(misfit.item, misfit.fault) for room in rooms for misfit in room.misplaced}


def worse(before: SceneGraph, after: SceneGraph) -> list[str]:
    """New faults: rooms that lack pieces or are out of reach, pieces misplaced or before leaves."""
    new = _wrong(after) - _wrong(before)
    return sorted(" ".join(line) for line in new)


@lru_cache(maxsize=2)  # each candidate is compared with one house
def _wrong(graph: SceneGraph) -> frozenset[tuple[str, ...]]:
    shut = {(room, "cannot be reached") for room in walk(graph).unreachable}
    shapes = [(item, footprint_polygon(item.box)) for item in graph.items
              if category(item.category).mount is Mount.FLOOR]  # fmt: skip
    shapes += [(item, footprint_polygon(item.box)) for item in graph.dressing
               if category(item.category).mount is Mount.FLOOR and not is_underfoot(item)
               and category(item.category).level is Level.DRESSING]  # fmt: skip
    stopped = set()
    for item, _ in shapes:
        if item.category not in SWINGS_M:
            continue
        swing = footprint_polygon(floor_before(item.box, FRONT, 0.0, SWINGS_M[item.category]))
        stopped |= {
            (other.id, f"stops {item.id}") for other, shape in shapes
            if other.room_id == item.room_id and other.id != item.id
            and swing.intersection(shape).area > _LEAF_M2
        }  # fmt: skip
    return frozenset(flaws(graph) | shut | stopped)
