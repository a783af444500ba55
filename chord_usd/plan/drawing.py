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
_NARROWEST_ROOM_M = 0.7
_LARGEST_PASSAGE_M = 1.8
"""A wider gap between rooms in which nothing is drawn makes them one room."""

_ENOUGH_DOORS = 2

_FARTHEST_MOVE = 0.5
"""Walls of a drawing vary; each face moves at most so many thicknesses to make them alike."""

_LEAST_EDGE = 3.0
"""An edge this many wall thicknesses long is straight, not one of many that follow a curve."""

_LEAST_STRAIGHT = 0.6
"""Share of a room's outline that runs straight; a blob in a photograph has less."""

_LEAST_WALLED = 0.5
"""Share of a room's outline along walls; what lies between dimension lines has less."""

_GOOD_SHARE = 0.8
"""A reading that encloses this share of what the best one does is as good."""

_BLOCK = np.ones((3, 3), np.uint8)


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
    most = max((reading.enclosed_px for reading in readings), default=0.0)
    # The strictest reading takes the least furniture for walls.
    best = next((r for r in readings if r.enclosed_px >= _GOOD_SHARE * most), None)
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
    regions = _regions(strokes, gaps)
    polygons = _room_outlines(regions, strokes, m_per_px)
    frame = PixelFrame(m_per_px, (0.0, 0.0), len(strokes.wall))
    bars = [Bar(_kind(gap, regions), gap.mask(regions.shape)) for gap in gaps]
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


def _regions(strokes: Strokes, gaps: list[Gap]) -> Labels:
    """(H, W) a number for each room, 0 for walls and outside.

    Between rooms only walls and gaps count; towards the outside any line does, since windows and
    balconies are often drawn with nothing else.
    """
    closed = close_gaps(strokes.wall, gaps)
    drawn = cv2.dilate((closed | strokes.ink).astype(np.uint8), _BLOCK)
    _, labels = cv2.connectedComponents(1 - drawn, connectivity=4)
    open_air = border_values(labels)
    reached = np.isin(np.arange(labels.max() + 1), open_air[open_air > 0])[labels]
    outside = cv2.dilate(reached.astype(np.uint8), _BLOCK) > 0
    # Odd, so that opening does not shift the region.
    side = 2 * max(round(0.25 * strokes.thickness_px), 1) + 1
    square = np.ones((side, side), np.uint8)
    inside = cv2.morphologyEx((~closed & ~outside).astype(np.uint8), cv2.MORPH_OPEN, square)
    count, labels = cv2.connectedComponents(inside, connectivity=4)
    near_wall = cv2.dilate(closed.astype(np.uint8), np.ones((2 * side + 1,) * 2, np.uint8)) > 0
    rim = (inside > 0) & (cv2.erode(inside, _BLOCK) == 0)
    rims = np.bincount(labels[rim], minlength=count)
    walled = np.bincount(labels[rim & near_wall], minlength=count)
    is_room = walled > _LEAST_WALLED * rims
    is_room[0] = False
    return np.where(is_room, np.arange(count), 0).astype(np.int32)[labels]


def _sides(gap: Gap, regions: Labels) -> tuple[int, int]:
    """The regions on both sides of a gap."""
    along = np.linspace(0.25, 0.75, 7) * gap.length_px
    found = []
    for side in (-1.0, 1.0):
        beside = side * (gap.width_px / 2 + np.array([2.5, 4.5]))
        points = gap.start + gap.along * along[:, None, None] + gap.across * beside[None, :, None]
        columns = points[..., 0].astype(int).clip(0, regions.shape[1] - 1).ravel()
        rows = points[..., 1].astype(int).clip(0, regions.shape[0] - 1).ravel()
        found.append(int(np.bincount(regions[rows, columns]).argmax()))
    return found[0], found[1]


def _parting_gaps(strokes: Strokes, gaps: list[Gap]) -> list[Gap]:
    """Gaps that have different regions on both sides once all are closed."""
    regions = _regions(strokes, gaps)
    return [gap for gap in gaps if len(set(_sides(gap, regions))) == 2]


def _without_open_plan(strokes: Strokes, gaps: list[Gap], m_per_px: float) -> list[Gap]:
    """Without wide empty gaps between two rooms: those are one room."""
    regions = _regions(strokes, gaps)
    kept = []
    for gap in gaps:
        if (
            gap.is_empty
            and gap.length_px * m_per_px > _LARGEST_PASSAGE_M
            and all(_sides(gap, regions))
        ):
            continue
        kept.append(gap)
    return _parting_gaps(strokes, kept)


def _room_outlines(regions: Labels, strokes: Strokes, m_per_px: float) -> list[FloatArray]:
    """Outlines of the regions that are large and straight enough for rooms."""
    noise_px = 0.5 + 0.12 * strokes.thickness_px
    areas = np.bincount(regions.ravel())
    # Half of the room's least width is how far its middle must be from its walls.
    depths = cv2.distanceTransform((regions > 0).astype(np.uint8), cv2.DIST_L2, 3)
    wide = np.unique(regions[depths * m_per_px >= _NARROWEST_ROOM_M / 2])
    large = wide[areas[wide] * m_per_px**2 >= _SMALLEST_ROOM_M2]
    outlines = [polygon_from_mask(regions == label, noise_px) for label in large if label > 0]
    return [outline for outline in outlines if _is_straight(outline, strokes.thickness_px)]


def _is_straight(outline: FloatArray, thickness_px: float) -> bool:
    """Whether most of an outline runs in long straight edges, as rooms do and blobs do not."""
    edges = np.roll(outline, -1, axis=0) - outline
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    return bool(
        lengths[lengths > _LEAST_EDGE * thickness_px].sum() > _LEAST_STRAIGHT * lengths.sum()
    )


# Meaning -----------------------------------------------------------------------------------------


def _measure_scale(strokes: Strokes, gaps: list[Gap]) -> float:
    """Metres per pixel: from doors drawn with their arcs, else with a leaf, else from the walls."""
    for doors in (
        [g for g in gaps if g.has_arc],
        [g for g in gaps if g.has_leaf and not g.has_pane],
    ):
        if len(doors) >= _ENOUGH_DOORS:
            # Wider ones are double doors, or lead to a balcony.
            lengths_px = [gap.length_px for gap in doors]
            return _USUAL_DOOR_M / float(np.percentile(lengths_px, 25))
    return WALL_THICKNESS_M / strokes.thickness_px


def _kind(gap: Gap, regions: Labels) -> OpeningKind:
    """Door by its arc, or by its leaf; window by its panes in an outer wall; else a passage."""
    inside = all(_sides(gap, regions))
    if gap.has_arc or (gap.has_leaf and not (gap.has_pane and not inside)):
        return "door"
    if gap.has_pane:
        return "door" if inside else "window"
    return "passage" if inside else "door"
