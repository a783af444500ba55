"""A house read back from its stage, as what is no USD wants it: a plan, its walls, its things."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from pxr import Usd

from chord_usd.errors import StageError
from chord_usd.runtime.stages import open_stage, reading
from chord_usd.scene.geometry import Floors, extent_m, rooms_beside, to_own
from chord_usd.scene.limits import LARGEST_HOUSE_M
from chord_usd.scene.room_names import room_kind
from chord_usd.scene.types import Item, Opening, Plan, Room, SceneGraph
from chord_usd.stage.check_contact import Body
from chord_usd.stage.check_scene import read_scene
from chord_usd.stage.names import ROOM_LABELS, printable, room_title, spoken
from chord_usd.stage.opening_parts import side_of, span_of
from chord_usd.stage.opening_shapes import Span
from chord_usd.stage.shell import opens_to
from chord_usd.stage.walls import Tunnel, Walls, build_walls


@dataclass(frozen=True, eq=False)
class House:
    """A house as it stands. Ids of rooms and openings are those of their prims, such as Bedroom_0
    and Bedroom_0_Door_0."""

    graph: SceneGraph
    """Ids of items are prim paths."""
    bodies: dict[str, Body]
    """What is seen of each item, in the world, by its id."""
    titles: dict[str, str]
    """What people call each room, by its id: names from the plan, else its kind and number."""
    owners: dict[str, str]
    """Id of the room that each opening's frame belongs to, by the opening's id."""

    @property
    def plan(self) -> Plan:
        """Rooms and openings."""
        return self.graph.plan

    @cached_property
    def walls(self) -> Walls:
        """The solid of the walls, and the holes in it."""
        return build_walls(self.plan)

    @cached_property
    def told(self) -> SceneGraph:
        """The graph as it is drawn and written: rooms as people call them, and what stands on an
        item in that item's own frame, where the stage has it in the world."""
        rooms = tuple(replace(room, name=self.titles[room.id]) for room in self.graph.rooms)
        return replace(self.graph, rooms=rooms, items=tuple(map(_carrying, self.graph.items)))

    @cached_property
    def digest(self) -> str:
        """Names this house and no other: what identifiers in files are made from."""
        told = [
            *((room.id, room.kind, room.polygon_m.round(4).tolist()) for room in self.plan.rooms),
            *((one.id, one.kind, one.box) for one in self.plan.openings),
            *((item.id, item.category, item.box) for item in self.things()),
        ]
        return hashlib.sha256(repr(told).encode()).hexdigest()

    def things(self) -> Sequence[Item]:
        """Furniture and dressing; what stands on furniture is left out."""
        return (*self.graph.items, *self.graph.dressing)

    def title(self, room: Room) -> str:
        """What a room is called, in words that tell its kind to whoever reads the file."""
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


def read_built(path: Path) -> House:
    """The house at path. Raises StageError."""
    with reading(path):
        return house_of(open_stage(path))


def house_of(stage: Usd.Stage) -> House:
    """Read a house. Raises StageError where the stage holds none."""
    scene = read_scene(stage)
    if not scene.graph.rooms:
        raise StageError(
            "holds no rooms that can be read",
            where=stage.GetRootLayer().realPath,
            expected="a house that chord-usd wrote",
        )
    if extent_m(scene.graph.rooms) > LARGEST_HOUSE_M:
        raise StageError(
            f"is more than {LARGEST_HOUSE_M:g} m wide",
            where=stage.GetRootLayer().realPath,
            expected="a house, in metres",
        )
    names = {room.id: room.name for room in scene.graph.rooms}
    shown = {
        name: printable(stage.GetPrimAtPath(path).GetDisplayName()) for path, name in names.items()
    }
    rooms = tuple(replace(room, id=room.name) for room in scene.graph.rooms)
    floors = Floors(rooms)
    openings, owners = [], {}
    for one in scene.graph.openings:
        room_path = one.id.rsplit("/Architecture/", 1)[0]
        owner = names.get(room_path, rooms[0].id)
        own_id = f"{owner}_{one.id.rsplit('/', 1)[-1]}"
        owners[own_id] = owner
        openings.append(replace(one, id=own_id, room_ids=rooms_beside(one.box, floors)))
    graph = replace(
        scene.graph,
        rooms=rooms,
        openings=tuple(openings),
        items=tuple(_in_room(item, names) for item in scene.graph.items),
        dressing=tuple(_in_room(item, names) for item in scene.graph.dressing),
    )
    titles = {room.id: room_title(room, shown[room.id], rooms) for room in rooms}
    return House(graph, {body.path: body for body in scene.items}, titles, owners)


def span_in_plan(tunnel: Tunnel) -> Span:
    """The hole of an opening as long as the plan has it, in the opening's own frame.

    Where a wall runs crosswise behind an end of it, less of it is cut through.
    """
    half = tunnel.opening.box.size_m[0] / 2
    return replace(span_of(tunnel), left=-half, right=half)


def _carrying(item: Item) -> Item:
    """An item with its children in its own frame."""

    def own(child: Item) -> Item:
        ((x_m, y_m),) = to_own(item.box, [child.box.center_m[:2]]).tolist()
        z_m = child.box.center_m[2] - item.box.center_m[2]
        yaw_deg = child.box.yaw_deg - item.box.yaw_deg
        return replace(child, box=replace(child.box, center_m=(x_m, y_m, z_m), yaw_deg=yaw_deg))

    return replace(item, children=tuple(map(own, item.children)))


def _in_room(item: Item, names: dict[str, str]) -> Item:
    return replace(item, room_id=names.get(item.room_id, ""))
