"""Real flats: the Japanese flats of FloorplanTransformation (Liu et al., ICCV 2017) as plans.

A line of the file is one flat: {"id", "lines"}, where a line is [x0, y0, x1, y1, label, a, b] in
pixels, y down, without scale. "wall" and "door" are segments (doors and windows alike); all other
labels are boxes that name a room or a fixture. Walls there are thin; here every wall takes
WALL_THICKNESS_M around the drawn line, as in all our plans.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from shapely import affinity
from shapely.errors import ShapelyError
from shapely.geometry import LineString
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.metrics.rooms import empty_rooms
from chord_usd.base.runtime.json_lines import read_lines
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.scene.geometry import refuse_unreachable
from chord_usd.base.scene.types import Plan, Room, RoomKind, frozen_array
from chord_usd.base.scene.wet_rooms import with_wet_kinds
from chord_usd.workshop.data.floorplans.traced import Mark, Segment, closed_cells, px_per_m
from chord_usd.workshop.data.floorplans.traced_openings import traced_openings, unreached
from chord_usd.workshop.data.floorplans.traced_rooms import TracedRoom, traced_rooms
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.splits import Part, part_of

_AREA_M2 = (14.0, 130.0)
"""Floor area of a flat that one can believe, balconies included."""

_LEAST_AREA_M2: dict[RoomKind, float] = {"living": 6.0, "bedroom": 4.5, "kitchen": 2.2}

_DRAWS = 2
"""Times a plan is furnished to find out whether it can be."""

_MAIN_STOREY = 0.7
"""A drawing of two storeys is read where one has at least this share of the floor."""

_FIXTURES_KEPT = ("toilet", "bathtub", "cooking_counter", "washing_basin")

_NAMES = {
    "living": "Living Room", "dining": "Dining Room", "bedroom": "Bedroom", "kitchen": "Kitchen",
    "bathroom": "Bathroom", "balcony": "Balcony", "corridor": "Corridor", "study": "Study",
    "store": "Store", "unknown": "Room",
}  # fmt: skip


def read_flats(path: Path, part: Part | None = None) -> list[Plan]:
    """The flats of the file that can be read soundly, in the order of the file.

    part: only those that belong to this part of the split (splits.part_of); None is all.
    Plan.extra holds "source" (the flat's id) and "fixtures": {category, x, y, w, h} boxes in
    metres of what the drawing shows (toilet, bathtub, cooking_counter, washing_basin), centre and
    size. Raises PlanError where the file is none of these.
    """
    flats = read_flats_or_why(path, part)
    return [plan for plan in flats.values() if isinstance(plan, Plan)]


def read_flats_or_why(path: Path, part: Part | None = None) -> dict[str, Plan | str]:
    """Every flat of this part by its id: the plan, or in words why it was dropped."""
    flats: dict[str, Plan | str] = {}
    for flat_id, lines in _records(path):
        if part is not None and part_of(flat_id) != part:
            continue
        try:
            flats[flat_id] = flat_from_lines(flat_id, lines)
        except PlanError as error:
            flats[flat_id] = error.what
    return flats


def furnishable(plans: Iterable[Plan]) -> list[Plan]:
    """The plans of which every room to live in can be furnished, in order; others teach emptiness.

    In about one flat of fifty a room is all doors, and nothing may stand before a door.
    """
    return [plan for plan in plans if _is_furnishable(plan)]


def _is_furnishable(plan: Plan) -> bool:
    draws = (furnish(plan, np.random.default_rng(seed)) for seed in range(_DRAWS))
    return any(not empty_rooms(scene) for scene in draws)


def _records(path: Path) -> Iterator[tuple[str, list[list[Any]]]]:
    for number, line in read_lines(path, PlanError):
        where = f"{path} line {number}"
        record = parse_json(line, where, PlanError)
        if not isinstance(record, Mapping) or not {"id", "lines"} <= record.keys():
            raise PlanError("no flat", where=where, expected='{"id", "lines"}')
        yield str(record["id"]), record["lines"]


def flat_from_lines(flat_id: str, lines: Sequence[Sequence[Any]]) -> Plan:
    """One flat from its labelled lines in pixels. Raises PlanError saying what is unsound."""
    try:
        return _flat_from_lines(flat_id, lines)
    except (ArithmeticError, LookupError, TypeError, ValueError, ShapelyError) as error:
        raise PlanError(f"lines that are none ({error!r:.200})") from error


def _flat_from_lines(flat_id: str, lines: Sequence[Sequence[Any]]) -> Plan:
    walls, doors, marks = _sorted_lines(lines)
    cells = closed_cells(walls)
    scale = px_per_m(cells, marks, doors)
    if not cells or scale <= 0.0:
        raise PlanError("no closed room")
    door_lines = [
        LineString([(x0 / scale, -y0 / scale), (x1 / scale, -y1 / scale)])
        for x0, y0, x1, y1 in doors
    ]
    rooms = traced_rooms(
        [affinity.scale(cell, 1 / scale, -1 / scale, origin=(0, 0)) for cell in cells],
        [_in_metres(mark, scale) for mark in marks],
        door_lines,
    )
    return _plan(flat_id, rooms, door_lines, [_in_metres(mark, scale) for mark in marks])


def _sorted_lines(
    lines: Sequence[Sequence[Any]],
) -> tuple[list[Segment], list[Segment], list[Mark]]:
    walls: list[Segment] = []
    doors: list[Segment] = []
    marks: list[Mark] = []
    refuse_unreachable([line[:4] for line in lines], PlanError)
    for x0, y0, x1, y1, label, *_ in lines:
        if label == "wall":
            walls.append((float(x0), float(y0), float(x1), float(y1)))
        elif label == "door":
            doors.append((float(x0), float(y0), float(x1), float(y1)))
        else:
            marks.append(Mark(label, min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)))
    return walls, doors, marks


def _in_metres(mark: Mark, scale: float) -> Mark:
    return Mark(mark.label, mark.x0 / scale, -mark.y1 / scale, mark.x1 / scale, -mark.y0 / scale)


def _plan(
    flat_id: str,
    rooms: Sequence[TracedRoom],
    doors: Sequence[LineString],
    marks: Sequence[Mark],
) -> Plan:
    rooms = _one_storey(rooms)
    ids = [f"room{index + 1}" for index in range(len(rooms))]
    openings = traced_openings(rooms, doors, ids)
    links = [[ids.index(i) for i in o.room_ids] for o in openings if o.kind != "window"]
    shafts = {ids[index] for index in unreached(rooms, links, links[0][0])}
    kept = [(i, room) for i, room in zip(ids, rooms, strict=True) if i not in shafts]
    _refuse_unsound([room for _, room in kept])
    plan = Plan(
        rooms=_named(kept),
        openings=tuple(o for o in openings if shafts.isdisjoint(o.room_ids)),
        extra={"source": flat_id, "fixtures": _fixtures(marks)},
    )
    return with_wet_kinds(plan)


def _one_storey(rooms: Sequence[TracedRoom]) -> list[TracedRoom]:
    """The rooms of the main storey, without a stairwell or attic drawn beside it."""
    if not rooms:
        raise PlanError("no closed room")
    groups = unary_union([room.cell.buffer(0.15) for room in rooms])
    parts = sorted(getattr(groups, "geoms", [groups]), key=lambda part: -part.area)
    if parts[0].area < _MAIN_STOREY * groups.area:
        raise PlanError("more than one storey in one drawing")
    return [room for room in rooms if parts[0].covers(room.cell)]


def _refuse_unsound(rooms: Sequence[TracedRoom]) -> None:
    area_m2 = sum(room.face.area for room in rooms)
    if not _AREA_M2[0] <= area_m2 <= _AREA_M2[1]:
        raise PlanError("a floor area beyond belief")
    unknown_m2 = sum(room.face.area for room in rooms if room.kind == "unknown")
    if unknown_m2 > 0.12 * area_m2:
        raise PlanError("rooms without labels")
    for room in rooms:
        if room.face.area < _LEAST_AREA_M2.get(room.kind, 0.0):
            raise PlanError(f"a {room.kind} too small to be one")
    kinds = {room.kind for room in rooms}
    if kinds.isdisjoint({"living", "bedroom"}) or "bathroom" not in kinds:
        raise PlanError("no bathroom, or nowhere to live")


def _named(rooms: Iterable[tuple[str, TracedRoom]]) -> tuple[Room, ...]:
    counts: dict[str, int] = {}
    named = []
    for room_id, room in rooms:
        counts[room.kind] = counts.get(room.kind, 0) + 1
        polygon = frozen_array(orient(room.face).exterior.coords[:-1])
        name = f"{_NAMES[room.kind]} {counts[room.kind]}"
        named.append(Room(room_id, room.kind, polygon, name))
    return tuple(named)


def _fixtures(marks: Sequence[Mark]) -> list[dict[str, Any]]:
    return [
        {
            "category": mark.label,
            "x": mark.center[0],
            "y": mark.center[1],
            "w": mark.x1 - mark.x0,
            "h": mark.y1 - mark.y0,
        }
        for mark in marks
        if mark.label in _FIXTURES_KEPT
    ]
