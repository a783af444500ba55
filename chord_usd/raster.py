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

from chord_usd import palette
from chord_usd.errors import PlanError
from chord_usd.palette import Level, Mount
from chord_usd.types import (
    CANVAS_PX,
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
)
from chord_usd.units import px_from_m, rotation_2d

IntArray = npt.NDArray[np.int64]

MITRE_LIMIT = 3.0
"""As in geometry.wall_area: a mitred corner reaches at most so many wall thicknesses."""

_BLANK, _WALL, _DOOR, _WINDOW, _FIRST_KIND, _UNSHADED = 0, 1, 2, 3, 64, 255
"""Where rooms overlap by mistake their codes add up to one that stands for nothing: white."""

_OPENING_CODES = {"door": _DOOR, "window": _WINDOW, "passage": _BLANK}
_KIND_CODES = {kind: _FIRST_KIND + index for index, kind in enumerate(ROOM_KINDS)}

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
    if not plan.rooms:
        raise PlanError("the plan has no rooms", expected="at least one room")
    points_m = np.concatenate(_wall_outlines(plan.rooms, WALL_THICKNESS_M))
    low, high = points_m.min(axis=0), points_m.max(axis=0)
    m_per_px = float((high - low).max()) / (size_px - 2 * margin_px)
    origin = (low + high) / 2 - m_per_px * size_px / 2
    return PixelFrame(m_per_px, (float(origin[0]), float(origin[1])), size_px)


# Plans -------------------------------------------------------------------------------------------


def draw_plan(plan: Plan, frame: PixelFrame | None = None, shade: bool = True) -> PlanImage:
    """The plan raster: black walls, coloured doors and windows, rooms in the grey of their kind.

    frame: of a square canvas, fit_frame(plan) by default. shade: False leaves rooms white.
    Openings are painted through the whole wall, and over walls only; a passage is a white gap.
    """
    frame = frame or fit_frame(plan)
    codes = _draw_shell(plan.rooms, frame, shade)
    is_wall = codes == _WALL
    for opening in plan.openings:
        _draw_opening(codes, is_wall, opening, frame)
    rgb = np.asarray(cv2.LUT(cv2.cvtColor(codes, cv2.COLOR_GRAY2RGB), _plan_colors()), np.uint8)
    rgb.setflags(write=False)
    return PlanImage(rgb, frame)


def _draw_shell(rooms: Sequence[Room], frame: PixelFrame, shade: bool) -> ByteArray:
    """(H, W) codes of walls and rooms."""
    if not rooms:
        return np.full((frame.height_px, frame.height_px), _BLANK, np.uint8)
    # Both outlines go into one sum: how many walled rooms a pixel lies in, and, above the lowest
    # _WALL_BITS, the code of the room whose floor it is.
    counts = [len(room.polygon_m) for room in rooms]
    kinds = [_KIND_CODES[room.kind] if shade else _UNSHADED for room in rooms]
    weights = np.repeat(np.left_shift(kinds, _WALL_BITS), counts)
    floors = px_from_m(np.concatenate([room.polygon_m for room in rooms]), frame)
    following = _following(counts)
    corners = px_from_m(np.stack(_wall_outlines(rooms, WALL_THICKNESS_M), axis=1), frame)
    loop = np.concatenate([corners, corners[following, :1]], axis=1)
    starts = np.concatenate([floors, loop[:, :-1].reshape(-1, 2)])
    ends = np.concatenate([floors[following], loop[:, 1:].reshape(-1, 2)])
    weights = np.concatenate([weights, np.ones(len(starts) - len(floors), weights.dtype)])
    sums = _winding(starts, ends, weights, frame.height_px)
    floor_codes = sums >> _WALL_BITS
    codes = np.minimum(floor_codes, _UNSHADED).astype(np.uint8)
    codes[(floor_codes == 0) & (sums != 0)] = _WALL
    return codes


def _following(counts: Sequence[int]) -> IntArray:
    """Index of each corner's successor, for closed polygons stored one after the other."""
    following = np.arange(1, sum(counts) + 1)
    ends = np.cumsum(counts)
    following[ends - 1] = ends - counts
    return following


