"""One working house: its pieces, and the shell around them, looked at once for all rules."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import shapely
from shapely import Polygon

from chord_usd.base.metrics.clear_floor import ClearFloor, ClearFloors, clearances
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.places.free_places import FreePlaces, free_places
from chord_usd.base.scene.geometry import footprint_polygon, room_polygon
from chord_usd.base.scene.oriented_rect import Edge, Footprint
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.types import Box, Item, LayoutImage, Opening, PixelFrame, Room, SceneGraph
from chord_usd.base.scene.units import m_from_px, px_from_m
from chord_usd.line.graph.colours import LabelArray, read_pixels
from chord_usd.line.graph.match import FLUSH_PX

if TYPE_CHECKING:
    from chord_usd.library.database import AssetDatabase

Faults = Callable[[SceneGraph], float]
"""How much is wrong with a house."""


@dataclass(frozen=True, eq=False)
class _Shell:
    """What no rule changes."""

    rooms: tuple[Room, ...]
    openings: tuple[Opening, ...]

    @cached_property
    def floors(self) -> dict[str, Polygon]:
        return {room.id: room_polygon(room) for room in self.rooms}

    @cached_property
    def clear(self) -> list[ClearFloor]:
        return list(clearances(self.rooms, self.openings))

    @cached_property
    def clear_floors(self) -> ClearFloors:
        return ClearFloors(self.clear)


@dataclass(frozen=True, eq=False)
class Arrangement:
    """A house in work. Make one with of."""

    graph: SceneGraph
    shell: _Shell
    painted: Painted | None = None
    """The raster that the house was read from."""
    faults: Faults | None = None
    movable: frozenset[str] | None = None
    """Ids of the items that may move or go; None for all."""
    database: AssetDatabase | None = None
    """Models that pieces may be given in place of theirs."""

    @classmethod
    def of(
        cls,
        graph: SceneGraph,
        *,
        painted: Painted | None = None,
        faults: Faults | None = None,
        movable: Collection[str] | None = None,
        database: AssetDatabase | None = None,
    ) -> Arrangement:
        """A house, and what some rules have to know of it."""
        may = None if movable is None else frozenset(movable)
        shell = _Shell(graph.rooms, graph.openings)
        return cls(graph, shell, painted, faults, may, database)

    @classmethod
    def read_from(cls, layout: LayoutImage, graph: SceneGraph) -> Arrangement:
        """A house that was read from a layout."""
        return cls.of(graph, painted=Painted(read_pixels(layout.rgb).item, layout.frame))

    def holding(self, graph: SceneGraph) -> Arrangement:
        """The same work with other pieces in it."""
        return replace(self, graph=graph)

    @property
    def floors(self) -> dict[str, Polygon]:
        """By room id."""
        return self.shell.floors

    @property
    def clear_floors(self) -> ClearFloors:
        """The floor that openings keep free."""
        return self.shell.clear_floors

    @property
    def reach_m(self) -> float:
        """Edges of what was read that are no farther apart than this are one."""
        return FLUSH_PX * self.painted.frame.m_per_px if self.painted else 0.0

    def may_move(self, item: Item) -> bool:
        """Whether a piece may move, or go; units of a composed kitchen stay, and what the plan
        shows."""
        if item.facts.unit is not None or item.facts.locked:
            return False
        return self.movable is None or item.id in self.movable

    def free_places(self, item: Item, among: Iterable[Item], *, is_new: bool = False) -> FreePlaces:
        """Free places of a piece among others, in its room and before no opening.

        is_new: as if it stood nowhere yet: its present place counts as taken, too.
        """
        return free_places(
            item, self.floors.get(item.room_id), among, self.shell.clear, is_new=is_new
        )


# Corrections of items before doors and windows: edges to half a pixel, and heights ------ --------

# An edge that reaches less than half a pixel into the floor that a door keeps free was drawn beside
# it, and so was a piece of which the picture shows nothing there: its box only spans what is
# painted around that floor's corner. A picture from above shows no heights: what is drawn before a
# window is one of the lower pieces of its category, where there are such.

_EDGES: tuple[Edge, ...] = ("u0", "u1", "v0", "v1")

_BARE = 0.2
"""Floor of which a smaller share shows a piece shows nothing of it: torn edges are no piece."""

_MOST_CUT = 0.25
"""Share of a side that a box may lose to floor that shows nothing of the piece."""


@dataclass(frozen=True, eq=False)
class Painted:
    """What a raster shows of items."""

    labels: LabelArray
    """(H, W) detector_class of a HOUSE category, or colours.NO_ITEM."""
    frame: PixelFrame

    def share(self, shape: shapely.Geometry, detector_class: int) -> float:
        """How many of the pixels in a shape show the category; 0.0 where it holds no pixel."""
        ring_px = px_from_m(shapely.get_coordinates(shape), self.frame)
        (left, top), (right, bottom) = (
            np.clip(edge, 0, self.labels.shape[::-1]).astype(int)
            for edge in (np.floor(ring_px.min(axis=0)), np.ceil(ring_px.max(axis=0)))
        )
        rows, columns = np.mgrid[top:bottom, left:right]
        centers_m = m_from_px(np.stack([columns, rows], axis=-1) + 0.5, self.frame)
        within = shapely.contains_xy(shape, centers_m[..., 0], centers_m[..., 1])
        shown = self.labels[top:bottom, left:right][within] == detector_class
        return float(shown.mean()) if shown.size else 0.0


def kept_off(clear: ClearFloors, item: Item, reach_m: float, painted: Painted | None = None) -> Box:
    """The piece's box with edges within reach_m of the free floor's on them.

    painted: where it shows nothing of the piece on that floor, edges come from farther.
    """
    row, footprint = category(item.category), Footprint.of(item.box)
    if row.mount is not Mount.FLOOR:
        return item.box
    for opening, free in clear.before(item.box):
        shared = footprint_polygon(footprint.on(item.box)).intersection(free)
        # What gave way to one opening may have left another's floor, too.
        if row.height_m[0] <= opening.box.center_m[2] or shared.area <= MIN_OVERLAP_M2:
            continue
        is_bare = painted and painted.share(shared, row.detector_class) < _BARE
        footprint = _backed_off(footprint, shared, reach_m, _MOST_CUT if is_bare else 0.0)
    return footprint.on(item.box)


def _backed_off(
    footprint: Footprint, shared: shapely.Geometry, reach_m: float, most_cut: float
) -> Footprint:
    """The one edge moved off the floor it shares that needs least.

    None where that is farther than reach_m and than most_cut, a share of the side that it cuts.
    """
    rect = footprint.rect
    local = rect.local(shapely.get_coordinates(shared))
    low, high = local.min(axis=0), local.max(axis=0)
    places = (float(high[0]), float(low[0]), float(high[1]), float(low[1]))
    moves = [abs(place - getattr(rect, edge)) for edge, place in zip(_EDGES, places, strict=True)]
    least = int(np.argmin(moves))
    sides_m = rect.u1 - rect.u0, rect.v1 - rect.v0
    if moves[least] > max(reach_m, most_cut * sides_m[least // 2]):
        return footprint
    return footprint.moved_edge(_EDGES[least], places[least])
