"""Where walls of a drawing are interrupted, and by what: door, window or nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.plan.strokes import Strokes
from chord_usd.types import BoolArray, FloatArray

_END_WIDTHS = (0.3, 2.2)
"""A wall ends in an edge so many usual wall thicknesses long."""

_EMPTY_REACH = 12.0
_DRAWN_REACH = 22.0
"""A gap is at most so many wall thicknesses long; longer if something is drawn all along it."""

_SHORTEST_GAP = 1.2

_PANE_SHARE = 0.7
"""A window or sliding door is drawn along at least so much of its gap."""

_SWING_SHARE = 0.7
"""Ink covers so much of a door's arc or leaf."""


@dataclass(frozen=True, eq=False)
class Gap:
    """A stretch between the end of a wall and what it faces. Continuous pixels, y down."""

    start: FloatArray
    """Middle of the wall's end."""
    along: FloatArray
    """Unit direction from the wall's end across the gap."""
    length_px: float
    width_px: float
    has_pane: bool
    """Something is drawn all along it."""
    has_swing: bool
    """A door's leaf or its arc is drawn at it."""

    @property
    def across(self) -> FloatArray:
        return np.array([-self.along[1], self.along[0]])

    def mask(self, shape: tuple[int, ...]) -> BoolArray:
        """Its pixels, and one more at either end so that nothing leaks past it."""
        half = self.across * self.width_px / 2
        first = self.start - self.along
        last = self.start + self.along * (self.length_px + 1)
        quad = np.array([first - half, first + half, last + half, last - half]) - 0.5
        canvas = np.zeros(shape, np.uint8)
        cv2.fillConvexPoly(canvas, np.rint(quad).astype(np.int32), (1.0,))
        return canvas > 0


