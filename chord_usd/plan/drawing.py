"""Any other drawing -> Plan: thick dark strokes are walls, what they enclose are rooms.

A classical reader for clean drawings: black or dark walls, doors with a leaf or an arc or an empty
gap, windows as thin lines in the wall. Room kinds stay unknown.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon

from chord_usd.errors import PlanError
from chord_usd.plan.gaps import Gap, close_gaps, find_gaps
from chord_usd.plan.ink import border_values
from chord_usd.plan.openings import Bar, read_openings
from chord_usd.plan.placement import placement
from chord_usd.plan.settle import even_out
from chord_usd.plan.strokes import Strokes, find_strokes
from chord_usd.types import (
    WALL_THICKNESS_M,
    BoolArray,
    ByteArray,
    FloatArray,
    OpeningKind,
    PixelFrame,
    Plan,
    Room,
    frozen_array,
)
from chord_usd.units import m_from_px
from chord_usd.vectorize import polygon_from_mask

_WORKING_SIDE_PX = 1600
"""Larger drawings are scaled down to this: walls stay several pixels thick."""

_USUAL_DOOR_M = 0.8
_SMALLEST_ROOM_M2 = 0.8
_LARGEST_PASSAGE_M = 1.8
"""A wider gap between rooms in which nothing is drawn makes them one room."""

_ENOUGH_DOORS = 2

_FARTHEST_MOVE = 0.5
"""Walls of a drawing vary; each face moves at most so many thicknesses to make them alike."""

_LEAST_EDGE = 3.0
"""An edge this many wall thicknesses long is straight, not one of many that follow a curve."""

_LEAST_STRAIGHT = 0.75
"""Share of the rooms' outlines that runs straight; a photograph of anything else has less."""


def read_drawing(rgb: ByteArray, m_per_px: float | None = None) -> Plan:
    """The plan in a drawing, RGB (H, W, 3).

    m_per_px: of the picture as given; without it doors (0.8 m) or else the walls (0.24 m) give the
    scale. Raises PlanError where no closed room is found.
    """
    shrink = min(1.0, _WORKING_SIDE_PX / max(rgb.shape[:2]))
    small = rgb
    if shrink < 1.0:
        small = np.asarray(
            cv2.resize(rgb, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA), np.uint8
        )
    readings = [_read(strokes, m_per_px and m_per_px / shrink) for strokes in find_strokes(small)]
    best = max(readings, key=lambda reading: reading.enclosed_px, default=None)
    if best is None or not best.polygons_px:
        raise PlanError(
            "no closed room was found",
            expected="a floor plan with dark walls round its rooms",
            try_="a clearer drawing, cut to one floor, with the walls filled in black",
        )
    plan = _plan(best)
    drawing = PixelFrame(best.frame.m_per_px * shrink, (0.0, 0.0), len(rgb))
    return replace(plan, extra=placement(drawing))


@dataclass(frozen=True, eq=False)
class _Reading:
    """What one way to tell walls from the rest makes of a drawing."""

    polygons_px: list[FloatArray]
    bars: list[Bar]
    frame: PixelFrame

    @property
    def enclosed_px(self) -> float:
        return sum(Polygon(polygon).area for polygon in self.polygons_px)


def _read(strokes: Strokes, m_per_px: float | None) -> _Reading:
    gaps = _parting_gaps(strokes, find_gaps(strokes))
    m_per_px = m_per_px or _measure_scale(strokes, gaps)
    gaps = _without_open_plan(strokes, gaps, m_per_px)
    regions = _regions(close_gaps(strokes.wall, gaps))
    polygons = _room_outlines(regions, strokes, m_per_px)
    frame = PixelFrame(m_per_px, (0.0, 0.0), len(strokes.wall))
    bars = [Bar(_kind(gap, regions), gap.mask(strokes.wall.shape)) for gap in gaps]
    return _Reading(polygons, bars, frame)


def _plan(reading: _Reading) -> Plan:
    """Rooms pulled to walls of the usual thickness, and openings in these."""
    thickness_px = WALL_THICKNESS_M / reading.frame.m_per_px
    polygons = even_out(reading.polygons_px, thickness_px, _FARTHEST_MOVE * thickness_px)
    rooms = tuple(
        Room(f"room{index + 1}", "unknown", frozen_array(m_from_px(polygon, reading.frame)))
        for index, polygon in enumerate(polygons)
    )
    room_ids = [room.id for room in rooms]
    openings = read_openings(reading.bars, polygons, room_ids, thickness_px, reading.frame)
    return Plan(rooms, tuple(opening for opening in openings if opening.room_ids))


