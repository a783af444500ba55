"""A user's picture, made ready to be read: not too large, and upright."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from chord_usd.plan.placement import UPRIGHT
from chord_usd.types import ByteArray, FloatArray
from chord_usd.units import rotation_2d

_WORKING_SIDE_PX = 1600
"""Larger drawings are scaled down to this: walls stay several pixels thick."""

_TEXT_SIDE_PX = 2000

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
    """(H, W, 3), sides of 1600 px at most."""
    fine: ByteArray
    """The same, sides of 2000 px at most, for what is printed small."""
    shrink: float
    """Pixels of rgb per pixel of the upright picture."""
    height_px: int
    """Of the upright picture, in the user's pixels."""
    skew_deg: float = 0.0
    """Clockwise turn that was taken out of the user's picture."""

    @property
    def fine_per_px(self) -> float:
        """Pixels of fine per pixel of rgb."""
        return self.fine.shape[0] / self.rgb.shape[0]

    @property
    def turn(self) -> Mapping[str, Any]:
        """The entry beside the frame that remembers the skew."""
        return {UPRIGHT: {"skewDeg": self.skew_deg}} if self.skew_deg else {}


def prepare(rgb: ByteArray) -> Sheet:
    """Scale a picture (H, W, 3) down if need be, and turn it upright."""
    small = _scaled(rgb, _WORKING_SIDE_PX)
    skew_deg = measure_skew(small)
    fine = _scaled(rgb, _TEXT_SIDE_PX)
    height_px = rgb.shape[0]
    if skew_deg:
        small, fine = turned(small, skew_deg), turned(fine, skew_deg)
        height_px = _turned_size(rgb.shape, skew_deg)[1]
    shrink = min(1.0, _WORKING_SIDE_PX / max(rgb.shape[:2]))
    return Sheet(small, fine, shrink, height_px, skew_deg)


def _scaled(rgb: ByteArray, side_px: int) -> ByteArray:
    shrink = min(1.0, side_px / max(rgb.shape[:2]))
    if shrink == 1.0:
        return rgb
    return np.asarray(
        cv2.resize(rgb, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA), np.uint8
    )


def turned(rgb: ByteArray, skew_deg: float) -> ByteArray:
    """The picture with a clockwise turn taken out, on a canvas that holds all of it."""
    width, height = _turned_size(rgb.shape, skew_deg)
    center = rgb.shape[1] / 2, rgb.shape[0] / 2
    matrix: FloatArray = np.array(cv2.getRotationMatrix2D(center, skew_deg, 1.0), np.float64)
    matrix[:, 2] += np.array([width - rgb.shape[1], height - rgb.shape[0]]) / 2
    paper = np.median(rgb.reshape(-1, 3)[:: max(1, rgb.size // 300_000)], axis=0).tolist()
    return np.asarray(
        cv2.warpAffine(
            rgb, matrix, (width, height), flags=cv2.INTER_LINEAR, borderValue=paper
        ),
        np.uint8,
    )  # fmt: skip


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
    # A turn that shifts the far end of the longest line by a pixel cannot be told from none.
    least_deg = max(_LEAST_SKEW_DEG, math.degrees(1.5 / max(edges.shape)))
    return skew_deg if abs(skew_deg) > least_deg else 0.0


def _sharpest_turn(edges: ByteArray, near_deg: float) -> float:
    """The turn at which most edges share their rows and columns.

    The lines of a small turn are stairs of upright pieces; all together they tell.
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
