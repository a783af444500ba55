"""The second level of the scene graph: which pieces carry items, and what came to stand on them."""

from __future__ import annotations

import zlib
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from chord_usd.base.metrics.clear_floor import sides_of
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.raster.relief import Relief, Reliefs
from chord_usd.base.raster.table_top import TableTop
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.trim import boards
from chord_usd.base.scene.types import Box, Item, SceneGraph
from chord_usd.line.graph.match import Database
from chord_usd.line.graph.table_place import Laid, place_on
from chord_usd.line.graph.top_view import is_too_small, view_from_above

_HANGS_FROM_M = 0.3
"""What has its underside higher than this hangs, and things may be below it."""


@dataclass(frozen=True, eq=False)
class View:
    """A supporting piece as seen from above."""

    item: Item
    top: TableTop
    relief: Relief
    """Of its mesh, at its own size."""
    around: tuple[Box, ...]
    """What items on it could run into: what hangs in its room, rises beside it, or stands out of
    the walls."""

    @property
    def is_too_small(self) -> bool:
        """Whether nothing fits on it."""
        return is_too_small(self.top)

    def seed(self, house_seed: int) -> int:
        """A seed of its own, which what else is in the house does not change."""
        return zlib.crc32(f"{house_seed}/{self.item.id}".encode())

    def laid(self, things: Sequence[Item], database: Database, reliefs: Reliefs) -> Laid:
        """What was drawn for its top, standing on the piece."""
        return place_on(self.item, self.relief, things, database, reliefs, self.around)


class TopModel(Protocol):
    """What says what stands on tops: lists.top_lists.TopLister or graph.table_items.TopPainter."""

    @property
    def content_hash(self) -> str:
        """Of the weights."""

    def things(
        self, tops: Sequence[TableTop], seeds: Sequence[int], progress: Progress | None = None
    ) -> list[list[Item]]:
        """Things on each top, in its frame, without meshes; a top's seed alone varies its own."""


@dataclass(frozen=True, eq=False)
class Tabletops:
    """A house whose supporting pieces have been filled."""

    graph: SceneGraph
    laid: dict[str, Laid]
    """By id of the piece."""
    too_small: tuple[str, ...]
    """Pieces on which nothing fits."""

    @property
    def bare(self) -> tuple[str, ...]:
        """Pieces that are large enough and carry nothing all the same."""
        return tuple(name for name, laid in self.laid.items() if not laid.children)

    @property
    def items(self) -> int:
        """How many items stand on all pieces together."""
        return sum(len(laid.children) for laid in self.laid.values())

    @property
    def left_out(self) -> int:
        """How many were drawn and found no place to stand."""
        return sum(laid.left_out for laid in self.laid.values())


def table_views(graph: SceneGraph, reliefs: Reliefs, rooms: Collection[str] = ()) -> list[View]:
    """Every supporting piece with a mesh and nothing on it, in the order of the graph.

    rooms: ids of the rooms to look into, by default all.
    """
    chosen = set(rooms) or {room.id for room in graph.rooms}
    views = []
    trim = _boards(graph)
    for item in graph.items:
        carries = item.category in CATEGORIES and CATEGORIES[item.category].supports
        if not carries or item.asset is None or item.children or item.room_id not in chosen:
            continue
        relief = reliefs(item.asset).scaled(item.box.size_m)
        others = tuple(one for one in graph.items_of(item.room_id) if one.id != item.id)
        top = view_from_above(item, others, graph.plan.room(item.room_id), relief)
        around = [one.box for one in others if _can_be_hit(one, item)]
        views.append(View(item, top, relief, (*around, *trim.get(item.room_id, ()))))
    return views


def _boards(graph: SceneGraph) -> dict[str, list[Box]]:
    """Window boards, by id of the room that they stand out into."""
    found: dict[str, list[Box]] = {}
    for opening, room in sides_of(graph.openings, graph.rooms):
        found.setdefault(room.id, []).extend(boards(opening, room))
    return found


def _can_be_hit(other: Item, piece: Item) -> bool:
    """Whether what stands on a piece could run into another that is not below it.

    Chairs reach under a table, and what lies before them is not in their way.
    """
    base_m = other.box.center_m[2]
    if base_m > _HANGS_FROM_M:
        return True
    rises = base_m + other.box.size_m[2] > piece.box.top_m
    shared = footprint_polygon(other.box).intersection(footprint_polygon(piece.box))
    return bool(rises and shared.area <= MIN_OVERLAP_M2)


def lay_pieces(
    views: Sequence[View],
    model: TopModel,
    house_seed: int,
    database: Database,
    reliefs: Reliefs,
    progress: Progress | None = None,
) -> dict[str, Laid]:
    """What comes to stand on each piece that is not too small, by the id of the piece.

    All are drawn in one batch.
    """
    fitting = [view for view in views if not view.is_too_small]
    if not fitting:
        return {}
    tops, seeds = [view.top for view in fitting], [view.seed(house_seed) for view in fitting]
    drawn = model.things(tops, seeds, progress)
    return {
        view.item.id: view.laid(things, database, reliefs)
        for view, things in zip(fitting, drawn, strict=True)
    }


def with_items(graph: SceneGraph, views: Sequence[View], laid: dict[str, Laid]) -> Tabletops:
    """The graph with what was laid as children of its pieces."""
    items = tuple(
        replace(item, children=laid[item.id].children) if item.id in laid else item
        for item in graph.items
    )
    too_small = tuple(view.item.id for view in views if view.is_too_small)
    return Tabletops(replace(graph, items=items), laid, too_small)
