"""Drawing: plan and layout rasters with an exact pixel frame.

A pixel is painted if and only if its centre lies inside the shape; a centre on the shape's left or
upper edge counts as inside. Neither Pillow nor cv2.fillPoly does so (both paint boundary pixels,
half a pixel too fat), and shapely is too slow for training data, so polygons are scan-converted
here by winding numbers. numpy and cv2 only.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.errors import PlanError
from chord_usd.base.scene import palette
from chord_usd.base.scene.palette import Level, Mount
from chord_usd.base.scene.types import (
    CANVAS_PX,
    LEARNED_KINDS,
    ROOM_KINDS,
    WALL_THICKNESS_M,
    BoolArray,
    Box,
    ByteArray,
    FloatArray,
    Item,
    LayoutImage,
    Opening,
    PixelFrame,
    Plan,
    PlanImage,
    Room,
    learned_kind,
)
from chord_usd.base.scene.units import px_from_m, rotation_2d

IntArray = npt.NDArray[np.int64]

FINEST_M_PER_PX = 0.03
COARSEST_M_PER_PX = 0.07
"""The layout model has hardly seen rasters that are finer: a bathroom that fills the canvas is no
bathroom to it. Of held-out houses that are drawn at 0.07, 0.085, 0.1 and 0.135 m it leaves 0, 2, 8
and 24 of a hundred rooms empty. 17 m fill a canvas of CANVAS_PX."""

CANVAS_STEP_PX = 32
LARGEST_CANVAS_PX = 8192

MITRE_LIMIT = 3.0
"""As in geometry.wall_area: a mitred corner reaches at most so many wall thicknesses."""

_FIRST_KIND, _UNSHADED = 64, 255
"""Where rooms overlap by mistake their codes add up to one that stands for nothing: white."""

_KIND_CODES = {kind: _FIRST_KIND + LEARNED_KINDS.index(learned_kind(kind)) for kind in ROOM_KINDS}

_WALL_GREY = palette.category("wall").rgb[0]

_OPENING_RGB = {
    "door": np.array(palette.category("door").rgb, np.uint8),
    "window": np.array(palette.category("window").rgb, np.uint8),
    "passage": np.array(palette.BACKGROUND_RGB, np.uint8),
}

_WALL_BITS = 12
"""Bits for the number of walls over one pixel, so that one sum carries it and the room's code."""

_TIE_PX = 1e-4
"""Openings are drawn this much wider than the wall, so that rounding leaves no sliver of wall."""


# Frames ------------------------------------------------------------------------------------------


def fit_frame(plan: Plan, size_px: int = CANVAS_PX, margin_px: int = 6) -> PixelFrame:
    """The frame in which the whole house, outer walls included, fills a square canvas.

    The house is centred; at least margin_px stay white on every side. Raises PlanError for a plan
    without rooms.
    """
    low, high = _extent_m(plan)
    m_per_px = float((high - low).max()) / (size_px - 2 * margin_px)
    return centred((low + high) / 2, m_per_px, size_px)


def house_frame(plan: Plan, margin_px: int = 6) -> PixelFrame:
    """The frame in which a house is furnished: that of fit_frame, at a scale that serves.

    A single room leaves more of its canvas white, so as not to be finer than FINEST_M_PER_PX. A
    house that would be coarser than COARSEST_M_PER_PX has a canvas larger than CANVAS_PX, by steps
    of CANVAS_STEP_PX. Raises PlanError for a plan without rooms, or one beyond LARGEST_CANVAS_PX.
    """
    low, high = _extent_m(plan)
    fitting = float((high - low).max()) / (CANVAS_PX - 2 * margin_px)
    return frame_at(plan, min(max(fitting, FINEST_M_PER_PX), COARSEST_M_PER_PX), margin_px)


def frame_at(plan: Plan, m_per_px: float, margin_px: int = 6) -> PixelFrame:
    """The frame at this scale in which the whole house lies, centred, CANVAS_PX high or more.

    Raises PlanError for a plan without rooms, or one beyond LARGEST_CANVAS_PX.
    """
    low, high = _extent_m(plan)
    extent_m = float((high - low).max())
    needed_px = extent_m / m_per_px + 2 * margin_px - _TIE_PX
    size_px = max(CANVAS_PX, CANVAS_STEP_PX * math.ceil(needed_px / CANVAS_STEP_PX))
    if size_px > LARGEST_CANVAS_PX:
        raise PlanError(
            f"the plan is {extent_m:.0f} m across",
            expected=f"at most {LARGEST_CANVAS_PX * m_per_px:.0f} m",
            try_="<m_per_px>, if that is not what it is",
        )
    return centred((low + high) / 2, m_per_px, size_px)


