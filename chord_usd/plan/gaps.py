"""Where walls of a drawing are interrupted, and by what: door, window or nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon

from chord_usd.plan.strokes import Strokes
from chord_usd.types import BoolArray, ByteArray, FloatArray

_END_WIDTHS = (0.3, 2.2)
"""A wall ends in an edge so many usual wall thicknesses long."""

_SHORTEST_FLANK = 0.25
"""The faces beside a wall's end are at least this share of its thickness long."""

_EMPTY_REACH = 12.0
_DRAWN_REACH = 22.0
"""A gap is at most so many wall thicknesses long; longer if something is drawn all along it."""

_SHORTEST_GAP = 1.2

_CORNER_PX, _CORNER_SHARE = 1.0, 0.1
"""Blur and hatching chamfer corners by so much: pixels, and a share of the wall's thickness."""

_MOST_ENDS = 1000
"""A drawing with more wall ends is no plan."""

_AXIS_SINE = 0.17
"""Walls within 10 degrees of an axis run along it; long ones are sure of a tenth of that."""

_LONG_FLANK = 2.5

_PANE_SHARE = 0.7
"""A window or sliding door is drawn along at least so much of its gap."""

_PANEL_SHARE = 0.4
"""Each of two sliding panels is so long, at least."""

_SILL_PX = 4.0
"""Lines this close to the wall's face are sills, not leaves or arcs."""

_SWING_SHARE = 0.85
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
    has_pane: bool = False
    """Something is drawn all along it."""
    has_leaf: bool = False
    """A straight line leads away from one of its ends, as the leaf of an open door."""
    has_arc: bool = False
    """The arc along which a door swings is drawn beside it."""

    @property
    def is_empty(self) -> bool:
        """Nothing is drawn at it."""
        return not (self.has_pane or self.has_leaf or self.has_arc)

    @property
    def across(self) -> FloatArray:
        return np.array([-self.along[1], self.along[0]])

    @property
    def corners(self) -> FloatArray:
        """(4, 2) its corners, a pixel into the wall at either end so that nothing leaks past it."""
        half = self.across * self.width_px / 2
        first = self.start - self.along
        last = self.start + self.along * (self.length_px + 1)
        return np.array([first - half, first + half, last + half, last - half])

    def mask(self, shape: tuple[int, ...]) -> BoolArray:
        """(H, W) its pixels."""
        canvas = np.zeros(shape, np.uint8)
        self.fill(canvas)
        return canvas > 0

    def fill(self, canvas: ByteArray) -> None:
        """Set its pixels to 1."""
        # cv2 puts pixel centres at whole numbers.
        cv2.fillConvexPoly(canvas, np.rint(self.corners - 0.5).astype(np.int32), (1.0,))


