"""What a room is for by what is fitted in it: hobs, WCs, basins, baths, showers and beds.

A symbol is known by the paper that its lines enclose: a hob by four equal rounds in a square, a WC
or a basin by an oval, a shower by the four triangles between its diagonals, a bath by a tub with
round corners in a box, a bed by pillows at the head of a blanket.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import cv2
import numpy as np

from chord_usd.types import BoolArray, FloatArray, RoomKind

_LEAST_M2, _MOST_M2 = 0.006, 3.4
"""What a line encloses; smaller are the holes of letters, larger is floor."""

_PRINTED = 0.8
"""What lies in a line of text by so much of its area is part of a letter."""

_ROUND_FILL, _BOX_FILL, _TRIANGLE_FILL = (0.68, 0.87), 0.86, (0.42, 0.6)
"""Shares of the least rectangle round it that an ellipse, a box and a triangle fill."""

_RING_M, _RING_RATIO, _RING_FILL = (0.1, 0.3), 1.35, (0.68, 0.95)
"""A ring of few pixels is squarer than a round."""

_RINGS_APART_M = (0.14, 0.45)
_OVAL_M, _OVAL_RATIO = ((0.36, 0.64), (0.24, 0.48)), (1.12, 1.8)
_SHOWER_M = (0.65, 1.15)

_BATH_M = (1.35, 1.95), (0.58, 0.9)
_RIM_M = 0.2
_BLANKET_M = (0.95, 1.75), (0.7, 2.15)
_PILLOW_M = (0.4, 0.85), (0.22, 0.6)
_BED_M = (1.7, 2.3)
"""From the foot of the blanket to beyond the pillows."""

_ALIKE = 1.35
"""Areas of parts that are drawn alike differ by no more than this factor."""

_LIVING_KITCHEN_M2 = 22.0
"""A larger room with a hob is an open living room."""


@dataclass(frozen=True, eq=False)
class _Patch:
    """Paper that lines enclose. Metres, on the picture."""

    center_m: FloatArray
    long_m: float
    short_m: float
    area_m2: float
    corners_m: FloatArray
    """(4, 2) of the least rectangle round it."""
    has_corners: bool
    """Whether it reaches into the corners of that rectangle."""

    @property
    def fill(self) -> float:
        return self.area_m2 / (self.long_m * self.short_m)

    @property
    def ratio(self) -> float:
        return self.long_m / self.short_m


def kind_by_fixtures(
    polygon_px: FloatArray, fine: BoolArray, letters: BoolArray, m_per_px: float
) -> RoomKind:
    """The kind of a room by the symbols in it; unknown where there are none that tell.

    polygon_px: (N, 2) the room's corners; fine: (H, W) lines; letters: (H, W) what lies in a line
    of text.
    """
    patches = _patches(polygon_px, fine, letters, m_per_px)
    if _has_hob(patches):
        floor_m2 = cv2.contourArea(polygon_px.astype(np.float32)) * m_per_px**2
        return "living" if floor_m2 > _LIVING_KITCHEN_M2 else "kitchen"
    if _has_bed(patches):
        return "bedroom"
    if any(map(_is_oval, patches)) or _has_shower(patches) or _has_bath(patches):
        return "bathroom"
    return "unknown"


def _patches(
    polygon_px: FloatArray, lines: BoolArray, letters: BoolArray, m_per_px: float
) -> list[_Patch]:
    """What lines enclose in a room, but for the insides of letters."""
    low = np.floor(polygon_px.min(axis=0)).astype(int).clip(0)
    high = np.ceil(polygon_px.max(axis=0)).astype(int) + 1
    window = slice(low[1], high[1]), slice(low[0], high[0])
    floor = np.zeros(lines[window].shape, np.uint8)
    cv2.fillPoly(floor, [np.rint(polygon_px - low - 0.5).astype(np.int32)], (1.0,))
    # A border of floor joins all of it, so that only what is enclosed is left.
    paper = np.pad(((floor == 0) | ~lines[window]).astype(np.uint8), 1, constant_values=1)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(paper, connectivity=4)
    pixels = stats[:, cv2.CC_STAT_AREA]
    areas = pixels * m_per_px**2
    printed = np.bincount(labels[1:-1, 1:-1][letters[window]], minlength=len(stats))
    found = []
    for label in np.flatnonzero(
        (areas > _LEAST_M2) & (areas < _MOST_M2) & (printed < _PRINTED * pixels)
    ):
        if label > 0:
            left, top, width, height = (int(v) for v in stats[label, :4])
            own = labels[top : top + height, left : left + width] == label
            found.append(_patch(own, (left, top), m_per_px))
    return found


def _patch(own: BoolArray, place: tuple[int, int], m_per_px: float) -> _Patch:
    outlines, _ = cv2.findContours(own.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    center, size, turn = cv2.minAreaRect(outlines[0])
    # Contours pass through pixel centres, and lines cover half a pixel more on either side.
    sides = np.array(size) + 1.0
    corners = cv2.boxPoints((center, (float(sides[0]), float(sides[1])), turn))
    inset = np.asarray(corners) * 0.92 + np.array(center) * 0.08
    # Beyond its bounds there is none of it.
    cells = np.rint(inset).astype(int).clip(-1, np.array(own.shape[::-1])) + 1
    within = np.pad(own, 1)[cells[:, 1], cells[:, 0]]
    middle = (np.array(center) + np.array(place)) * m_per_px
    area = float(own.sum()) * m_per_px**2
    placed = (corners + np.array(place)) * m_per_px
    long, short = float(sides.max()) * m_per_px, float(sides.min()) * m_per_px
    return _Patch(middle, long, short, area, placed, int(within.sum()) > 1)


def _between(value: float, bounds: tuple[float, float]) -> bool:
    return bounds[0] <= value <= bounds[1]


def _are_alike(patches: Sequence[_Patch]) -> bool:
    areas = [patch.area_m2 for patch in patches]
    return max(areas) < _ALIKE * min(areas)


def _spread(patches: Sequence[_Patch]) -> tuple[float, float]:
    """Sides of the least rectangle round the centres."""
    centers = np.array([patch.center_m for patch in patches], np.float32)
    _, size, _ = cv2.minAreaRect(centers)
    return min(size), max(size)


def _has_hob(patches: Sequence[_Patch]) -> bool:
    rings = [
        p for p in patches
        if _between(p.fill, _RING_FILL) and not p.has_corners
        and _between(p.long_m, _RING_M) and p.ratio < _RING_RATIO
    ]  # fmt: skip
    return any(
        _are_alike(four) and all(_between(side, _RINGS_APART_M) for side in _spread(four))
        for four in combinations(rings[:12], 4)
    )


def _is_oval(patch: _Patch) -> bool:
    return (
        _between(patch.fill, _ROUND_FILL)
        and _between(patch.long_m, _OVAL_M[0])
        and _between(patch.short_m, _OVAL_M[1])
        and _between(patch.ratio, _OVAL_RATIO)
        and not patch.has_corners
    )


def _has_shower(patches: Sequence[_Patch]) -> bool:
    quarters = [
        p for p in patches
        if _between(p.fill, _TRIANGLE_FILL) and _between(_base_m(p), _SHOWER_M)
    ]  # fmt: skip
    return any(
        _are_alike(four) and max(_spread(four)) < _base_m(four[0])
        for four in combinations(quarters[:8], 4)
    )


def _base_m(triangle: _Patch) -> float:
    """The long side of half a square; the least rectangle round it lies along that or its legs."""
    return triangle.long_m * (1.0 if triangle.ratio > math.sqrt(2.0) else math.sqrt(2.0))


def _has_bath(patches: Sequence[_Patch]) -> bool:
    """A tub with round corners in a box with square ones."""
    boxes = [p for p in patches if _is_sized(p, _BATH_M) and p.has_corners]
    tubs = [p for p in patches if p.fill > _BOX_FILL and not p.has_corners]
    return any(
        np.hypot(*(tub.center_m - box.center_m)) < _RIM_M
        and _between(box.long_m - tub.long_m, (0.04, 2 * _RIM_M))
        and _between(box.short_m - tub.short_m, (0.04, 2 * _RIM_M))
        for box in boxes
        for tub in tubs
    )


def _has_bed(patches: Sequence[_Patch]) -> bool:
    pillows = [p for p in patches if p.fill > _BOX_FILL and _is_sized(p, _PILLOW_M)]
    return any(
        _between(_length_with(blanket, pillow), _BED_M)
        for blanket in patches
        if blanket.fill > _BOX_FILL
        and any(_is_sized(blanket, sides) for sides in (_BLANKET_M, _BLANKET_M[::-1]))
        for pillow in pillows
        if pillow is not blanket
    )


def _is_sized(patch: _Patch, sides: tuple[tuple[float, float], tuple[float, float]]) -> bool:
    """Whether its long and its short side lie within these bounds."""
    return _between(patch.long_m, sides[0]) and _between(patch.short_m, sides[1])


def _length_with(blanket: _Patch, pillow: _Patch) -> float:
    """From the blanket's far edge to that of a pillow that lies before one of its edges; else 0."""
    corners = blanket.corners_m
    for first in range(4):
        start, stop = corners[first], corners[(first + 1) % 4]
        along = (stop - start) / np.hypot(*(stop - start))
        outward = np.array([along[1], -along[0]])
        if outward @ (blanket.center_m - start) > 0:
            outward = -outward
        offset = (pillow.corners_m - start) @ outward
        beside = (pillow.center_m - start) @ along
        if offset.min() > 0 and 0 < beside < np.hypot(*(stop - start)):
            depth = abs(float(outward @ (corners[(first + 2) % 4] - start)))
            return depth + float(offset.max())
    return 0.0
