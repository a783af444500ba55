"""A plan drawn in a style, and the plan that a perfect reader would find in the drawing."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np
import shapely
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    front_direction,
    polygons_of,
    room_polygon,
    room_sides,
    rooms_beside,
    wall_area,
)
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    ByteArray,
    FloatArray,
    Opening,
    PixelFrame,
    Plan,
    Room,
    RoomKind,
    frozen_array,
)
from chord_usd.base.scene.units import px_from_m
from chord_usd.workshop.data.drawn.fixtures import SYMBOLS
from chord_usd.workshop.data.drawn.inscriptions import draw_dimensions, middle_of, write_names
from chord_usd.workshop.data.drawn.page_styles import RGB, Style
from chord_usd.workshop.data.drawn.paper import soil

_MARGIN_M = 2.0

_DOUBLE_DOOR_M = 1.3
"""Wider doors have two leaves."""

_LEADING: tuple[RoomKind, ...] = (
    "living", "bedroom", "kitchen", "bathroom", "dining", "study", "balcony", "store", "corridor",
)  # fmt: skip

_FLOOR_RGB: dict[RoomKind, RGB] = {
    "living": (250, 235, 200), "dining": (250, 225, 190), "bedroom": (215, 230, 245),
    "kitchen": (245, 215, 205), "bathroom": (205, 235, 240), "balcony": (220, 240, 210),
    "corridor": (240, 240, 225), "study": (230, 220, 245), "store": (230, 230, 230),
    "unknown": (255, 255, 255),
}  # fmt: skip
_TINT: RGB = (240, 236, 226)


@dataclass(frozen=True, eq=False)
class Drawing:
    """A drawn plan and its truth."""

    rgb: ByteArray
    """(H, W, 3)."""
    truth: Plan
    """Metres; rooms that run into each other are one."""
    frame: PixelFrame
    """Where the upright drawing lies."""
    style: Style
    to_picture: FloatArray
    """(3, 3) from the upright drawing's continuous pixels to pixels of rgb."""
    recognisable: frozenset[str]
    """Rooms of the truth whose kind is shown, by a name or by a symbol."""


def draw_in_style(plan: Plan, style: Style, rng: np.random.Generator) -> Drawing:
    """Draw a plan."""
    truth = _as_drawn(without_seams(plan), style)
    frame = _frame(truth, style.m_per_px)
    corners = np.concatenate([room.polygon_m for room in truth.rooms])
    width = math.ceil((np.ptp(corners[:, 0]) + 2 * _MARGIN_M) / style.m_per_px)
    canvas = np.full((frame.height_px, width, 3), style.paper_rgb, np.uint8)
    _fill_floors(canvas, plan, frame, style)
    if style.has_furniture:
        _draw_furniture(canvas, truth, frame, style, rng)
    recognisable = _draw_symbols(canvas, truth, frame, style, rng) if style.has_symbols else set()
    _draw_walls(canvas, truth, frame, style)
    for opening in truth.openings:
        _draw_opening(canvas, opening, frame, style)
    recognisable |= write_names(canvas, truth, frame, style)
    if style.has_dimensions:
        draw_dimensions(canvas, truth, frame, style)
    if style.has_frame:
        inset = 6
        far = canvas.shape[1] - inset, canvas.shape[0] - inset
        cv2.rectangle(canvas, (inset, inset), far, style.line_rgb, 2)
    rgb, to_picture = soil(canvas, style, rng)
    return Drawing(rgb, truth, frame, style, to_picture, frozenset(recognisable))


def without_seams(plan: Plan) -> Plan:
    """The plan as one who sees no colours would read it: touching rooms are one."""
    floors = polygons_of(shapely.union_all([room_polygon(r).buffer(1e-4) for r in plan.rooms]))
    rooms = []
    for index, floor in enumerate(floors):
        parts = [r for r in plan.rooms if floor.contains(room_polygon(r).representative_point())]
        kinds = {room.kind for room in parts}
        kind: RoomKind = next((leading for leading in _LEADING if leading in kinds), "unknown")
        outline = floor if len(parts) > 1 else room_polygon(parts[0])
        outline = orient(Polygon(outline.exterior).simplify(1e-3))
        corners = frozen_array(outline.exterior.coords[:-1])
        rooms.append(Room(f"room{index + 1}", kind, corners))
    openings = tuple(
        Opening(o.id, o.kind, o.box, rooms_beside(o.box, rooms)) for o in plan.openings
    )
    return Plan(tuple(rooms), openings)


