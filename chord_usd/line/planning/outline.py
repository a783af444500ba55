"""A drawing of outer walls -> the shell that rooms are planned in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.raster import plan_labels
from chord_usd.base.scene.geometry import polygons_of, room_polygon
from chord_usd.base.scene.tunnels import ON_LINE_M
from chord_usd.base.scene.types import (
    OPEN,
    SURROUNDS,
    WALL_THICKNESS_M,
    ByteArray,
    PixelFrame,
    Plan,
    Room,
    frozen_array,
)

LEAST_AREA_M2 = 14.0


def shell_of(plan: Plan, where: str) -> Plan:
    """The open plan that was read from a drawing: one room, and the openings of its walls.

    where: what to name in errors. Rooms that touch are the parts that a reader saw on one floor.
    Raises PlanError where it has inner walls, islands or more than can be planned at once.
    """
    floors = polygons_of(_touching([room_polygon(room) for room in plan.rooms]))
    if len(floors) != 1:
        raise _not_open(f"has {len(floors)} closed rooms", where)
    if floors[0].interiors:
        raise _not_open("has walls inside", where)
    extra = {key: value for room in plan.rooms for key, value in room.extra.items()}
    corners = np.asarray(orient(floors[0]).exterior.simplify(1e-6).coords)[:-1]
    room = Room(plan.rooms[0].id, "unknown", frozen_array(corners), extra=extra)
    if OPEN in room.extra:
        raise PlanError(
            f"has outer walls that are open for {room.extra[OPEN]:.1f} m",
            where=where,
            expected="an open plan: outer walls that close, but for doors and windows",
            try_="drawing what closes them",
        )
    if SURROUNDS in room.extra:
        raise _not_open(f"has walls inside, round {room.extra[SURROUNDS]:g} m²", where)
    area_m2 = room_polygon(room).area
    extent_m, most_m = plan_labels.extent_m(plan), plan_labels.LARGEST_M
    if area_m2 < LEAST_AREA_M2 or extent_m > most_m:
        raise PlanError(
            f"encloses {area_m2:.1f} m², {extent_m:.1f} m across",
            where=where,
            expected=f"at least {LEAST_AREA_M2:g} m² and at most {most_m:.0f} m across",
            try_="<m_per_px>, where the drawing's scale was read wrong",
        )
    openings = tuple(
        replace(
            opening,
            kind="door" if opening.kind == "passage" else opening.kind,
            room_ids=(room.id,),
        )
        for opening in plan.openings
    )
    return Plan((room,), openings, plan.extra)


def _touching(floors: Sequence[Polygon]) -> BaseGeometry:
    """The floors, those that touch as one."""
    joined = unary_union(floors).buffer(ON_LINE_M, join_style="mitre")
    return joined.buffer(-ON_LINE_M, join_style="mitre")


def _not_open(what: str, where: str) -> PlanError:
    return PlanError(
        what,
        where=where,
        expected="an open plan: outer walls that close, nothing inside",
        try_="<generate>, for a plan that has its rooms",
    )


def shell_labels(shell: Plan) -> tuple[ByteArray, PixelFrame]:
    """(H, W) labels of a shell (plan_labels.open_plan), and where they lie."""
    scale = plan_labels.fitting_scale(shell) or plan_labels.SCALES_M[-1]
    frame = plan_labels.label_frame(shell, scale)
    return plan_labels.open_plan(plan_labels.label_plan(shell, frame), scale), frame


def open_shell(plan: Plan) -> Plan:
    """The shell of a house that has rooms: what is left when its inner walls are taken out."""
    floors = unary_union([room_polygon(room) for room in plan.rooms])
    closed = floors.buffer(WALL_THICKNESS_M, join_style="mitre")
    whole = closed.buffer(-WALL_THICKNESS_M, join_style="mitre")
    floor = orient(max(polygons_of(whole), key=lambda part: part.area))
    room = replace(
        plan.rooms[0],
        id="room1",
        kind="unknown",
        polygon_m=frozen_array(np.asarray(floor.exterior.simplify(1e-6).coords)[:-1]),
    )
    outer = tuple(replace(o, room_ids=("room1",)) for o in plan.openings if len(o.room_ids) == 1)
    return Plan((room,), outer)