def find_gaps(strokes: Strokes) -> list[Gap]:
    """Every stretch that may be an opening, the shortest first."""
    drawn = cv2.dilate(strokes.thin.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    gaps: list[Gap] = []
    taken = np.zeros(strokes.wall.shape, bool)
    found = [_gap_before(end, strokes, drawn) for end in _wall_ends(strokes)]
    for gap in sorted((g for g in found if g is not None), key=lambda gap: gap.length_px):
        mask = gap.mask(taken.shape)
        # The wall ends on both sides of a gap both see it.
        if (mask & taken).sum() < 0.5 * mask.sum():
            gaps.append(gap)
            taken |= mask
    return gaps


# Wall ends ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _End:
    middle: FloatArray
    outward: FloatArray
    width_px: float


def _wall_ends(strokes: Strokes) -> list[_End]:
    """Short edges of the walls' outlines between two convex corners."""
    contours, _ = cv2.findContours(
        strokes.wall.astype(np.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE
    )
    ends = []
    for contour in contours:
        corners = cv2.approxPolyDP(contour, 1.0 + 0.12 * strokes.thickness_px, closed=True)
        if len(corners) >= 4:
            ends += _ends_of(corners.reshape(-1, 2) + 0.5, strokes)
    return ends


def _ends_of(corners: FloatArray, strokes: Strokes) -> list[_End]:
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    units = edges / np.maximum(lengths, 1e-9)[:, None]
    # Contours pass through pixel centres: the stroke is a pixel thicker.
    widths = lengths + 1.0
    shortest, longest = (factor * strokes.thickness_px for factor in _END_WIDTHS)
    ends = []
    for index in np.flatnonzero((widths >= shortest) & (widths <= longest)):
        outward = np.array([units[index, 1], -units[index, 0]])
        middle = corners[index] + edges[index] / 2
        if _value_at(strokes.wall, middle + 2.5 * outward):
            outward = -outward
        if _value_at(strokes.wall, middle + 2.5 * outward):
            continue
        arrives, leaves = units[index - 1] @ outward, units[(index + 1) % len(units)] @ outward
        flanks = lengths[index - 1], lengths[(index + 1) % len(units)]
        if arrives > 0.8 and leaves < -0.8 and max(flanks) > 0.5 * widths[index]:
            ends.append(_End(middle, outward, float(widths[index])))
    return ends


def _value_at(mask: BoolArray, point: FloatArray) -> bool:
    column, row = math.floor(point[0]), math.floor(point[1])
    inside = 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1]
    return inside and bool(mask[row, column])


def _values_at(mask: BoolArray, points: npt.NDArray[np.float64]) -> BoolArray:
    """Values of a mask at points (..., 2); False outside."""
    columns, rows = np.floor(points[..., 0]).astype(int), np.floor(points[..., 1]).astype(int)
    inside = (rows >= 0) & (rows < mask.shape[0]) & (columns >= 0) & (columns < mask.shape[1])
    values = mask[rows.clip(0, mask.shape[0] - 1), columns.clip(0, mask.shape[1] - 1)]
    return np.asarray(values & inside)


# What a wall end faces ---------------------------------------------------------------------------


def _gap_before(end: _End, strokes: Strokes, drawn: BoolArray) -> Gap | None:
    """The gap from a wall's end to the wall it faces; None if there is none near enough."""
    across = np.array([-end.outward[1], end.outward[0]])
    steps = np.arange(1.5, _DRAWN_REACH * strokes.thickness_px)
    offsets = np.array([-0.3, 0.0, 0.3]) * end.width_px
    rays = (
        end.middle + end.outward * steps[:, None, None] + across * offsets[None, :, None]
    )  # (steps, rays, 2)
    blocked = _values_at(strokes.wall, rays)
    hits = np.where(blocked.any(axis=0), np.argmax(blocked, axis=0), len(steps))
    middle = int(np.median(hits))
    if middle >= len(steps) or np.ptp(hits) > 0.6 * strokes.thickness_px:
        return None
    length = float(steps[middle]) - 0.5
    if length < _SHORTEST_GAP * strokes.thickness_px:
        return None
    gap = Gap(end.middle, end.outward, length, end.width_px, False, False)
    has_pane = _pane_share(gap, strokes.ink & ~strokes.wall) >= _PANE_SHARE
    if not has_pane and length > _EMPTY_REACH * strokes.thickness_px:
        return None
    has_swing = _swing_share(gap, drawn) >= _SWING_SHARE
    return Gap(end.middle, end.outward, length, end.width_px, has_pane, has_swing)


def _pane_share(gap: Gap, ink: BoolArray) -> float:
    """Share of the gap's length along which something is drawn within the wall's width."""
    along = np.arange(1.5, gap.length_px - 1.0)
    half = gap.width_px / 2 + 1.0
    beside = np.arange(-half, half + 0.5)
    points = gap.start + gap.along * along[:, None, None] + gap.across * beside[None, :, None]
    return float(_values_at(ink, points).any(axis=1).mean()) if len(along) else 0.0


_LEAF_ANGLES = np.radians(np.arange(25.0, 156.0, 3.0))
_ARC_ANGLES = np.radians(np.arange(15.0, 76.0, 3.0))


def _swing_share(gap: Gap, drawn: BoolArray) -> float:
    """How much of the best door leaf or arc, over all places of the hinge, is covered by ink."""
    best = 0.0
    for radius in (gap.length_px, gap.length_px / 2):
        for at_start in (True, False):
            inward = gap.along if at_start else -gap.along
            hinge = gap.start if at_start else gap.start + gap.along * gap.length_px
            for side in (-1.0, 1.0):
                for offset in (-0.5, 0.0, 0.5):
                    corner = hinge + gap.across * offset * gap.width_px
                    best = max(best, _arc_share(corner, inward, side * gap.across, radius, drawn))
                    if radius == gap.length_px:
                        leaf = _leaf_share(corner, inward, side * gap.across, gap, drawn)
                        best = max(best, leaf)
    return best


def _arc_share(
    hinge: FloatArray, inward: FloatArray, side: FloatArray, radius_px: float, drawn: BoolArray
) -> float:
    directions = np.cos(_ARC_ANGLES)[:, None] * inward + np.sin(_ARC_ANGLES)[:, None] * side
    radii = radius_px * np.array([0.94, 0.97, 1.0, 1.03, 1.06])
    points = hinge + directions[:, None, :] * radii[None, :, None]
    return float(_values_at(drawn, points).any(axis=1).mean())


def _leaf_share(
    hinge: FloatArray, inward: FloatArray, side: FloatArray, gap: Gap, drawn: BoolArray
) -> float:
    """Coverage of the best straight leaf beyond the wall's face, about as long as the gap."""
    directions = np.cos(_LEAF_ANGLES)[:, None] * inward + np.sin(_LEAF_ANGLES)[:, None] * side
    reach = np.arange(max(0.25 * gap.length_px, 0.6 * gap.width_px), 0.75 * gap.length_px)
    if len(reach) < 4:
        return 0.0
    points = hinge + directions[:, None, :] * reach[None, :, None]
    return float(_values_at(drawn, points).mean(axis=1).max())


def close_gaps(wall: BoolArray, gaps: Sequence[Gap]) -> BoolArray:
    """The walls with all gaps filled."""
    closed = wall.copy()
    for gap in gaps:
        closed |= gap.mask(wall.shape)
    return closed
