"""Whether a room is a home: what its kind cannot do without is there, and nothing stands wrongly.

A room is complete when it holds the essentials of its kind, and right when, beyond that, cabinets
have their back to a wall, chairs stand at a table and face it, sofas face a table or television and
the television of a living room faces a seat, kitchen units stand end to end, and people can stand
before the front of what they use; an undersized piece is none. Rooms of the kinds in ESSENTIALS are
judged; a house is complete, or right, when every judged room of it is.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from chord_usd.base.metrics.clear_floor import open_borders, solid_sides
from chord_usd.base.metrics.footprints import PolygonArray
from chord_usd.base.metrics.fronts import shut_fronts
from chord_usd.base.metrics.rooms import is_studio
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS, unit_gaps
from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    front_direction,
    room_polygon,
    room_sides,
)
from chord_usd.base.scene.palette import CATEGORIES, having
from chord_usd.base.scene.types import FloatArray, Item, Room, RoomKind, SceneGraph

SEATS, TABLES, FACED = having("seat"), having("table"), having("faced")
"""What a sofa looks at."""

WALLED = having("walled")
"""Pieces that stand with their back to a wall."""


@dataclass(frozen=True)
class Essential:
    """What a room of a kind cannot do without: any piece of these categories."""

    name: str
    categories: frozenset[str]


Side = FloatArray | tuple[FloatArray, FloatArray]
"""Start and end of a side of a room, (2,) metres each."""


def _single(name: str, *categories: str) -> Essential:
    return Essential(name, frozenset(categories or (name,)))


ESSENTIALS: dict[RoomKind, tuple[Essential, ...]] = {
    "bedroom": (_single("bed"),),
    "living": (_single("seat", *SEATS), _single("coffee table or television", *FACED)),
    "dining": (_single("dining table", "dining_table"),),
    "kitchen": (_single("sink", "sink_cabinet"), _single("cooker", "cooker_cabinet")),
    "bathroom": (
        _single("toilet"),
        _single("washbasin", *having("basin")),
        _single("shower or bathtub", *having("bathing")),
    ),
    "washroom": (
        _single("washing machine", *having("laundry")),
        _single("washbasin", *having("basin")),
    ),
    "wc": (_single("toilet"), _single("washbasin", *having("basin"))),
}
"""By kind of room, the most needed first. A dining table also takes DINERS chairs."""

DINERS = 2
TWO_CHAIRS = "two chairs at the table"

FEWER_BELOW_M2: dict[RoomKind, tuple[tuple[float, int], ...]] = {
    "bathroom": ((2.0, 1), (3.0, 2)), "washroom": ((1.6, 1),), "wc": ((1.8, 1),),
}  # fmt: skip
"""Rooms smaller than an area need no more than so many of their essentials; smallest area first."""

WALL_GAP_M = 0.13
"""A back no farther than this from a wall stands at it: a panel may hang between."""
LEAST_WALL_M = 0.2
ISLAND_M = 0.8
"""A kitchen unit that is farther than this from every wall stands in an island."""
AT_TABLE_M = 0.65
"""From a chair's middle to its table's edge."""
SEES_M = 5.0
"""A sofa looks no farther."""
BACK_DEG, CHAIR_DEG, SOFA_DEG, TELEVISION_DEG = 12.0, 46.0, 50.0, 60.0
"""How far from exactly right a piece may be turned."""

Fault = Literal[
    "off its wall", "without a table", "turned from its table", "facing nothing", "turned away",
    "facing no seat", "apart from its run", "undersized", "out of reach",
]  # fmt: skip
UNDERSIZED: Fault = "undersized"
SHUT: Fault = "out of reach"
"""Nobody can stand before its front (metrics.fronts)."""


@dataclass(frozen=True)
class Misplaced:
    """A piece that stands wrongly."""

    item: str
    category: str
    fault: Fault


@dataclass(frozen=True)
class Homely:
    """What one room lacks, and what stands wrongly in it."""

    room: str
    kind: RoomKind
    missing: tuple[str, ...]
    """Names of ESSENTIALS that are not there, the most needed first, and TWO_CHAIRS."""
    misplaced: tuple[Misplaced, ...]

    @property
    def is_judged(self) -> bool:
        """Whether rooms of this kind have essentials."""
        return self.kind in ESSENTIALS

    @property
    def complete(self) -> bool:
        """Whether nothing is missing."""
        return not self.missing

    @property
    def right(self) -> bool:
        """Whether nothing is missing and nothing stands wrongly."""
        return not self.missing and not self.misplaced


def homely_rooms(graph: SceneGraph) -> list[Homely]:
    """Every room of the house, in its order; those of other kinds than ESSENTIALS lack nothing.

    Chairs, seats and what they look at count across rooms, as in an open plan they do.
    """
    house = _House(graph)
    return [
        Homely(room.id, room.kind, _missing(room, house), house.misplaced(room))
        for room in graph.rooms
    ]


HOME: dict[str, frozenset[str]] = {
    "bed": frozenset(("bed",)),
    "cooker": frozenset(("cooker_cabinet",)),
    "sink": frozenset(("sink_cabinet",)),
    "toilet": frozenset(("toilet",)),
    "seat": SEATS,
}
"""What no home is without, in whichever room."""


def home_lacks(items: Iterable[Item]) -> tuple[str, ...]:
    """Names of what is nowhere in a home: every room of one without a kitchen can be complete."""
    standing = {item.category for item in items if not is_undersized(item)}
    return tuple(name for name, categories in HOME.items() if not standing & categories)


def is_complete(rooms: Iterable[Homely]) -> bool:
    """Whether every judged room of a house is complete."""
    return all(room.complete for room in rooms if room.is_judged)


def is_right(rooms: Iterable[Homely]) -> bool:
    """Whether every judged room of a house is right."""
    return all(room.right for room in rooms if room.is_judged)


def lacking(kind: RoomKind, area_m2: float, categories: Iterable[str]) -> tuple[str, ...]:
    """Names of the essentials that a room of this kind and area with these pieces lacks."""
    standing = frozenset(categories)
    essentials = ESSENTIALS.get(kind, ())
    absent = [essential.name for essential in essentials if not standing & essential.categories]
    most = (count for below, count in FEWER_BELOW_M2.get(kind, ()) if area_m2 < below)
    needed = next(most, len(essentials))
    return tuple(absent[: max(0, needed - (len(essentials) - len(absent)))])


def _missing(room: Room, house: _House) -> tuple[str, ...]:
    items = [
        item.category for item in house.items if item.room_id == room.id and not is_undersized(item)
    ]
    missing = lacking(room.kind, room_polygon(room).area, items)
    if room.kind == "dining" and not missing and house.diners(room) < DINERS:
        return (TWO_CHAIRS,)
    if house.is_studio and room.kind == "living" and "bed" not in items:
        return (*missing, "bed")
    return missing


def is_undersized(item: Item) -> bool:
    """Whether a piece is too small to be one, as what the painter leaves of it before a door."""
    row = CATEGORIES.get(item.category)
    return row is not None and row.is_undersized(item.box.size_m)


class _House:
    """The pieces of a house, and what each stands at."""

    def __init__(self, graph: SceneGraph) -> None:
        self.items = graph.items
        self.is_studio = is_studio([room.kind for room in graph.rooms])
        corners = np.array([footprint(item.box) for item in graph.items]).reshape(-1, 4, 2)
        self.shapes: PolygonArray = np.atleast_1d(shapely.polygons(corners))
        self._index = {id(item): index for index, item in enumerate(graph.items)}
        self._shut = shut_fronts(graph)
        passages = (opening for opening in graph.openings if opening.kind == "passage")
        self._gaps = (*passages, *open_borders(graph.rooms, graph.openings))

    def shape(self, item: Item) -> shapely.Polygon:
        shape: shapely.Polygon = self.shapes[self._index[id(item)]]
        return shape

    def of(self, categories: frozenset[str]) -> list[Item]:
        return [item for item in self.items if item.category in categories]

    def diners(self, room: Room) -> int:
        """Chairs of the house that stand at the dining tables of a room."""
        tables = [item for item in self.of(frozenset(("dining_table",))) if item.room_id == room.id]
        return sum(
            min(self._distance_m(table, chair) for table in tables) < AT_TABLE_M
            for chair in self.of(frozenset(("chair",)))
        )

    def _distance_m(self, table: Item, chair: Item) -> float:
        return float(self.shape(table).distance(shapely.Point(chair.box.center_m[:2])))

    def misplaced(self, room: Room) -> tuple[Misplaced, ...]:
        """What stands wrongly in a room, in the order of its pieces."""
        sides, walls = room_sides(room), [*solid_sides(room, self._gaps)]
        items = [item for item in self.items if item.room_id == room.id]
        apart = {min(unit.id, other.id) for unit, other, _ in unit_gaps(items, room_polygon(room))}
        misplaced = []
        for item in items:
            is_unit = item.category in KITCHEN_UNITS  # runs end at open borders
            faults = [*self._faults(item, room.kind, sides if is_unit else walls)]
            if item.id in apart:
                faults.append("apart from its run")
            if item.id in self._shut:
                faults.append(SHUT)
            misplaced += [Misplaced(item.id, item.category, fault) for fault in faults if fault]
        return tuple(misplaced)

    def _faults(
        self,
        item: Item,
        kind: RoomKind,
        sides: Sequence[Side],
    ) -> Iterator[Fault | None]:
        if is_undersized(item):
            yield UNDERSIZED
        is_walled = item.category in WALLED and not self._in_island(item, sides)
        if is_walled and not has_back_to_wall(item, sides):
            yield "off its wall"
        if item.category == "chair":
            yield self._chair_fault(item)
        if item.category == "sofa":
            yield self._sofa_fault(item)
        if item.category == "tv_cabinet" and kind == "living":
            seats = self.of(SEATS)
            if not any(_faces(item, _middle(seat), TELEVISION_DEG) for seat in seats):
                yield "facing no seat"

    def _in_island(self, item: Item, sides: Sequence[Side]) -> bool:
        """Whether a kitchen unit stands where one walks all round it."""
        lines = shapely.linestrings([np.stack([*side]) for side in sides])
        return item.category in KITCHEN_UNITS and bool(
            shapely.distance(lines, self.shape(item)).min() > ISLAND_M
        )

    def _chair_fault(self, chair: Item) -> Fault | None:
        tables = self.of(TABLES)
        nearest = min(tables, key=lambda table: self._distance_m(table, chair), default=None)
        if nearest is None or self._distance_m(nearest, chair) > AT_TABLE_M:
            return "without a table"
        middle, edge = shapely.Point(chair.box.center_m[:2]), self.shape(nearest)
        near = edge.exterior.interpolate(edge.exterior.project(middle))
        at = _middle(nearest) if edge.contains(middle) else np.array(near.coords[0])
        if _faces(chair, at, CHAIR_DEG) or _faces(chair, _middle(nearest), CHAIR_DEG):
            return None
        return "turned from its table"

    def _sofa_fault(self, sofa: Item) -> Fault | None:
        shape = self.shape(sofa)
        seen = [item for item in self.of(FACED) if self.shape(item).distance(shape) < SEES_M]
        if not seen:
            return "facing nothing"
        ahead = any(_faces(sofa, _middle(item), SOFA_DEG) for item in seen)
        return None if ahead else "turned away"


def has_back_to_wall(item: Item, sides: Iterable[Side]) -> bool:
    """Whether an item's back is at one of these walls, and parallel to it.

    sides: start and end of each, (2,) metres; those shorter than LEAST_WALL_M count for none.
    """
    front = front_direction(item.box.yaw_deg)
    back = _middle(item) - front * item.box.size_m[1] / 2
    for start, end in sides:
        along = end - start
        length_m = float(np.hypot(*along))
        if length_m < LEAST_WALL_M:
            continue
        along = along / length_m
        if abs(along @ front) >= np.sin(np.radians(BACK_DEG)):
            continue
        s = min(max(float((back - start) @ along), 0.0), length_m)
        if np.hypot(*(start + s * along - back)) <= WALL_GAP_M:
            return True
    return False


def table_of(chair: Item, items: Iterable[Item]) -> Item | None:
    """The table that a chair stands at: the nearest of them, no farther than AT_TABLE_M."""
    at = shapely.Point(chair.box.center_m[:2])
    away = [(footprint_polygon(table.box).distance(at), table.id, table)
            for table in items if table.category in TABLES]  # fmt: skip
    nearest_m, _, table = min(
        away, key=lambda candidate: candidate[:2], default=(AT_TABLE_M, "", None)
    )
    return table if nearest_m < AT_TABLE_M else None


def _middle(item: Item) -> FloatArray:
    return np.array(item.box.center_m[:2])


def _faces(item: Item, point: FloatArray, within_deg: float) -> bool:
    """Whether the item's front points at a place; at its own middle it always does."""
    ahead = point - _middle(item)
    away = float(np.hypot(*ahead))
    if away < 1e-6:
        return True
    return float(ahead @ front_direction(item.box.yaw_deg)) / away >= np.cos(np.radians(within_deg))
