"""Shapes of a vector file -> Plan, exactly: rooms end where walls begin, openings lie in walls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from shapely import affinity
from shapely.geometry import LineString, MultiPolygon, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.drawn_pieces import DRAWN, to_entry
from chord_usd.base.scene.geometry import polygons_of, room_polygon, rooms_beside
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.types import (
    BASE_AND_HEIGHT_M,
    WALL_THICKNESS_M,
    Box,
    FloatArray,
    Item,
    Opening,
    PixelFrame,
    Plan,
    Room,
    frozen_array,
)
from chord_usd.line.plan.floor_parts import part_open_plans
from chord_usd.line.plan.labels import named_by_texts, numbered, uses_named
from chord_usd.line.plan.paper_scale import stated_ratio
from chord_usd.line.plan.placement import WARNINGS
from chord_usd.line.plan.printed import STATED, Estimate, estimates
from chord_usd.line.plan.scale_choice import SCALE, Scale, choose_scale
from chord_usd.line.plan.text import Text
from chord_usd.line.plan.vector.shapes import (
    Label,
    OpeningShape,
    PieceShape,
    RoomShape,
    VectorDrawing,
)

_SMALLEST_ROOM_M2 = 0.8
_NARROWEST_ROOM_M = 0.5
_DRAWN_EXACTLY = 0.999
_SMALLEST_DRAWN_M2, _NARROWEST_DRAWN_M = 0.4, 0.01
"""A room that its file draws, and that walls take no more than a thousandth of, is as it is."""

_USUAL_DOOR_M = 0.8
_SMALLEST_HOME_M2 = 4.0
_LEAST_COVERED = 0.2
"""Share of what the walls surround that must be rooms; a plot has walls, too."""

_CORNER_M = 0.005
"""Corners closer to a straight line than this are none."""

_BEYOND_M = 0.03
"""Beside the jamb, far enough for a frame that is drawn over the wall."""

_FARTHEST_FACE_M = 0.6
"""No wall's face lies farther from the middle of an opening in it."""

_BRIDGE = 0.2
"""An opening reaches across its wall by so many of its lengths when a gap has to be closed."""


_AS_DRAWN = PixelFrame(1.0, (0.0, 0.0), 0)
"""Labels are points; a frame of one metre per pixel leaves them where they are."""


def assemble(drawing: VectorDrawing, where: str, m_per_unit: float | None = None) -> Plan:
    """The plan of one storey. where: the file, for messages. m_per_unit overrides the file's.

    Raises PlanError where no room is found.
    """
    scale = _scale(drawing, where, m_per_unit)
    scaled = _in_metres(drawing, scale.m_per_px)
    rooms = _rooms(scaled)
    if not rooms:
        raise PlanError(
            "holds no room: its walls close round nothing",
            where=where,
            expected="rooms, or walls that meet at their corners",
        )
    _refuse_niches(rooms, scaled.walls, where)
    openings = _openings(scaled, rooms)
    warnings = [*drawing.notes, *scale.warnings()]
    extra: dict[str, Any] = {SCALE: scale.report(), **({WARNINGS: warnings} if warnings else {})}
    extra |= {DRAWN: to_entry(_items(scaled.pieces))} if scaled.pieces else {}
    plan = Plan(rooms, openings, extra)
    return _parted(plan, () if drawing.rooms else scaled.labels)


def _items(pieces: Sequence[PieceShape]) -> list[Item]:
    """Pieces in metres, as high as their categories are."""
    items = []
    for piece in pieces:
        row = category(piece.category)
        size_m = (piece.length, piece.depth, sum(row.height_m) / 2)
        x, y = piece.center.tolist()
        items.append(Item("", row.name, Box((x, y, 0.0), size_m, piece.yaw_deg)))
    return items


def _parted(plan: Plan, labels: Sequence[Label]) -> Plan:
    """The plan with rooms parted that have several names: labels, where walls alone make rooms."""
    texts = _as_texts(labels, -1.0)
    uses = {room.id: uses_named(room, texts, _AS_DRAWN) for room in plan.rooms}
    return part_open_plans(plan, uses)


def _refuse_niches(rooms: Sequence[Room], walls: Sequence[Polygon], where: str) -> None:
    """Raises PlanError where what was read are no rooms, but what is left between walls."""
    floor_m2 = sum(room_polygon(room).area for room in rooms)
    around_m2 = unary_union(walls).convex_hull.area if walls else 0.0
    if floor_m2 >= max(_SMALLEST_HOME_M2, _LEAST_COVERED * around_m2):
        return
    closed = "one closed room" if len(rooms) == 1 else f"{len(rooms)} closed rooms"
    problem = f"holds {closed} of {floor_m2:.3g} m²"
    if around_m2 > _SMALLEST_HOME_M2:
        problem += f" within {around_m2:.3g} m² of walls"
    raise PlanError(
        f"{problem}: niches, no dwelling", where=where,
        expected=f"rooms of {_SMALLEST_HOME_M2:g} m² or more, whose walls close round them",
        try_=("drawing the missing walls or rooms", "<m_per_px> if it is larger"),
    )  # fmt: skip


