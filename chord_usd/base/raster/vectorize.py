"""From pixels back to outlines: simple polygons and rotated boxes in continuous pixels.

A raster is taken as canvas.py draws it: a pixel is set if and only if its centre is inside. The
outline therefore crosses every crack (the border of a set and an unset pixel) between the centres
of the two, less than half a pixel from the crack's middle. The fewest straight lines that do so
are the outline: edges along an axis come out within half a pixel, slanted ones far closer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt
from shapely.geometry import LineString, Polygon
from shapely.geometry.polygon import orient

from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.types import BoolArray, ByteArray, FloatArray

IntArray = npt.NDArray[np.int64]

_SLACK_PX = 0.02
"""A crack counts as crossed this far beyond half a pixel: drawings round, too."""

_HAIR_PX = 0.01
_LEAST_NOISE_PX = 0.5
"""Borders that stray less are followed pixel by pixel."""


@dataclass(frozen=True)
class RotatedBox:
    """A rectangle on the canvas, continuous pixels, y down."""

    center_px: tuple[float, float]
    length_px: float
    width_px: float
    angle_deg: float
    """Direction of the length, clockwise as seen (y is down), in [0, 180)."""


def polygon_from_mask(mask: BoolArray | ByteArray, noise_px: float = 0.0) -> FloatArray:
    """(N, 2) outline of the largest 4-connected region of a mask, in continuous pixels.

    Edges as few as fit; those nearly along an axis lie along it exactly, slanted ones stay
    slanted. Holes are passed over. The polygon is simple and, seen in the world, counter-clockwise.
    noise_px: how far the mask's border may stray from the outline beyond its own rounding; 0 for
    exact drawings. Raises ValueError for an empty mask.
    """
    whole = np.asarray(mask).astype(np.uint8)
    x, y, width, height = cv2.boundingRect(whole)
    region = largest_region(whole[y : y + height, x : x + width] != 0)
    outline = _crack_outline(region)
    corners = _corners(outline, _fit_edges(_Cracks(outline, noise_px)))
    while not (fits := _is_outline(corners, outline, noise_px)) and noise_px > _LEAST_NOISE_PX:
        # Long edges across a torn border; shorter ones follow it.
        noise_px /= 2
        corners = _corners(outline, _fit_edges(_Cracks(outline, noise_px)))
    is_block = np.ptp(outline, axis=0).prod() == region.sum()
    if is_block or not fits:
        # A rectangle, of however few pixels, or lines that meet where no corner is: keep to corners
        # on the pixel grid.
        corners = _grid_corners(outline).astype(np.float64)
    polygon = Polygon(corners)
    if not polygon.is_valid:
        # A region that touches itself at a grid point; a hair less does not.
        polygon = max(polygons_of(polygon.buffer(-_HAIR_PX)), key=lambda part: part.area)
    corners = np.asarray(orient(polygon, -1.0).exterior.coords, dtype=np.float64)[:-1]
    return corners + np.array([x, y])


def _is_outline(corners: FloatArray, outline: IntArray, noise_px: float) -> bool:
    """Whether these corners make a simple polygon that keeps close to the outline."""
    if len(corners) < 3:
        return False
    polygon = Polygon(corners)
    closed = LineString(np.concatenate([outline, outline[:1]]))
    strayed = closed.hausdorff_distance(polygon.exterior)
    return bool(polygon.is_valid and strayed <= 2.0 + 2 * noise_px)


def largest_region(mask: BoolArray) -> BoolArray:
    """The largest 4-connected region of a mask. Raises ValueError for an empty mask."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(
        mask.astype(np.uint8), connectivity=4
    )
    if count < 2:
        raise ValueError("the mask is empty")
    return np.asarray(labels == 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA])))


