"""A house read back from its stage, as what is no USD wants it: a plan, its walls, its things."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import shapely
from pxr import Usd
from shapely.geometry import Point, Polygon
from shapely.geometry.polygon import orient

from chord_usd.base.errors import StageError
from chord_usd.base.runtime.stages import open_stage, reading, storey_prims
from chord_usd.base.scene.geometry import (
    Floors,
    extent_m,
    footprint_polygon,
    polygons_of,
    room_polygon,
    rooms_beside,
    to_own,
)
from chord_usd.base.scene.limits import LARGEST_HOUSE_M
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.types import (
    FloatArray,
    Item,
    Opening,
    Plan,
    Room,
    SceneGraph,
    frozen_array,
)
from chord_usd.line.stage.author.names import ROOM_LABELS, printable, room_title, spoken
from chord_usd.line.stage.check.check_contact import Body, Solid
from chord_usd.line.stage.check.check_scene import StageScene, StageStair, read_scene, read_storeys
from chord_usd.line.stage.read.leaf_states import StatedDoor, stated_doors
from chord_usd.line.stage.shell.author_shell import opens_to
from chord_usd.line.stage.shell.opening_parts import side_of, span_of
from chord_usd.line.stage.shell.opening_shapes import Span
from chord_usd.line.stage.shell.walls import Tunnel, Walls, build_walls


@dataclass(frozen=True, eq=False)
class BuiltStairs:
    """Stairs as they stand, in the frame of the storey that they start on."""

    id: str
    form: str
    rooms: tuple[str, str]
    """Ids of the rooms where they start, and where they end."""
    walk_m: FloatArray
    """(N, 3) the line that one walks up."""
    solids: tuple[Solid, ...]
    """Steps and landings, handrails, railings."""


@dataclass(frozen=True, eq=False)
class House:
    """A house as it stands. Rooms and openings have the names of their prims as ids, such as
    Bedroom_0 and Bedroom_0_Door_0."""

    graph: SceneGraph
    """Ids of items are prim paths."""
    bodies: dict[str, Body]
    """What is seen of each item, in the world, by its id."""
    scene: StageScene
    """As it was read: paths for ids, stairs apart from rooms."""
    titles: dict[str, str]
    """What people call each room, by its id: names from the plan, else its kind and number."""
    owners: dict[str, str]
    """Id of the room that each opening's frame belongs to, by the opening's id."""
    storey: str = ""
    """Name of its group where it is a storey of a house of several: Storey_0."""
    storey_title: str = ""
    elevation_m: float = 0.0
    """Of its floor; everything else is in the storey's own frame."""
    stairs: tuple[BuiltStairs, ...] = ()
    """Up from this storey."""
    wells: tuple[Polygon, ...] = ()
    """Parts of its rooms that stairs stand on or come up through."""
    holes: tuple[Polygon, ...] = ()
    """What of these has no floor."""
    stated: Mapping[str, StatedDoor] = field(default_factory=dict)
    """Doors and windows that somebody gave a state, by the ids of openings."""

    @property
    def plan(self) -> Plan:
        """Rooms and openings."""
        return self.graph.plan

    @property
    def scene_as_stated(self) -> StageScene:
        """The scene without the doors between rooms that are shut by their state."""
        openings = self.scene.graph.openings
        shut = {
            opening.id
            for opening in openings
            if len(opening.room_ids) > 1
            and (door := self.stated.get(_opening_id(opening.id)))
            and door.is_shut
        }
        kept = tuple(opening for opening in openings if opening.id not in shut)
        return replace(self.scene, graph=replace(self.scene.graph, openings=kept))

    @cached_property
    def walls(self) -> Walls:
        """The solid of the walls, and the holes in it."""
        return build_walls(self.plan)

    @cached_property
    def drawn_graph(self) -> SceneGraph:
        """The graph as it is drawn and written: rooms as people call them, and what stands on an
        item in that item's own frame, where the stage has it in the world."""
        rooms = tuple(replace(room, name=self.titles[room.id]) for room in self.graph.rooms)
        rooms += tuple(
            Room(f"stairs{number}", "corridor", np.asarray(well.exterior.coords)[:-1], "Stairs")
            for number, well in enumerate(self.wells)
        )
        return replace(self.graph, rooms=rooms, items=tuple(map(_carrying, self.graph.items)))

    @cached_property
    def digest(self) -> str:
        """Names this house and no other: what identifiers in files are made from."""
        facts = [
            *((room.id, room.kind, room.polygon_m.round(4).tolist()) for room in self.plan.rooms),
            *((opening.id, opening.kind, opening.box) for opening in self.plan.openings),
            *((item.id, item.category, item.box) for item in self.things()),
        ]
        return hashlib.sha256(repr(facts).encode()).hexdigest()

    def things(self) -> Sequence[Item]:
        """Furniture and dressing; what stands on furniture is left out."""
        return (*self.graph.items, *self.graph.dressing)

    def title(self, room: Room) -> str:
        """Title of a room, in words that name its kind to readers of the file."""
        title = self.titles[room.id]
        return title if room_kind(title) == room.kind else spoken(ROOM_LABELS[room.kind])

    def opens_to(self, opening: Opening) -> int:
        """The side that a door's leaves swing to: 1 is its own +y, -1 its -y."""
        tunnel = self.walls.tunnels[opening.id]
        index = next(
            (n for n, room in enumerate(self.walls.rooms) if room.id == self.owners[opening.id]), 0
        )
        indoors = self.walls.floors_m[index].representative_point().coords[0]
        return opens_to(tunnel, self.walls, side_of(indoors, tunnel))


