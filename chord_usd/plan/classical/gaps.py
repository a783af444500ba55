"""Where walls of a drawing are interrupted, and by what: door, window or nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon

from chord_usd.plan.classical.strokes import Strokes
from chord_usd.scene.types import BoolArray, ByteArray, FloatArray

_END_WIDTHS = (0.3, 2.2)
"""A wall ends in an edge so many usual wall thicknesses long."""

_SHORTEST_FLANK, _SLANTED_FLANK = 0.25, 1.5
"""The faces beside a wall's end are at least this share of its thickness long; those of a slanted
wall longer."""

_WIDE_END, _WIDE_FLANK = 1.4, 0.6
"""A wider edge, in wall thicknesses, is the side of a stub unless both faces beside it are longer
than this share of it."""

_BULGE_PX = 3

_EMPTY_REACH = 12.0
_DRAWN_REACH = 22.0
"""A gap is at most so many wall thicknesses long; longer if something is drawn all along it."""

_SHORTEST_GAP = 1.2

_CORNER_SHARES = (0.05, 0.1)
"""Outlines are simplified by these shares of the wall's thickness, and a pixel."""

_LOOSE, _SLIVER = 2.5, 0.75
"""Bits of wall no longer than this and not as wide as a wall are none, in wall thicknesses."""

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


_LEAST_ARM = 1.6
"""Both walls that meet in a corner are at least so many thicknesses long."""

_BAR_SHARE = 0.9
_BAR_DEPTH = 0.5
_ALONE_SHARE = 0.5
"""A bar is drawn along both faces of the wall, so far apart at least, in wall thicknesses; of the
lines beside it, which tiles have, less is drawn."""


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
    walls = strokes.wall if strokes.lines is None else strokes.lines
    drawn = cv2.dilate(strokes.thin.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    bold_px = _bold_px(strokes)
    loose, seen = _without_slivers(walls, bold_px)
    found = [
        gap
        for axis in (0, 1)
        for end in _wall_ends(seen[axis], bold_px)
        if int(np.argmax(np.abs(end.outward))) == axis
        and (gap := _gap_before(end, seen[axis], strokes, strokes.ink & ~seen[axis])) is not None
    ]
    barred = _barred_gaps(strokes, walls, bold_px)
    candidates = [_with_swing(gap, drawn) for gap in found]
    longest_px = _EMPTY_REACH * strokes.thickness_px
    candidates = [g for g in candidates if not g.is_empty or g.length_px <= longest_px]
    gaps: list[Gap] = []
    taken: list[Polygon] = []

    def rank(gap: Gap) -> tuple[bool, float]:
        # From the edge of a bit of wall a pane is seen as a leaf across its own wall.
        is_vague = not (gap.has_pane or gap.has_arc) and _touches(gap, loose)
        return gap.is_empty or is_vague, gap.length_px

    # Where walls end tells more than where they meet.
    for gap in [*sorted(candidates, key=rank), *sorted(barred, key=rank)]:
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


def _bold_px(strokes: Strokes) -> float:
    """How thick the walls are as they are drawn."""
    if strokes.lines is None:
        return strokes.thickness_px
    rim = strokes.lines & (cv2.erode(strokes.lines.astype(np.uint8), np.ones((3, 3))) == 0)
    return max(2.0 * float(strokes.lines.sum()) / max(float(rim.sum()), 1.0), 2.0)


def _without_slivers(
    wall: BoolArray, thickness_px: float
) -> tuple[BoolArray, tuple[BoolArray, BoolArray]]:
    """(H, W) the loose bits of wall; and walls as seen along x and y: without bits too slight.

    Where two sliding panels overlap, or a pane has a mullion, the lines are as thick as a wall.
    """
    _, labels, stats, _ = cv2.connectedComponentsWithStats(wall.astype(np.uint8), connectivity=8)
    sizes = stats[:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]]
    loose = sizes.max(axis=1) < _LOOSE * thickness_px
    loose[0] = False
    slight = loose[:, None] & (sizes < _SLIVER * thickness_px)
    return loose[labels], (wall & ~slight[labels, 1], wall & ~slight[labels, 0])


