"""Floors with several uses become rooms that are open to each other, and what to say of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from shapely.geometry import Point

from chord_usd.base.places.free_places import is_passage
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.room_names import LEADING, room_kinds
from chord_usd.base.scene.types import Item, Plan, Room, RoomKind
from chord_usd.line.plan.home_uses import Uses
from chord_usd.line.plan.open_plans import Use, can_share, part_room
from chord_usd.line.plan.seen_kinds import SeenKinds

_LEAST_DRAWN_M2 = 1.0
"""A hob and a sink, seen as a kitchen."""

_SHARED: dict[RoomKind, float] = {"living": 6.0, "kitchen": 2.0, "dining": 4.0}
"""What shares floors, and how much floor has to look like it. Empty rooms look like bedrooms."""


def part_open_plans(
    plan: Plan, named: Mapping[str, Sequence[Use]], seen: SeenKinds | None = None
) -> Plan:
    """The plan with rooms parted that have several uses. named: by room id, in place of what the
    rooms' own names say; seen: on the plan's drawing."""
    for room in plan.rooms:
        uses = _uses_named(room, named.get(room.id, ()))
        uses += _uses_seen(room, uses, seen) if seen else []
        if len({use.kind for use in uses}) > 1:
            plan = part_room(plan, room.id, uses, seen)
    return plan


def part_floors(
    plan: Plan,
    uses: Sequence[Uses],
    named: Mapping[str, Sequence[Use]],
    seen: SeenKinds | None,
    pieces: Sequence[Item] = (),
) -> tuple[Plan, list[str], set[tuple[int, RoomKind]]]:
    """The plan with its floors parted into what they are for; what to say of parts without a name;
    and (floor, use) of the further uses that a floor has no place for.

    uses: of plan.rooms; named: by room id, in place of what the rooms' own names say; seen: on the
    plan's drawing; pieces: drawn there. A kitchen is where its hob is drawn, if not where it is
    named.
    """
    warnings: list[str] = []
    failed: set[tuple[int, RoomKind]] = set()
    for index, (room, wanted) in enumerate(zip(plan.rooms, uses, strict=True)):
        room_uses = _uses_named(room, named.get(room.id, ()))
        known = {use.kind for use in room_uses}
        needed = [*room_uses, *(Use(kind) for kind in LEADING if kind in wanted.further - known)]
        placed = {use.kind for use in room_uses if use.spots_m}
        asked = wanted.further - (known - {"kitchen"})
        free = [use.kind for use in needed if use.kind in asked - placed]
        cooked = [part for part in uses if "kitchen" in part.all]
        may_cook = wanted in cooked or not cooked
        at_hobs = _at_hobs(needed, room, pieces)
        parted = _parted(plan, room, at_hobs, set(asked), seen, may_cook)
        if at_hobs != needed and parted is plan:
            parted = _parted(plan, room, needed, set(asked), seen, may_cook)
        new = {old.id for old in parted.rooms} - {old.id for old in plan.rooms}
        for kind in free:
            made = [part for part in parted.rooms if part.id in new and part.kind == kind]
            made = [part for part in made if _can_hold(parted, part)]
            warnings += [_split_note(parted, room, part.id, kind, seen) for part in made]
            failed |= {(index, kind)} if not made and kind not in known else set()
        plan = parted
    return plan, warnings, failed


def _parted(
    plan: Plan,
    room: Room,
    needed: list[Use],
    wanted: set[RoomKind],
    seen: SeenKinds | None,
    may_cook: bool,
) -> Plan:
    """The plan with a room parted into what it is needed for, and what is drawn there; the first
    way that gives each wanted use a part. may_cook: whether a kitchen may be among the latter."""
    drawn = _uses_seen(room, needed, seen) if seen else []
    drawn = [use for use in drawn if may_cook or use.kind != "kitchen"]
    pair = [use for use in needed if use.kind in wanted | {room.kind}]
    # What is drawn nowhere contradicts every part.
    ways = [(needed + drawn, seen), (needed, seen), (needed, None), (pair, None)]
    ways = ways[:1] + ways[2 - bool(wanted and drawn) :]
    named = {use.kind for use in needed if use.spots_m}
    tried: list[tuple[Plan, set[RoomKind]]] = []
    for uses, shown in ways if wanted else ways[: 1 + (len(named) > 1)]:
        if len({use.kind for use in uses}) < 2:
            continue
        parted = part_room(plan, room.id, uses, shown)
        made = [part for part in parted.rooms if part not in plan.rooms]
        kinds = {part.kind for part in made if part.kind in named or _can_hold(parted, part)}
        tried.append((parted, kinds))
        if wanted | named <= tried[-1][1]:
            return parted
    best = max(tried, key=lambda way: (wanted <= way[1], len(way[1] & named)), default=None)
    return best[0] if best else plan


def _can_hold(plan: Plan, room: Room) -> bool:
    """Whether a room holds what its kind cannot do without: a bed is the largest such piece."""
    return room.kind != "bedroom" or not is_passage(plan.scene(), room.id)


def _at_hobs(needed: list[Use], room: Room, pieces: Sequence[Item]) -> list[Use]:
    """What a room is needed for, a kitchen without a place at its hobs."""
    floor = room_polygon(room)
    spots = tuple(
        piece.box.center_m[:2] for piece in pieces
        if piece.category == "cooker_cabinet" and floor.covers(Point(piece.box.center_m[:2]))
    )  # fmt: skip
    return [
        replace(use, spots_m=spots) if use.kind == "kitchen" and not use.spots_m else use
        for use in needed
    ]


def _uses_named(room: Room, named: Sequence[Use]) -> list[Use]:
    """What a room is named for, or else what it is."""
    kinds = [kind for kind in room_kinds(room.name) if can_share(kind)] or [room.kind]
    return list(named) or [Use(kind) for kind in kinds if kind != "unknown"]


def _uses_seen(room: Room, named: Sequence[Use], seen: SeenKinds) -> list[Use]:
    """What a floor may be used for, too, by what is drawn there."""
    known = {use.kind for use in named}
    if known and not known & _SHARED.keys():
        return []
    areas = seen.areas_m2(room_polygon(room))
    likely = [kind for kind, least_m2 in _SHARED.items() if areas[kind] > least_m2]
    return [Use(kind, is_needed=False) for kind in likely if kind not in known]


def _split_note(plan: Plan, host: Room, new: str, need: RoomKind, seen: SeenKinds | None) -> str:
    """The warning that a part of a room became a room."""
    if seen and seen.areas_m2(room_polygon(plan.room(new)))[need] > _LEAST_DRAWN_M2:
        return f"{new} is the part of {host.id} where a {need} is drawn"
    if need in room_kinds(host.name):
        return f"{host.id} is named a {need}, too: a part of it became {new}"
    return f"no {need} was recognised: a part of {host.id} became {new}"


def too_small(
    plan: Plan, floors: Sequence[Room], named: Sequence[Room]
) -> set[tuple[int, RoomKind]]:
    """(floor, kind) of rooms whose kind no name says, and that cannot hold it.

    plan: parted. floors: before; named: the same with the kinds that names say.
    """
    by_id = {room.id: room for room in plan.rooms}
    pairs = [(by_id[room.id], known.kind) for room, known in zip(floors, named, strict=True)]
    return {
        (index, room.kind)
        for index, (room, kind) in enumerate(pairs)
        if kind == "unknown" and not _can_hold(plan, room)
    }