def read_built(path: Path) -> list[House]:
    """The storeys of the house at path, the lowest first. Raises StageError."""
    with reading(path):
        return houses_of(open_stage(path))


def house_of(stage: Usd.Stage) -> House:
    """Read a house of one storey. Raises StageError where the stage holds none."""
    read_scene(stage)
    return houses_of(stage)[0]


def houses_of(stage: Usd.Stage) -> list[House]:
    """Read the storeys of a house, the lowest first. Raises StageError where there is none."""
    scenes, groups = read_storeys(stage), storey_prims(stage)
    where = stage.GetRootLayer().realPath
    if not all(scene.graph.rooms for scene in scenes):
        raise StageError(
            "holds no rooms that can be read", where=where,
            expected="a house that chord-usd wrote",
        )  # fmt: skip
    if max(extent_m(scene.graph.rooms) for scene in scenes) > LARGEST_HOUSE_M:
        raise StageError(
            f"is more than {LARGEST_HOUSE_M:g} m wide", where=where,
            expected="a house, in metres",
        )  # fmt: skip
    if not groups:
        return [_storey(stage, scenes[0])]
    houses = [_storey(stage, scene) for scene in scenes]
    storeys = []
    for index, (house, scene, group) in enumerate(zip(houses, scenes, groups, strict=True)):
        above = houses[index + 1] if index + 1 < len(houses) else None
        stairs = [_stairs(stage, stair, house, above) for stair in scene.stairs] if above else []
        title = printable(group.GetDisplayName()) or group.GetName()
        storeys.append(
            replace(
                house, storey=group.GetName(), storey_title=title, stairs=tuple(stairs),
                elevation_m=scene.elevation_m, wells=tuple(map(room_polygon, scene.shafts)),
                holes=scene.holes,
            )
        )  # fmt: skip
    return storeys


def _stairs(stage: Usd.Stage, stair: StageStair, below: House, above: House) -> BuiltStairs:
    prim = stage.GetPrimAtPath(stair.body.path)
    room = stair.body.path.split("/Architecture/")[0].rsplit("/", 1)[-1]
    ends = [_room_at(house, stair.walk_m[at, :2]) for house, at in ((below, 0), (above, -1))]
    form = prim.GetAttribute("chord:form").Get() if prim.HasAttribute("chord:form") else ""
    return BuiltStairs(
        f"{room}_{prim.GetName()}", str(form), (ends[0], ends[1]), stair.walk_m, stair.body.solids
    )


def _room_at(house: House, at_m: FloatArray) -> str:
    place = Point(at_m)
    return min(house.plan.rooms, key=lambda room: room_polygon(room).distance(place)).id


def _storey(stage: Usd.Stage, scene: StageScene) -> House:
    parted = scene
    scene, inside = whole_rooms(scene)
    names = {room.id: room.name for room in scene.graph.rooms}
    names |= {part: names[whole] for part, whole in inside.items()}
    shown = {
        name: printable(stage.GetPrimAtPath(path).GetDisplayName())
        for path, name in names.items()
        if path not in inside
    }
    rooms = tuple(replace(room, id=room.name) for room in scene.graph.rooms)
    floors = Floors(rooms)
    openings, owners, stated = [], {}, {}
    doors = stated_doors(stage)
    for opening in scene.graph.openings:
        owner = names.get(opening.id.partition("/Architecture/")[0], rooms[0].id)
        own_id = _opening_id(opening.id)
        owners[own_id] = owner
        if opening.id in doors:
            stated[own_id] = doors[opening.id]
        openings.append(replace(opening, id=own_id, room_ids=rooms_beside(opening.box, floors)))
    graph = replace(
        scene.graph,
        rooms=rooms,
        openings=tuple(openings),
        items=tuple(_in_room(item, names) for item in scene.graph.items),
        dressing=tuple(_in_room(item, names) for item in scene.graph.dressing),
    )
    titles = {room.id: room_title(room, shown[room.id], rooms) for room in rooms}
    bodies = {body.path: body for body in scene.items}
    return House(graph, bodies, parted, titles, owners, stated=stated)


