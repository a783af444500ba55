"""Doors, windows and passages: from the pixels of a bar in a wall to a box between two rooms."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np

from chord_usd.base.raster.vectorize import rotated_box_from_mask
from chord_usd.base.scene.types import (
    BASE_AND_HEIGHT_M,
    BoolArray,
    Box,
    FloatArray,
    Opening,
    OpeningKind,
    PixelFrame,
)
from chord_usd.base.scene.units import m_from_px

if TYPE_CHECKING:
    from chord_usd.line.plan.wall_openings import WallOpening

CONFIDENCE = "confidence"
"""Key of Room.extra and Opening.extra: how sure the reading of a drawing is, [0, 1]."""

GUESSED = "guessed"
"""Key of Opening.extra: it stands there since rooms have to be entered."""

_LEAST_PIXELS = 3

_LEAST_FILL = 0.7
"""A straight bar fills so much of its rotated box; one that turns a corner does not."""

_MOST_SKEW = math.sin(math.radians(15.0))
"""A bar and the wall it lies in differ in direction by less than this."""


def is_guessed(opening: Opening) -> bool:
    """Whether an opening stands there since rooms have to be entered."""
    return GUESSED in opening.extra


@dataclass(frozen=True, eq=False)
class Bar:
    """The pixels of one opening, (H, W)."""

    kind: OpeningKind
    mask: BoolArray
    confidence: float | None = None
    """Of a drawing: how plainly it shows that something opens here, [0, 1]."""


def bars_of(kind: OpeningKind, ink: BoolArray, thickness_px: float) -> Iterator[Bar]:
    """Each straight patch of an opening's colour; stray pixels are passed over."""
    count, labels = cv2.connectedComponents(ink.astype(np.uint8), connectivity=4)
    for label in range(1, count):
        mask = np.asarray(labels == label)
        for part in _straight_parts(mask, thickness_px):
            if part.sum() >= _LEAST_PIXELS:
                yield Bar(kind, part)


def _straight_parts(mask: BoolArray, thickness_px: float) -> list[BoolArray]:
    """The mask; or its two arms where it runs round a corner (a corner window)."""
    box = rotated_box_from_mask(mask)
    if mask.sum() > _LEAST_FILL * box.length_px * box.width_px:
        return [mask]
    arm = round(1.5 * thickness_px) + 1
    flat = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, np.ones((1, arm), np.uint8)) > 0
    rest = mask & ~flat
    return [flat, rest] if flat.any() and rest.any() else [mask]


@dataclass(frozen=True, eq=False)
class _Side:
    """The edge of a room along which an opening lies."""

    room: int
    distance_px: float
    """From the bar's centre to the edge."""
    along: FloatArray
    """Unit direction of the edge."""
    outward: FloatArray
    """Unit normal from the room into the wall."""


def read_openings(
    bars: Sequence[Bar],
    polygons_px: Sequence[FloatArray],
    room_ids: Sequence[str],
    thickness_px: float,
    frame: PixelFrame,
) -> tuple[Opening, ...]:
    """Place each bar in the wall it lies in. polygons_px: the rooms, as from polygon_from_mask."""
    counts = dict.fromkeys(BASE_AND_HEIGHT_M, 0)
    openings = []
    for bar in bars:
        counts[bar.kind] += 1
        name = f"{bar.kind}{counts[bar.kind]}"
        openings.append(_read_opening(name, bar, polygons_px, room_ids, thickness_px, frame))
    return tuple(openings)


def _read_opening(
    name: str,
    bar: Bar,
    polygons_px: Sequence[FloatArray],
    room_ids: Sequence[str],
    thickness_px: float,
    frame: PixelFrame,
) -> Opening:
    box = rotated_box_from_mask(bar.mask)
    center, width_px, length_px = np.array(box.center_px), box.width_px, box.length_px
    direction = math.radians(box.angle_deg)
    along = np.array([math.cos(direction), math.sin(direction)])
    sides = _sides(center, along, polygons_px, thickness_px)
    if sides:
        along = sides[0].along
        center, width_px = _centered_in_wall(center, sides, thickness_px)
        center, length_px = _lengthwise(bar.mask, center, along)
    box_m = _box(bar.kind, center, along, (length_px, width_px), frame)
    joined = _joined([(side.room, side.outward) for side in sides], box_m.yaw_deg, room_ids)
    extra = {} if bar.confidence is None else {CONFIDENCE: bar.confidence}
    return Opening(name, bar.kind, box_m, joined, extra)


