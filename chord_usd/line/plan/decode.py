"""Plan raster -> Plan, to within half a pixel of what was drawn.

What a raster cannot show is filled in: heights of openings (see types.BASE_AND_HEIGHT_M), ids,
and where two rooms of one kind touch without a wall, they are one room.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from chord_usd.base.errors import PlanError
from chord_usd.base.raster.vectorize import polygon_from_mask
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    BoolArray,
    ByteArray,
    FloatArray,
    PixelFrame,
    Plan,
    PlanImage,
    Room,
    RoomKind,
    frozen_array,
)
from chord_usd.base.scene.units import m_from_px
from chord_usd.line.plan.ink import Ink, kind_of_shade, label_floors, sort_pixels
from chord_usd.line.plan.openings import Bar, bars_of, read_openings
from chord_usd.line.plan.passages import find_passages
from chord_usd.line.plan.placement import placement
from chord_usd.line.plan.scale import measure_scale
from chord_usd.line.plan.settle import settle

_SMALLEST_ROOM_M2 = 0.2


def decode_plan(image: PlanImage | ByteArray, m_per_px: float | None = None) -> Plan:
    """The vector plan in a plan raster.

    image: with its frame, or RGB (H, W, 3) alone. m_per_px overrides the frame's; without either
    the walls' thickness gives the scale. Without a frame the lower left corner is the origin.
    Raises PlanError where no closed room is found.
    """
    rgb = image.rgb if isinstance(image, PlanImage) else image
    ink = sort_pixels(rgb)
    frame = _frame(image, ink, m_per_px)
    thickness_px = WALL_THICKNESS_M / frame.m_per_px
    bars = [
        *bars_of("door", ink.door, thickness_px),
        *bars_of("window", ink.window, thickness_px),
        *(Bar("passage", mask) for mask in find_passages(ink, thickness_px)),
    ]
    outlines = _room_outlines(ink, bars, frame.m_per_px)
    if not outlines:
        raise PlanError(
            "no closed room was found",
            expected="rooms enclosed by black walls",
            try_="close the gaps between walls, or draw doors in green and windows in blue",
        )
    polygons = settle([outline.polygon_px for outline in outlines], ink.solid, thickness_px)
    rooms = _rooms(outlines, polygons, frame)
    room_ids = [room.id for room in rooms]
    openings = read_openings(bars, polygons, room_ids, thickness_px, frame)
    plan = Plan(rooms, openings, placement(frame))
    return _without_courts(plan) if ink.is_shaded else plan


def _without_courts(plan: Plan) -> Plan:
    """Without white areas of a shaded plan that only windows look onto: those are outside."""
    entered = {i for o in plan.openings if o.kind != "window" for i in o.room_ids}
    looked_onto = {i for o in plan.openings if o.kind == "window" for i in o.room_ids}
    courts = {
        room.id
        for room in plan.rooms
        if room.kind == "unknown" and room.id in looked_onto - entered
    }
    if len(courts) == len(plan.rooms):
        return plan
    openings = tuple(
        replace(opening, room_ids=tuple(i for i in opening.room_ids if i not in courts))
        for opening in plan.openings
    )
    return replace(
        plan,
        rooms=tuple(room for room in plan.rooms if room.id not in courts),
        openings=openings,
    )


def _frame(image: PlanImage | ByteArray, ink: Ink, m_per_px: float | None) -> PixelFrame:
    if isinstance(image, PlanImage):
        if m_per_px is None or m_per_px == image.frame.m_per_px:
            return image.frame
        return PixelFrame(m_per_px, image.frame.origin_m, image.frame.height_px)
    return PixelFrame(m_per_px or measure_scale(ink.solid), (0.0, 0.0), len(image))


@dataclass(frozen=True, eq=False)
class _Outline:
    kind: RoomKind
    polygon_px: FloatArray


def _room_outlines(ink: Ink, bars: list[Bar], m_per_px: float) -> list[_Outline]:
    """The rooms from top to bottom, left to right."""
    closed: BoolArray = np.zeros(ink.wall.shape, bool)
    for bar in bars:
        closed |= bar.mask
    labels = label_floors(ink, closed)
    areas = np.bincount(labels.ravel())
    outlines = []
    for label in np.flatnonzero(areas * m_per_px**2 >= _SMALLEST_ROOM_M2):
        if label > 0:
            mask = labels == label
            shade = int(ink.shade[mask][0])
            outlines.append(_Outline(kind_of_shade(shade), polygon_from_mask(mask)))
    return sorted(outlines, key=lambda outline: tuple(outline.polygon_px.min(axis=0)[::-1]))


def _rooms(
    outlines: list[_Outline], polygons_px: list[FloatArray], frame: PixelFrame
) -> tuple[Room, ...]:
    counts: dict[RoomKind, int] = {}
    rooms = []
    for outline, polygon_px in zip(outlines, polygons_px, strict=True):
        counts[outline.kind] = counts.get(outline.kind, 0) + 1
        name = "room" if outline.kind == "unknown" else outline.kind
        polygon = frozen_array(m_from_px(polygon_px, frame))
        rooms.append(Room(f"{name}{counts[outline.kind]}", outline.kind, polygon))
    return tuple(rooms)