def rotated_box_from_mask(mask: BoolArray | ByteArray) -> RotatedBox:
    """The rectangle that a mask shows: its bounds where it fills them, else along its long axis.

    Raises ValueError for an empty mask.
    """
    rows, columns = np.nonzero(mask)
    if len(rows) == 0:
        raise ValueError("the mask is empty")
    low = np.array([columns.min(), rows.min()])
    size = np.array([columns.max() + 1, rows.max() + 1]) - low
    if len(rows) == size[0] * size[1]:
        center = low + size / 2
        length, width = float(size.max()), float(size.min())
        angle = 0.0 if size[0] >= size[1] else 90.0
        return RotatedBox((float(center[0]), float(center[1])), length, width, angle)
    points = np.stack([columns, rows], axis=1) + 0.5
    middle = points.mean(axis=0)
    axes = np.linalg.eigh(np.cov(points.T, bias=True))[1]
    spread = (points - middle) @ axes
    low, high = spread.min(axis=0), spread.max(axis=0)
    middle = middle + axes @ (low + high) / 2
    # The outermost centres of a row of pixels lie half a pixel inside its ends.
    width, length = high - low + np.abs(axes).max(axis=0)
    angle = math.degrees(math.atan2(axes[1, 1], axes[0, 1])) % 180.0
    return RotatedBox((float(middle[0]), float(middle[1])), float(length), float(width), angle)


# Cracks ------------------------------------------------------------------------------------------


def _crack_outline(region: BoolArray) -> IntArray:
    """(N, 2) grid points round a 4-connected region, one pixel apart, the region on the right.

    The outer outline only. Going right means that the region lies below (y is down).
    """
    inside = np.pad(region, 1).tolist()
    row, column = np.argwhere(region)[0]
    start = x, y = int(column), int(row)
    direction, points = 0, [start]
    while True:
        dx, dy = _STEPS[direction]
        x, y = x + dx, y + dy
        direction = _turn(inside, x, y, direction)
        if (x, y) == start and direction == 0:
            return np.array(points)
        points.append((x, y))


_STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))
"""Right, down, left, up."""