def _as_drawn(plan: Plan, style: Style) -> Plan:
    """Doors within the house that are drawn as gaps are passages: they look the same."""
    if style.door != "gap":
        return plan
    openings = (
        replace(o, kind="passage")
        if o.kind == "door" and len(o.room_ids) == 2 and not _is_double(o)
        else o
        for o in plan.openings
    )
    return replace(plan, openings=tuple(openings))


def _frame(plan: Plan, m_per_px: float) -> PixelFrame:
    corners = np.concatenate([room.polygon_m for room in plan.rooms])
    low, high = corners.min(axis=0) - _MARGIN_M, corners.max(axis=0) + _MARGIN_M
    height = math.ceil((high[1] - low[1]) / m_per_px)
    return PixelFrame(m_per_px, (float(low[0]), float(low[1])), height)


def _fill_floors(canvas: ByteArray, plan: Plan, frame: PixelFrame, style: Style) -> None:
    if style.floors == "white":
        return
    for room in plan.rooms:
        rgb = _FLOOR_RGB[room.kind] if style.floors == "coloured" else _TINT
        floor = room_polygon(room).buffer(WALL_THICKNESS_M / 2, join_style="mitre")
        _fill(canvas, floor, frame, rgb)


def _fill(canvas: ByteArray, area: BaseGeometry, frame: PixelFrame, rgb: RGB) -> None:
    """Paint an area; the holes in it stay as they are."""
    mask = np.zeros(canvas.shape[:2], np.uint8)
    for part in polygons_of(area):
        rings = [part.exterior, *part.interiors]
        pixels = [np.rint(px_from_m(np.array(r.coords), frame) - 0.5) for r in rings]
        cv2.fillPoly(mask, [points.astype(np.int32) for points in pixels], (1.0,))
    canvas[mask > 0] = rgb


# Walls -------------------------------------------------------------------------------------------


def _draw_walls(canvas: ByteArray, plan: Plan, frame: PixelFrame, style: Style) -> None:
    holes = shapely.union_all([footprint_polygon(o.box).buffer(1e-6) for o in plan.openings])
    whole = wall_area(plan.rooms)
    slimmer = (WALL_THICKNESS_M - style.wall_m) / 2
    walls = whole.buffer(-slimmer, join_style="mitre")
    # Openings are as deep as the walls, whatever these were made.
    deep = shapely.union_all([_deepened(o, style.wall_m).buffer(1e-6) for o in plan.openings])
    walls = walls.difference(deep if slimmer < 0 else holes)
    if style.wall == "line":
        _draw_middle_lines(canvas, whole, holes, frame, style)
        return
    if style.wall == "solid":
        _fill(canvas, walls, frame, style.wall_rgb)
        return
    _fill(canvas, walls, frame, style.body_rgb or style.paper_rgb)
    if style.wall in ("hatched", "crossed"):
        mask = np.zeros((*canvas.shape[:2], 3), np.uint8)
        _fill(mask, walls, frame, (1, 1, 1))
        rows, columns = np.indices(canvas.shape[:2])
        step = max(5, round(0.07 / frame.m_per_px))
        is_hatch = (rows + columns) % step < 1
        if style.wall == "crossed":
            is_hatch |= (rows - columns) % step < 1
        canvas[(mask[..., 0] > 0) & is_hatch] = style.wall_rgb
    for part in polygons_of(walls):
        for ring in (part.exterior, *part.interiors):
            _line(canvas, np.array(ring.coords), frame, style.wall_rgb, style.line_px)


def _deepened(opening: Opening, depth_m: float) -> Polygon:
    corners = footprint(opening.box)
    across = -front_direction(opening.box.yaw_deg)
    half = across * (max(depth_m, opening.box.size_m[1]) - opening.box.size_m[1]) / 2
    return Polygon(corners + np.array([half, -half, -half, half]))


