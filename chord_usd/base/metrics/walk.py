"""Where one can walk: the free floor of a house in one piece, and the rooms it reaches.

Free floor is the rooms plus the holes of doors and passages, minus the footprints of what stands
below head height. A walker is a disc of WALKER_RADIUS_M, so its centre keeps to the free floor
eroded by that much (SceneEval). The certificate, maps for robots, rules and dressing all ask here.

A walker starts at the entrance. Parts that the plan itself separates from it, such as a garage,
are entered by an outer door there. What the plan gives no way in at all is doorless: no furniture
is to blame.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
import shapely
from shapely.geometry import Point

from chord_usd.base.metrics.clear_floor import open_borders, rooms_beside
from chord_usd.base.metrics.footprints import GRID_M, footprints_of, is_underfoot
from chord_usd.base.scene.geometry import footprint_polygon, polygons_of, room_polygon
from chord_usd.base.scene.palette import CATEGORIES, Mount
from chord_usd.base.scene.types import WALL_THICKNESS_M, Item, Opening, Room, RoomKind, SceneGraph

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
    "washroom", "wc",
)  # fmt: skip
"""Rooms a front door leads into, likeliest first; a balcony has none."""


@dataclass(frozen=True)
class Ascent:
    """A stair that can be walked."""

    storey: int
    """Index of the lower one."""
    foot_m: tuple[float, float]
    top_m: tuple[float, float]
    """Where one stands before the first step, and after the last."""


@dataclass(frozen=True)
class Walk:
    """How far one gets on foot."""

    walkable: float
    """Largest connected part of the walkable floor / all of it, [0, 1]; 0.0 where there is none."""
    walkable_m2: float
    """All of it: where the centre of a walker can be."""
    unreachable: tuple[str, ...]
    """Ids of rooms that no way leads to."""
    rooms: int
    doorless: tuple[str, ...] = ()
    """Of unreachable, those that the plan gives no way in, even without furniture."""
    annexes: tuple[str, ...] = ()
    """Ids of rooms that only an outer door beside the entrance leads to."""
    reached: shapely.Geometry = field(default_factory=shapely.Polygon)
    """Where the centre of a walker gets to."""

    @property
    def reachable_rooms(self) -> float:
        """Share of rooms that can be reached; 1.0 for a house without rooms."""
        return 1.0 - len(self.unreachable) / self.rooms if self.rooms else 1.0

    @property
    def shut(self) -> tuple[str, ...]:
        """Ids of rooms that furniture or dressing shuts."""
        return tuple(room_id for room_id in self.unreachable if room_id not in self.doorless)


def walk(graph: SceneGraph) -> Walk:
    """Walkable share and reachable rooms of a house on one floor (walk_storeys)."""
    return walk_storeys([graph])[0]


def walk_storeys(storeys: Sequence[SceneGraph], ascents: Sequence[Ascent] = ()) -> list[Walk]:
    """How far one gets on each storey, over stairs, from the entrance, on the lowest that has one.

    Without an entrance one starts in the largest connected part of the lowest storey. An entrance
    that opens onto no walkable floor reaches no room. Leave openings by which one steps onto stairs
    out of the graphs: they are no entrances.
    """
    front = next(
        ((at, door) for at, graph in enumerate(storeys) if (door := entrance(graph))), None
    )  # fmt: skip
    starts = [front] if front else []
    walks = _walked(storeys, ascents, starts)
    if not any(each.unreachable for each in walks):
        return walks
    empty = [replace(graph, items=(), dressing=()) for graph in storeys]
    planned = _walked(empty, ascents, starts)
    other_doors = [
        (at, door)
        for at, graph in enumerate(storeys)
        for door in outer_doors(graph)
        if not _near(planned[at].reached, footprint_polygon(door.box))
    ]
    if front and other_doors:
        walks = _walked(storeys, ascents, [*starts, *other_doors])
        entered = _walked(empty, ascents, [*starts, *other_doors])
    else:
        entered = planned
    return [
        _blamed(graph, each, plan, whole)
        for graph, each, plan, whole in zip(storeys, walks, planned, entered, strict=True)
    ]


def _blamed(graph: SceneGraph, walked: Walk, planned: Walk, entered: Walk) -> Walk:
    """The walk, with what is the plan's. planned: of the empty house from the entrance; entered:
    from all its outer doors. Ducts, smaller than REACHED_M2 and without a way in, are no rooms."""
    areas_m2 = {room.id: room_polygon(room).area for room in graph.rooms}
    ducts = [room_id for room_id in entered.unreachable if areas_m2[room_id] < REACHED_M2]
    return replace(
        walked,
        unreachable=tuple(each for each in walked.unreachable if each not in ducts),
        doorless=tuple(each for each in entered.unreachable if each not in ducts),
        annexes=tuple(each for each in planned.unreachable if each not in entered.unreachable),
    )


def _walked(
    storeys: Sequence[SceneGraph],
    ascents: Sequence[Ascent],
    starts: Sequence[tuple[int, Opening]],
) -> list[Walk]:
    """From outer doors on these storeys, without looking for what the plan is to blame for."""
    free = [free_floor(graph) for graph in storeys]
    parts = [walkable_parts(floor) for floor in free]
    reached: list[set[int]] = [set() for _ in storeys]
    for at, door in starts:
        reached[at] |= _part_at(footprint_polygon(door.box), parts[at])
    if not starts and storeys and parts[0]:
        areas_m2 = [part.area for part in parts[0]]
        reached[0].add(areas_m2.index(max(areas_m2)))
    ways = [
        (way.storey, _part_at(Point(way.foot_m), parts[way.storey]),
         _part_at(Point(way.top_m), parts[way.storey + 1]))
        for way in ascents
    ]  # fmt: skip
    for _ in storeys:  # a way up and down again takes no more rounds
        for low, foot, top in ways:
            if foot & reached[low]:
                reached[low + 1] |= top
            if top & reached[low + 1]:
                reached[low] |= foot
    return [_measured(*each) for each in zip(storeys, free, parts, reached, strict=True)]


def _part_at(place: shapely.Geometry, parts: Sequence[shapely.Polygon]) -> set[int]:
    """Index of the part that one stands on at a place, if there is such a part."""
    nearest = min(range(len(parts)), key=lambda at: place.distance(parts[at]), default=None)
    return {nearest} if nearest is not None and _near(parts[nearest], place) else set()


def _near(walkable: shapely.Geometry, place: shapely.Geometry) -> bool:
    """Whether a walker steps from a place, such as a doorway, onto walkable floor."""
    return bool(place.distance(walkable) < WALKER_RADIUS_M + WALL_THICKNESS_M)


def _measured(
    graph: SceneGraph,
    free: shapely.Geometry,
    parts: Sequence[shapely.Polygon],
    reached: set[int],
) -> Walk:
    areas_m2 = [part.area for part in parts]
    total_m2 = sum(areas_m2)
    start = shapely.union_all([parts[at] for at in sorted(reached)])
    return Walk(
        walkable=max(areas_m2) / total_m2 if total_m2 > 0 else 0.0,
        walkable_m2=total_m2,
        unreachable=tuple(_unreachable_rooms(graph, free, start)),
        rooms=len(graph.rooms),
        reached=start,
    )


def _unreachable_rooms(
    graph: SceneGraph, free: shapely.Geometry, start: shapely.Geometry
) -> list[str]:
    """Ids of the rooms that one does not get to from a part of the free floor."""
    if start.is_empty:
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


def outer_doors(graph: SceneGraph) -> list[Opening]:
    """Doors and passages between the outside and a room to enter by, the likeliest first."""
    candidates: list[tuple[int, int, Opening]] = []
    sides = rooms_beside(graph.openings, graph.rooms)
    for order, (opening, pair) in enumerate(zip(graph.openings, sides, strict=True)):
        beside = [room for room in pair if room is not None]
        if opening.kind != "window" and len(beside) == 1 and beside[0].kind in ENTRANCE_KINDS:
            candidates.append((ENTRANCE_KINDS.index(beside[0].kind), order, opening))
    return [opening for _, _, opening in sorted(candidates, key=lambda each: each[:2])]


def entrance(graph: SceneGraph) -> Opening | None:
    """The front door: the likeliest of the outer doors; None where none leads out."""
    return next(iter(outer_doors(graph)), None)


def free_floor(graph: SceneGraph) -> shapely.Geometry:
    """Floor that nothing stands on, doorways included; grown by SEAM_M at the walls."""
    floor = _bare_floor(tuple(graph.rooms), tuple(graph.openings))
    return left_free(floor, (*graph.items, *filter(takes_floor, graph.dressing)))


@lru_cache(maxsize=64)  # drafts of a house ask for the same plan, and for each of its rooms alone
def _bare_floor(rooms: tuple[Room, ...], openings: tuple[Opening, ...]) -> shapely.Geometry:
    grown = [room_polygon(room).buffer(SEAM_M, join_style="mitre") for room in rooms]
    doorways = [_doorway(opening) for opening in openings if opening.kind != "window"]
    return shapely.union_all([*grown, *doorways])


def left_free(floor: shapely.Geometry, things: Iterable[Item]) -> shapely.Geometry:
    """A floor less what of these stands on it below head height."""
    standing = [
        item for item in things if item.box.center_m[2] < HEAD_ROOM_M and not is_underfoot(item)
    ]
    if not standing:
        return floor
    stood_on = shapely.union_all(footprints_of(standing).polygons)
    return floor.difference(stood_on, grid_size=GRID_M)


def takes_floor(item: Item) -> bool:
    """Whether dressing takes up floor: it stands or hangs, and a walker does not pass by it."""
    row = CATEGORIES.get(item.category)
    if row is None or row.mount is Mount.WALL:
        return row is None or item.box.size_m[1] > PASSED_BY_M
    return row.mount in (Mount.FLOOR, Mount.CEILING)


def _doorway(opening: Opening) -> shapely.Polygon:
    length_m, width_m, height_m = opening.box.size_m
    deeper_m = (length_m, width_m + 2 * DOOR_OVERLAP_M, height_m)
    return footprint_polygon(replace(opening.box, size_m=deeper_m))


def ways_shut(graph: SceneGraph, room: Room) -> int:
    """How many ways of a room, doors, passages and open borders, its pieces part from most of the
    others in it."""
    return _ways_shut(_alone(graph, room))


def is_shut(graph: SceneGraph, room: Room) -> bool:
    """Whether the pieces of a room keep a walker from the floor, or part the ways of the room."""
    alone = _alone(graph, room)
    return bool(_ways_shut(alone) or walk(alone).shut)


def _ways_shut(alone: SceneGraph) -> int:
    if len({way.id for way in alone.openings}) < 2:
        return 0
    shut = _parted(alone)
    return max(0, shut - _parted(replace(alone, items=()))) if shut else 0


def _alone(graph: SceneGraph, room: Room) -> SceneGraph:
    """A room with its pieces, and doors, passages and open borders as its openings."""
    doors = [each for each in graph.openings if each.kind != "window" and room.id in each.room_ids]
    borders = open_borders(graph.rooms, graph.openings)
    ways = (*doors, *(border for border in borders if room.id in border.room_ids))
    items = tuple(item for item in graph.items if item.room_id == room.id)
    return replace(graph, rooms=(room,), openings=ways, items=items, dressing=())


def _parted(room: SceneGraph) -> int:
    """Ways of a single room beyond those that hang together."""
    doorways: dict[str, list[shapely.Polygon]] = {}
    for way in room.openings:
        doorways.setdefault(way.id, []).append(footprint_polygon(way.box))
    near_m = WALKER_RADIUS_M + 2 * SEAM_M
    joined = [
        sum(any(part.dwithin(side, near_m) for side in sides) for sides in doorways.values())
        for part in walkable_parts(free_floor(room))
    ]
    return len(doorways) - max(joined, default=0)


def walkable_parts(free: shapely.Geometry) -> list[shapely.Polygon]:
    """Where the centre of a walker can be on free floor, in connected parts."""
    return polygons_of(free.buffer(-WALKER_RADIUS_M - SEAM_M, quad_segs=4))
