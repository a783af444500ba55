"""The part of a storey that a stair takes up, as a room of its own: nothing is furnished in it.

Where the stair stands in a hall, the hall loses that floor; the two touch, so no wall is between
them, and where one steps on or off is a passage, which furniture keeps clear.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from shapely import affinity, get_coordinates
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.polygon import orient
from shapely.ops import substring, unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.dwellings import is_common
from chord_usd.base.scene.geometry import polygons_of, room_polygon
from chord_usd.base.scene.types import (
    BASE_AND_HEIGHT_M,
    WALL_THICKNESS_M,
    Box,
    FloatArray,
    Opening,
    Plan,
    Room,
    frozen_array,
)

if TYPE_CHECKING:
    from chord_usd.base.scene.stair_forms import BuiltStair

CELL = "stairCell"
"""Key of Room.extra: the room is what a stair takes up."""

OPEN = "stairOpen"
"""Key of Room.extra of such a room: what of it has no floor, a list of [x, y] in centimetres."""

_CELL: dict[str, Any] = {CELL: True, "roomKind": "corridor"}

_WITH_STAIRS = ("corridor", "living", "dining", "unknown")
_LEAST_WELL_M2 = 1.5
"""Of the floor that a stair takes up in a storey alone."""

_LEAST_M2 = 0.5
"""Of what is left of a room beside a stair; less is no floor."""

_NARROW_M = 0.45
"""Floor no wider than this beside a stair is none that one can use."""

_LEAST_FALL_M2 = 0.02
_TOUCH_M = 0.05
_SEAM_M = 2e-3


@dataclass(frozen=True, eq=False)
class Cell:
    """Where a stair meets a storey."""

    room: str
    """Id of the room that is the stair's."""
    joined: str
    """Id of the room that one steps on from, or off to."""
    hole_m: Polygon | None = None
    """Where it has no floor, since the stair comes up from below."""


def is_cell(room: Room) -> bool:
    """Whether a room is what a stair takes up."""
    return bool(room.extra.get(CELL))


def with_cell(plan: Plan, built: BuiltStair, *, above: bool) -> tuple[Plan, Cell]:
    """The plan with a stair's cell, and the room that the stair leads to on it.

    above: whether the stair arrives on this storey, and does not start there. Raises PlanError for
    a stair that leads nowhere.
    """
    area = built.above_m if above else built.area_m
    by_share = sorted(
        ((area.intersection(room_polygon(room)).area / area.area, room) for room in plan.rooms),
        key=lambda pair: -pair[0],
    )
    share, main = by_share[0]
    if share < 0.5:
        raise PlanError(
            f"stair {built.stair.id} leads nowhere: it meets no room"
            if above else f"stair {built.stair.id} stands in no room",
            expected="a room around the stair on both storeys",
        )  # fmt: skip
    if not above:
        _refuse_fall(main, built)
    beside = _left_of(main, area)
    pockets = [part for part in beside if above and part.difference(built.area_m).area < _LEAST_M2]
    hole = area if share > 0.99 else _inside(area, main)
    if is_cell(main):
        cell = replace(main, polygon_m=_corners(_with_more(main, area, plan)))
        rooms = [r for r in plan.rooms if r.id != main.id]
    elif len(pockets) == len(beside):  # the room is there for the stair
        cell, rooms = _marked(main), [r for r in plan.rooms if r.id != main.id]
        hole = room_polygon(main)
    else:
        hole = max(polygons_of(unary_union([hole, *pockets])), key=lambda part: part.area)
        cell = Room(
            _free_id(plan, f"{built.stair.id}_cell"), "corridor", _corners(hole), "Stairs", _CELL
        )
        rooms = list(plan.rooms)
    if above:
        hole = built.hole_m.intersection(hole) if built.is_spiral else hole
        cell = replace(cell, extra={**cell.extra, OPEN: _open_cm(cell, built, hole)})
    rooms = [part for room in rooms for part in _cut(room, room_polygon(cell))]
    place = [room.id for room in plan.rooms].index(main.id)
    rooms.insert(min(place + 1, len(rooms)), cell)
    plan = replace(plan, rooms=tuple(rooms))
    return _joined(plan, Cell(cell.id, "", hole if above else None), built, above)