def _draw_middle_lines(
    canvas: ByteArray, walls: BaseGeometry, holes: BaseGeometry, frame: PixelFrame, style: Style
) -> None:
    """Walls as single strokes, as in a sketch."""
    width = max(style.line_px * frame.m_per_px, 0.03)
    core = walls.buffer(-(WALL_THICKNESS_M - width) / 2, join_style="mitre")
    _fill(canvas, core.difference(holes), frame, style.wall_rgb)


def _line(
    canvas: ByteArray, points: FloatArray, frame: PixelFrame, rgb: RGB, width_px: int = 1
) -> None:
    pixels = np.rint(px_from_m(points, frame) - 0.5).astype(np.int32)
    cv2.polylines(canvas, [pixels], False, rgb, width_px, cv2.LINE_AA)


# Openings ----------------------------------------------------------------------------------------


def _draw_opening(canvas: ByteArray, opening: Opening, frame: PixelFrame, style: Style) -> None:
    corners = footprint(opening.box)
    inner = min(1.0, style.wall_m / WALL_THICKNESS_M) if style.wall != "line" else 0.6
    middle = corners.mean(axis=0)
    across = -front_direction(opening.box.yaw_deg)
    offsets = (corners - middle) @ across
    corners = corners - np.outer(offsets * (1 - inner), across)
    rgb, width = style.line_rgb, 1 if style.wall == "line" else style.line_px
    if opening.kind == "window":
        if style.window == "filled":
            _fill(canvas, Polygon(corners), frame, style.window_rgb)
        _line(canvas, corners[[0, 1, 2, 3, 0]], frame, rgb, width)
        ends = (corners[0] + corners[1]) / 2, (corners[2] + corners[3]) / 2
        # A window that is no more than a hollow piece of wall would look like one.
        if style.window == "panes" or (style.wall == "hollow" and style.window == "double"):
            _line(canvas, np.array(ends), frame, rgb, width)
    elif opening.kind == "door" and style.door == "filled":
        _fill(canvas, Polygon(corners), frame, style.door_rgb)
        _line(canvas, corners[[0, 1, 2, 3, 0]], frame, rgb, width)
    elif opening.kind == "door" and style.door == "gap" and _is_double(opening):
        _draw_sliding(canvas, corners, frame, style)
    elif opening.kind == "door" and style.door != "gap":
        hinge, jamb = corners[0], corners[3]
        if not _is_double(opening):
            _draw_leaf(canvas, hinge, jamb - hinge, across, frame, style)
        else:
            half = (jamb - hinge) / 2
            _draw_leaf(canvas, hinge, half, across, frame, style)
            _draw_leaf(canvas, jamb, -half, across, frame, style)


def _is_double(opening: Opening) -> bool:
    return opening.box.size_m[0] >= _DOUBLE_DOOR_M


def _draw_sliding(canvas: ByteArray, corners: FloatArray, frame: PixelFrame, style: Style) -> None:
    """Two panels, one behind the other."""
    for share, first, last in ((0.35, 0.0, 0.55), (0.65, 0.45, 1.0)):
        start = corners[0] + share * (corners[1] - corners[0])
        stop = corners[3] + share * (corners[2] - corners[3])
        ends = start + np.array([[first], [last]]) * (stop - start)
        _line(canvas, ends, frame, style.line_rgb, style.line_px)


def _draw_leaf(
    canvas: ByteArray, hinge: FloatArray, reach: FloatArray, across: FloatArray,
    frame: PixelFrame, style: Style,
) -> None:  # fmt: skip
    """An open leaf, and the arc along which it opens."""
    length = float(np.hypot(*reach))
    width = 1 if style.wall == "line" else style.line_px
    angles = np.radians(np.arange(0, 91, 3))[:, None]
    swing = hinge + np.cos(angles) * reach + length * np.sin(angles) * across
    if style.door == "arc":
        _line(canvas, swing, frame, style.line_rgb, width)
    _line(canvas, np.array([hinge, swing[-1]]), frame, style.line_rgb, width)