def _turn(inside: list[list[bool]], x: int, y: int, direction: int) -> int:
    """The direction in which the outline goes on at this grid point.

    Turns right where it can: regions that touch at a corner only are two regions.
    """
    # Pixels round the grid point, in padded rows and columns: the pixel left of grid column x is
    # padded column x.
    dx, dy = _STEPS[direction]
    rx, ry = -dy, dx  # to the right of the way, y down
    ahead_right = inside[y + (dy + ry + 1) // 2][x + (dx + rx + 1) // 2]
    if not ahead_right:
        return (direction + 1) % 4
    ahead_left = inside[y + (dy - ry + 1) // 2][x + (dx - rx + 1) // 2]
    return (direction + 3) % 4 if ahead_left else direction


def _grid_corners(outline: IntArray) -> IntArray:
    """The grid points where the outline turns."""
    steps = np.roll(outline, -1, axis=0) - outline
    return outline[np.any(steps != np.roll(steps, 1, axis=0), axis=1)]


# Lines -------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Line:
    """normal . point = offset; the normal is of length one and points out of the region."""

    normal: FloatArray
    offset: float

    def nearest(self, point: FloatArray) -> FloatArray:
        return point + (self.offset - self.normal @ point) * self.normal


@dataclass(frozen=True, eq=False)
class _Edge:
    """A stretch of the outline and its line."""

    cracks: IntArray
    """Indices of the stretch's cracks; each begins at the outline's point of that index."""
    directions: FloatArray
    """(N, 2) unit steps of the outline along them."""
    line: _Line


class _Cracks:
    """The cracks along an outline, and the lines that cross stretches of them."""

    def __init__(self, outline: IntArray, noise_px: float) -> None:
        self.points = outline.astype(np.float64)
        self.slack_px = _SLACK_PX + noise_px
        # Without noise a line along an axis has no step at all: a whole pixel parts both sides.
        self._axis_slack_px = self.slack_px if noise_px > 0.0 else _SLACK_PX - 1.0
        self.directions = np.roll(self.points, -1, axis=0) - self.points
        self.jogs = _jogs(self.directions) if noise_px == 0.0 else set()
        self._middles = self.points + self.directions / 2
        self._outward = _left_of(self.directions)
        self._found: dict[tuple[int, int], tuple[float, _Line]] = {}

    def between(self, start: int, stop: int) -> IntArray:
        """Indices of the cracks from one grid point to another, round the end if need be."""
        count = len(self.points)
        return (start + np.arange((stop - start) % count or count)) % count

    def is_straight(self, start: int, stop: int) -> bool:
        """Whether one line crosses all cracks of this stretch."""
        return self.excess(start, stop) <= self.slack_px

    def is_clean(self, start: int, stop: int) -> bool:
        """As is_straight, but a line along an axis must not pass over any step."""
        excess, line = self._best(start, stop)
        return excess < (_SLACK_PX - 1.0 if 0.0 in line.normal else 0.0)

    def excess(self, start: int, stop: int) -> float:
        """How far, in pixels, the best line fails to part the pixels on both sides."""
        return self._best(start, stop)[0]

    def fit(self, start: int, stop: int) -> _Line:
        """The line of this stretch: along an axis if one fits, else by least squares."""
        excess, best = self._best(start, stop)
        if 0.0 in best.normal:
            return best
        cracks = self.between(start, stop)
        # The last cracks at either end may belong to the neighbours.
        trimmed = cracks[1:-1] if len(cracks) > 6 else cracks
        middles = self._middles[trimmed]
        center = middles.mean(axis=0)
        normal = np.linalg.svd(middles - center)[2][1]
        normal *= np.sign(normal @ best.normal) or 1.0
        line = _Line(normal, float(normal @ center))
        inner, outer = self._sides(cracks)
        missed = max((inner @ normal).max() - line.offset, line.offset - (outer @ normal).min())
        return line if missed <= max(excess, self.slack_px) + 0.1 else best

    def _lone_run(self, cracks: IntArray) -> IntArray | None:
        """The run that all cracks are of, but for the first and the last, or a few of very many.

        A run is a line along its axis, whatever slanted line could pass as well.
        """
        middle = len(cracks) // 2
        directions = self.directions[cracks]
        turns = np.flatnonzero(np.any(directions != directions[middle], axis=1))
        start = int(turns[turns < middle].max(initial=-1)) + 1
        stop = int(turns[turns > middle].min(initial=len(cracks)))
        ends_only = start <= 1 and stop >= len(cracks) - 1 and stop - start >= min(len(cracks), 2)
        outward = self._outward[cracks[middle]]
        strays = [np.abs(part @ outward).sum() for part in (directions[:start], directions[stop:])]
        is_long = stop - start >= max(_LONG_RUN, 0.95 * len(cracks)) and max(strays) <= 1.0
        return cracks[start:stop] if ends_only or is_long else None

    def edge(self, start: int, stop: int) -> _Edge:
        cracks = self.between(start, stop)
        return _Edge(cracks, self.directions[cracks], self.fit(start, stop))

    def _sides(self, cracks: IntArray) -> tuple[FloatArray, FloatArray]:
        """Centres of the pixels inside and outside of these cracks."""
        middles, outward = self._middles[cracks], self._outward[cracks]
        return middles - outward / 2, middles + outward / 2

    def _best(self, start: int, stop: int) -> tuple[float, _Line]:
        if (start, stop) not in self._found:
            self._found[start, stop] = self._separate(self.between(start, stop))
        return self._found[start, stop]

    def _separate(self, cracks: IntArray) -> tuple[float, _Line]:
        """The line that best parts inner from outer pixels, an axis-parallel one if that parts."""
        run = self._lone_run(cracks)
        if run is not None:
            normal = self._outward[run[0]]
            line = _Line(normal, float(normal @ self._middles[run[0]]))
            return -1.0 if len(run) == len(cracks) else _RUN_AND_END, line
        inner, outer = self._sides(cracks)
        # Two convex shapes that can be parted at all can be parted along an edge of one of them.
        hulls = [_hull(inner), _hull(outer)]
        edges = np.concatenate([np.roll(hull, -1, axis=0) - hull for hull in hulls])
        edges = edges[np.any(edges != 0.0, axis=1)]
        normals = _left_of(edges)
        normals /= np.hypot(normals[:, 0], normals[:, 1])[:, None]
        normals = np.concatenate([_AXES, normals, -normals])
        # A line must have the region on the side where most of its cracks have it.
        normals = normals[normals @ self._outward[cracks].sum(axis=0) > 0.0]
        if len(normals) == 0:
            return math.inf, _Line(_AXES[0], 0.0)
        low = (hulls[0] @ normals.T).max(axis=0)
        high = (hulls[1] @ normals.T).min(axis=0)
        excesses = low - high
        on_axis = np.any(normals == 0.0, axis=1)
        fits = on_axis & (excesses <= self._axis_slack_px)
        excesses = np.where(on_axis & ~fits, math.inf, excesses)
        best = int(np.argmin(np.where(fits, -math.inf, excesses)))
        return float(excesses[best]), _Line(normals[best], float(low[best] + high[best]) / 2)


def _left_of(directions: FloatArray) -> FloatArray:
    """(N, 2) directions turned to the side that lies outside, the region being on the right."""
    return np.stack([directions[:, 1], -directions[:, 0]], axis=1)


_AXES = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])