def _wall_outlines(rooms: Sequence[Room], thickness_m: float) -> list[FloatArray]:
    """Four (N, 2) arrays: the points of the rooms' outlines, grown by thickness_m, at each corner.

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
    cosine = (arriving * leaving).sum(axis=1)
    # Along its own edge's direction the tip lies tan(half the turn) away, in wall thicknesses.
    tangent = turn / np.maximum(1.0 + cosine, 1e-9)
    half = np.sqrt(np.maximum((1.0 + cosine) / 2, 1e-12))  # cosine of half the turn
    sine = np.sqrt(np.maximum((1.0 - cosine) / 2, 1e-12))
    tangent = np.minimum(tangent, (MITRE_LIMIT - half) / sine)
    arriving_along = np.stack([-arriving[:, 1], arriving[:, 0]], axis=1)
    reach = np.where(turn > 0, tangent, 0.0)[:, None] * thickness_m
    first = corners + arriving * thickness_m
    last = corners + leaving * thickness_m
    convex = (turn > -1e-9)[:, None]
    return [
        first,
        np.where(convex, first + arriving_along * reach, corners),
        np.where(convex, last - along * reach, corners),
        last,
    ]


def _winding(
    starts: FloatArray, ends: FloatArray, weights: IntArray, size_px: int
) -> npt.NDArray[np.int32]:
    """(size_px, size_px) sum of the weights of all closed outlines, times how often each winds.

    starts, ends: (E, 2) edges in continuous pixels, counter-clockwise in the world. Exact: what
    counts is the pixel's centre.
    """
    (x0, y0), (x1, y1) = starts.T, ends.T
    low, high = np.minimum(y0, y1), np.maximum(y0, y1)
    first_row = np.clip(np.ceil(low - 0.5), 0, size_px).astype(np.int64)
    counts = np.clip(np.ceil(high - 0.5), 0, size_px).astype(np.int64) - first_row
    edges = np.flatnonzero(counts)
    counts = counts[edges]
    x0, y0, x1, y1 = x0[edges], y0[edges], x1[edges], y1[edges]
    slope = (x1 - x0) / (y1 - y0)
    signed = np.where(y1 > y0, weights[edges], -weights[edges])
    skipped = np.cumsum(counts) - counts
    rows = np.arange(counts.sum()) + np.repeat(first_row[edges] - skipped, counts)
    # The reference row is added last, so that vertical edges keep their x to the last bit.
    x = np.repeat(x0, counts) + (rows + 0.5 - np.repeat(y0, counts)) * np.repeat(slope, counts)
    columns = np.clip(np.ceil(x - 0.5), 0, size_px).astype(np.int64)
    steps = np.bincount(
        rows * (size_px + 1) + columns,
        weights=np.repeat(signed, counts),
        minlength=size_px * (size_px + 1),
    )
    # Each row's steps sum to zero, so one running sum over the whole canvas serves all rows.
    total = np.cumsum(steps.astype(np.int32), dtype=np.int32)
    return total.reshape(size_px, size_px + 1)[:, :size_px]


def _draw_opening(
    codes: ByteArray, is_wall: BoolArray, opening: Opening, frame: PixelFrame
) -> None:
    half_length = opening.box.size_m[0] / frame.m_per_px / 2
    half_width = max(opening.box.size_m[1], WALL_THICKNESS_M) / frame.m_per_px / 2 + _TIE_PX
    spot = _Spot.on(opening.box, frame)
    window, inside = spot.covered((-half_length, half_length), (-half_width, half_width))
    mask = is_wall[window] if inside is None else is_wall[window] & inside
    codes[window][mask] = _OPENING_CODES[opening.kind]


@lru_cache(maxsize=1)
def _plan_colors() -> ByteArray:
    """(1, 256, 3) colour of each code."""
    colors = np.empty((1, 256, 3), np.uint8)
    colors[:] = palette.BACKGROUND_RGB
    for name, code in (("wall", _WALL), ("door", _DOOR), ("window", _WINDOW)):
        colors[0, code] = palette.category(name).rgb
    for kind, code in _KIND_CODES.items():
        colors[0, code] = palette.ROOM_SHADES[kind]
    return colors


def room_pixels(room: Room, frame: PixelFrame) -> BoolArray:
    """(H, W) pixels whose centres lie in a room's floor, whatever stands on it."""
    corners = px_from_m(room.polygon_m, frame)
    weights = np.ones(len(corners), np.int64)
    winding = _winding(corners, np.roll(corners, -1, axis=0), weights, frame.height_px)
    return np.asarray(winding != 0, np.bool_)


# Items -------------------------------------------------------------------------------------------

_MOUNT_ORDER = {Mount.UNDERFOOT: 0, Mount.FLOOR: 1, Mount.WALL: 2}


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
    labels = np.zeros((frame.height_px, frame.height_px), np.uint8)
    front = np.zeros(labels.shape, np.bool_)
    for item in sorted(items, key=_painting_order):
        row = palette.category(item.category)
        if row.level is level:
            _draw_item(labels, front, item.box, row.detector_class + 1, frame)
    return labels, front