def find_gaps(strokes: Strokes) -> list[Gap]:
    """Every stretch that may be an opening: drawn ones first, then the shortest.

    None crosses another: of two that do, the later one sees through a door.
    """
    panes = strokes.ink & ~strokes.wall
    drawn = cv2.dilate(strokes.thin.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    found = [_gap_before(end, strokes, panes) for end in _wall_ends(strokes)]
    candidates = [_with_swing(gap, drawn) for gap in found if gap is not None]
    longest_px = _EMPTY_REACH * strokes.thickness_px
    candidates = [g for g in candidates if not g.is_empty or g.length_px <= longest_px]
    gaps: list[Gap] = []
    taken: list[Polygon] = []
    for gap in sorted(candidates, key=lambda gap: (gap.is_empty, gap.length_px)):
        shape = Polygon(gap.corners)
        if not any(shape.intersects(other) for other in taken):
            gaps.append(gap)
            taken.append(shape)
    return gaps


def _with_swing(gap: Gap, drawn: BoolArray) -> Gap:
    arc, leaf = _swing_shares(gap, drawn)
    return replace(gap, has_arc=arc >= _SWING_SHARE, has_leaf=leaf >= _SWING_SHARE)


def close_gaps(wall: BoolArray, gaps: Sequence[Gap]) -> BoolArray:
    """The walls with all gaps filled."""
    canvas = wall.astype(np.uint8)
    for gap in gaps:
        gap.fill(canvas)
    return canvas > 0


# Wall ends ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _End:
    middle: FloatArray
    outward: FloatArray
    width_px: float


def _wall_ends(strokes: Strokes) -> list[_End]:
    """Short edges of the walls' outlines between two convex corners; [] for a scrawl."""
    contours, _ = cv2.findContours(
        strokes.wall.astype(np.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE
    )
    ends = []
    for contour in contours:
        slack_px = _CORNER_PX + _CORNER_SHARE * strokes.thickness_px
        corners = cv2.approxPolyDP(contour, slack_px, closed=True)
        if len(corners) >= 4:
            ends += _ends_of(corners.reshape(-1, 2) + 0.5, strokes)
    return ends if len(ends) <= _MOST_ENDS else []


def _ends_of(corners: FloatArray, strokes: Strokes) -> list[_End]:
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    units = edges / np.maximum(lengths, 1e-9)[:, None]
    # Contours pass through pixel centres: the stroke is a pixel thicker.
    widths = lengths + 1.0
    shortest, longest = (factor * strokes.thickness_px for factor in _END_WIDTHS)
    ends = []
    for index in np.flatnonzero((widths >= shortest) & (widths <= longest)):
        before, after = index - 1, (index + 1) % len(units)
        # The wall's direction shows in its long faces, not in its short end.
        flank = units[before] if lengths[before] >= lengths[after] else -units[after]
        is_long = max(lengths[before], lengths[after]) > _LONG_FLANK * widths[index]
        outward = _upright(flank, _AXIS_SINE / 10 if is_long else _AXIS_SINE)
        if units[before] @ outward < 0.8 or units[after] @ outward > -0.8:
            continue
        if max(lengths[before], lengths[after]) < _SHORTEST_FLANK * widths[index]:
            continue
        middle = corners[index] + edges[index] / 2
        if not _value_at(strokes.wall, middle + 2.5 * outward):
            width = abs(float(edges[index] @ np.array([-outward[1], outward[0]]))) + 1.0
            ends.append(_End(middle, outward, width))
    return ends


def _upright(direction: FloatArray, slack: float) -> FloatArray:
    """The direction, along an axis if its sine to that is no more than slack."""
    axis = int(np.argmax(np.abs(direction)))
    if abs(direction[1 - axis]) > slack:
        return direction
    snapped = np.zeros(2)
    snapped[axis] = np.sign(direction[axis])
    return snapped


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


def _gap_before(end: _End, strokes: Strokes, panes: BoolArray) -> Gap | None:
    """The gap from a wall's end to the wall it faces; None if there is none near enough."""
    across = np.array([-end.outward[1], end.outward[0]])
    steps = np.arange(1.5, _DRAWN_REACH * strokes.thickness_px)
    offsets = np.array([-0.3, 0.0, 0.3]) * end.width_px
    rays = end.middle + end.outward * steps[:, None, None] + across * offsets[:, None]
    blocked = _values_at(strokes.wall, rays)
    hits = np.where(blocked.any(axis=0), np.argmax(blocked, axis=0), len(steps))
    middle = int(np.median(hits))
    if middle >= len(steps) or np.ptp(hits) > 0.6 * strokes.thickness_px:
        return None
    length = float(steps[middle]) - 0.5
    if length < _SHORTEST_GAP * strokes.thickness_px:
        return None
    gap = Gap(end.middle, end.outward, length, end.width_px)
    return replace(gap, has_pane=_pane_share(gap, panes) >= _PANE_SHARE)


def _pane_share(gap: Gap, ink: BoolArray) -> float:
    """Share of the gap's length along which a line or two are drawn within the wall's width."""
    along = np.arange(1.5, gap.length_px - 1.0)
    half = gap.width_px / 2 + 1.0
    beside = np.arange(-half, half + 0.5)
    points = gap.start + gap.along * along[:, None, None] + gap.across * beside[None, :, None]
    if len(along) == 0:
        return 0.0
    lines = _values_at(ink, points)
    # A pane is a line, or two where one panel slides behind the other; specks are neither.
    lines[:, 1:-1] |= lines[:, :-2] | lines[:, 2:]
    longest = lines[:, int(np.argmax(lines.sum(axis=0)))]
    second = lines[:, int(np.argmax((lines & ~longest[:, None]).sum(axis=0)))]
    if longest.mean() >= _PANE_SHARE or second.mean() < _PANEL_SHARE:
        return float(longest.mean())
    return float((longest | second).mean())


_SWING_ANGLES = np.radians(np.arange(15.0, 76.0, 3.0))
_LEAF_ANGLES = np.radians(np.arange(25.0, 156.0, 3.0))


def _swing_shares(gap: Gap, drawn: BoolArray) -> tuple[float, float]:
    """How much of the best arc and of the best leaf is drawn, over all places of the hinge."""
    arc, leaf = 0.0, 0.0
    for at_start in (True, False):
        inward = gap.along if at_start else -gap.along
        hinge = gap.start if at_start else gap.start + gap.along * gap.length_px
        for side in (gap.across, -gap.across):
            for offset in (-0.5, 0.0, 0.5):
                corner = hinge + side * offset * gap.width_px
                beyond = (0.5 - offset) * gap.width_px + _SILL_PX
                for radius in (gap.length_px, gap.length_px / 2):
                    # One leaf, or one of two.
                    arc = max(arc, _arc_share(corner, inward, side, radius, beyond, drawn))
                    leaf = max(leaf, _leaf_share(corner, inward, side, radius, beyond, drawn))
    return arc, leaf


def _arc_share(
    hinge: FloatArray,
    inward: FloatArray,
    side: FloatArray,
    radius_px: float,
    beyond_px: float,
    drawn: BoolArray,
) -> float:
    """Share of an arc that is drawn, of what lies beyond the wall's face."""
    angles = _SWING_ANGLES[np.sin(_SWING_ANGLES) * radius_px > beyond_px]
    if len(angles) < len(_SWING_ANGLES) / 2:
        return 0.0
    directions = np.cos(angles)[:, None] * inward + np.sin(angles)[:, None] * side
    radii = radius_px * np.array([0.97, 0.985, 1.0, 1.015, 1.03])
    points = hinge + directions[:, None, :] * radii[None, :, None]
    return float(_values_at(drawn, points).any(axis=1).mean())


def _leaf_share(
    hinge: FloatArray,
    inward: FloatArray,
    side: FloatArray,
    length_px: float,
    beyond_px: float,
    drawn: BoolArray,
) -> float:
    """Coverage of the best straight leaf, of what lies beyond the wall's face."""
    directions = np.cos(_LEAF_ANGLES)[:, None] * inward + np.sin(_LEAF_ANGLES)[:, None] * side
    reach = np.arange(0.2 * length_px, 0.75 * length_px)
    points = hinge + directions[:, None, :] * reach[None, :, None]
    outside = np.sin(_LEAF_ANGLES)[:, None] * reach > beyond_px
    covered = (_values_at(drawn, points) & outside).sum(axis=1)
    enough = outside.sum(axis=1) >= 0.35 * length_px
    return float(np.max(np.where(enough, covered / np.maximum(outside.sum(axis=1), 1), 0.0)))
