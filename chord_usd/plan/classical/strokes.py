"""Where the walls are in a drawing: its thick dark strokes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.plan.classical.bodies import filled_bodies
from chord_usd.plan.sheet import FAINTEST_INK, brightness_of
from chord_usd.scene.types import BoolArray, ByteArray, FloatArray

_DARKNESS = (0.45, 0.65, 0.8)
"""Shares of the paper's brightness below which a pixel may be wall, tried in turn."""

_FLAT_COLORS = 6
_COLOR_STEP = 16
_LEAST_COLOR_SHARE = 0.004
_LEAST_CHROMA = 60
"""Walls may have one flat colour: vivid, and one of the most frequent of these in the picture."""

_SAME_COLOR = 28
"""Levels by which JPEG changes a flat colour."""

_BLOTCHED_COLOR, _BLOTCH_PX = 64, 2
"""And beside another colour, whose tint it shares over blocks of pixels: levels, and how far."""

_RIM_PX = (0, 1, 2)
"""By so much thicker than at the first threshold fine lines are at each."""

_WIDEST_LINE = 0.008
_LEAST_WINDOW_PX = 9
"""Lines are thinner than both, as a share of the picture and in pixels."""

_LEAST_FILLED = 0.01
"""Share of the picture from which floors and walls are filled with something light."""

_EDGE = 0.006
"""Share of the picture's shorter side that is passed over along its edges."""

_LEAST_WALL_PX = 2
_LONGEST_RUN_PX = 200

_ELONGATED = 4.0
"""A stroke is at least so many times as long as thick."""

_THINNEST_WALL = 0.35
"""Inner walls are at least this share of the usual wall's thickness."""

_THINNEST_IN_BLUR, _BLUR_PX = 0.5, 4
_THINNEST_IF_SOFT, _SOFT_PX = 0.6, 6
"""Where walls are but a few pixels thick, blur makes lines half as thick: share of the wall's
thickness, and pixels."""

_SHORTEST_WALL = 2.5
"""Loose pieces shorter than so many thicknesses are symbols or letters, unless they are piers."""

_FINEST_LINE = 0.009
_BOLDEST_LINE_PX = 7.0
"""A drawing's walls are single lines if they are thinner than both: this share of it, and this."""

_WALL_SHARE = 0.018
"""What a wall measures in a usual dwelling, as a share of the side of a square as large."""

_FRAME_FILLED = 0.97
_WITHIN_FRAME = 0.5
_HOLLOW = 0.92
_FRAME_MARGIN = 0.08
"""A frame is a bare rectangle near the sheet's edge, round what measures such a share of it; the
outer face of a hollow wall lies closer to the inner one."""

_TALLEST_TEXT = 0.08
"""Taller lines of text, as a share of the picture, are walls that look like letters."""

_SOFT = 0.75
"""In a blurred picture neighbouring pixels at the edges of walls differ by less of the contrast."""

_LINE_SHARE = 0.75
"""Walls drawn as single lines are all about as bold as the usual one."""

_LONGEST_LETTERS = 2.0
"""Letters that touch are no longer than so many wall thicknesses; a door's leaf is."""

_LETTER_SHARE = 0.3
"""A piece of which less than this lies outside of lines of text is a letter."""

_SHORTEST_PIER = 0.75
_PIER_FILL = 0.8
"""What is left of a wall between two openings fills its bounds; a basin does not."""