def _hull(points: FloatArray) -> FloatArray:
    return cv2.convexHull(points.astype(np.float32)).reshape(-1, 2).astype(np.float64)


def _fit_edges(cracks: _Cracks) -> list[_Edge]:
    """The fewest lines that cross all cracks, in order along the outline."""
    points = cracks.points.astype(np.int32)
    rough = cv2.approxPolyDP(points.reshape(-1, 1, 2), 1.0 + cracks.slack_px, closed=True)
    index_of = {point: index for index, point in enumerate(map(tuple, points.tolist()))}
    cuts = sorted({index_of[x, y] for x, y in rough.reshape(-1, 2).tolist()} | cracks.jogs)
    cuts = [cut for start, stop in _spans(cuts) for cut in _split(cracks, start, stop)]
    cuts = _absorb_tips(cracks, _merge(cracks, cuts))
    for _ in range(2):
        cuts = _move_cuts(cracks, cuts)
    return [cracks.edge(start, stop) for start, stop in _spans(cuts)]


def _jogs(directions: FloatArray) -> set[int]:
    """Grid points before and after each lone step of one pixel in an otherwise straight run.

    A lone step is a jog or a slant; taken for a jog, either is met within half a pixel. Slanted
    lines show by several steps to the same side.
    """
    starts = np.flatnonzero(np.any(directions != np.roll(directions, 1, axis=0), axis=1))
    lengths = (np.roll(starts, -1) - starts) % len(directions)
    ways = directions[starts]

    def same_way(shift: int) -> BoolArray:
        return np.asarray((np.roll(ways, -shift, axis=0) == ways).all(axis=1))

    before, after = np.roll(lengths, 1), np.roll(lengths, -1)
    is_step = (lengths == 1) & (before >= 2) & (after >= 2)
    is_step &= np.roll((np.roll(ways, -2, axis=0) == ways).all(axis=1), 1)
    for shift in (-2, 2):
        is_step &= ~((np.roll(lengths, -shift) == 1) & same_way(shift))
    steps = starts[is_step]
    return {*steps.tolist(), *((steps + 1) % len(directions)).tolist()}


def _spans(cuts: list[int]) -> list[tuple[int, int]]:
    return list(zip(cuts, cuts[1:] + cuts[:1], strict=True))


def _split(cracks: _Cracks, start: int, stop: int) -> list[int]:
    """Start, and cuts after it, such that every piece up to stop is straight."""
    stretch = cracks.between(start, stop)
    if len(stretch) < 2 or cracks.is_straight(start, stop):
        return [start]
    points = cracks.points[stretch]
    chord = cracks.points[stop] - points[0]
    distances = np.abs((points - points[0]) @ np.array([-chord[1], chord[0]]))
    middle = int(stretch[max(int(np.argmax(distances)), 1)])
    return _split(cracks, start, middle) + _split(cracks, middle, stop)


def _merge(cracks: _Cracks, cuts: list[int]) -> list[int]:
    """Leave out cuts that one line can pass, those it passes most easily first."""
    cuts = list(cuts)
    while len(cuts) > 3:
        neighbours = zip(cuts[-1:] + cuts[:-1], cuts, cuts[1:] + cuts[:1], strict=True)
        costs = [
            (cracks.excess(before, after), cut)
            for before, cut, after in neighbours
            if cut not in cracks.jogs
        ]
        excess, cut = min(costs, default=(math.inf, 0))
        if excess > cracks.slack_px:
            break
        cuts.remove(cut)
    return cuts