def _painting_order(item: Item) -> tuple[int, float]:
    mount = palette.category(item.category).mount
    return _MOUNT_ORDER[mount], -item.box.size_m[0] * item.box.size_m[1]


def _draw_item(
    labels: ByteArray, front: BoolArray, box: Box, label: int, frame: PixelFrame
) -> None:
    spot = _Spot.on(box, frame)
    half_length = max(box.size_m[0] / frame.m_per_px, 1.0) / 2
    back = box.size_m[1] / frame.m_per_px / 2
    width = max(2 * back, 1.0)
    window, inside = spot.covered((-half_length, half_length), (back - width, back))
    _fill(labels, window, inside, label)
    _fill(front, window, inside, False)
    half_mark = max(palette.FRONT_MARK_LENGTH * half_length, 0.5)
    mark_width = max(palette.FRONT_MARK_WIDTH * width, 1.0)
    span = (back - width, back - width + mark_width)
    _fill(front, *spot.covered((-half_mark, half_mark), span), True)


def _fill(
    array: npt.NDArray[Any], window: tuple[slice, slice], inside: BoolArray | None, value: int
) -> None:
    if inside is None:
        array[window] = value
    else:
        array[window][inside] = value


class _Spot:
    """An oriented place on the canvas. Plain floats: arrays of two are slower than the painting."""

    def __init__(self, x: float, y: float, cos: float, sin: float, size_px: int) -> None:
        self._x, self._y, self._cos, self._sin, self._size_px = x, y, cos, sin, size_px

    @classmethod
    def on(cls, box: Box, frame: PixelFrame) -> _Spot:
        x = (box.center_m[0] - frame.origin_m[0]) / frame.m_per_px
        y = frame.height_px - (box.center_m[1] - frame.origin_m[1]) / frame.m_per_px
        return cls(x, y, *_cos_sin(box.yaw_deg), frame.height_px)

    def covered(
        self, own_x: tuple[float, float], own_y: tuple[float, float]
    ) -> tuple[tuple[slice, slice], BoolArray | None]:
        """Pixels whose centres lie within these spans (from, to) of the own axes, in pixels.

        Returns a window of the canvas and which of its pixels they are, None for all of them.
        """
        # Own x points to (cos, -sin) on the canvas, own y to (-sin, -cos): image y is down.
        cos, sin = self._cos, self._sin
        right = [cos * a - sin * b for a in own_x for b in own_y]
        down = [-sin * a - cos * b for a in own_x for b in own_y]
        columns = self._pixels(self._x + min(right), self._x + max(right))
        rows = self._pixels(self._y + min(down), self._y + max(down))
        if cos == 0.0 or sin == 0.0:
            return (rows, columns), None
        x = np.arange(columns.start, columns.stop) + (0.5 - self._x)
        y = (np.arange(rows.start, rows.stop) + (0.5 - self._y))[:, None]
        along, across = cos * x - sin * y, -sin * x - cos * y
        inside = (along >= own_x[0]) & (along < own_x[1])
        inside &= (across >= own_y[0]) & (across < own_y[1])
        return (rows, columns), inside

    def _pixels(self, low: float, high: float) -> slice:
        """Pixels whose centres lie in [low, high), clipped to the canvas."""
        first = min(max(math.ceil(low - 0.5), 0), self._size_px)
        return slice(first, min(max(math.ceil(high - 0.5), first), self._size_px))


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
    pixels = np.flatnonzero(labels)
    flat = rgb.reshape(-1, 3)
    kind = 2 * labels.reshape(-1)[pixels].astype(np.intp) + front.reshape(-1)[pixels]
    base = flat[pixels].astype(np.intp)
    index = (kind[:, None] * 3 + np.arange(3)) * 256 + base
    flat[pixels] = _paint_table(level).take(index)
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
    """(2 * labels * 3 * 256,) painted value by label, front mark, channel and the value below.

    Holds what palette.painted gives for every grey value.
    """
    rows = [row for row in palette.CATEGORIES.values() if row.level is level]
    table = np.empty((1 + max(row.detector_class for row in rows) + 1, 2, 3, 256), np.uint8)
    base = np.arange(256, dtype=np.float64)
    table[0] = base
    for row in rows:
        top = np.array(row.rgb, dtype=np.float64)[:, None]
        item = np.rint((1.0 - palette.ITEM_OPACITY) * base + palette.ITEM_OPACITY * top)
        mark = np.rint((1.0 - palette.FRONT_MARK_OPACITY) * item)
        table[row.detector_class + 1] = item, mark
    return table.reshape(-1)