def with_wells(plan: Plan, stairs: Sequence[Polygon]) -> Plan:
    """The plan of a storey alone with a cell for each stair that it shows, so that nothing stands
    on the steps.

    stairs: outlines, metres. Passed over are those that are small, in a room for something else, or
    before an opening: there something else is drawn.
    """
    for area in stairs:
        main = max(plan.rooms, key=lambda room: area.intersection(room_polygon(room)).area)
        well = area.intersection(room_polygon(main))
        is_empty = is_cell(main) or is_common(main)
        if is_empty or main.kind not in _WITH_STAIRS or well.area < _LEAST_WELL_M2:
            continue
        beside = _left_of(main, area)
        doors = [
            opening
            for opening in plan.openings
            if main.id in opening.room_ids and opening.kind != "window"
        ]
        if not beside:
            rooms = [_marked(room) if room is main else room for room in plan.rooms]
            plan = replace(plan, rooms=tuple(rooms))
        elif len(beside) == 1 and all(_opens_onto(opening, beside[0], area) for opening in doors):
            corners = _corners(_inside(area, main))
            cell = Room(_free_id(plan, f"{main.id}_stairs"), "corridor", corners, "Stairs", _CELL)
            rooms = [part for room in plan.rooms for part in _cut(room, room_polygon(cell))]
            plan = replace(plan, rooms=(*rooms, cell))
    return plan


def _opens_onto(opening: Opening, floor: Polygon, stair: Polygon) -> bool:
    """Whether one steps through an opening onto a floor and not onto a stair."""
    middle = Point(opening.box.center_m[:2])
    return bool(middle.distance(floor) + _TOUCH_M < middle.distance(stair))


def _refuse_fall(room: Room, built: BuiltStair) -> None:
    """Raises PlanError for a stair whose first steps one reaches over the hole of another one."""
    holes = unary_union([Polygon(ring) for ring in room.extra.get(OPEN, ())])
    way = built.approach_m
    if (
        way is not None
        and affinity.scale(way, 100.0, 100.0, origin=(0, 0)).intersection(holes).area
        > _LEAST_FALL_M2 * 1e4
    ):
        raise PlanError(
            f"stair {built.stair.id} begins over the hole that the stair below comes up through",
            expected="its front where the stair below ends",
        )


def _open_cm(cell: Room, built: BuiltStair, hole: Polygon) -> list[list[list[float]]]:
    """Holes in the floor of a cell, those that it had before included."""
    left = hole if built.landing_m is None else hole.difference(built.landing_m)
    rings = [np.asarray(part.exterior.coords)[:-1] * 100.0 for part in polygons_of(left)]
    return [*cell.extra.get(OPEN, ()), *(ring.round(2).tolist() for ring in rings)]


def _with_more(cell: Room, area: Polygon, plan: Plan) -> Polygon:
    """A cell with what another stair takes up beside it."""
    floors = unary_union([area.intersection(room_polygon(room)) for room in plan.rooms])
    touching = unary_union([room_polygon(cell), floors]).buffer(1e-4, join_style="mitre")
    parts = polygons_of(touching.buffer(-1e-4, join_style="mitre"))
    return max(parts, key=lambda part: part.intersection(room_polygon(cell)).area)


def _joined(plan: Plan, cell: Cell, built: BuiltStair, above: bool) -> tuple[Plan, Cell]:
    """The room where one steps on or off, over a passage where no wall is between."""
    probe = Point(built.walk_m[-1 if above else 0, :2])
    edge = built.arrival_m if above else built.departure_m
    others = [room for room in plan.rooms if room.id != cell.room]
    beyond = next((room for room in others if room_polygon(room).covers(probe)), None)
    if beyond is not None and room_polygon(beyond).distance(edge.centroid) < _TOUCH_M:
        name = f"{built.stair.id}_{'top' if above else 'foot'}"
        opening = _passage(name, _open_part(edge, plan.room(cell.room), beyond), cell.room, beyond)
        added = (
            () if any(_is_known(opening, existing) for existing in plan.openings) else (opening,)
        )
        plan = replace(plan, openings=(*plan.openings, *added))
        return _as_landing(plan, beyond.id), replace(cell, joined=beyond.id)
    for opening in plan.openings:
        joins = opening.kind != "window" and len(opening.room_ids) > 1
        near = Point(opening.box.center_m[:2]).distance(edge) < 2 * WALL_THICKNESS_M
        if joins and near and cell.room in opening.room_ids:
            joined = next(room_id for room_id in opening.room_ids if room_id != cell.room)
            return _as_landing(plan, joined), replace(cell, joined=joined)
    raise PlanError(
        f"stair {built.stair.id} leads nowhere: its {'top' if above else 'foot'} ends at a wall",
        expected="floor, or a door, where one steps on and off",
    )