def _extent_m(plan: Plan) -> tuple[FloatArray, FloatArray]:
    """(2,) lower left and upper right of the house, outer walls included."""
    if not plan.rooms:
        raise PlanError("the plan has no rooms", expected="at least one room")
    points_m = _wall_outlines(plan.rooms).reshape(-1, 2)
    return points_m.min(axis=0), points_m.max(axis=0)


def centred(middle_m: FloatArray, m_per_px: float, size_px: int) -> PixelFrame:
    """The frame of a square canvas whose middle lies at middle_m (2,)."""
    origin = middle_m - m_per_px * size_px / 2
    return PixelFrame(m_per_px, (float(origin[0]), float(origin[1])), size_px)


# Plans -------------------------------------------------------------------------------------------


def draw_plan(plan: Plan, frame: PixelFrame | None = None, shade: bool = True) -> PlanImage:
    """The plan raster: black walls, coloured doors and windows, rooms in the grey of their kind.

    frame: of a square canvas, fit_frame(plan) by default. shade: False leaves rooms white.
    Openings are painted through the whole wall, and over walls only; a passage is a white gap.
    """
    frame = frame or fit_frame(plan)
    greys = _draw_shell(plan.rooms, frame, shade)
    is_wall = greys == _WALL_GREY
    rgb = np.asarray(cv2.cvtColor(greys, cv2.COLOR_GRAY2RGB), np.uint8)
    _draw_openings(rgb, is_wall, plan.openings, frame)
    rgb.setflags(write=False)
    return PlanImage(rgb, frame)


def _draw_shell(rooms: tuple[Room, ...], frame: PixelFrame, shade: bool) -> ByteArray:
    """(H, W) grey levels of walls and rooms; whatever is not an opening is grey in the palette."""
    if not rooms:
        return np.full((frame.height_px, frame.height_px), palette.BACKGROUND_RGB[0], np.uint8)
    # Both outlines go into one sum: how many walled rooms a pixel lies in, and, above the lowest
    # _WALL_BITS, the code of the room whose floor it is.
    counts = [len(room.polygon_m) for room in rooms]
    kinds = [_KIND_CODES[room.kind] if shade else _UNSHADED for room in rooms]
    weights = np.repeat(np.left_shift(kinds, _WALL_BITS), counts)
    floors = px_from_m(np.concatenate([room.polygon_m for room in rooms]), frame)
    following = _following(counts)
    corners = px_from_m(_wall_outlines(rooms), frame)
    loop = np.concatenate([corners, corners[following, :1]], axis=1)
    starts = np.concatenate([floors, loop[:, :-1].reshape(-1, 2)])
    ends = np.concatenate([floors[following], loop[:, 1:].reshape(-1, 2)])
    weights = np.concatenate([weights, np.ones(len(starts) - len(floors), weights.dtype)])
    sums, lengths = _winding(starts, ends, weights, frame.height_px)
    codes = sums >> _WALL_BITS
    greys = _code_greys().take(codes, mode="clip")
    greys[(codes == 0) & (sums != 0)] = _WALL_GREY
    return _spread(greys, lengths, frame.height_px)


def _following(counts: Sequence[int]) -> IntArray:
    """Index of each corner's successor, for closed polygons stored one after the other."""
    following = np.arange(1, sum(counts) + 1)
    ends = np.cumsum(counts)
    following[ends - 1] = ends - counts
    return following


