"""Where one can walk: the free floor of a house in one piece, and the rooms it reaches.

Free floor is the rooms plus the holes of doors and passages, minus the footprints of what stands
below head height. A walker is a disc of WALKER_RADIUS_M, so its centre keeps to the free floor
eroded by that much (SceneEval).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely

from chord_usd.metrics.clear_floor import rooms_beside
from chord_usd.metrics.footprints import GRID_M, footprints_of, is_underfoot
from chord_usd.scene.geometry import footprint_polygon, polygons_of, room_polygon
from chord_usd.scene.palette import CATEGORIES, Mount
from chord_usd.scene.types import WALL_THICKNESS_M, Item, Opening, Room, RoomKind, SceneGraph

WALKER_RADIUS_M = 0.2
HEAD_ROOM_M = 1.8
"""Items whose underside is above this are walked under."""

PASSED_BY_M = 0.05
"""What hangs on a wall and is no deeper than this takes up no floor."""

REACHED_M2 = 1.0
"""A room is reached when a walker from the entrance covers this much of its floor."""

REACHED_SHARE = 0.5
"""A room with less than twice REACHED_M2 free is reached when this share of it is covered."""

DOOR_OVERLAP_M = 0.05
"""Doorways are this much deeper on both sides, so that a hole drawn a little thin still joins."""

SEAM_M = 0.005
"""Rooms are grown by this much, which closes the seam between two that touch."""

ENTRANCE_KINDS: tuple[RoomKind, ...] = (
    "corridor", "living", "dining", "unknown", "kitchen", "study", "store", "bedroom", "bathroom",
)  # fmt: skip
"""Rooms a front door leads into, likeliest first; a balcony has none."""


@dataclass(frozen=True)
class Walk:
    """How far one gets on foot."""

    walkable: float
    """Largest connected part of the walkable floor / all of it, [0, 1]; 0.0 where there is none."""
    walkable_m2: float
    """All of it: where the centre of a walker can be."""
    unreachable: tuple[str, ...]
    """Ids of rooms the entrance does not lead to."""
    rooms: int

    @property
    def reachable_rooms(self) -> float:
        """Share of rooms that the entrance leads to; 1.0 for a house without rooms."""
        return 1.0 - len(self.unreachable) / self.rooms if self.rooms else 1.0


def free_floor(graph: SceneGraph) -> shapely.Geometry:
    """Floor that nothing stands on, doorways included; grown by SEAM_M at the walls."""
    rooms = [room_polygon(room).buffer(SEAM_M, join_style="mitre") for room in graph.rooms]
    doorways = [_doorway(opening) for opening in graph.openings if opening.kind != "window"]
    floor = shapely.union_all([*rooms, *doorways])
    things = (*graph.items, *filter(_is_in_the_way, graph.dressing))
    standing = [
        item for item in things if item.box.center_m[2] < HEAD_ROOM_M and not is_underfoot(item)
    ]
    if not standing:
        return floor
    stood_on = shapely.union_all(footprints_of(standing).polygons)
    return floor.difference(stood_on, grid_size=GRID_M)


def _is_in_the_way(item: Item) -> bool:
    """Whether dressing takes up floor: it stands or hangs, and is no picture that one passes by."""
    row = CATEGORIES.get(item.category)
    if row is None or row.mount is Mount.WALL:
        return row is None or item.box.size_m[1] > PASSED_BY_M
    return row.mount in (Mount.FLOOR, Mount.CEILING)


def _doorway(opening: Opening) -> shapely.Polygon:
    length_m, width_m, height_m = opening.box.size_m
    deeper_m = (length_m, width_m + 2 * DOOR_OVERLAP_M, height_m)
    return footprint_polygon(replace(opening.box, size_m=deeper_m))


def entrance(graph: SceneGraph) -> Opening | None:
    """The front door: a door or passage between the outside and the likeliest room to enter by.

    None where no door leads out of the drawn rooms.
    """
    candidates: list[tuple[int, int, Opening]] = []
    sides = rooms_beside(graph.openings, graph.rooms)
    for order, (opening, pair) in enumerate(zip(graph.openings, sides, strict=True)):
        beside = [room for room in pair if room is not None]
        if opening.kind != "window" and len(beside) == 1 and beside[0].kind in ENTRANCE_KINDS:
            candidates.append((ENTRANCE_KINDS.index(beside[0].kind), order, opening))
    return min(candidates)[2] if candidates else None


def walk(graph: SceneGraph) -> Walk:
    """Walkable share and reachable rooms of a house.

    Without an entrance one starts in the largest connected part. An entrance that opens onto no
    walkable floor reaches no room.
    """
    free = free_floor(graph)
    parts = walkable_parts(free)
    areas_m2 = np.array([part.area for part in parts])
    total_m2 = float(areas_m2.sum())
    largest_m2 = float(areas_m2.max()) if parts else 0.0
    return Walk(
        walkable=largest_m2 / total_m2 if total_m2 > 0 else 0.0,
        walkable_m2=total_m2,
        unreachable=tuple(unreachable_rooms(graph, free, _start(graph, parts))),
        rooms=len(graph.rooms),
    )


def ways_shut(graph: SceneGraph, room: Room) -> int:
    """How many doors and passages of a room its pieces part from most of the others in it."""
    ways = tuple(one for one in graph.openings if one.kind != "window" and room.id in one.room_ids)
    if len(ways) < 2:
        return 0
    items = tuple(item for item in graph.items if item.room_id == room.id)
    own = replace(graph, rooms=(room,), openings=ways, items=items, dressing=())
    shut = _parted(own)
    return max(0, shut - _parted(replace(own, items=()))) if shut else 0


def _parted(room: SceneGraph) -> int:
    """Ways of a single room beyond those that hang together."""
    doorways = [footprint_polygon(way.box) for way in room.openings]
    near_m = WALKER_RADIUS_M + 2 * SEAM_M
    joined = [
        sum(part.distance(doorway) <= near_m for doorway in doorways)
        for part in walkable_parts(free_floor(room))
    ]
    return len(doorways) - max(joined, default=0)


def walkable_parts(free: shapely.Geometry) -> list[shapely.Polygon]:
    """Where the centre of a walker can be on free floor, in connected parts."""
    return polygons_of(free.buffer(-WALKER_RADIUS_M - SEAM_M, quad_segs=4))


def _start(graph: SceneGraph, parts: list[shapely.Polygon]) -> shapely.Polygon | None:
    """The connected part one enters by."""
    if not parts:
        return None
    door = entrance(graph)
    if door is None:
        return max(parts, key=lambda part: part.area)
    doorway = footprint_polygon(door.box)
    nearest = min(parts, key=doorway.distance)
    return nearest if doorway.distance(nearest) < WALKER_RADIUS_M + WALL_THICKNESS_M else None


def unreachable_rooms(
    graph: SceneGraph, free: shapely.Geometry, start: shapely.Geometry | None
) -> list[str]:
    """Ids of the rooms that one does not get to from a part of the free floor."""
    if start is None:
        return [room.id for room in graph.rooms]
    # What the walker's whole disc covers, not only its centre: a small bathroom has floor to
    # stand on but hardly any for the centre of the disc.
    covered = start.buffer(WALKER_RADIUS_M, quad_segs=4)
    floors = np.array([room_polygon(room) for room in graph.rooms])
    covered_m2 = shapely.area(shapely.intersection(floors, covered))
    free_m2 = shapely.area(shapely.intersection(floors, free))
    needed_m2 = np.minimum(REACHED_M2, REACHED_SHARE * free_m2)
    reached = (covered_m2 >= needed_m2) & (covered_m2 > 0)
    return [room.id for room, yes in zip(graph.rooms, reached, strict=True) if not yes]