def _is_known(passage: Opening, other: Opening) -> bool:
    """Whether there is such a passage: a stair may begin where the one below ends."""
    apart = np.subtract(passage.box.center_m, other.box.center_m)
    between = set(passage.room_ids) == set(other.room_ids)
    return passage.id == other.id or (between and bool(np.hypot(*apart[:2]) < _TOUCH_M))


def _as_landing(plan: Plan, room_id: str) -> Plan:
    """A room that a stair leads to is a hall, if nothing says what else it is."""
    rooms = tuple(
        replace(room, kind="corridor") if room.id == room_id and room.kind == "unknown" else room
        for room in plan.rooms
    )
    return replace(plan, rooms=rooms)


def _open_part(edge: LineString, cell: Room, beyond: Room) -> LineString:
    """What of an edge is floor on both sides: a stair may reach into the walls beside it, and a
    passage that does would count as one through these."""
    near = edge.buffer(_TOUCH_M, cap_style="flat")
    floor = [room_polygon(room).intersection(near) for room in (cell, beyond)]
    spans = [
        sorted(edge.project(Point(at)) for at in get_coordinates(part)) for part in floor if part
    ]
    if len(spans) < 2:
        return edge
    low, high = max(span[0] for span in spans), min(span[-1] for span in spans)
    if high - low > edge.length - _SEAM_M:
        return edge
    return substring(edge, low + _SEAM_M, high - _SEAM_M)


def _passage(name: str, edge: LineString, cell: str, beyond: Room) -> Opening:
    (x0, y0), (x1, y1) = np.asarray(edge.coords)
    low, height = BASE_AND_HEIGHT_M["passage"]
    length = float(np.hypot(x1 - x0, y1 - y0))
    yaw_deg = float(np.degrees(np.arctan2(y1 - y0, x1 - x0))) % 180.0
    middle = (float(x0 + x1) / 2, float(y0 + y1) / 2, low)
    return Opening(
        name, "passage", Box(middle, (length, WALL_THICKNESS_M, height), yaw_deg),
        (cell, beyond.id),
    )  # fmt: skip


def _left_of(room: Room, area: Polygon) -> list[Polygon]:
    """What of a room's floor can be used beside a stair, the largest part first."""
    free = room_polygon(room).difference(area.buffer(1e-4, join_style="mitre"))
    half = _NARROW_M / 2
    opened = free.buffer(-half, join_style="mitre").buffer(half, join_style="mitre")
    exact = room_polygon(room).difference(area).intersection(
        opened.buffer(1e-3, join_style="mitre")
    )  # fmt: skip
    parts = [part for part in polygons_of(exact) if part.area >= _LEAST_M2]
    return sorted(parts, key=lambda part: -part.area)


def _cut(room: Room, area: Polygon) -> list[Room]:
    """A room less the stair; in several where the stair divides it."""
    if room_polygon(room).intersection(area).area < 1e-3:
        return [room]
    parts = _left_of(room, area)
    return [
        replace(room, id=room.id if index == 0 else f"{room.id}_{index}",
                polygon_m=_corners(part))
        for index, part in enumerate(parts)
    ]  # fmt: skip


def _inside(area: Polygon, room: Room) -> Polygon:
    parts = polygons_of(area.intersection(room_polygon(room)))
    return max(parts, key=lambda part: part.area)


def _marked(room: Room) -> Room:
    return replace(room, kind="corridor", extra={**room.extra, **_CELL})


def _corners(polygon: Polygon) -> FloatArray:
    tidy = orient(Polygon(polygon.exterior).simplify(2e-3))
    return frozen_array(np.asarray(tidy.exterior.coords)[:-1])


def _free_id(plan: Plan, wanted: str) -> str:
    taken, number = {room.id for room in plan.rooms}, 0
    while (name := wanted if not number else f"{wanted}_{number}") in taken:
        number += 1
    return name