@lru_cache(maxsize=1)  # a plan's frame is fitted right before the plan is drawn
def _wall_outlines(rooms: tuple[Room, ...]) -> FloatArray:
    """(N, 4, 2) points of the rooms' outlines, grown by a wall's thickness, at each corner.

    N counts the corners of all rooms. At a convex corner they are the end of one grown edge, the
    (cut) mitre and the start of the next; at a reflex corner the outline runs back through the
    corner itself. Such an outline may cross itself, but winds positively round what it covers.
    """
    corners = np.concatenate([room.polygon_m for room in rooms])
    following = _following([len(room.polygon_m) for room in rooms])
    along = corners[following] - corners
    along /= np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-12)[:, None]
    leaving = np.stack([along[:, 1], -along[:, 0]], axis=1)  # outward normals
    arriving = np.empty_like(leaving)
    arriving[following] = leaving
    turn = arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0]
    cosine = arriving[:, 0] * leaving[:, 0] + arriving[:, 1] * leaving[:, 1]
    # Along its own edge's direction the tip lies tan(half the turn) away, in wall thicknesses.
    tangent = turn / np.maximum(1.0 + cosine, 1e-9)
    half = np.sqrt(np.maximum((1.0 + cosine) / 2, 1e-12))  # cosine of half the turn
    sine = np.sqrt(np.maximum((1.0 - cosine) / 2, 1e-12))
    tangent = np.minimum(tangent, (MITRE_LIMIT - half) / sine)
    arriving_along = np.stack([-arriving[:, 1], arriving[:, 0]], axis=1)
    reach = np.where(turn > 0, tangent, 0.0)[:, None] * WALL_THICKNESS_M
    first = corners + arriving * WALL_THICKNESS_M
    last = corners + leaving * WALL_THICKNESS_M
    points = np.stack([first, first + arriving_along * reach, last - along * reach, last], axis=1)
    reflex = turn <= -1e-9
    points[reflex, 1:3] = corners[reflex, None]
    points.setflags(write=False)
    return points


def _winding(
    starts: FloatArray, ends: FloatArray, weights: IntArray, size_px: int
) -> tuple[IntArray, IntArray]:
    """Sums of the weights of all closed outlines, times how often each winds, over the canvas.

    starts, ends: (E, 2) edges in continuous pixels, counter-clockwise in the world. Exact: what
    counts is the pixel's centre. Returns (R,) sums and (R,) lengths of runs of equal pixels, row
    by row from the upper left: there are a hundred times fewer than pixels.
    """
    (x0, y0), (x1, y1) = starts.T, ends.T
    low, high = np.minimum(y0, y1), np.maximum(y0, y1)
    first_row = _pixels(low, size_px)
    counts = _pixels(high, size_px) - first_row
    edges = np.flatnonzero(counts)
    counts = counts[edges]
    x0, y0, x1, y1 = x0[edges], y0[edges], x1[edges], y1[edges]
    slope = (x1 - x0) / (y1 - y0)
    signed = np.where(y1 > y0, weights[edges], -weights[edges])
    skipped = np.cumsum(counts) - counts
    rows = np.arange(counts.sum()) + np.repeat(first_row[edges] - skipped, counts)
    # The reference row is added last, so that vertical edges keep their x to the last bit.
    x = np.repeat(x0, counts) + (rows + 0.5 - np.repeat(y0, counts)) * np.repeat(slope, counts)
    columns = _pixels(x, size_px)
    # Each row's steps sum to zero, so one running sum serves all rows, and steps at a row's right
    # edge may as well be taken at the start of the next.
    steps = rows * size_px + columns
    order = np.argsort(steps)
    bounds = np.concatenate([[0], steps[order], [size_px * size_px]])
    sums = np.concatenate([[0], np.cumsum(np.repeat(signed, counts)[order])])
    return sums, np.diff(bounds)


def _pixels(edges_px: FloatArray, size_px: int) -> IntArray:
    """The first pixel of a row whose centre lies at or beyond each edge; size_px if none does."""
    first: IntArray = np.minimum(np.maximum(np.ceil(edges_px - 0.5), 0), size_px).astype(np.int64)
    return first


def _spread(values: npt.NDArray[Any], lengths: IntArray, size_px: int) -> npt.NDArray[Any]:
    """(size_px, size_px) the canvas from the values of its runs."""
    return np.repeat(values, lengths).reshape(size_px, size_px)


def _draw_openings(
    rgb: ByteArray, is_wall: BoolArray, openings: Sequence[Opening], frame: PixelFrame
) -> None:
    spots = _Spots([opening.box for opening in openings], frame)
    half_widths = np.maximum(spots.widths_px, WALL_THICKNESS_M / frame.m_per_px) / 2 + _TIE_PX
    covered = spots.covered(spots.lengths_px / 2, -half_widths, half_widths)
    for opening, (top, bottom, left, right, inside) in zip(openings, covered, strict=True):
        mask = is_wall[top:bottom, left:right, None]
        mask = mask if inside is None else mask & inside[:, :, None]
        np.copyto(rgb[top:bottom, left:right], _OPENING_RGB[opening.kind], where=mask)


