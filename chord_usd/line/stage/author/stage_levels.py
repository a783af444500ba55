"""The storeys of a house as they are written: their groups, their stairs and the holes for them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from pxr import Sdf, Vt
from shapely.geometry import LineString, Polygon

from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.base.scene.storeys import Building, with_own_ids
from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.stage.author.names import NamedRoom, name_rooms
from chord_usd.line.stage.author.prims import Types, attribute, note
from chord_usd.line.stage.shell.walls import Walls, build_walls

if TYPE_CHECKING:
    from chord_usd.base.scene.stair_forms import BuiltStair

ROOMS = "/House/Rooms"
STOREY = "Storey_"
"""What the groups of storeys below ROOMS are called, with their index."""


@dataclass(frozen=True, eq=False)
class Rising:
    """A stair up from a storey."""

    built: BuiltStair
    foot: str
    top: str
    """Ids of the rooms that it joins."""


@dataclass(frozen=True, eq=False)
class Level:
    """A storey of a house, or a whole house of one."""

    graph: SceneGraph
    rooms: tuple[NamedRoom, ...]
    walls: Walls
    group: str = ""
    """Name of the group of its rooms; "" in a house of one storey."""
    title: str = ""
    elevation_m: float = 0.0
    rising: dict[str, list[Rising]] = field(default_factory=dict)
    """Stairs up from it, by id of their cells, whose ceilings have holes."""
    ways: dict[str, list[LineString]] = field(default_factory=dict)
    """By id of the cells with holes, since a stair comes up: the edges one walks over."""
    holes: list[Polygon] = field(default_factory=list)
    """In its floor."""
    landings: list[Polygon] = field(default_factory=list)
    """Of stairs from below, in the holes."""

    @property
    def path(self) -> str:
        """Path of what its rooms lie below."""
        return f"{ROOMS}/{self.group}" if self.group else ROOMS


def one_level(graph: SceneGraph) -> Level:
    """A house of one storey."""
    return Level(graph, name_rooms(graph), build_walls(graph.plan))


def levels_of(building: Building, graphs: Sequence[SceneGraph]) -> list[Level]:
    """The storeys of a house, furnished, the lowest first. Names of rooms are unique in it."""
    if len(graphs) == 1:
        return [one_level(graphs[0])]
    levels: list[Level] = []
    taken: set[str] = set()
    for storey, furnished in zip(building.storeys, graphs, strict=True):
        graph = with_own_ids(furnished, storey.prefix)
        group = f"{STOREY}{storey.index}"
        rooms = name_rooms(graph, group, taken)
        level = Level(graph, rooms, build_walls(graph.plan), group, storey.name, storey.elevation_m)
        for climb in building.climbs:
            if climb.storey == storey.index:
                rising = Rising(climb.built, climb.foot.joined, climb.top.joined)
                level.rising.setdefault(climb.foot.room, []).append(rising)
            elif climb.storey == storey.index - 1:
                level.ways.setdefault(climb.top.room, []).extend(climb.built.stepped_m[1])
                level.holes.extend([climb.top.hole_m] if climb.top.hole_m else [])
                level.landings.extend([climb.built.landing_m] if climb.built.landing_m else [])
        for cell, ways in level.ways.items():
            ways += [
                way for rising in level.rising.get(cell, ()) for way in rising.built.stepped_m[0]
            ]
        levels.append(level)
    return levels


def room_specs(layer: Sdf.Layer) -> Iterator[Sdf.PrimSpec]:
    """The rooms of a house in its own layer, storey by storey."""
    for child in layer.GetPrimAtPath(ROOMS).nameChildren:
        if child.name.startswith(STOREY):
            yield from child.nameChildren
        else:
            yield child


def room_spec(layer: Sdf.Layer, name: str) -> Sdf.PrimSpec | None:
    """The room of a house in its own layer, on whatever storey; None where it is not there."""
    rooms = room_specs(layer) if layer.GetPrimAtPath(ROOMS) else ()
    return next((room for room in rooms if room.name == name), None)


def is_shaft(level: Level, room: NamedRoom) -> bool:
    """Whether a hole is in a room's ceiling or floor, since a stair goes through it."""
    return is_cell(room.room) and (room.room.id in level.rising or room.room.id in level.ways)


SHAFT = "stairwell"
"""`chord:category` of rooms that a stair goes through."""

STAIR_WALK = "chord:walk_m"
"""Attribute of stairs: (N, 3) the line that one walks up, in the storey's frame."""


def note_stair(prim: Sdf.PrimSpec, rising: Rising) -> None:
    """What no mesh of a stair says: the rooms it joins and the line that one walks."""
    built = rising.built
    note(
        prim, node_id=f"{rising.foot}/{built.stair.id}", category="stairs",
        rooms=(rising.foot, rising.top),
        form=built.stair.form, rise_m=round(built.rise_m, 4), going_m=round(built.going_m, 4),
    )  # fmt: skip
    line = Vt.Vec3dArray.FromNumpy(built.walk_m.round(4).copy())
    attribute(prim, STAIR_WALK, Types.Double3Array, line, custom=True)
