"""What is wrong with a plan, in words: what keeps it from being a house."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, combinations

from chord_usd.base.metrics.walk import entrance, walk
from chord_usd.base.scene.geometry import room_polygon, rooms_beside
from chord_usd.base.scene.types import WALL_THICKNESS_M, Plan, RoomKind, SceneGraph

LEAST_AREA_M2: dict[RoomKind, float] = {
    "living": 6.0, "dining": 3.5, "bedroom": 4.5, "kitchen": 2.5, "bathroom": 1.0,
    "balcony": 0.8, "corridor": 0.8, "study": 3.0, "store": 0.6,
}  # fmt: skip
"""Less floor than this is no room of the kind; a WC of its own is a bathroom."""

LEAST_WIDTH_M = 0.7

NO_ENTRANCE_KINDS: tuple[RoomKind, ...] = ("bathroom", "store", "balcony")
"""Rooms that nobody comes home to; no procedural house and no real flat is entered by one."""

_NEARLY = 1e-3


def faults(plan: Plan) -> list[str]:
    """Everything wrong with a plan; an empty list for a house that one can live in.

    Rooms are closed (simple polygons, a wall apart or open to each other along a border), large
    enough for their kind, openings lie in walls, there is a front door, not into a bathroom, and
    every room can be reached from it.
    """
    if not plan.rooms:
        return ["there are no rooms"]
    open_rooms = [room.id for room in plan.rooms if not room_polygon(room).is_valid]
    if open_rooms:
        return [f"{room_id} is not closed" for room_id in open_rooms]
    return [*_of_rooms(plan), *_of_openings(plan), *_of_ways(plan)]


def _of_rooms(plan: Plan) -> Iterator[str]:
    floors = [(room, room_polygon(room)) for room in plan.rooms]
    for room, floor in floors:
        least = LEAST_AREA_M2.get(room.kind, 0.6)
        if floor.area < least:
            yield f"{room.id} has {floor.area:.1f} m2, less than {least:g}"
        if floor.buffer(-LEAST_WIDTH_M / 2).is_empty:
            yield f"{room.id} is narrower than {LEAST_WIDTH_M:g} m"
    # Rooms of an open plan share a border that one can walk through.
    apart_m = {
        frozenset((room.id, other.id)): floor.distance(other_floor)
        for (room, floor), (other, other_floor) in combinations(floors, 2)
    }
    open_to = {pair for pair, distance in apart_m.items() if distance < _NEARLY}
    for (room, floor), (other, other_floor) in combinations(floors, 2):
        pair = frozenset((room.id, other.id))
        if pair in open_to:
            if floor.intersection(other_floor).area > _NEARLY:
                yield f"{room.id} and {other.id} overlap"
        elif apart_m[pair] < WALL_THICKNESS_M - _NEARLY and not _share_a_space(pair, open_to):
            yield f"{room.id} and {other.id} are less than a wall apart"


def _share_a_space(pair: frozenset[str], open_to: set[frozenset[str]]) -> bool:
    """Whether both are open to a third, where no wall stands between them."""
    beside = [{*chain.from_iterable(o for o in open_to if room in o)} for room in pair]
    return bool(beside[0] & beside[1])


def _of_openings(plan: Plan) -> Iterator[str]:
    for opening in plan.openings:
        beside = rooms_beside(opening.box, plan.rooms)
        if not beside or set(beside) != set(opening.room_ids):
            rooms = ", ".join(opening.room_ids) or "a room"
            yield f"{opening.id} does not lie in a wall of {rooms}"


def _of_ways(plan: Plan) -> Iterator[str]:
    house = SceneGraph(plan.rooms, plan.openings, ())
    front_door = entrance(house)
    if front_door is None:
        yield "there is no front door"
    else:
        for room_id in front_door.room_ids:
            if plan.room(room_id).kind in NO_ENTRANCE_KINDS:
                yield f"the front door leads into {room_id}"
    for room_id in walk(house).unreachable:
        yield f"{room_id} cannot be reached"
