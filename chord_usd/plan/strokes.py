"""Where the walls are in a drawing: its thick dark strokes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from chord_usd.types import BoolArray, ByteArray, FloatArray

_DARKNESS = (0.45, 0.65, 0.8)
"""Shares of the paper's brightness below which a pixel may be wall, tried in turn."""

_FAINTEST_INK = 0.88
"""Share of the paper's brightness below which anything is drawn at all."""

_EDGE = 0.006
"""Share of the picture's shorter side that is passed over along its edges."""

_LEAST_WALL_PX = 2
_LONGEST_RUN_PX = 200

_ELONGATED = 4.0
"""A stroke is at least so many times as long as thick."""

_THINNEST_WALL = 0.35
"""Inner walls are at least this share of the usual wall's thickness."""

_SHORTEST_WALL = 2.5
"""Loose pieces shorter than so many thicknesses are symbols or letters, unless they are piers."""

_SHORTEST_PIER = 0.75
_PIER_FILL = 0.7
"""What is left of a wall between two openings fills its bounds, even at a corner."""


@dataclass(frozen=True, eq=False)
class Strokes:
    """A drawing's ink, sorted. Arrays (H, W)."""

    ink: BoolArray
    """Everything drawn."""
    wall: BoolArray
    """Thick strokes only."""
    thickness_px: float
    """Of the usual wall."""

    @property
    def thin(self) -> BoolArray:
        """Ink that is no wall: door leaves, window panes, furniture, text."""
        near_wall = cv2.dilate(self.wall.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
        return self.ink & ~near_wall


def find_strokes(rgb: ByteArray) -> Iterator[Strokes]:
    """Ways to tell walls from the rest in a drawing (H, W, 3), the strictest first."""
    brightness = _brightness(rgb)
    # A frame along the picture's edge is no part of the plan.
    edge = max(3, round(_EDGE * min(brightness.shape)))
    brightness = np.pad(brightness[edge:-edge, edge:-edge], edge, constant_values=1.0)
    ink = brightness < _FAINTEST_INK
    for share in _DARKNESS:
        dark = brightness < share
        thickness_px = _wall_thickness(dark)
        if thickness_px is None:
            continue
        wall = _thick_parts(dark, thickness_px)
        if wall.any():
            yield Strokes(ink, wall, thickness_px)


def _brightness(rgb: ByteArray) -> FloatArray:
    """(H, W) grey values relative to the paper round them: shadows on a photo do not count."""
    grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    small = cv2.resize(grey, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
    side = max(small.shape) // 12 * 2 + 1
    paper = cv2.morphologyEx(small, cv2.MORPH_CLOSE, np.ones((side, side), np.uint8))
    paper = cv2.GaussianBlur(paper, (side, side), 0)
    paper = cv2.resize(paper, (grey.shape[1], grey.shape[0]), interpolation=cv2.INTER_LINEAR)
    return grey / np.maximum(paper, 1.0)


def _run_lengths(ink: BoolArray) -> np.ndarray:  # type: ignore[type-arg]
    """(H, W) length of the run of ink along its row that each pixel is in; 0 for paper."""
    padded = np.pad(ink, ((0, 0), (1, 1))).astype(np.int8)
    change = np.diff(padded, axis=1).ravel()
    starts, stops = np.flatnonzero(change == 1), np.flatnonzero(change == -1)
    runs = np.zeros(ink.shape[0] * (ink.shape[1] + 1), np.int32)
    runs[starts] = stops - starts
    runs[stops] -= stops - starts
    return np.cumsum(runs).reshape(ink.shape[0], -1)[:, :-1]


def _wall_thickness(ink: BoolArray) -> float | None:
    """Thickness in pixels of the strokes that carry the drawing; None if there are no strokes."""
    across, down = _run_lengths(ink), _run_lengths(ink.T).T
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


def _thick_parts(ink: BoolArray, thickness_px: float) -> BoolArray:
    """Ink at least as thick as an inner wall, without specks and symbols."""
    side = max(round(_THINNEST_WALL * thickness_px), _LEAST_WALL_PX)
    opened = cv2.morphologyEx(ink.astype(np.uint8), cv2.MORPH_OPEN, np.ones((side, side), np.uint8))
    count, labels, stats, _ = cv2.connectedComponentsWithStats(opened, connectivity=8)
    width, height = stats[:, cv2.CC_STAT_WIDTH], stats[:, cv2.CC_STAT_HEIGHT]
    extent, area = np.maximum(width, height), stats[:, cv2.CC_STAT_AREA]
    is_pier = (extent >= _SHORTEST_PIER * thickness_px) & (area >= _PIER_FILL * width * height)
    keep = (extent >= _SHORTEST_WALL * thickness_px) | is_pier
    keep[0] = False
    return np.asarray(keep[labels]) if count > 1 else np.zeros(ink.shape, bool)