def _scale(drawing: VectorDrawing, where: str, given: float | None) -> Scale:
    if given or drawing.m_per_unit:
        return Scale(given or drawing.m_per_unit or 1.0, "given" if given else "file")
    lengths = [
        float(np.hypot(*(o.stop - o.start))) for o in drawing.openings if o.kind == "door"
    ]  # fmt: skip
    doors = _USUAL_DOOR_M / float(np.percentile(lengths, 25)) if len(lengths) >= 2 else None
    polygons = [np.array(room.polygon.exterior.coords[:-1]) for room in drawing.rooms]
    printed = estimates(_as_texts(drawing.labels, 1.0), polygons)
    walls = [_thickness(wall) for wall in drawing.walls]
    thickness = float(np.median(walls)) if walls else 0.0
    if not printed and doors is None and thickness <= 0.0:
        raise PlanError(
            "does not say how large it is", where=where, expected="units, doors or walls",
            try_="<m_per_px>",
        )  # fmt: skip
    paper = drawing.paper_m_per_unit
    if paper and (ratio := stated_ratio(label.text for label in drawing.labels)):
        printed.append(Estimate(STATED, ratio * paper, f"1:{ratio}"))
    usual = WALL_THICKNESS_M / thickness if thickness else doors or 1.0
    return choose_scale(printed, doors, usual, paper=paper)


def _thickness(wall: Polygon) -> float:
    """Of a long thin polygon."""
    half = wall.length / 4
    return float(half - math.sqrt(max(half**2 - wall.area, 0.0)))


def _in_metres(drawing: VectorDrawing, m_per_unit: float) -> VectorDrawing:
    def sized(polygon: Polygon) -> Polygon:
        return affinity.scale(polygon, m_per_unit, m_per_unit, origin=(0, 0))

    def length(value: float | None) -> float | None:
        return None if value is None else value * m_per_unit

    return replace(
        drawing,
        rooms=[replace(room, polygon=sized(room.polygon)) for room in drawing.rooms],
        walls=[sized(wall) for wall in drawing.walls],
        openings=[
            replace(
                o, start=o.start * m_per_unit, stop=o.stop * m_per_unit, depth=length(o.depth),
                base=length(o.base), height=length(o.height),
            )
            for o in drawing.openings
        ],
        labels=[replace(label, point=label.point * m_per_unit) for label in drawing.labels],
        pieces=[
            replace(
                p, center=p.center * m_per_unit, length=p.length * m_per_unit,
                depth=p.depth * m_per_unit,
            )
            for p in drawing.pieces
        ],
        m_per_unit=1.0,
    )  # fmt: skip


# Rooms -------------------------------------------------------------------------------------------


def _rooms(drawing: VectorDrawing) -> tuple[Room, ...]:
    walls = unary_union([wall.buffer(0) for wall in drawing.walls])
    shapes = list(drawing.rooms) or [RoomShape(hole) for hole in _holes(walls, drawing.openings)]
    rooms, taken = [], Polygon()
    for shape in sorted(shapes, key=lambda shape: shape.polygon.area):
        # Some draughtsmen draw the flat round its rooms; what is left between these is wall.
        free = shape.polygon.buffer(0).difference(walls).difference(taken)
        is_exact = bool(drawing.rooms) and free.area > _DRAWN_EXACTLY * shape.polygon.area
        floor = _tidy(free, is_exact)
        if floor is not None:
            rooms.append((shape.name, floor))
            taken = taken.union(floor.buffer(1e-6, join_style="mitre"))
    rooms.sort(key=lambda row: (-round(row[1].bounds[3], 2), row[1].bounds[0]))
    plain = [_room(name, floor) for name, floor in rooms]
    return numbered(named_by_texts(plain, _as_texts(drawing.labels, -1.0), _AS_DRAWN))


def _holes(walls: BaseGeometry, openings: Sequence[OpeningShape]) -> list[Polygon]:
    """What the walls enclose once all openings are closed."""
    closed = unary_union([walls, *(_across(opening, walls) for opening in openings)])
    # A hair's breadth between walls that should touch is no gap.
    closed = closed.buffer(0.01, join_style="mitre").buffer(-0.01, join_style="mitre")
    rings = [ring for part in polygons_of(closed) for ring in part.interiors]
    return [Polygon(ring) for ring in rings]


def _across(opening: OpeningShape, walls: BaseGeometry) -> Polygon:
    """The opening as deep as the wall at its jambs."""
    along = opening.stop - opening.start
    length = float(np.hypot(*along))
    along = along / max(length, 1e-9)
    across = np.array([-along[1], along[0]])
    depth = opening.depth or max(WALL_THICKNESS_M, _BRIDGE * length)
    spans = [
        span
        for jamb in (opening.start - _BEYOND_M * along, opening.stop + _BEYOND_M * along)
        if (span := _wall_span(jamb, across, walls)) is not None
    ]
    low = min((span[0] for span in spans), default=-depth / 2)
    high = max((span[1] for span in spans), default=depth / 2)
    start, stop = opening.start, opening.stop
    low_side, high_side = low * across, high * across
    return Polygon([start + low_side, stop + low_side, stop + high_side, start + high_side])


