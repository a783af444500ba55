"""Items of layouts that others painted: where colours are not the palette's, the detector decides.

JPEG, blur and other colours tear patches of one category apart and mix new ones at their edges; the
network has learned to see past that. A front is the darkest of the four strips where a mark could
be, and away from a wall, whatever the colours.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from chord_usd.base.scene.oriented_rect import OrientedRect
from chord_usd.base.scene.palette import HOUSE_CATEGORIES, Category, Mount
from chord_usd.base.scene.types import ByteArray, Detection, FloatArray, frozen_array
from chord_usd.base.scene.units import fold_deg
from chord_usd.line.graph.colours import LayoutPixels
from chord_usd.line.graph.directions import Directions
from chord_usd.line.graph.patches import UsualSize
from chord_usd.line.graph.rectangles import canvas_corners, front_mark, upright_points
from chord_usd.line.graph.snap import (
    SURE_SCORE,
    FoundItem,
    long_fronts,
    proposed_rect,
    thinned,
    walls_behind,
)

_SAME_DEG = 5.0
"""Boxes are no farther off the direction of their walls than this."""

_LEVELS, _MOST_DARKER = 160.0, 60.0
"""Darker by so many levels is worth as much as a wall right behind; and what is darker still is the
wall itself, that bleeds into the piece."""

_LEAST_MARK, _LONG_WORD = 0.05, 0.3
"""Least mark that counts; weight of a long front, without a mark, beside a wall behind."""


def find_foreign_items(
    pixels: LayoutPixels,
    rgb: ByteArray,
    m_per_px: float,
    directions: Directions,
    proposals: Iterable[Detection],
) -> list[FoundItem]:
    """Every sure proposal as an item, in the order of the categories, then as they come.

    pixels: of the picture rgb, for its walls. directions: of the walls.
    """
    grey = rgb.mean(axis=2)
    rows = {row.name: row for row in HOUSE_CATEGORIES}
    order = {name: at for at, name in enumerate(rows)}
    sure = [
        proposal
        for proposal in proposals
        if proposal.score >= SURE_SCORE and proposal.category in rows
    ]
    sure.sort(key=lambda proposal: order[proposal.category])
    return [
        _item(proposal, pixels, grey, m_per_px, directions, rows[proposal.category])
        for proposal in sure
    ]


def _item(
    proposal: Detection,
    pixels: LayoutPixels,
    grey: FloatArray,
    m_per_px: float,
    directions: Directions,
    row: Category,
) -> FoundItem:
    rect = _aligned(proposed_rect(proposal, UsualSize.of(row, m_per_px)), directions)
    turns, is_seen = _front(rect, pixels, grey, row)
    rect = thinned(rect, turns, row, m_per_px)
    corners = frozen_array(canvas_corners(rect, turns))
    return FoundItem(Detection(row.name, corners, proposal.score), is_seen, in_detector=True)


def _aligned(rect: OrientedRect, directions: Directions) -> OrientedRect:
    """Along the nearest wall, where it nearly is; a quarter turn changes length and depth."""
    for angle in directions.near(rect.center):
        off = fold_deg(rect.angle_deg - angle)
        if abs(off) <= _SAME_DEG:
            sides = rect.u1 - rect.u0, rect.v1 - rect.v0
            quarters = round((rect.angle_deg - off - angle) / 90.0)
            along, across = sides[::-1] if quarters % 2 else sides
            return OrientedRect.around(rect.center, angle, along, across)
    return rect


def _front(
    rect: OrientedRect, pixels: LayoutPixels, grey: FloatArray, row: Category
) -> tuple[int, bool]:
    """Quarter turns of a piece, and whether a mark shows them."""
    darker = np.array([_darker(rect, turns, grey) for turns in range(4)])
    marks = np.clip(darker, -_MOST_DARKER, _MOST_DARKER) / _LEVELS
    if row.mount is Mount.WALL:
        marks = marks * long_fronts(rect)
    walls = walls_behind(pixels, rect, range(4))
    if marks.max() < _LEAST_MARK:
        return int(np.argmax(walls + _LONG_WORD * long_fronts(rect))), False
    return int(np.argmax(marks + walls)), True


def _darker(rect: OrientedRect, turns: int, grey: FloatArray) -> float:
    """By how many levels the place of a mark is darker than the rest of the piece."""
    corners = canvas_corners(rect)
    height, width = grey.shape
    left, top = np.clip(np.floor(corners.min(axis=0)).astype(int), 0, (width, height))
    right, bottom = np.clip(np.ceil(corners.max(axis=0)).astype(int), 0, (width, height))
    part = grey[top:bottom, left:right]
    points = upright_points(np.ones(part.shape, bool), int(top), int(left))
    inside, marked = rect.covers(points), front_mark(rect, turns).covers(points)
    levels = part.ravel()
    if not marked.any() or not (inside & ~marked).any():
        return 0.0
    return float(np.median(levels[inside & ~marked]) - levels[marked].mean())
