"""Bubble diagrams: an architect's first sketch of a house, a disc for each room.

A sheet that floors are planned on shows one as discs in the rooms' shades (palette.ROOM_SHADES):
what rooms there are, and about where and how large, is decided before a wall is drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import shapely
from shapely.geometry import Polygon

from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.palette import BACKGROUND_RGB, ROOM_SHADES
from chord_usd.base.scene.types import ByteArray, Plan, PlanImage, Room, RoomKind, learned_kind
from chord_usd.base.scene.units import px_from_m

LEAST_RADIUS_M = 0.25
"""Smaller discs would look like dirt."""

_RADIUS_SHARE = 0.35
"""Of the root of a room's area."""
_CLEAR_SHARE = 0.9
"""Of the way from a disc's centre to the nearest wall."""
_IN_THE_MIDDLE = 0.8
"""A centroid is a room's middle if this share of the largest inscribed circle fits around it."""
_SUBPIXEL_BITS = 4


@dataclass(frozen=True)
class Bubble:
    """One room of a diagram; metres, in the plan's frame."""

    kind: RoomKind
    x_m: float
    y_m: float
    radius_m: float


def bubbles_of(plan: Plan) -> tuple[Bubble, ...]:
    """The diagram of a plan; rooms of unknown kind have no bubble."""
    return tuple(_bubble(room) for room in plan.rooms if room.kind != "unknown")


def jittered(bubbles: Sequence[Bubble], rng: np.random.Generator) -> tuple[Bubble, ...]:
    """The diagram as another hand would sketch it: somewhat off, and of other sizes."""
    return tuple(_sketched(bubble, rng) for bubble in bubbles)


def _sketched(bubble: Bubble, rng: np.random.Generator) -> Bubble:
    # Off by less than the radius, so that the middle stays in its room.
    dx_m, dy_m = rng.uniform(-0.35, 0.35, 2) * bubble.radius_m
    radius_m = max(LEAST_RADIUS_M, bubble.radius_m * float(rng.uniform(0.7, 1.05)))
    return Bubble(bubble.kind, bubble.x_m + float(dx_m), bubble.y_m + float(dy_m), radius_m)


def stretched(
    bubbles: Sequence[Bubble], origin_m: tuple[float, float], factor: float
) -> tuple[Bubble, ...]:
    """The diagram so many times as large, a point of the plane staying where it is."""
    x_m, y_m = origin_m
    return tuple(
        Bubble(
            bubble.kind,
            x_m + (bubble.x_m - x_m) * factor,
            y_m + (bubble.y_m - y_m) * factor,
            bubble.radius_m * factor,
        )
        for bubble in bubbles
    )


def touching_pairs(bubbles: Sequence[Bubble]) -> int:
    """How many pairs touch or overlap, as rooms of a house never do."""
    return sum(
        bool(np.hypot(bubble.x_m - two.x_m, bubble.y_m - two.y_m) <= bubble.radius_m + two.radius_m)
        for index, bubble in enumerate(bubbles)
        for two in bubbles[:index]
    )


def with_bubbles(sheet: PlanImage, bubbles: Sequence[Bubble]) -> PlanImage:
    """The sheet with the diagram drawn on its white, small bubbles over large ones."""
    rgb: ByteArray = sheet.rgb.copy()
    drawn = (rgb != BACKGROUND_RGB[0]).any(axis=2)
    unit = 1 << _SUBPIXEL_BITS
    for bubble in sorted(bubbles, key=lambda disc: -disc.radius_m):
        centre = px_from_m(np.array([[bubble.x_m, bubble.y_m]]), sheet.frame)[0]
        # A pixel's middle lies half a pixel from its edge.
        column, row = (round(float(value - 0.5) * unit) for value in centre)
        radius = round(bubble.radius_m / sheet.frame.m_per_px * unit)
        shade = ROOM_SHADES[bubble.kind]
        cv2.circle(rgb, (column, row), radius, shade, cv2.FILLED, shift=_SUBPIXEL_BITS)
    rgb[drawn] = sheet.rgb[drawn]
    return PlanImage(rgb, sheet.frame)


def _bubble(room: Room) -> Bubble:
    floor = room_polygon(room)
    x_m, y_m, clear_m = _middle(floor)
    radius_m = min(_RADIUS_SHARE * floor.area**0.5, _CLEAR_SHARE * clear_m)
    return Bubble(learned_kind(room.kind), x_m, y_m, max(radius_m, LEAST_RADIUS_M))


def _middle(floor: Polygon) -> tuple[float, float, float]:
    """A point well inside a room, and how far it is from the walls."""
    centroid, edge = floor.centroid, floor.exterior
    if floor.contains(centroid):
        clear_m = edge.distance(centroid)
        if floor.area > 0.99 * floor.envelope.area:  # a rectangle: nowhere is more in the middle
            return centroid.x, centroid.y, clear_m
    else:
        clear_m = 0.0
    circle = shapely.maximum_inscribed_circle(floor, tolerance=0.05)
    if clear_m >= _IN_THE_MIDDLE * circle.length:
        return centroid.x, centroid.y, clear_m
    x_m, y_m = circle.coords[0]
    return x_m, y_m, circle.length
