"""A user's picture, made ready to be read: not too large, and upright."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np

from chord_usd.base.scene.types import BoolArray, ByteArray, FloatArray
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.plan.perspective import find_sheet, rectifying, sheet_size
from chord_usd.line.plan.placement import Straightening

_WORKING_SIDE_PX = 1280
"""Larger drawings are scaled down to this: walls stay several pixels thick."""

_TEXT_SIDE_PX = 1800

_BLACK_SCREEN = 60
FAINTEST_INK = 0.88
"""Share of the paper's brightness below which anything is drawn at all."""

_LEAST_SKEW_DEG = 0.2
_FINE_REACH_DEG, _FINE_STEP_DEG = 1.2, 0.1
_SAMPLES = 40_000
_STEP_DEG = 0.25
_LEAST_LINES_SHARE = 0.4
"""Of all that is drawn straight, so much must run along the drawing's own axes."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """A picture, ready to be read."""

    rgb: ByteArray
    """(H, W, 3), sides of 1280 px at most."""
    fine: ByteArray
    """The same, sides of 1800 px at most, for what is printed small."""
    shrink: float
    """Pixels of rgb per pixel of the upright picture."""
    height_px: int
    """Of the upright picture, in the user's pixels."""
    straightening: Straightening
    """What was done to the user's picture."""

    @property
    def fine_per_px(self) -> float:
        """Pixels of fine per pixel of rgb."""
        return self.fine.shape[0] / self.rgb.shape[0]


def prepare(rgb: ByteArray) -> Sheet:
    """Scale a picture (H, W, 3) down if need be, and straighten it."""
    small, fine = _scaled(rgb, _WORKING_SIDE_PX), _scaled(rgb, _TEXT_SIDE_PX)
    shrink = min(1.0, _WORKING_SIDE_PX / max(rgb.shape[:2]))
    done = Straightening()
    corners = find_sheet(small)
    if corners is not None:
        corners_px = corners / shrink
        points = tuple((float(x), float(y)) for x, y in corners_px)
        done = Straightening(0.0, points, sheet_size(corners_px, rgb.shape))
        small, fine = (straightened(part, done, rgb.shape) for part in (small, fine))
    skew_deg = measure_skew(small)
    if skew_deg:
        small, fine = turned(small, skew_deg), turned(fine, skew_deg)
    done = replace(done, skew_deg=skew_deg)
    height_px = straightening_matrix(done, rgb.shape)[1][1]
    return Sheet(small, fine, shrink, height_px, done)


def straightening_matrix(
    done: Straightening, shape: tuple[int, ...]
) -> tuple[FloatArray, tuple[int, int]]:
    """(3, 3) from the continuous pixels of a picture of a shape (H, W) to the pixels of the
    straightened picture, and its width and height.
    """
    matrix, size = np.eye(3), (shape[1], shape[0])
    if done.corners_px:
        matrix, size = rectifying(np.array(done.corners_px), done.size_px), done.size_px
    if done.skew_deg:
        matrix = _turning(size, done.skew_deg) @ matrix
        size = _turned_size(size[::-1], done.skew_deg)
    return matrix, size


def straightened(rgb: ByteArray, done: Straightening, shape: tuple[int, ...]) -> ByteArray:
    """A picture as it was read. rgb: the user's, of a shape (H, W), or that scaled down."""
    matrix, (width, height) = straightening_matrix(done, shape)
    shrink = rgb.shape[0] / shape[0]
    to_own, from_own = np.diag([shrink, shrink, 1.0]), np.diag([1 / shrink, 1 / shrink, 1.0])
    return _warped(rgb, to_own @ matrix @ from_own, (round(width * shrink), round(height * shrink)))