@lru_cache(maxsize=1)
def _code_greys() -> ByteArray:
    """(256,) grey level of each code of a floor."""
    greys = np.full(256, palette.BACKGROUND_RGB[0], np.uint8)
    for kind, code in _KIND_CODES.items():
        greys[code] = palette.ROOM_SHADES[learned_kind(kind)][0]
    return greys


def room_pixels(room: Room, frame: PixelFrame) -> BoolArray:
    """(H, W) pixels whose centres lie in a room's floor, whatever stands on it."""
    corners = px_from_m(room.polygon_m, frame)
    weights = np.ones(len(corners), np.int64)
    sums, lengths = _winding(corners, np.roll(corners, -1, axis=0), weights, frame.height_px)
    return _spread(sums != 0, lengths, frame.height_px)


# Items -------------------------------------------------------------------------------------------

_MOUNTS = (Mount.UNDERFOOT, Mount.FLOOR, Mount.WALL)
_MOUNT_ORDER = {
    row.name: _MOUNTS.index(row.mount)
    for row in palette.CATEGORIES.values()
    if row.mount in _MOUNTS
}


def draw_items(
    items: Iterable[Item], frame: PixelFrame, level: Level = Level.HOUSE
) -> tuple[ByteArray, BoolArray]:
    """What stands where: labels (H, W) and front marks (H, W).

    A label is 0 for nothing, else 1 + the detector class of the topmost item; items of other
    levels are passed over, children too. Painted underfoot first, then larger before smaller,
    wall-hung last. Anything thinner than a pixel is drawn one pixel thick, growing towards its
    front, away from the wall behind it. A front mark covers the middle of the front edge, at least
    one pixel of it.
    """
    rows = [(palette.category(item.category), item.box) for item in items]
    rows = sorted((row for row in rows if row[0].level is level), key=_painting_order)
    spots = _Spots([box for _, box in rows], frame)
    half_lengths = np.maximum(spots.lengths_px, 1.0) / 2
    backs = spots.widths_px / 2
    widths = np.maximum(spots.widths_px, 1.0)
    bodies = spots.covered(half_lengths, backs - widths, backs)
    half_marks = np.maximum(palette.FRONT_MARK_LENGTH * half_lengths, 0.5)
    marks_to = backs - widths + np.maximum(palette.FRONT_MARK_WIDTH * widths, 1.0)
    marks = spots.covered(half_marks, backs - widths, marks_to)
    # One array holds both, the front mark in its lowest bit: marks go with what they are on.
    codes = np.zeros((frame.height_px, frame.height_px), np.uint8)
    for (row, _), body, mark in zip(rows, bodies, marks, strict=True):
        code = 2 * (row.detector_class + 1)
        _fill(codes, body, code)
        _fill(codes, mark, code + 1)
    labels: ByteArray = codes >> np.uint8(1)
    return labels, (codes & 1).astype(np.bool_)


def taken_pixels(items: Iterable[Item], frame: PixelFrame) -> BoolArray:
    """(H, W) pixels that these items are drawn on, and those beside them."""
    taken = draw_items(items, frame)[0] > 0
    cross = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
    return cv2.dilate(taken.astype(np.uint8), cross).astype(bool)


def _painting_order(row: tuple[palette.Category, Box]) -> tuple[int, float]:
    category, box = row
    return _MOUNT_ORDER[category.name], -box.size_m[0] * box.size_m[1]


Covered = tuple[int, int, int, int, BoolArray | None]
"""First row and last + 1, first column and last + 1 of a window of the canvas, and which of its
pixels are meant; None for all of them."""


def _fill(array: ByteArray, covered: Covered, value: int) -> None:
    top, bottom, left, right, inside = covered
    if inside is None:
        array[top:bottom, left:right] = value
    else:
        array[top:bottom, left:right][inside] = value


