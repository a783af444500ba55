"""What the rooms of a home are for, all together: no home is without a kitchen, a bath and a bed.

A room whose drawing says little takes what the others leave to be done. What still has no place is
given a part of the largest floor, as in a studio.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from chord_usd.base.raster.page_labels import KIND_NAMES
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.room_areas import plausibility
from chord_usd.base.scene.room_names import room_kinds
from chord_usd.base.scene.types import FloatArray, Plan, Room, RoomKind
from chord_usd.line.plan.open_plans import Use, can_share, part_room
from chord_usd.line.plan.seen_kinds import SeenKinds

_SURE = 0.5
"""A room's kind is told from this chance on."""

_MISSED: dict[RoomKind, float] = {"bathroom": 4.0, "bedroom": 3.0, "living": 2.0, "kitchen": 1.1}
"""Nats that a home without one costs; the most needed first."""

_HOSTS: dict[RoomKind, tuple[RoomKind, ...]] = {
    "kitchen": ("living", "dining", "bedroom"), "bedroom": ("living",),
}  # fmt: skip
"""Whose floor may be shared by what has no room, the first choice first."""
_HOST_M2 = 14.0
_NOTHING: Mapping[str, Sequence[Use]] = {}
_LEAST_DRAWN_M2 = 1.0
"""A hob and a sink, seen as a kitchen."""

_LEAST_CHANCE = 1e-3

_SECOND_KITCHEN = 0.2
"""How likely a room without a name is a kitchen, against what it looks like, beside another."""

_SHARED: dict[RoomKind, float] = {"living": 6.0, "kitchen": 2.0, "dining": 4.0}
"""What shares floors, and how much floor has to look like it. Empty rooms look like bedrooms."""


def kinds_of_home(
    chances: FloatArray,
    areas_m2: Sequence[float],
    told: Sequence[RoomKind],
    is_home: bool,
    elsewhere: Collection[RoomKind] = (),
) -> list[tuple[RoomKind, float]]:
    """Kinds of N rooms, and how sure each is; unknown where nothing tells.

    chances: (N, K) of KIND_NAMES, by what is drawn in each. areas_m2: empty where not known. told:
    by their names, "unknown" without one. is_home: whether all rooms of a home are there.
    elsewhere: named or drawn on floors that lead with another kind (uses_elsewhere).
    """
    chances = np.array(chances, np.float64)
    if "kitchen" in elsewhere:
        nameless = [kind == "unknown" for kind in told]
        chances[nameless, KIND_NAMES.index("kitchen")] *= _SECOND_KITCHEN
    if len(areas_m2):
        chances = chances * [[plausibility(kind, area) for kind in KIND_NAMES] for area in areas_m2]
    nats = np.log(np.maximum(chances, _LEAST_CHANCE))
    best = nats.argmax(axis=1)
    sure = chances[np.arange(len(best)), best]
    needed = _make_complete(best, nats, told, elsewhere) if is_home else set()
    return [
        (KIND_NAMES[kind] if sure[room] >= _SURE or room in needed else "unknown",
         round(float(chances[room, kind]), 2))
        for room, kind in enumerate(best)
    ]  # fmt: skip


def _make_complete(
    best: npt.NDArray[np.intp],
    nats: FloatArray,
    told: Sequence[RoomKind],
    elsewhere: Collection[RoomKind],
) -> set[int]:
    """Give what a home is missing to the nameless rooms that speak against it least, in place;
    which rooms these are."""
    own = np.arange(len(best))
    needed: set[int] = set()
    for need, cost in _MISSED.items():
        if need in told or need in elsewhere:
            continue
        column = KIND_NAMES.index(need)
        loss = np.array(nats[own, best] - nats[:, column])
        loss[[kind != "unknown" or room in needed for room, kind in enumerate(told)]] = np.inf
        if len(loss) and loss.min() < cost:
            room = int(np.lexsort((-nats[:, column], loss))[0])
            best[room] = column
            needed.add(room)
    return needed