def _warped(rgb: ByteArray, matrix: FloatArray, size: tuple[int, int]) -> ByteArray:
    """matrix: (3, 3) between continuous pixels; the canvas is as paper."""
    paper = np.median(rgb.reshape(-1, 3)[:: max(1, rgb.size // 300_000)], axis=0).tolist()
    # cv2 puts pixel centres at whole numbers.
    half, back = np.eye(3), np.eye(3)
    half[:2, 2], back[:2, 2] = 0.5, -0.5
    warp = back @ matrix @ half
    return np.asarray(
        cv2.warpPerspective(rgb, warp, size, flags=cv2.INTER_LINEAR, borderValue=paper), np.uint8
    )


def _scaled(rgb: ByteArray, side_px: int) -> ByteArray:
    shrink = min(1.0, side_px / max(rgb.shape[:2]))
    if shrink == 1.0:
        return rgb
    return np.asarray(
        cv2.resize(rgb, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA), np.uint8
    )


def turned(rgb: ByteArray, skew_deg: float) -> ByteArray:
    """The picture with a clockwise turn taken out, on a canvas that holds all of it."""
    size = rgb.shape[1], rgb.shape[0]
    return _warped(rgb, _turning(size, skew_deg), _turned_size(rgb.shape, skew_deg))


def _turning(size: tuple[int, int], skew_deg: float) -> FloatArray:
    """(3, 3) about the middle of a picture (W, H), on the canvas that holds all of it."""
    width, height = _turned_size(size[::-1], skew_deg)
    matrix = np.eye(3)
    matrix[:2] = cv2.getRotationMatrix2D((size[0] / 2, size[1] / 2), skew_deg, 1.0)
    matrix[:2, 2] += np.array([width - size[0], height - size[1]]) / 2
    return matrix


def _turned_size(shape: tuple[int, ...], skew_deg: float) -> tuple[int, int]:
    cos, sin = abs(math.cos(math.radians(skew_deg))), abs(math.sin(math.radians(skew_deg)))
    return round(shape[1] * cos + shape[0] * sin), round(shape[1] * sin + shape[0] * cos)


def measure_skew(rgb: ByteArray) -> float:
    """Degrees by which a drawing's axes are turned clockwise on the picture; 0.0 if upright.

    A plan with one slanted wing is upright: most of its lines must run along the turned axes.
    """
    grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    edges = np.asarray(cv2.Canny(grey, 60, 160), np.uint8)
    skew_deg = _sharpest_turn(edges, _skew_of_lines(edges))
    # A turn that shifts the far end of the longest line by a pixel looks like none.
    least_deg = max(_LEAST_SKEW_DEG, math.degrees(1.5 / max(edges.shape)))
    return skew_deg if abs(skew_deg) > least_deg else 0.0


def _sharpest_turn(edges: ByteArray, near_deg: float) -> float:
    """The turn at which most edges share their rows and columns.

    The lines of a small turn are stairs of upright pieces; only all together show the turn.
    """
    points = np.argwhere(edges > 0)[:: max(1, int((edges > 0).sum()) // _SAMPLES)]
    points = points - np.array(edges.shape) / 2
    best, sharpest = near_deg, -1.0
    for step in np.arange(-_FINE_REACH_DEG, _FINE_REACH_DEG + 1e-9, _FINE_STEP_DEG):
        turn = rotation_2d(near_deg + step)
        places = np.rint(points @ turn.T).astype(int) + max(edges.shape)
        sharpness = float(sum((np.bincount(axis) ** 2).sum() for axis in places.T))
        if sharpness > sharpest:
            best, sharpest = near_deg + step, sharpness
    return round(float(best), 2)


def _skew_of_lines(edges: ByteArray) -> float:
    """By the longest lines, to a degree; 0.0 where these run along the picture's axes."""
    least = max(edges.shape) // 25
    lines = cv2.HoughLinesP(edges, 1.0, math.radians(_STEP_DEG), 40, None, least, 4)
    if lines is None:
        return 0.0
    vectors: FloatArray = lines.reshape(-1, 4)[:, 2:] - lines.reshape(-1, 4)[:, :2].astype(float)
    lengths = np.hypot(vectors[:, 0], vectors[:, 1])
    angles = (np.degrees(np.arctan2(vectors[:, 1], vectors[:, 0])) + 45.0) % 90.0 - 45.0
    bins = np.arange(-45.0, 45.0, _STEP_DEG)
    counts, _ = np.histogram(angles, np.append(bins, 45.0), weights=lengths)
    smooth = np.convolve(np.pad(counts, 2, mode="wrap"), np.ones(5), mode="valid")
    peak = int(np.argmax(smooth))
    share = smooth[peak] / lengths.sum()
    near = np.abs((angles - bins[peak] - _STEP_DEG / 2 + 45.0) % 90.0 - 45.0) < 1.0
    if share < _LEAST_LINES_SHARE:
        return 0.0
    center = bins[peak] + _STEP_DEG / 2
    off = (angles[near] - center + 45.0) % 90.0 - 45.0
    skew_deg = float(center + np.average(off, weights=lengths[near]))
    # Drawn on the square grid of a screen, upright lines are upright to the pixel.
    upright = lengths[np.abs(angles) < _STEP_DEG].sum()
    return 0.0 if upright > 0.5 * smooth[peak] else skew_deg


def on_white(rgb: ByteArray) -> ByteArray:
    """A drawing (H, W, 3) on light paper: one on a black screen has its colours turned round."""
    dark = np.median(cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)[::4, ::4]) < _BLACK_SCREEN
    return np.asarray(255 - rgb, np.uint8) if dark else rgb


def brightness_of(rgb: ByteArray) -> FloatArray:
    """(H, W) grey values of a drawing on light paper, (H, W, 3), relative to the paper round them:
    shadows on a photo do not count."""
    grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    small = cv2.resize(grey, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
    side = max(small.shape) // 12 * 2 + 1
    paper = cv2.morphologyEx(small, cv2.MORPH_CLOSE, np.ones((side, side), np.uint8))
    paper = cv2.GaussianBlur(paper, (side, side), 0)
    paper = cv2.resize(paper, (grey.shape[1], grey.shape[0]), interpolation=cv2.INTER_LINEAR)
    return grey / np.maximum(paper, 1.0)


def ink_of(rgb: ByteArray) -> BoolArray:
    """(H, W) what is drawn on light paper: darker than the paper round it."""
    return np.asarray(brightness_of(rgb) < FAINTEST_INK)