def _touches(gap: Gap, mask: BoolArray) -> bool:
    """Whether either end of a gap lies at a mask."""
    ends = gap.start - 1.5 * gap.along, gap.start + (gap.length_px + 2.0) * gap.along
    return any(_value_at(mask, end) for end in ends)


@dataclass(frozen=True, eq=False)
class _End:
    middle: FloatArray
    outward: FloatArray
    width_px: float


def _wall_ends(wall: BoolArray, thickness_px: float) -> list[_End]:
    """Short edges of the walls' outlines between two convex corners; [] for a scrawl."""
    contours, _ = cv2.findContours(wall.astype(np.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    ends: dict[tuple[float, ...], _End] = {}
    found = 0
    # A fine outline has the shortest stubs of walls, a rough one the ends that blur has rounded.
    for share in _CORNER_SHARES:
        for contour in contours:
            corners = cv2.approxPolyDP(contour, 1.0 + share * thickness_px, closed=True)
            if len(corners) >= 4:
                own = _ends_of(corners.reshape(-1, 2) + 0.5, wall, thickness_px)
                ends |= {(*end.middle, *end.outward, end.width_px): end for end in own}
                found += len(own)
        if found > _MOST_ENDS:
            return []
    return list(ends.values())


def _ends_of(corners: FloatArray, wall: BoolArray, thickness_px: float) -> list[_End]:
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    units = edges / np.maximum(lengths, 1e-9)[:, None]
    # Contours pass through pixel centres: the stroke is a pixel thicker.
    widths = lengths + 1.0
    shortest, longest = (factor * thickness_px for factor in _END_WIDTHS)
    ends = []
    for index in np.flatnonzero((widths >= shortest) & (widths <= longest)):
        before, after = index - 1, (index + 1) % len(units)
        # The wall's direction shows in its long faces, not in its short end.
        flank = units[before] if lengths[before] >= lengths[after] else -units[after]
        is_long = max(lengths[before], lengths[after]) > _LONG_FLANK * widths[index]
        outward = _upright(flank, _AXIS_SINE / 10 if is_long else _AXIS_SINE)
        if units[before] @ outward < 0.8 or units[after] @ outward > -0.8:
            continue
        # What leads away at an angle must be plain to see.
        least = _SHORTEST_FLANK if np.abs(outward).max() == 1.0 else _SLANTED_FLANK
        if max(lengths[before], lengths[after]) < least * widths[index]:
            continue
        is_wide = widths[index] > _WIDE_END * thickness_px
        if is_wide and min(lengths[before], lengths[after]) < _WIDE_FLANK * widths[index]:
            continue
        middle = corners[index] + edges[index] / 2
        if not _value_at(wall, middle + 2.5 * outward):
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


# Openings from corner to corner ------------------------------------------------------------------


def _barred_gaps(strokes: Strokes, walls: BoolArray, thickness_px: float) -> list[Gap]:
    """Openings that fill the side of a room, and so have no end of a wall beside them.

    They go on from a wall where it meets another, and are drawn as a bar as thick as the wall.
    """
    lines = strokes.fine & ~walls
    found = [
        gap
        for end in _corner_ends(walls, thickness_px)
        if (gap := _gap_before(end, walls, strokes, lines)) is not None
    ]
    return [gap for gap in found if gap.has_pane and _is_bar(gap, lines)]


def _corner_ends(wall: BoolArray, thickness_px: float) -> list[_End]:
    """Where either wall of a corner would go on beyond the other; [] for a scrawl."""
    contours, _ = cv2.findContours(wall.astype(np.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    ends: list[_End] = []
    for contour in contours:
        corners = cv2.approxPolyDP(contour, 1.0 + _CORNER_SHARES[0] * thickness_px, closed=True)
        if len(corners) >= 4:
            ends += _ends_beyond(corners.reshape(-1, 2) + 0.5, wall, thickness_px)
    return ends if len(ends) <= _MOST_ENDS else []


def _ends_beyond(corners: FloatArray, wall: BoolArray, thickness_px: float) -> list[_End]:
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    units = edges / np.maximum(lengths, 1e-9)[:, None]
    least = _LEAST_ARM * thickness_px
    ends = []
    for index in np.flatnonzero((lengths >= least) & (np.roll(lengths, 1) >= least)):
        onward, back = (_upright(way, _AXIS_SINE) for way in (units[index - 1], -units[index]))
        is_square = np.abs(onward).max() == np.abs(back).max() == 1.0 and onward @ back == 0.0
        if not is_square or _value_at(wall, corners[index] + 2.5 * (onward + back)):
            continue
        # The wall along either side goes on past the other's face.
        for along, across in ((onward, back), (back, onward)):
            beside = corners[index] - least * along
            depth = _depth(wall, beside, -across, _END_WIDTHS[1] * thickness_px)
            if depth is not None and depth >= _END_WIDTHS[0] * thickness_px:
                # Contours pass through pixel centres: the face is half a pixel farther out.
                middle = corners[index] - across * (depth - 1.0) / 2
                ends.append(_End(middle, along, depth))
    return ends


def _depth(wall: BoolArray, start: FloatArray, inward: FloatArray, most_px: float) -> float | None:
    """How thick a wall is below a point of its face; None if more than most_px."""
    steps = np.arange(0.0, most_px + 2.0)
    is_wall = _values_at(wall, start + inward * steps[:, None])
    return None if is_wall.all() else float(np.argmin(is_wall))


def _is_bar(gap: Gap, lines: BoolArray) -> bool:
    """Whether both faces of the wall are drawn along a gap, and nothing like them beside it."""
    along = np.arange(1.5, gap.length_px - 1.0)
    reach = 1.5 * gap.width_px
    offsets = np.arange(-reach, reach + 0.5)
    points = gap.start + gap.along * along[:, None, None] + gap.across * offsets[None, :, None]
    drawn = _values_at(lines, points)
    # Faces may be out of true by a pixel.
    drawn[:, 1:-1] |= drawn[:, :-2] | drawn[:, 2:]
    share = drawn.mean(axis=0)
    own = np.abs(offsets) <= gap.width_px / 2 + 1.5
    faces = offsets[own & (share >= _BAR_SHARE)]
    beside = share[np.abs(offsets) > gap.width_px / 2 + 4.5]
    return (
        len(faces) > 1
        and float(np.ptp(faces)) >= _BAR_DEPTH * gap.width_px
        and bool((beside < _ALONE_SHARE).all())
    )


# What a wall end faces ---------------------------------------------------------------------------


def _gap_before(end: _End, wall: BoolArray, strokes: Strokes, panes: BoolArray) -> Gap | None:
    """The gap from a wall's end to the wall it faces; None if there is none near enough."""
    across = np.array([-end.outward[1], end.outward[0]])
    steps = np.arange(1.5, _DRAWN_REACH * strokes.thickness_px)
    offsets = np.array([-0.3, 0.0, 0.3]) * end.width_px
    rays = end.middle + end.outward * steps[:, None, None] + across * offsets[:, None]
    blocked = _values_at(wall, rays)
    # A ragged end bulges past the edge that was fitted to it.
    blocked[:_BULGE_PX] &= np.cumsum(~blocked[:_BULGE_PX], axis=0) > 0
    hits = np.where(blocked.any(axis=0), np.argmax(blocked, axis=0), len(steps))
    middle = int(np.median(hits))
    if middle >= len(steps) or np.ptp(hits) > 0.6 * strokes.thickness_px:
        return None
    length = float(steps[middle]) - 0.5
    if length < _SHORTEST_GAP * strokes.thickness_px:
        return None
    width_px = strokes.thickness_px if strokes.are_lines else end.width_px
    gap = Gap(end.middle, end.outward, length, width_px)
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