def openings_of(
    wall_openings: Sequence[WallOpening], room_ids: Sequence[str], frame: PixelFrame
) -> tuple[Opening, ...]:
    """Openings found along walls, in metres."""
    counts = dict.fromkeys(BASE_AND_HEIGHT_M, 0)
    openings = []
    for opening in wall_openings:
        counts[opening.kind] += 1
        low, high = opening.insets_px
        size_px = opening.length_px - low - high, opening.depth_px
        center_px = opening.center_px + (low - high) / 2 * opening.along
        box = _box(opening.kind, center_px, opening.along, size_px, frame)
        joined = _joined(opening.rooms, box.yaw_deg, room_ids)
        extra = {CONFIDENCE: opening.confidence, **({GUESSED: True} if opening.is_guess else {})}
        openings.append(
            Opening(f"{opening.kind}{counts[opening.kind]}", opening.kind, box, joined, extra)
        )
    return tuple(openings)


def _box(
    kind: OpeningKind,
    center_px: FloatArray,
    along: FloatArray,
    size_px: tuple[float, float],
    frame: PixelFrame,
) -> Box:
    base_m, height_m = BASE_AND_HEIGHT_M[kind]
    x, y = m_from_px(center_px, frame)
    size_m = size_px[0] * frame.m_per_px, size_px[1] * frame.m_per_px, height_m
    return Box((float(x), float(y), base_m), size_m, _yaw_deg(along))


def _sides(
    center: FloatArray, along: FloatArray, polygons_px: Sequence[FloatArray], thickness_px: float
) -> list[_Side]:
    """The nearest edges of rooms on one or both sides of a bar, the nearer one first."""
    nearest: dict[bool, _Side] = {}
    for room, polygon in enumerate(polygons_px):
        edges = np.roll(polygon, -1, axis=0) - polygon
        lengths = np.maximum(np.hypot(edges[:, 0], edges[:, 1]), 1e-9)
        directions = edges / lengths[:, None]
        # Clockwise in numbers: outside lies to the left.
        outward = np.stack([-directions[:, 1], directions[:, 0]], axis=1)
        place = center - polygon
        distance, progress = (place * outward).sum(axis=1), (place * directions).sum(axis=1)
        fits = np.abs(outward @ along) < _MOST_SKEW
        fits &= (distance > -1.0) & (distance < 1.5 * thickness_px + 1.0)
        fits &= (progress > 0.0) & (progress < lengths)
        for edge in np.flatnonzero(fits):
            side = _Side(room, float(distance[edge]), directions[edge], outward[edge])
            faces_along = bool(directions[edge] @ along > 0.0)
            best = nearest.get(faces_along)
            if best is None or side.distance_px < best.distance_px:
                nearest[faces_along] = side
    return sorted(nearest.values(), key=lambda side: side.distance_px)


def _centered_in_wall(
    center: FloatArray, sides: Sequence[_Side], thickness_px: float
) -> tuple[FloatArray, float]:
    """The centre moved across to the middle of the wall, and the wall's thickness."""
    near = sides[0]
    width = sum(side.distance_px for side in sides)
    if len(sides) == 1 or abs(width - thickness_px) < 1.0:
        width = thickness_px
    return center + near.outward * (width / 2 - near.distance_px), width


def _lengthwise(mask: BoolArray, center: FloatArray, along: FloatArray) -> tuple[FloatArray, float]:
    """The centre moved along the wall to the middle of the bar's pixels, and their length."""
    rows, columns = np.nonzero(mask)
    progress = (np.stack([columns, rows], axis=1) + 0.5 - center) @ along
    low, high = float(progress.min()), float(progress.max())
    # The outermost centres of a row of pixels lie half a pixel inside its ends.
    length_px = high - low + float(np.abs(along).max())
    return center + along * (low + high) / 2, length_px


def _yaw_deg(along: FloatArray) -> float:
    """Yaw in [0, 180) of a direction on the canvas, where y points down."""
    yaw_deg = math.degrees(math.atan2(-along[1], along[0])) % 180.0
    nearest = round(yaw_deg / 90.0) * 90.0
    return nearest % 180.0 if abs(yaw_deg - nearest) < 1e-6 else yaw_deg


def _joined(
    sides: Sequence[tuple[int, FloatArray]], yaw_deg: float, room_ids: Sequence[str]
) -> tuple[str, ...]:
    """The rooms on the opening's +y and -y side, in this order.

    sides: index of each room, and its normal into the wall.
    """
    yaw = math.radians(yaw_deg)
    up = np.array([-math.sin(yaw), -math.cos(yaw)])
    ordered = sorted(sides, key=lambda side: float(side[1] @ up))
    return tuple(dict.fromkeys(room_ids[room] for room, _ in ordered))
