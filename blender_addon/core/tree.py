"""Which object of an imported stage is what: USD paths from names, and the collection tree."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

_COPY_NUMBER = re.compile(r"\.\d{3,}$")
"""Blender numbers objects of one name; a prim's name holds no dot."""

ROOMS, FURNITURE, DRESSING, ARCHITECTURE, LIGHTS, CAMERAS, ITEMS = (
    "Rooms",
    "Furniture",
    "Dressing",
    "Architecture",
    "Lights",
    "Cameras",
    "Items",
)


EXTERIOR, ROOF = "Exterior", "Roof"
_STOREY = re.compile(r"Storey_\d+$")
"""Groups of the rooms of a storey, and what is outside of it."""


@dataclass
class Branch:
    """A collection to make, with the objects and collections in it."""

    name: str
    objects: list[str] = field(default_factory=list)
    branches: dict[str, Branch] = field(default_factory=dict)

    def branch(self, key: str, name: str = "") -> Branch:
        """The branch under this key, a new one of this name where there is none."""
        return self.branches.setdefault(key, Branch(name or key))


def prim_name(object_name: str) -> str:
    """The prim's name behind an object's: Chair_0.001 was Chair_0."""
    return _COPY_NUMBER.sub("", object_name)


def usd_paths(parents: Mapping[str, str | None]) -> dict[str, str]:
    """USD path of each object, from the parent of each (None at the top)."""

    def path(name: str) -> str:
        above = parents[name]
        prefix = path(above) if above is not None and above in parents else ""
        return f"{prefix}/{prim_name(name)}"

    return {name: path(name) for name in parents}


def shown_names(paths: Iterable[str]) -> dict[str, str]:
    """A name for each USD path that no other has, as short as that goes; Blender would number them.

    Bed_0; where several rooms have one, Bedroom_0 Bed_0; below those, Bedroom_0 Door_0 Frame.
    """
    shown: dict[str, str] = {}
    waiting = {path: path.strip("/").split("/") for path in paths}
    for form in (_own_name, _with_room, _with_parent, " ".join):
        names = {path: form(parts) for path, parts in waiting.items()}
        counts = Counter([*shown.values(), *names.values()])
        shown |= {path: name for path, name in names.items() if counts[name] == 1}
        waiting = {path: parts for path, parts in waiting.items() if path not in shown}
    return shown


def _own_name(parts: list[str]) -> str:
    """A room's camera would have the name of the room."""
    return f"Camera {parts[-1]}" if parts[1:2] == [CAMERAS] and len(parts) > 2 else parts[-1]


def _with_room(parts: list[str]) -> str:
    parts, _ = _without_storey(parts)
    owner = parts[2:3] if parts[1:2] == [ROOMS] and len(parts) > 3 else parts[1:2]
    return " ".join([*owner, parts[-1]])


def _with_parent(parts: list[str]) -> str:
    return " ".join([_with_room(parts[:-1]), parts[-1]])


def collection_tree(paths: Mapping[str, str]) -> Branch:
    """House > rooms > furniture, dressing, architecture and lights; cameras and roof beside the
    rooms.

    A piece with things on it is a collection of its own in the furniture. paths: object name to USD
    path. Objects that are not below a room or the cameras lie in the house's own collection.
    """
    names = [path.split("/")[1] for path in paths.values()]
    house = Branch(names[0] if names else "House")
    laid = {piece_of(path) for path in paths.values() if f"/{ITEMS}/" in path}
    for name, path in paths.items():
        branch = _place(house, path.split("/")[1:])
        if piece_of(path) in laid:
            piece = piece_of(path).rpartition("/")[-1]
            branch = branch.branch(piece, f"{room_of(path)} {piece}")
        branch.objects.append(name)
    return house


def _place(house: Branch, parts: list[str]) -> Branch:
    if len(parts) > 1 and parts[1] == CAMERAS:
        return house.branch(CAMERAS)
    if len(parts) > 1 and parts[1] == ROOF:
        return house.branch(ROOF)
    parts, storey = _without_storey(parts)
    house = house.branch(storey) if storey else house
    if len(parts) > 2 and parts[1] == ROOMS:
        room = house.branch(parts[2])
        if len(parts) > 3 and parts[3] in (FURNITURE, DRESSING, ARCHITECTURE, LIGHTS):
            # Collections of one name would be numbered: Blender's names are unique in a file.
            return room.branch(parts[3], f"{room.name} {parts[3]}")
        return room
    return house


def room_names(paths: Iterable[str]) -> list[str]:
    """The rooms of a house, in the order of the stage."""
    return list(dict.fromkeys(room for path in paths if (room := room_of(path))))


def is_piece(path: str) -> bool:
    """Whether this is furniture or dressing of a room: what is moved and removed as a whole."""
    return is_placed(path) and len(_parts(path)) == 5


def is_placed(path: str) -> bool:
    """Whether this is a piece, a part of one, or what stands on it: placements to look after."""
    return _group_of(path) in (FURNITURE, DRESSING)


def is_dressing(path: str) -> bool:
    """Whether this is what a room is dressed with."""
    return _group_of(path) == DRESSING


def is_light(path: str) -> bool:
    """Whether this is a lamp of a room."""
    return _group_of(path) == LIGHTS


def room_of(path: str) -> str:
    """The room that something is in; empty for what is in none."""
    parts = _parts(path)
    return parts[2] if len(parts) > 2 and parts[1] == ROOMS else ""


def room_path(paths: Iterable[str], room: str) -> str:
    """The path of a room, by that of anything in it; empty where it is not there."""
    for path in paths:
        if room_of(path) == room:
            return path[: path.index(f"/{room}") + len(room) + 1]
    return ""


def storey_of(path: str) -> str:
    """The storey that something is on; empty in a house of one."""
    return _without_storey(path.split("/")[1:])[1]


def storeys(paths: Iterable[str]) -> list[str]:
    """The storeys of a house, the lowest first."""
    names = {storey_of(path) for path in paths} - {""}
    return sorted(names, key=lambda name: int(name.rpartition("_")[2]))


def piece_of(path: str) -> str:
    """The path of the piece that this is a part of, or stands on; empty where there is none."""
    if not is_placed(path):
        return ""
    return "/".join(path.split("/")[: 7 if storey_of(path) else 6])


def _group_of(path: str) -> str:
    """The group of its room that something is in, such as Furniture; empty where it is in none."""
    parts = _parts(path)
    return parts[3] if len(parts) > 4 and parts[1] == ROOMS else ""


def _parts(path: str) -> list[str]:
    """Names along a path as in a house of one storey."""
    return _without_storey(path.split("/")[1:])[0]


def _without_storey(parts: list[str]) -> tuple[list[str], str]:
    """The names along a path without that of its storey, and that name; empty for none."""
    if len(parts) > 2 and parts[1] in (ROOMS, EXTERIOR) and _STOREY.match(parts[2]):
        return [*parts[:2], *parts[3:]], parts[2]
    return parts, ""


def has_roof(paths: Iterable[str]) -> bool:
    """Whether a roof came in with the house."""
    return any(path.split("/")[2:3] == [ROOF] for path in paths)


def is_ceiling(path: str) -> bool:
    """Whether this is a part of a room's ceiling."""
    return path.rsplit("/", 1)[-1].startswith("Ceiling")