def _absorb_tips(cracks: _Cracks, cuts: list[int]) -> list[int]:
    """Share out short pieces between the lines before and after them, where these reach so far.

    The tip of a slanted corner is a few cracks flat: either neighbour could have drawn them.
    """
    index = 0
    while index < len(cuts) and len(cuts) > 3:
        before, start = cuts[index - 1], cuts[index]
        stop, after = cuts[(index + 1) % len(cuts)], cuts[(index + 2) % len(cuts)]
        tip = cracks.between(start, stop)
        shared = None
        if len(tip) <= _LONGEST_TIP and not {start, stop} & cracks.jogs:
            shared = _common_cut(cracks, before, [*tip.tolist(), stop], after)
        if shared is None:
            index += 1
        else:
            cuts = sorted({*cuts, shared} - ({start, stop} - {shared}))
    return cuts


def _common_cut(cracks: _Cracks, before: int, choices: list[int], after: int) -> int | None:
    """The cut of these, middle ones first, that parts [before, after) into two clean lines."""
    count = len(cracks.points)
    # The far ends of both lines may be tips themselves, not yet shared out.
    before = (before + _tip_of((choices[0] - before) % count)) % count
    after = (after - _tip_of((after - choices[-1]) % count)) % count
    for cut in sorted(choices, key=lambda c: abs(choices.index(c) - (len(choices) - 1) / 2)):
        if cracks.is_clean(before, cut) and cracks.is_clean(cut, after):
            return cut
    return None


def _tip_of(length: int) -> int:
    return min(_LONGEST_TIP // 2, length // 4)


def _move_cuts(cracks: _Cracks, cuts: list[int]) -> list[int]:
    """Move each cut to the grid point nearest to where the lines before and after it meet."""
    count = len(cracks.points)
    lines = [cracks.fit(start, stop) for start, stop in _spans(cuts)]
    moved = []
    for index, cut in enumerate(cuts):
        meeting = _meeting(lines[index - 1], lines[index])
        if meeting is None or cut in cracks.jogs:
            moved.append(cut)
            continue
        back = min(_REACH, (cut - cuts[index - 1]) % count - 1)
        forth = min(_REACH, (cuts[(index + 1) % len(cuts)] - cut) % count - 1)
        near = (cut + np.arange(-(back // 2), forth // 2 + 1)) % count
        distances = ((cracks.points[near] - meeting) ** 2).sum(axis=1)
        moved.append(int(near[np.argmin(distances)]))
    return moved


_LONG_RUN = 20
"""Cracks."""

_RUN_AND_END = -0.9
"""Excess of a line along a run with one more crack at an end: good, but not clean."""

_LONGEST_TIP = 8
"""Cracks."""

_REACH = 12
"""A cut moves at most half as many cracks at once."""

_LEAST_SINE = 0.02
"""Lines that turn less than this meet nowhere in particular."""


def _meeting(first: _Line, second: _Line) -> FloatArray | None:
    """Where two lines meet, None for (nearly) parallel ones."""
    normals = np.stack([first.normal, second.normal])
    sine = normals[0, 0] * normals[1, 1] - normals[0, 1] * normals[1, 0]
    if abs(sine) < _LEAST_SINE:
        return None
    x = first.offset * normals[1, 1] - second.offset * normals[0, 1]
    y = normals[0, 0] * second.offset - normals[1, 0] * first.offset
    return np.array([x, y]) / sine


def _corners(outline: IntArray, edges: list[_Edge]) -> FloatArray:
    """Where each edge meets the one before; a short step where they are parallel."""
    corners: list[FloatArray] = []
    for index, edge in enumerate(edges):
        cut = outline[edge.cracks[0]].astype(np.float64)
        before = edges[index - 1].line
        meeting = _meeting(before, edge.line)
        if meeting is not None and np.hypot(*(meeting - cut)) <= _FARTHEST_CORNER_PX:
            corners.append(meeting)
        else:
            corners += [before.nearest(cut), edge.line.nearest(cut)]
    return np.array(corners)


_FARTHEST_CORNER_PX = 4.0
"""Lines that meet farther from the outline than this have a short edge between them."""