def uses_elsewhere(
    rooms: Sequence[Room], named: Sequence[Sequence[Use]], seen: SeenKinds | None
) -> set[RoomKind]:
    """Kinds that are named or drawn on a part of a floor: no other room has to be one.

    rooms: N, with the kinds that their names say; named: what each is named for; seen: on the
    plan's drawing.
    """
    found = {use.kind for uses in named for use in uses}
    for room in rooms:
        floor = room_polygon(room)
        if seen and room.kind in ("unknown", *_HOSTS["kitchen"]) and floor.area >= _HOST_M2:
            drawn_m2 = seen.areas_m2(floor)["kitchen"]
            found |= {"kitchen"} if _SHARED["kitchen"] < drawn_m2 < floor.area / 2 else set()
    return found


def part_open_plans(
    plan: Plan, named: Mapping[str, Sequence[Use]], seen: SeenKinds | None = None
) -> Plan:
    """The plan with rooms parted that have several uses. named: by room id, in place of what the
    rooms' own names say; seen: on the plan's drawing."""
    for room in plan.rooms:
        kinds = [kind for kind in room_kinds(room.name) if can_share(kind)] or [room.kind]
        own = [Use(kind) for kind in kinds if kind != "unknown"]
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


def with_missing_rooms(
    plan: Plan, seen: SeenKinds | None = None, named: Mapping[str, Sequence[Use]] = _NOTHING
) -> tuple[Plan, list[str]]:
    """The home with a kitchen and a bed on the floor of another room, where it has none; and what
    to say of that. named: what rooms are named for and where, by their ids."""
    told = []
    for need in _HOSTS:
        kinds = [room.kind for room in plan.rooms]
        if need in kinds or (need == "bedroom" and "study" in kinds):
            continue
        for host in _hosts(plan, need, seen):
            parted = _parted(plan, host, _named_or(host.kind, need, named.get(host.id, ())), seen)
            if parted is not plan:
                (new,) = {room.id for room in parted.rooms} - {room.id for room in plan.rooms}
                told.append(_told(parted, host, new, need, seen))
                plan = parted
                break
    return plan, told


def _named_or(host: RoomKind, need: RoomKind, named: Sequence[Use]) -> list[Use]:
    """The two uses of a floor, where they are named if they are."""
    known = {use.kind: use for use in named}
    return [known.get(kind, Use(kind)) for kind in (host, need)]


def _parted(plan: Plan, host: Room, uses: Sequence[Use], seen: SeenKinds | None) -> Plan:
    """The plan with a part of a room for what is needed: where it is drawn, or else where it fits
    best; as it is where it fits nowhere."""
    parted = part_room(plan, host.id, uses, seen)
    # What is drawn nowhere contradicts every part, and a bed fits on any floor.
    if parted is plan and uses[-1].kind == "kitchen":
        return part_room(plan, host.id, uses)
    return parted


def _told(plan: Plan, host: Room, new: str, need: RoomKind, seen: SeenKinds | None) -> str:
    """Of a part of a room that became a room."""
    if seen and seen.areas_m2(room_polygon(plan.room(new)))[need] > _LEAST_DRAWN_M2:
        return f"{new} is the part of {host.id} where a {need} is drawn"
    if need in room_kinds(host.name):
        return f"{host.id} is named a {need}, too: a part of it became {new}"
    return f"no {need} was recognised: a part of {host.id} became {new}"


def _hosts(plan: Plan, need: RoomKind, seen: SeenKinds | None) -> Iterator[Room]:
    """Rooms that may share their floor with what is needed: those that are named for it, those
    where it is drawn, then the largest of each kind; a bedroom only where it is all there is, as in
    a studio."""
    found = []
    for rank, kind in enumerate(_HOSTS[need]):
        rooms = [room for room in plan.rooms if room.kind == kind]
        is_wanted = kind == "bedroom" and len(rooms) > 1
        for room in () if is_wanted else rooms:
            floor = room_polygon(room)
            is_named = need in room_kinds(room.name)
            drawn_m2 = seen.areas_m2(floor)[need] if seen and need == "kitchen" else 0.0
            is_drawn = drawn_m2 > _LEAST_DRAWN_M2
            if floor.area >= _HOST_M2 or is_named:
                found.append((not is_named, not is_drawn, rank, -floor.area, room))
    return (row[-1] for row in sorted(found, key=lambda row: row[:-1]))
