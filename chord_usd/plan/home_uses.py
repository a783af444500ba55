"""What the rooms of a home are for, all together: no home is without a kitchen, a bath and a bed.

A room whose drawing says little takes what the others leave to be done. What still has no place is
given a part of the largest floor, as in a studio.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from chord_usd.plan.open_plans import Use, part_room
from chord_usd.plan.seen_kinds import SeenKinds
from chord_usd.raster.page_labels import KIND_NAMES
from chord_usd.scene.geometry import room_polygon
from chord_usd.scene.room_areas import plausibility
from chord_usd.scene.types import FloatArray, Plan, Room, RoomKind

_SURE = 0.5
"""A room's kind is told from this chance on."""

_MISSED: dict[RoomKind, float] = {"bathroom": 4.0, "bedroom": 3.0, "living": 2.0, "kitchen": 1.1}
"""Nats that a home without one costs; the most needed first."""

_HOSTS: dict[RoomKind, tuple[RoomKind, ...]] = {
    "kitchen": ("living", "dining", "bedroom"), "bedroom": ("living",),
}  # fmt: skip
"""Whose floor may be shared by what has no room, the first choice first."""
_HOST_M2 = 14.0

_LEAST_CHANCE = 1e-3

_SHARED: dict[RoomKind, float] = {"living": 6.0, "kitchen": 2.0, "dining": 4.0}
"""What shares floors, and how much floor has to look like it. Empty rooms look like bedrooms."""


def kinds_of_home(
    chances: FloatArray, areas_m2: Sequence[float], told: Sequence[RoomKind], is_home: bool
) -> list[tuple[RoomKind, float]]:
    """Kinds of N rooms, and how sure each is; unknown where nothing tells.

    chances: (N, K) of KIND_NAMES, by what is drawn in each. areas_m2: empty where not known. told:
    by their names, "unknown" without one. is_home: whether all rooms of a home are there.
    """
    chances = np.array(chances, np.float64)
    if len(areas_m2):
        chances = chances * [[plausibility(kind, area) for kind in KIND_NAMES] for area in areas_m2]
    nats = np.log(np.maximum(chances, _LEAST_CHANCE))
    best = nats.argmax(axis=1)
    sure = chances[np.arange(len(best)), best]
    needed = _make_complete(best, nats, told) if is_home else set()
    return [
        (KIND_NAMES[kind] if sure[room] >= _SURE or room in needed else "unknown",
         round(float(chances[room, kind]), 2))
        for room, kind in enumerate(best)
    ]  # fmt: skip


def _make_complete(
    best: npt.NDArray[np.intp], nats: FloatArray, told: Sequence[RoomKind]
) -> set[int]:
    """Give what a home is missing to the nameless rooms that speak against it least, in place;
    which rooms these are."""
    own = np.arange(len(best))
    needed: set[int] = set()
    for need, cost in _MISSED.items():
        if need in told:
            continue
        column = KIND_NAMES.index(need)
        loss = np.array(nats[own, best] - nats[:, column])
        loss[[kind != "unknown" or room in needed for room, kind in enumerate(told)]] = np.inf
        if len(loss) and loss.min() < cost:
            room = int(np.lexsort((-nats[:, column], loss))[0])
            best[room] = column
            needed.add(room)
    return needed


def part_open_plans(
    plan: Plan, named: Mapping[str, Sequence[Use]], seen: SeenKinds | None = None
) -> Plan:
    """The plan with rooms parted that have several uses. named: by room id; seen: on the plan's
    drawing."""
    for room in plan.rooms:
        own = [Use(room.kind)] if room.kind != "unknown" else []
        uses = list(named.get(room.id) or own)
        uses += _uses_seen(room, uses, seen) if seen else []
        if len({use.kind for use in uses}) > 1:
            plan = part_room(plan, room.id, uses, seen)
    return plan


def _uses_seen(room: Room, named: Sequence[Use], seen: SeenKinds) -> list[Use]:
    """What a floor may be used for, too, by what is drawn there."""
    told = {use.kind for use in named}
    if told and not told & _SHARED.keys():
        return []
    areas = seen.areas_m2(room_polygon(room))
    likely = [kind for kind, least_m2 in _SHARED.items() if areas[kind] > least_m2]
    return [Use(kind, is_needed=False) for kind in likely if kind not in told]


def with_missing_rooms(plan: Plan, seen: SeenKinds | None = None) -> tuple[Plan, list[str]]:
    """The home with a kitchen and a bed on the floor of another room, where it has none; and what
    to say of that."""
    told = []
    for need in _HOSTS:
        kinds = [room.kind for room in plan.rooms]
        if need in kinds or (need == "bedroom" and "study" in kinds):
            continue
        for host in _hosts(plan, need):
            parted = part_room(plan, host.id, (Use(host.kind), Use(need)), seen)
            if parted is not plan:
                (new,) = {room.id for room in parted.rooms} - {room.id for room in plan.rooms}
                told.append(f"no {need} is drawn: a part of {host.id} became {new}")
                plan = parted
                break
    return plan, told


def _hosts(plan: Plan, need: RoomKind) -> Iterator[Room]:
    """Rooms that may share their floor with what is needed: the largest of each kind; a bedroom
    only where it is all there is, as in a studio."""
    for kind in _HOSTS[need]:
        rooms = [room for room in plan.rooms if room.kind == kind]
        largest = max(rooms, key=lambda room: room_polygon(room).area, default=None)
        is_wanted = kind == "bedroom" and len(rooms) > 1
        if largest and not is_wanted and room_polygon(largest).area >= _HOST_M2:
            yield largest
