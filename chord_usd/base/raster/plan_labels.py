"""Floor plans as label maps: what floor planning diffuses.

A label map is a plan raster before it is painted: one small number a pixel, for the outside, the
floor of each kind of room, walls and what is in them. Its scale is chosen before the house is
known, so that a wall (24 cm) is at least LEAST_WALL_PX wide.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np

from chord_usd.base.raster import canvas
from chord_usd.base.scene import palette
from chord_usd.base.scene.types import (
    LEARNED_KINDS,
    WALL_THICKNESS_M,
    BoolArray,
    ByteArray,
    PixelFrame,
    Plan,
)

LABEL_NAMES = ("outside", *LEARNED_KINDS, "wall", "door", "window", "passage")
OUTSIDE = 0
FIRST_ROOM = 1
WALL, DOOR, WINDOW, PASSAGE = (
    LABEL_NAMES.index(name) for name in ("wall", "door", "window", "passage")
)

CANVAS_PX = 160
"""Side of a label map."""

SCALES_M = (0.12, 0.16)
"""Metres per pixel that label maps are drawn at: houses up to 18 m and up to 24 m across."""

COARSE_FROM_M2 = 130.0
"""Houses with more floor are drawn at the coarser scale, where only their area is known."""

MARGIN_PX = 5
"""Free border of a label map."""

_ROOM_PX = CANVAS_PX - 2 * MARGIN_PX

LARGEST_M = _ROOM_PX * SCALES_M[-1]
"""Extent of the largest house that can be drawn."""


def label_of(kind: str) -> int:
    """The label of a kind of room, of "wall", "door", "window" or "passage"."""
    return LABEL_NAMES.index(kind)


def extent_m(plan: Plan) -> float:
    """The longer side of a house, walls included."""
    points = np.concatenate([room.polygon_m for room in plan.rooms])
    return float(np.ptp(points, axis=0).max()) + 2 * WALL_THICKNESS_M


def fitting_scale(plan: Plan) -> float | None:
    """The finest of SCALES_M at which a house fits; None where none does."""
    needed_m = extent_m(plan)
    return next((scale for scale in SCALES_M if needed_m <= _ROOM_PX * scale), None)


def scale_for_area(area_m2: float) -> float:
    """The scale of the sheet that a house with this much floor is planned on."""
    return SCALES_M[int(area_m2 > COARSE_FROM_M2)]


def sheet_frame(m_per_px: float) -> PixelFrame:
    """The frame of a label map whose middle is the origin."""
    return canvas.centred(np.zeros(2), m_per_px, CANVAS_PX)


def label_frame(plan: Plan, m_per_px: float) -> PixelFrame:
    """The frame in which a plan lies in the middle of its label map, on whole pixels."""
    points = np.concatenate([room.polygon_m for room in plan.rooms])
    return canvas.centred((points.min(axis=0) + points.max(axis=0)) / 2, m_per_px, CANVAS_PX)


def label_plan(plan: Plan, frame: PixelFrame) -> ByteArray:
    """(H, W) labels of a plan.

    PASSAGE are gaps in walls, inner and outer, and a strip where rooms meet without a wall.
    """
    rgb = canvas.draw_plan(plan, frame).rgb
    labels = _label_of_grey()[rgb[..., 1]]
    for label, name in ((DOOR, "door"), (WINDOW, "window")):
        labels[(rgb == np.array(palette.category(name).rgb, np.uint8)).all(axis=2)] = label
    # What is white is outside, a room of unknown kind, or a passage: only the last lies in a wall.
    for room in plan.rooms:
        if room.kind == "unknown":
            labels[canvas.room_pixels(room, frame)] = label_of("unknown")
    inside = house_mask(labels)
    labels[((labels == OUTSIDE) & inside) | _open_borders(labels)] = PASSAGE
    return np.asarray(labels, np.uint8)


def is_floor(labels: ByteArray) -> BoolArray:
    """(H, W) pixels of rooms."""
    return np.asarray((labels >= FIRST_ROOM) & (labels < WALL))


def _open_borders(labels: ByteArray) -> BoolArray:
    """(H, W) pixels of a room beside one of another kind of room."""
    floor, borders = is_floor(labels), np.zeros(labels.shape, bool)
    for first, second in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        differs = (labels[first] != labels[second]) & floor[first] & floor[second]
        borders[first] |= differs
        borders[second] |= differs
    return borders


def house_mask(labels: ByteArray) -> BoolArray:
    """(H, W) the house with its walls; gaps in outer walls up to a door's width are closed."""
    drawn = (labels != OUTSIDE).astype(np.uint8)
    kernel = np.ones((3, 3), np.uint8)
    return fill_shell(cv2.morphologyEx(drawn, cv2.MORPH_CLOSE, kernel) != 0)


def fill_shell(shell: BoolArray) -> BoolArray:
    """(H, W) a closed outline and all that lies within."""
    drawn = shell.astype(np.uint8)
    contours, _ = cv2.findContours(drawn, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    filled = cv2.drawContours(np.zeros_like(drawn), contours, -1, (1.0,), cv2.FILLED)
    return np.asarray(filled).astype(bool)


def open_plan(labels: ByteArray, m_per_px: float) -> ByteArray:
    """(H, W) the same house without its rooms: outer walls with their openings, one bare floor."""
    inside = house_mask(labels)
    wall_px = max(1, round(WALL_THICKNESS_M / m_per_px))
    kernel = np.ones((2 * wall_px + 1, 2 * wall_px + 1), np.uint8)
    floor = cv2.erode(inside.astype(np.uint8), kernel).astype(bool)
    kept = np.isin(labels, (DOOR, WINDOW))
    shell = np.where(kept, labels, np.where(labels == PASSAGE, DOOR, WALL))
    return np.where(floor, label_of("unknown"), np.where(inside, shell, OUTSIDE)).astype(np.uint8)


def paint_labels(labels: ByteArray) -> ByteArray:
    """(H, W, 3) the plan raster of a label map."""
    return _colors()[labels]


@lru_cache(maxsize=1)
def _colors() -> ByteArray:
    rows = [palette.BACKGROUND_RGB]
    rows += [(palette.ROOM_SHADES[kind][0],) * 3 for kind in LEARNED_KINDS]
    rows += [palette.category(name).rgb for name in ("wall", "door", "window")]
    rows.append(palette.BACKGROUND_RGB)
    return np.array(rows, np.uint8)


@lru_cache(maxsize=1)
def _label_of_grey() -> ByteArray:
    """(256,) label by grey level; white is left open."""
    table = np.zeros(256, np.uint8)
    table[palette.category("wall").rgb[0]] = WALL
    for kind in LEARNED_KINDS:
        if palette.ROOM_SHADES[kind] != palette.BACKGROUND_RGB:
            table[palette.ROOM_SHADES[kind][0]] = label_of(kind)
    return table
