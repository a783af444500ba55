"""What every prim of a house is called: readable, valid, and the same for the same scene graph."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import Point

from chord_usd.base.errors import SceneError
from chord_usd.base.metrics.clear_floor import open_borders
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.base.scene.types import Item, Opening, Room, RoomKind, SceneGraph

ROOM_LABELS: dict[RoomKind, str] = {
    "living": "LivingRoom",
    "dining": "DiningRoom",
    "bedroom": "Bedroom",
    "kitchen": "Kitchen",
    "bathroom": "Bathroom",
    "balcony": "Balcony",
    "corridor": "Corridor",
    "study": "Study",
    "store": "Storeroom",
    "unknown": "Room",
    "washroom": "Washroom",
    "wc": "WC",
}


REQUESTS = "chord:requests"
"""Attribute of a room's Furniture: pieces that it must and must not hold, in words."""

BORDER = "Border"
"""Label of open borders of rooms that touch, which have no mesh: passages for who reads a stage."""


@dataclass(frozen=True, eq=False)
class NamedItem:
    """An item and its prims: `Desk_0`, a group around `Desk` where it carries children.

    Numbers run through the house: Blender numbers objects of one name once more.
    """

    name: str
    label: str
    item: Item
    children: tuple[NamedItem, ...]


@dataclass(frozen=True, eq=False)
class NamedOpening:
    """An opening, named after its kind: `Door_0`; an open border is `Border_0`."""

    name: str
    opening: Opening


@dataclass(frozen=True, eq=False)
class NamedRoom:
    """A room with what stands in it and the openings whose frames and linings it owns."""

    index: int
    """Position in the scene graph."""
    name: str
    room: Room
    items: tuple[NamedItem, ...]
    openings: tuple[NamedOpening, ...]
    dressing: tuple[NamedItem, ...] = ()
    group: str = ""
    """Name of the group of its storey; "" in a house of one."""

    @property
    def path(self) -> str:
        """Path of its prim."""
        return (
            f"/House/Rooms/{self.group}/{self.name}" if self.group else f"/House/Rooms/{self.name}"
        )


def name_rooms(
    graph: SceneGraph, group: str = "", taken: set[str] | None = None
) -> tuple[NamedRoom, ...]:
    """Every room, item and opening of a house under its name, in the graph's order.

    group: that of the storey. taken: names that other storeys have; gets those that are given, so
    that no two rooms, openings or items of a house are called the same.

    An opening belongs to the first room it joins; what names no room of the house belongs to the
    nearest one. Raises SceneError for a house without rooms.
    """
    if not graph.rooms:
        raise SceneError(
            "the scene graph holds no room",
            expected="at least one closed room",
            try_="<plan read>",
        )
    taken = set() if taken is None else taken
    names = _numbered([room_label(room) for room in graph.rooms], taken)
    place = _Places(graph.rooms)
    items, dressing = _by_room(graph.items, place), _by_room(graph.dressing, place)
    openings: list[list[Opening]] = [[] for _ in graph.rooms]
    borders: list[list[Opening]] = [[] for _ in graph.rooms]
    for opening in graph.openings:
        openings[place.owner(opening.room_ids, opening.box.center_m)].append(opening)
    for number, border in enumerate(open_borders(graph.rooms, graph.openings)):
        side = replace(border, id=f"border/{border.id}/{number}")  # node ids are unique
        borders[place.owner(border.room_ids, border.box.center_m)].append(side)
    return tuple(
        NamedRoom(
            index, names[index], room, name_items(items[index], taken),
            _openings(openings[index], borders[index], taken),
            name_items(dressing[index], taken), group,
        )
        for index, room in enumerate(graph.rooms)
    )  # fmt: skip


def _by_room(items: Iterable[Item], place: _Places) -> list[list[Item]]:
    rooms: list[list[Item]] = [[] for _ in place.floors]
    for item in items:
        rooms[place.owner((item.room_id,), item.box.center_m)].append(item)
    return rooms


def name_items(items: Sequence[Item], taken: set[str]) -> tuple[NamedItem, ...]:
    """Items under their category's label, numbered in their order: Desk_0, Chair_0, Chair_1.

    taken: names already in use in the house; the names of items and their children are added.
    """
    labels = [identifier(category(item.category).label) for item in items]
    return tuple(
        NamedItem(name, label, item, name_items(item.children, taken))
        for name, label, item in zip(_numbered(labels, taken), labels, items, strict=True)
    )


def identifier(text: str) -> str:
    """Text as a prim name: "All-in-one Computer" becomes AllInOneComputer."""
    words = [word for word in re.split(r"[^0-9A-Za-z]+", text) if word]
    joined = "".join(word[0].upper() + word[1:] for word in words)
    return joined if joined and not joined[0].isdigit() else f"_{joined}"


def room_title(room: Room, shown: str, rooms: Sequence[Room]) -> str:
    """What people call a room: the name that a stage shows, where people gave it; else its kind,
    numbered from 1 where there are several. Ids are the names of prims."""
    if shown and shown != room.id:
        return shown
    of_kind = [other.id for other in rooms if other.kind == room.kind]
    number = f" {of_kind.index(room.id) + 1}" if len(of_kind) > 1 else ""
    return f"{spoken(room_label(room))}{number}"


def room_label(room: Room) -> str:
    """What prims of such rooms are called, less their number."""
    return "Stairs" if is_cell(room) else ROOM_LABELS[room.kind]


def printable(text: str) -> str:
    """Text in one line, without characters that cannot be printed."""
    return " ".join("".join(char if char.isprintable() else " " for char in text).split())


def spoken(label: str) -> str:
    """LivingRoom as people write it: Living Room."""
    return "".join(f" {char}" if char.isupper() else char for char in label).strip()


def _openings(
    openings: Sequence[Opening], borders: Sequence[Opening], taken: set[str]
) -> tuple[NamedOpening, ...]:
    labels = [opening.kind.capitalize() for opening in openings] + [BORDER] * len(borders)
    return tuple(map(NamedOpening, _numbered(labels, taken), (*openings, *borders)))


def _numbered(labels: Iterable[str], taken: set[str]) -> list[str]:
    """Each label with the first number that is free, which is then taken."""
    seen: Counter[str] = Counter()
    names = []
    for label in labels:
        while f"{label}_{seen[label]}" in taken:
            seen[label] += 1
        names.append(f"{label}_{seen[label]}")
        taken.add(names[-1])
    return names


class _Places:
    """Which room a thing is in."""

    def __init__(self, rooms: Sequence[Room]) -> None:
        # The first of several with the same id.
        self._index_of = {room.id: index for index, room in reversed(list(enumerate(rooms)))}
        self.floors = [room_polygon(room) for room in rooms]

    def owner(self, room_ids: Sequence[str], at_m: tuple[float, float, float]) -> int:
        """Index of the first room named, else of the nearest one."""
        for room_id in room_ids:
            if room_id in self._index_of:
                return self._index_of[room_id]
        distances = shapely.distance(self.floors, Point(at_m[:2]))
        return int(np.argmin(distances))