@dataclass(frozen=True, eq=False)
class Strokes:
    """A drawing's ink, sorted. Arrays (H, W)."""

    ink: BoolArray
    """Everything drawn."""
    fine: BoolArray
    """Lines alone: darker than the paper or the coloured floor that they are drawn on."""
    wall: BoolArray
    """Thick strokes only."""
    thickness_px: float
    """Of the usual wall."""

    letters: BoolArray
    """What lies in a line of text."""
    lines: BoolArray | None = None
    """Walls that are drawn as single lines, as in a sketch, as they are; wall and thickness are as
    if they were drawn to scale in a usual dwelling."""

    @property
    def are_lines(self) -> bool:
        """Whether walls are drawn as single lines."""
        return self.lines is not None

    @property
    def thin(self) -> BoolArray:
        """Ink that is no wall: door leaves, window panes, furniture."""
        near_wall = cv2.dilate(self.wall.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
        thin = self.fine & ~near_wall
        # A door's leaf may run through a name; letters end where the name ends.
        count, labels, stats, _ = cv2.connectedComponentsWithStats(
            thin.astype(np.uint8), connectivity=8
        )
        within = np.bincount(labels[self.letters], minlength=count)
        is_letter = within > (1.0 - _LETTER_SHARE) * stats[:, cv2.CC_STAT_AREA]
        is_letter &= stats[:, 2:4].max(axis=1) < _LONGEST_LETTERS * self.thickness_px
        return thin & ~np.asarray(is_letter)[labels]


def find_strokes(rgb: ByteArray, texts_px: Sequence[FloatArray] = ()) -> Iterator[Strokes]:
    """Ways to tell walls from the rest in a drawing on light paper (H, W, 3), the strictest first.

    texts_px: (4, 2) corners of each line of text: what lies in one is no wall.
    """
    brightness = brightness_of(rgb)
    # A frame along the picture's edge is no part of the plan.
    edge = max(3, round(_EDGE * min(brightness.shape)))
    brightness = np.pad(brightness[edge:-edge, edge:-edge], edge, constant_values=1.0)
    ink = brightness < FAINTEST_INK
    brightness[_frames(ink)] = 1.0
    ink = brightness < FAINTEST_INK
    drawn = _Drawn(ink, ink & _fine_lines(brightness), _boxes(ink.shape, texts_px))
    soft = _is_soft(brightness)
    for share, rim_px in zip(_DARKNESS, _RIM_PX, strict=True):
        yield from _strokes_of(brightness < share, drawn, soft=soft, rim_px=rim_px)
    for colored in _flat_colors(rgb):
        # With the dark lines that such a wall is drawn between.
        faces = drawn.fine & (cv2.dilate(colored, np.ones((3, 3), np.uint8)) > 0)
        yield from _strokes_of((colored > 0) | faces, drawn)
    outlined = drawn.fine | (brightness < _DARKNESS[0])
    for faces in [ink, outlined] if (ink & ~outlined).mean() > _LEAST_FILLED else [ink]:
        for bodies in filled_bodies(faces):
            yield from _strokes_of(bodies, drawn)


@dataclass(frozen=True, eq=False)
class _Drawn:
    """What every way to tell walls needs. Arrays (H, W), see Strokes."""

    ink: BoolArray
    fine: BoolArray
    letters: BoolArray


def _fine_lines(brightness: FloatArray) -> BoolArray:
    """(H, W) what is darker than all that lies round it, as lines are on a floor of any colour."""
    side = max(round(_WIDEST_LINE * max(brightness.shape)) | 1, _LEAST_WINDOW_PX)
    grey = brightness.astype(np.float32)
    ground = cv2.morphologyEx(grey, cv2.MORPH_CLOSE, np.ones((side, side), np.uint8))
    return np.asarray(grey < FAINTEST_INK * ground)


def _flat_colors(rgb: ByteArray) -> Iterator[ByteArray]:
    """(H, W) not 0 where each of the picture's vivid flat colours is."""
    codes = (rgb // _COLOR_STEP).astype(np.int32) @ np.array([256, 16, 1])
    counts = np.bincount(codes.ravel(), minlength=4096)
    order = np.argsort(-counts)
    often = order[counts[order] > _LEAST_COLOR_SHARE * codes.size]
    colors = np.stack([often // 256, often // 16 % 16, often % 16], axis=1) * _COLOR_STEP
    found: list[FloatArray] = []
    for code in often[np.ptp(colors, axis=1) >= _LEAST_CHROMA]:
        color = rgb[codes == code].mean(axis=0)
        if all(np.abs(color - other).max() > _SAME_COLOR for other in found):
            found.append(color)
            yield _blotched(rgb, color, colors + _COLOR_STEP / 2)
        if len(found) == _FLAT_COLORS:
            return


def _blotched(rgb: ByteArray, color: FloatArray, others: FloatArray) -> ByteArray:
    """(H, W) not 0 where a flat colour is, with what JPEG made of it beside other colours."""
    low, high = color - _SAME_COLOR, color + _SAME_COLOR
    sure = np.asarray(cv2.inRange(rgb, low, high), np.uint8)
    wide = cv2.inRange(rgb, color - _BLOTCHED_COLOR, color + _BLOTCHED_COLOR)
    beside = cv2.dilate(sure, np.ones((2 * _BLOTCH_PX + 1,) * 2, np.uint8))
    rows, columns = np.nonzero((wide > 0) & (beside > 0) & (sure == 0))
    pixels = rgb[rows, columns].astype(np.float64)
    apart = others[np.abs(others - color).max(axis=1) > _SAME_COLOR]
    off = np.abs(pixels - color).max(axis=1)
    nearer = [np.abs(pixels - other).max(axis=1) > off for other in apart]
    own = np.all(nearer, axis=0) if nearer else np.ones(len(pixels), bool)
    sure[rows[own], columns[own]] = 255
    return sure


def _boxes(shape: tuple[int, ...], corners_px: Sequence[FloatArray]) -> BoolArray:
    """(H, W) what lies in one of these boxes, but for the tallest."""
    canvas = np.zeros(shape, np.uint8)
    for corners in corners_px:
        edges = np.roll(corners, -1, axis=0)[:2] - corners[:2]
        if np.hypot(edges[:, 0], edges[:, 1]).min() > _TALLEST_TEXT * max(shape):
            continue
        cv2.fillConvexPoly(canvas, np.rint(corners - 0.5).astype(np.int32), (1.0,))
    return canvas > 0


def _frames(ink: BoolArray) -> BoolArray:
    """(H, W) bare rectangles round everything else, as sheets have."""
    frames = np.zeros(ink.shape, bool)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(ink.astype(np.uint8), connectivity=8)
    ends = stats[:, :2] + stats[:, 2:4]
    for label in np.argsort(-stats[1:, 2:4].sum(axis=1))[:4] + 1 if count > 1 else ():
        left, top, width, height = (int(v) for v in stats[label, :4])
        within = (stats[:, :2] > (left, top)).all(axis=1) & (ends < ends[label]).all(axis=1)
        if not within.any() or max(left, top) > _FRAME_MARGIN * max(ink.shape):
            continue
        content = ends[within].max(axis=0) - stats[within, :2].min(axis=0)
        largest = stats[within, 2:4].max(axis=0)
        if (content < _WITHIN_FRAME * stats[label, 2:4]).any():
            continue
        if (largest > _HOLLOW * stats[label, 2:4]).all():
            continue
        own = labels[top : top + height, left : left + width] == label
        _, _, holes, _ = cv2.connectedComponentsWithStats((~own).astype(np.uint8), connectivity=4)
        hole = holes[1:, cv2.CC_STAT_AREA].max(initial=0)
        if hole + own.sum() >= _FRAME_FILLED * width * height:
            frames[top : top + height, left : left + width] |= own
    return frames


def _strokes_of(
    dark: BoolArray, drawn: _Drawn, *, soft: bool = False, rim_px: int = 0
) -> Iterator[Strokes]:
    """The thick strokes among dark pixels, if there are any."""
    thickness_px = _wall_thickness(dark)
    if thickness_px is None:
        return
    letters = drawn.letters
    wall = _thick_parts(dark, thickness_px, soft=soft, rim_px=rim_px)
    sides_px = _extent(wall)
    lines = None
    if thickness_px < min(_BOLDEST_LINE_PX, _FINEST_LINE * max(sides_px)):
        lines = _bold_lines(dark, thickness_px)
        thickness_px = max(thickness_px, _WALL_SHARE * math.sqrt(sides_px[0] * sides_px[1]))
        lines = _without_specks(lines, letters, thickness_px / 2)
        wall = _thickened(lines, thickness_px)
    else:
        wall = _without_specks(wall, letters, thickness_px)
    if wall.any():
        yield Strokes(drawn.ink, drawn.fine, wall, thickness_px, letters, lines)


def _bold_lines(dark: BoolArray, thickness_px: float) -> BoolArray:
    """Lines about this bold, in any direction."""
    side = max(math.ceil(_LINE_SHARE * thickness_px - 0.25), _LEAST_WALL_PX)
    shapes = [
        cv2.getStructuringElement(how, (side, side)) for how in (cv2.MORPH_RECT, cv2.MORPH_CROSS)
    ]
    image = dark.astype(np.uint8)
    return np.any([cv2.morphologyEx(image, cv2.MORPH_OPEN, shape) > 0 for shape in shapes], axis=0)


def _is_soft(brightness: FloatArray) -> bool:
    """Whether the edges of what is dark are blurred, as in a photograph."""
    grey = brightness.astype(np.float32)
    steps = cv2.dilate(grey, np.ones((3, 3), np.uint8)) - cv2.erode(grey, np.ones((3, 3), np.uint8))
    # Lines are thinner than their own blur: the steps at the thickest ink tell.
    dark = grey < _DARKNESS[0]
    core = cv2.erode(dark.astype(np.uint8), np.ones((3, 3), np.uint8))
    rim = dark & (cv2.dilate(core, np.ones((5, 5), np.uint8)) > 0) & (core == 0)
    if not rim.any() or not core.any():
        return False
    contrast = 1.0 - float(np.median(grey[core > 0]))
    return float(np.median(steps[rim])) < _SOFT * contrast


def _run_lengths(ink: BoolArray) -> npt.NDArray[np.int64]:
    """(N,) of each of the N pixels of ink, row by row: the length of the run that it is in."""
    flat = np.zeros(ink.shape[0] * (ink.shape[1] + 1) + 1, bool)
    flat[1:].reshape(ink.shape[0], -1)[:, :-1] = ink
    edges = np.flatnonzero(flat[1:] != flat[:-1])
    lengths = edges[1::2] - edges[::2]
    return np.repeat(lengths, lengths)


def _wall_thickness(ink: BoolArray) -> float | None:
    """Thickness in pixels of the strokes that carry the drawing; None if there are no strokes."""
    across, upright = _run_lengths(ink), np.zeros(ink.shape[::-1], np.int64)
    upright[ink.T] = _run_lengths(ink.T)
    down = upright.T[ink]
    thick, long = np.minimum(across, down), np.maximum(across, down)
    is_stroke = (thick >= _LEAST_WALL_PX) & (long >= _ELONGATED * thick)
    counts = np.bincount(np.minimum(thick[is_stroke], _LONGEST_RUN_PX))
    if counts.sum() < max(ink.shape):
        return None
    # Walls are few but thick: every pixel counts as often as its stroke is thick.
    smooth = np.convolve(counts * np.arange(len(counts)), [0.5, 1.0, 0.5], mode="same")
    peak = int(np.argmax(smooth))
    near = np.arange(max(peak - 1, 0), min(peak + 2, len(counts)))
    return float(np.average(near, weights=counts[near] + 1e-9))


def _thick_parts(
    ink: BoolArray, thickness_px: float, *, soft: bool, rim_px: int = 0
) -> BoolArray:  # fmt: skip
    """Ink at least as thick as an inner wall."""
    share, most_px = (_THINNEST_IF_SOFT, _SOFT_PX) if soft else (_THINNEST_IN_BLUR, _BLUR_PX)
    blurred = min(round(share * thickness_px), most_px)
    thinnest = round(_THINNEST_WALL * thickness_px) + rim_px
    side = max(min(thinnest, round(thickness_px / 2)), blurred, _LEAST_WALL_PX)
    square = np.ones((side, side), np.uint8)
    return cv2.morphologyEx(ink.astype(np.uint8), cv2.MORPH_OPEN, square) > 0


def _extent(wall: BoolArray) -> tuple[float, float]:
    """Width and height of what is drawn."""
    rows, columns = np.flatnonzero(wall.any(axis=1)), np.flatnonzero(wall.any(axis=0))
    return (float(np.ptp(columns)), float(np.ptp(rows))) if len(rows) else (0.0, 0.0)


def _thickened(lines: BoolArray, thickness_px: float) -> BoolArray:
    """Lines made walls of this thickness, without making them longer."""
    side = 2 * round(thickness_px / 2) + 1
    image = lines.astype(np.uint8)
    flat = cv2.morphologyEx(image, cv2.MORPH_OPEN, np.ones((1, side), np.uint8))
    steep = cv2.morphologyEx(image, cv2.MORPH_OPEN, np.ones((side, 1), np.uint8))
    slanted = lines & ~_grown(flat, 1, 3) & ~_grown(steep, 3, 1)
    return (
        _grown(flat, 1, side)
        | _grown(steep, side, 1)
        | _grown(slanted.astype(np.uint8), side // 2 | 1, side // 2 | 1)
    )


def _grown(mask: ByteArray | cv2.typing.MatLike, width_px: int, height_px: int) -> BoolArray:
    return cv2.dilate(mask, np.ones((height_px, width_px), np.uint8)) > 0


def _without_specks(wall: BoolArray, letters: BoolArray, thickness_px: float) -> BoolArray:
    """Without letters, specks and symbols: what is too short for a wall so thick."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(
        wall.astype(np.uint8), connectivity=8
    )
    width, height = stats[:, cv2.CC_STAT_WIDTH], stats[:, cv2.CC_STAT_HEIGHT]
    extent, area = np.maximum(width, height), stats[:, cv2.CC_STAT_AREA]
    is_pier = (extent >= _SHORTEST_PIER * thickness_px) & (area >= _PIER_FILL * width * height)
    keep = (extent >= _SHORTEST_WALL * thickness_px) | is_pier
    outside = np.bincount(labels[~letters], minlength=count)
    keep &= outside > _LETTER_SHARE * area
    keep[0] = False
    return np.asarray(keep[labels]) if count > 1 else np.zeros(wall.shape, bool)