def _wall_span(
    jamb: FloatArray, across: FloatArray, walls: BaseGeometry
) -> tuple[float, float] | None:
    """Where the wall beside a jamb begins and ends, from the jamb; None where it runs on."""
    ray = LineString([jamb - _FARTHEST_FACE_M * across, jamb + _FARTHEST_FACE_M * across])
    cut = walls.intersection(ray)
    parts = [part for part in getattr(cut, "geoms", [cut]) if part.length > 0.02]
    if not parts:
        return None
    near = min(parts, key=lambda part: part.distance(Point(*jamb)))
    offsets = (np.array(near.coords) - jamb) @ across
    is_lengthwise = near.length > 0.9 * _FARTHEST_FACE_M
    return None if is_lengthwise else (float(offsets.min()), float(offsets.max()))


def _tidy(area: BaseGeometry, is_exact: bool) -> Polygon | None:
    """The largest part of what is left of a room; None where that is too small to be one."""
    half = (_NARROWEST_DRAWN_M if is_exact else _NARROWEST_ROOM_M) / 2
    least_m2 = _SMALLEST_DRAWN_M2 if is_exact else _SMALLEST_ROOM_M2
    core = area.buffer(-half, join_style="mitre").buffer(half, join_style="mitre")
    # Slivers between a room drawn by hand and its walls go; true corners stay as they are.
    kept = area.intersection(core.buffer(1e-3, join_style="mitre"))
    parts = polygons_of(kept if not kept.is_empty else MultiPolygon())
    if not parts:
        return None
    floor = max(parts, key=lambda part: part.area)
    floor = Polygon(floor.exterior).simplify(_CORNER_M)
    return orient(floor) if floor.is_valid and floor.area >= least_m2 else None


def _room(name: str, floor: Polygon) -> Room:
    # Ids and, from labels, kinds of nameless rooms are given by labels.numbered.
    return Room("", room_kind(name), frozen_array(floor.exterior.coords[:-1]), name)


def _as_texts(labels: Sequence[Label], y_sign: float) -> list[Text]:
    return [Text(label.text, np.tile(label.point * (1.0, y_sign), (4, 1)), 1.0) for label in labels]


# Openings ----------------------------------------------------------------------------------------


def _openings(drawing: VectorDrawing, rooms: Sequence[Room]) -> tuple[Opening, ...]:
    floors = [room_polygon(room) for room in rooms]
    counts: dict[str, int] = {}
    openings = []
    for shape in drawing.openings:
        box = _box(shape, floors)
        joined = rooms_beside(box, rooms)
        if joined:
            counts[shape.kind] = counts.get(shape.kind, 0) + 1
            openings.append(Opening(f"{shape.kind}{counts[shape.kind]}", shape.kind, box, joined))
    return tuple(openings)


def _box(shape: OpeningShape, floors: Sequence[Polygon]) -> Box:
    """The hole: where rooms lie on one or both sides, exactly as deep as the wall between them."""
    along = shape.stop - shape.start
    length = float(np.hypot(*along))
    along = along / max(length, 1e-9)
    center, across = (shape.start + shape.stop) / 2, np.array([-along[1], along[0]])
    faces = [_face(center, side * across, floors) for side in (1.0, -1.0)]
    depth = shape.depth or WALL_THICKNESS_M
    if faces[0] is not None and faces[1] is not None:
        depth = faces[0] + faces[1]
        center = center + across * (faces[0] - faces[1]) / 2
    elif faces[0] is not None or faces[1] is not None:
        # From the room's face outwards.
        side, near = (1.0, faces[0]) if faces[0] is not None else (-1.0, faces[1])
        center = center + side * across * ((near or 0.0) - depth / 2)
    base_m, height_m = BASE_AND_HEIGHT_M[shape.kind]
    base_m = base_m if shape.base is None else shape.base
    height_m = height_m if shape.height is None else shape.height
    yaw_deg = round(math.degrees(math.atan2(along[1], along[0])) % 180.0, 6) % 180.0
    return Box((float(center[0]), float(center[1]), base_m), (length, depth, height_m), yaw_deg)


def _face(center: FloatArray, way: FloatArray, floors: Sequence[Polygon]) -> float | None:
    """Distance from a point in a wall to the room on this side of it; negative inside the room."""
    ray = LineString([center - 0.15 * way, center + _FARTHEST_FACE_M * way])
    start = Point(center - 0.15 * way)
    hits = [
        start.distance(cut) - 0.15
        for floor in floors
        if not (cut := floor.intersection(ray)).is_empty and cut.length > 0.05
        and not floor.contains(start)
    ]  # fmt: skip
    return min(hits, default=None)
