"""One working house: its pieces, and the shell around them, looked at once for all rules."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from shapely import Polygon

from chord_usd.base.metrics.clear_floor import ClearFloor, ClearFloors, clearances
from chord_usd.base.places.free_places import FreePlaces, free_places
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Item, LayoutImage, Opening, Room, SceneGraph
from chord_usd.line.arrange.free_floor import Painted
from chord_usd.line.graph.colours import read_pixels
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

    def free_places(self, item: Item, among: Iterable[Item], *, anew: bool = False) -> FreePlaces:
        """Where a piece may stand among others, in its room and before no opening. anew: also where
        it stands on something now, that is taken."""
        return free_places(item, self.floors.get(item.room_id), among, self.shell.clear, anew=anew)