class _Spots:
    """Oriented places on the canvas, all of a house at once."""

    def __init__(self, boxes: Sequence[Box], frame: PixelFrame) -> None:
        numbers = [(*box.center_m[:2], *box.size_m[:2], *_cos_sin(box.yaw_deg)) for box in boxes]
        x_m, y_m, lengths_m, widths_m, cos, sin = np.array(numbers).reshape(-1, 6).T
        self._x = (x_m - frame.origin_m[0]) / frame.m_per_px
        self._y = frame.height_px - (y_m - frame.origin_m[1]) / frame.m_per_px
        self._cos, self._sin = cos, sin
        self._size_px = frame.height_px
        self.lengths_px = lengths_m / frame.m_per_px
        self.widths_px = widths_m / frame.m_per_px

    def covered(
        self, half_lengths: FloatArray, widths_from: FloatArray, widths_to: FloatArray
    ) -> list[Covered]:
        """Of each spot, the pixels whose centres lie at most so far along, in [from, to) across.

        (N,) pixels: half lengths from the middle along own x, and spans of own y.
        """
        # Own x points to (cos, -sin) on the canvas, own y to (-sin, -cos): image y is down.
        cos, sin = self._cos, self._sin
        half_x, half_y = np.abs(cos) * half_lengths, np.abs(sin) * half_lengths
        x_from, x_to = sin * widths_from, sin * widths_to
        y_from, y_to = cos * widths_from, cos * widths_to
        corners = np.array([
            self._y + (-half_y - np.maximum(y_from, y_to)),
            self._y + (half_y - np.minimum(y_from, y_to)),
            self._x + (-half_x - np.maximum(x_from, x_to)),
            self._x + (half_x - np.minimum(x_from, x_to)),
        ])  # fmt: skip
        windows = _pixels(corners, self._size_px).T.tolist()
        covered: list[Covered] = [(*window, None) for window in windows]
        for i in np.flatnonzero((cos != 0.0) & (sin != 0.0)).tolist():
            inside = self._inside(i, covered[i], half_lengths[i], widths_from[i], widths_to[i])
            covered[i] = (*covered[i][:4], inside)
        return covered

    def _inside(
        self, index: int, window: Covered, half_length: float, width_from: float, width_to: float
    ) -> BoolArray:
        """Which pixels of a slanted spot's window lie in it."""
        top, bottom, left, right, _ = window
        cos, sin = self._cos[index], self._sin[index]
        x = np.arange(left, right) + (0.5 - self._x[index])
        y = (np.arange(top, bottom) + (0.5 - self._y[index]))[:, None]
        along, across = cos * x - sin * y, -sin * x - cos * y
        inside = (along >= -half_length) & (along < half_length)
        inside &= (across >= width_from) & (across < width_to)
        return np.asarray(inside, np.bool_)


@lru_cache(maxsize=4096)
def _cos_sin(yaw_deg: float) -> tuple[float, float]:
    turn = rotation_2d(yaw_deg)
    return float(turn[0, 0]), float(turn[1, 0])


# Layouts -----------------------------------------------------------------------------------------


def paint_layout(
    plan_image: PlanImage, labels: ByteArray, front: BoolArray, level: Level = Level.HOUSE
) -> ByteArray:
    """(H, W, 3) the plan raster with items painted over it at palette.ITEM_OPACITY.

    labels, front: as from draw_items. Front marks are black at palette.FRONT_MARK_OPACITY over the
    painted item. Pixels of label 0 stay as they are.
    """
    rgb = plan_image.rgb.copy()
    pixels = np.flatnonzero(labels != 0)
    kinds = (2 * labels + front).reshape(-1)[pixels].astype(np.intp)
    # Channel by channel: arrays that stay in the cache are several times faster.
    for channel, table in zip(rgb.reshape(-1, 3).T, _paint_table(level), strict=True):
        channel[pixels] = table.take(256 * kinds + channel[pixels])
    return rgb


def layout_image(
    plan_image: PlanImage, items: Iterable[Item], level: Level = Level.HOUSE
) -> LayoutImage:
    """The layout raster of these items over this plan raster."""
    labels, front = draw_items(items, plan_image.frame, level)
    rgb = paint_layout(plan_image, labels, front, level)
    rgb.setflags(write=False)
    return LayoutImage(rgb, plan_image.frame)


@lru_cache(maxsize=2)
def _paint_table(level: Level) -> ByteArray:
    """(3, labels * 2 * 256) painted value by channel; by label, front mark and the value below.

    Holds what palette.painted gives for every grey value.
    """
    rows = [row for row in palette.CATEGORIES.values() if row.level is level]
    table = np.empty((3, 1 + max(row.detector_class for row in rows) + 1, 2, 256), np.uint8)
    base = np.arange(256, dtype=np.float64)
    table[:, 0] = base
    for row in rows:
        top = np.array(row.rgb, dtype=np.float64)[:, None]
        item = np.rint((1.0 - palette.ITEM_OPACITY) * base + palette.ITEM_OPACITY * top)
        mark = np.rint((1.0 - palette.FRONT_MARK_OPACITY) * item)
        table[:, row.detector_class + 1] = np.stack([item, mark], axis=1)
    return table.reshape(3, -1)