# Furniture ---------------------------------------------------------------------------------------

_SYMBOLS: dict[RoomKind, tuple[tuple[float, float], ...]] = {
    "living": ((2.0, 0.9), (1.1, 0.6)), "dining": ((1.6, 0.9),),
    "bedroom": ((1.6, 2.0), (1.8, 0.6)), "kitchen": ((2.2, 0.6),),
    "bathroom": ((1.6, 0.7), (0.4, 0.6)), "balcony": ((0.6, 0.6),),
    "corridor": (), "study": ((1.4, 0.7),), "store": ((1.0, 0.4),), "unknown": (),
}  # fmt: skip


def _draw_furniture(
    canvas: ByteArray, plan: Plan, frame: PixelFrame, style: Style, rng: np.random.Generator
) -> None:
    """Outlines of pieces in the corners of rooms, clear of doors, names and one another."""
    for room, taken in _rooms_and_taken(plan, style):
        low, high = room.polygon_m.min(axis=0), room.polygon_m.max(axis=0)
        for index, (length, width) in enumerate(_SYMBOLS[room.kind]):
            size = np.array([length, width] if rng.random() < 0.5 else [width, length])
            spot = np.where(rng.random(2) < 0.5, low + 0.08, high - size - 0.08)
            piece = shapely.box(*spot, *(spot + size))
            if not room_polygon(room).contains(piece) or any(piece.intersects(t) for t in taken):
                continue
            taken.append(piece)
            _line(canvas, np.array(piece.exterior.coords), frame, style.line_rgb, 1)
            if index == 0:
                inner = piece.buffer(-0.12, join_style="mitre")
                _line(canvas, np.array(inner.exterior.coords), frame, style.line_rgb, 1)
            else:
                round_ = piece.centroid.buffer(0.3 * float(size.min()))
                _line(canvas, np.array(round_.exterior.coords), frame, style.line_rgb, 1)


_BACK_M = 0.02
"""Between a fixture and the wall behind it."""


def _draw_symbols(
    canvas: ByteArray, plan: Plan, frame: PixelFrame, style: Style, rng: np.random.Generator
) -> set[str]:
    """Fixtures with their backs to walls, clear of doors, sizes and one another.

    Returns the rooms in which there was place for any.
    """
    fitted = set()
    for room, taken in _rooms_and_taken(plan, style):
        floor = room_polygon(room).buffer(1e-6)
        edges = room_sides(room)
        for symbol in SYMBOLS.get(room.kind, ()):
            for index in rng.permutation(len(edges)):
                start, stop = edges[index]
                along = (stop - start) / np.hypot(*(stop - start))
                # Counter-clockwise: the room lies to the left.
                turn = np.stack([along, [-along[1], along[0]]], axis=1)
                shift = rng.uniform(0.05, max(0.1, np.hypot(*(stop - start)) - symbol.size_m[0]))
                place = start + turn @ np.array([shift, _BACK_M])
                piece = Polygon(
                    np.array(shapely.box(0, 0, *symbol.size_m).exterior.coords) @ turn.T + place
                )
                if not floor.contains(piece) or any(piece.intersects(t) for t in taken):
                    continue
                taken.append(piece)
                fitted.add(room.id)
                for line in symbol.lines(turn, place):
                    _line(canvas, line, frame, style.line_rgb, 1)
                break
    return fitted


def _rooms_and_taken(plan: Plan, style: Style) -> Iterator[tuple[Room, list[Polygon]]]:
    """Each room, and where nothing may stand: before doors, on names, and what is added to it."""
    taken = [_swept(opening) for opening in plan.openings if opening.kind != "window"]
    for room in plan.rooms:
        taken.append(Point(middle_of(room)).buffer(2 * style.letters_m))
        yield room, taken


def _swept(opening: Opening) -> Polygon:
    """Where people and leaves pass."""
    length = opening.box.size_m[0] / (2 if _is_double(opening) else 1)
    return footprint_polygon(opening.box).buffer(length, cap_style="square", join_style="mitre")