def _opening_id(path: str) -> str:
    """Bedroom_0_Door_0, of the path of its prim."""
    room_path, _, name = path.partition("/Architecture/")
    return f"{room_path.rsplit('/', 1)[-1]}_{name.rsplit('/', 1)[-1]}"


def span_in_plan(tunnel: Tunnel) -> Span:
    """The hole of an opening as long as the plan has it, in the opening's own frame.

    Where a wall runs crosswise behind an end of it, less of it is cut through.
    """
    half = tunnel.opening.box.size_m[0] / 2
    return replace(span_of(tunnel), left=-half, right=half)


def _carrying(item: Item) -> Item:
    """An item with its children in its own frame."""

    def in_parent_frame(child: Item) -> Item:
        ((x_m, y_m),) = to_own(item.box, [child.box.center_m[:2]]).tolist()
        z_m = child.box.center_m[2] - item.box.center_m[2]
        yaw_deg = child.box.yaw_deg - item.box.yaw_deg
        return replace(child, box=replace(child.box, center_m=(x_m, y_m, z_m), yaw_deg=yaw_deg))

    return replace(item, children=tuple(map(in_parent_frame, item.children)))


def _in_room(item: Item, names: dict[str, str]) -> Item:
    return replace(item, room_id=names.get(item.room_id, ""))


# Rooms as architects draw them, with the stairs that stand in them: stages keep those ------------

_TOUCH_M = 0.01
_LEAST_SEAM_M = 0.5
"""What touches a stair along less is parted from it by a wall."""

_GRID_M = 1e-4


def whole_rooms(scene: StageScene) -> tuple[StageScene, dict[str, str]]:
    """The storey with its shafts in the rooms around them, and which room each lost part is in now,
    by ids. A shaft that walls part from every room is a room of its own."""
    rooms = list(scene.graph.rooms)
    inside: dict[str, str] = {}
    for shaft in scene.shafts:
        area = room_polygon(shaft)
        parts = [room for room in rooms if _seam_m(area, room_polygon(room)) > _LEAST_SEAM_M]
        if not parts:
            rooms.append(shaft)
            continue
        main = max(parts, key=lambda room: room_polygon(room).area)
        whole = _together([area, *map(room_polygon, parts)])
        lost = [shaft.id, *(room.id for room in parts if room.id != main.id)]
        inside = {part: main.id if to in lost else to for part, to in inside.items()}
        inside |= dict.fromkeys(lost, main.id)
        rooms = [
            replace(room, polygon_m=whole) if room.id == main.id else room
            for room in rooms if room.id not in lost
        ]  # fmt: skip
    if not scene.shafts:
        return scene, {}
    openings = tuple(opening for opening in scene.graph.openings if not _is_within(opening, rooms))
    return replace(scene, graph=replace(scene.graph, rooms=tuple(rooms), openings=openings)), inside


def _seam_m(first: Polygon, second: Polygon) -> float:
    near = first.buffer(_TOUCH_M, join_style="mitre").intersection(second.exterior)
    return float(near.length)


def _together(areas: Sequence[Polygon]) -> np.ndarray:
    """(N, 2) outline of areas that touch."""
    grown = [area.buffer(_TOUCH_M, join_style="mitre") for area in areas]
    joined = shapely.union_all(grown).buffer(-_TOUCH_M, join_style="mitre")
    largest = max(polygons_of(joined), key=lambda part: part.area)
    outline = orient(Polygon(largest.exterior).simplify(_GRID_M * 5))
    corners = np.asarray(outline.exterior.coords)[:-1]
    return frozen_array(np.round(corners / _GRID_M) * _GRID_M)


def _is_within(opening: Opening, rooms: Sequence[Room]) -> bool:
    """Whether it is no way through a wall, but where one steps on a stair within a room."""
    if opening.kind != "passage":
        return False
    middle = Point(opening.box.center_m[:2])
    deep = footprint_polygon(opening.box)
    return any(
        room_polygon(room).covers(middle)
        and room_polygon(room).intersection(deep).area > 0.9 * deep.area
        for room in rooms
    )
