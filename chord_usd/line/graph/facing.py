"""Which way a piece faces: by its front mark; where that is torn, by the wall behind it, too."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from chord_usd.base.scene.oriented_rect import OrientedRect
from chord_usd.base.scene.palette import PLAN_CATEGORIES, Mount
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.graph.colours import CLEAR, LayoutPixels
from chord_usd.line.graph.joining import Piece
from chord_usd.line.graph.patches import UsualSize, mark_fits
from chord_usd.line.graph.rectangles import canvas_corners, front_mark

LEAST_MARK_FIT = 0.2
"""A mark that lies on its place worse than this (intersection over union) tells nothing."""

_WALL_WORD, _SPLIT_WORD, _ODD_WORD, _LONG_WORD = 0.3, 0.2, 0.25, 0.3
"""What a wall behind, the splitting of a patch, an odd size and a long front are worth beside a
mark's fit. A clean mark fits by 0.6 or more better than at any other side, so it always wins."""

_SAME_MARK = 0.7
_LOOK_PX = np.array([0.8, 1.6, 2.4])
"""Distances behind an edge at which a wall is looked for."""
_LOOK_SHARES = np.array([0.15, 0.4, 0.6, 0.85])

_DOOR = next(row.detector_class for row in PLAN_CATEGORIES if row.name == "door")


def facing(
    pixels: LayoutPixels, piece: Piece, marked: FloatArray, mount: Mount, usual_px: UsualSize
) -> tuple[int, bool]:
    """Quarter turns of a piece, and whether its mark told them.

    marked: (N, 2) upright points of the patch that are of a front mark.
    """
    rectangle = piece.rectangle
    fits = mark_fits(rectangle, marked)
    if mount is Mount.WALL:
        fits = fits * long_fronts(rectangle)  # panels hang flat, whatever their mark has become
    if fits.max() < LEAST_MARK_FIT:
        walls = walls_behind(pixels, rectangle, range(4))
        return int(np.argmax(walls + _LONG_WORD * long_fronts(rectangle))), False
    turns = int(fits.argmax())
    opposite = (turns + 2) % 4
    thin = front_mark(rectangle, opposite).covered_by(front_mark(rectangle, turns)) > _SAME_MARK
    if thin or mount is Mount.WALL:
        # The mark of a piece a pixel or two thick does not tell its front from its back.
        choices = (turns, opposite)
        return choices[int(np.argmax(walls_behind(pixels, rectangle, choices)))], True
    word = fits + _WALL_WORD * walls_behind(pixels, rectangle, range(4))
    if piece.quarter_turns is not None:
        word[piece.quarter_turns] += _SPLIT_WORD
    odd = [usual_px.odd_sides(Piece(rectangle, choice)) for choice in range(4)]
    return int(np.argmax(word - _ODD_WORD * np.array(odd))), True


def long_fronts(rectangle: OrientedRect) -> FloatArray:
    """(4,) 1 where the front would be a longer side."""
    across, along = rectangle.u1 - rectangle.u0, rectangle.v1 - rectangle.v0
    return np.array([across >= along, along >= across] * 2, dtype=np.float64)


def walls_behind(
    pixels: LayoutPixels, rectangle: OrientedRect, choices: Iterable[int]
) -> FloatArray:
    """Share of wall or window right behind the back, for each choice of quarter turns."""
    corners = np.array([canvas_corners(rectangle, turns) for turns in choices])
    back_left, front_left, back_right = corners[:, 0], corners[:, 1], corners[:, 3]
    outward = back_left - front_left
    outward = outward / np.maximum(np.hypot(outward[:, 0], outward[:, 1]), 1e-9)[:, None]
    along = back_left[:, None] + (back_right - back_left)[:, None] * _LOOK_SHARES[:, None]
    points = along[:, :, None] + outward[:, None, None] * _LOOK_PX[:, None]
    height, width = pixels.structure.shape
    columns, rows = np.moveaxis(np.floor(points).astype(int), -1, 0)
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    seen = pixels.structure[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)]
    solid = inside & (seen != CLEAR) & (seen != _DOOR)
    shares: FloatArray = solid.mean(axis=(1, 2))
    return shares