# Regions -----------------------------------------------------------------------------------------

Labels = npt.NDArray[np.int32]


def _regions(closed: BoolArray) -> Labels:
    """(H, W) a number for each enclosed region, 0 for walls and outside."""
    count, labels = cv2.connectedComponents((~closed).astype(np.uint8), connectivity=4)
    inner = np.arange(count, dtype=np.int32)
    inner[border_values(labels)] = 0
    return inner[labels]


def _sides(gap: Gap, regions: Labels) -> tuple[int, int]:
    """The regions on both sides of a gap."""
    along = np.linspace(0.25, 0.75, 7) * gap.length_px
    found = []
    for side in (-1.0, 1.0):
        beside = side * (gap.width_px / 2 + np.array([1.5, 3.0]))
        points = gap.start + gap.along * along[:, None, None] + gap.across * beside[None, :, None]
        columns = points[..., 0].astype(int).clip(0, regions.shape[1] - 1).ravel()
        rows = points[..., 1].astype(int).clip(0, regions.shape[0] - 1).ravel()
        found.append(int(np.bincount(regions[rows, columns]).argmax()))
    return found[0], found[1]


def _parting_gaps(strokes: Strokes, gaps: list[Gap]) -> list[Gap]:
    """Gaps that have different regions on both sides once all are closed."""
    regions = _regions(close_gaps(strokes.wall, gaps))
    return [gap for gap in gaps if len(set(_sides(gap, regions))) == 2]


def _without_open_plan(strokes: Strokes, gaps: list[Gap], m_per_px: float) -> list[Gap]:
    """Without wide empty gaps between two rooms: those are one room."""
    regions = _regions(close_gaps(strokes.wall, gaps))
    kept = []
    for gap in gaps:
        empty = not (gap.has_pane or gap.has_swing)
        if empty and gap.length_px * m_per_px > _LARGEST_PASSAGE_M and all(_sides(gap, regions)):
            continue
        kept.append(gap)
    return _parting_gaps(strokes, kept)


def _room_outlines(regions: Labels, strokes: Strokes, m_per_px: float) -> list[FloatArray]:
    """Outlines of the regions large enough; none at all if they are not straight."""
    noise_px = 0.5 + 0.12 * strokes.thickness_px
    side = max(round(0.4 * strokes.thickness_px), 2)
    areas = np.bincount(regions.ravel())
    outlines = []
    for label in np.flatnonzero(areas * m_per_px**2 >= _SMALLEST_ROOM_M2):
        if label == 0:
            continue
        mask = cv2.morphologyEx(
            (regions == label).astype(np.uint8), cv2.MORPH_OPEN, np.ones((side, side), np.uint8)
        )
        if mask.any():
            outlines.append(polygon_from_mask(mask > 0, noise_px))
    edges = [np.roll(outline, -1, axis=0) - outline for outline in outlines]
    lengths = np.concatenate([np.hypot(*edge.T) for edge in edges]) if edges else np.zeros(1)
    straight = lengths[lengths > _LEAST_EDGE * strokes.thickness_px].sum()
    return outlines if straight > _LEAST_STRAIGHT * lengths.sum() else []


# Meaning -----------------------------------------------------------------------------------------


def _measure_scale(strokes: Strokes, gaps: list[Gap]) -> float:
    """Metres per pixel: from doors drawn with leaf or arc, else from the walls."""
    doors_px = [gap.length_px for gap in gaps if gap.has_swing]
    if len(doors_px) >= _ENOUGH_DOORS:
        return _USUAL_DOOR_M / float(np.median(doors_px))
    return WALL_THICKNESS_M / strokes.thickness_px


def _kind(gap: Gap, regions: Labels) -> OpeningKind:
    """Door by its leaf, window by its panes in an outer wall, passage by its emptiness."""
    inside = all(_sides(gap, regions))
    if gap.has_swing:
        return "door"
    if gap.has_pane:
        return "door" if inside else "window"
    return "passage" if inside else "door"
