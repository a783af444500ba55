"""Regions of a page between its walls: which are rooms, and what their outlines are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon

from chord_usd.base.raster.page_labels import (
    FLOOR,
    OUTSIDE,
    STAIRS,
)
from chord_usd.base.raster.vectorize import polygon_from_mask
from chord_usd.base.scene.stair_spirals import is_round
from chord_usd.base.scene.types import OPEN, SURROUNDS, BoolArray, FloatArray
from chord_usd.line.plan.openings import CONFIDENCE
from chord_usd.line.plan.segment import SOLID, Segments, usual_thickness_px
from chord_usd.line.plan.squared import is_askew, squared

_SMALLEST_ROOM_M2 = 0.8
_NARROWEST_ROOM_M = 0.6

_CLEAR = 0.25
"""Floor with a greater chance of a wall or an opening may part two rooms: of the two errors, two
rooms in one is the worse."""

_NECK = 1.5
"""Floor narrower than so many thicknesses of a wall is a hole in what was seen of one: whatever
people walk through has jambs, and is seen as an opening."""

_LEAK, _MOSTLY, _TO_CORNER = 7.0, 0.5, 0.75
"""Walls of rooms that are seen as floor in so large a share have gaps of so many thicknesses at
most: a door's width. So much of a gap lies between what is wider and a corner."""

_NOISE = 0.35
"""By how many thicknesses the rim of a wall strays, beside half a pixel..."""
_GRAINS = 2.5
"""...and by how many of the pixels that were looked at: openings in thin walls bulge so far."""

_USUAL_CORNERS, _MOST_CORNERS = 14, 300
"""Few rooms have more than the first; an outline with more than the second has a torn rim."""
_TOOTH, _TEETH = 2.0, (1.0, 2.0, 3.0)
"""Most edges of a torn rim are shorter than so many thicknesses of a wall. Its teeth are narrower
than these..."""
_FILLS = 0.93
"""...and a room without them shares at least so much with the region that was seen."""

_TORN_M = 0.2
"""Parts of a flight that are no farther apart are one."""
_LEAST_FLIGHT_M = (0.6, 1.2)
"""Sides of what is a flight of stairs to another storey, and not some steps."""

_STAIRWELL = 0.5
"""A room with stairs on so much of its floor is there for them."""

_OPEN_M, _SURROUNDED_M2 = 1.2, 1.0
"""Wider than a door; larger than a chimney."""

_BLOCK = np.ones((3, 3), np.uint8)

Labels = npt.NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Regions:
    """A page's floors and walls as pixels."""

    labels: Labels
    """(H, W) a number for each region of floor, 0 for walls and outside."""
    solid: BoolArray
    """(H, W) what parts rooms: walls, and openings in them."""
    thickness_px: float
    """Of the usual wall."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A room of a page."""

    polygon_px: FloatArray
    """(N, 2) corners."""
    confidence: float
    """How sure it is that this is a room, [0, 1]: by its floor and its rim."""
    open_px: float
    """How much of its rim lies at the outside with nothing between."""
    surrounded_px2: float
    """What walls within it take up: a shaft, or the well of a staircase."""
    kinds: FloatArray
    """Chances of KIND_NAMES by what is drawn in it."""
    stairs: float
    """Share of its floor that stairs take up."""

    def extra(self, m_per_px: float) -> dict[str, float]:
        """For Room.extra."""
        open_m = round(self.open_px * m_per_px, 2)
        inside_m2 = round(self.surrounded_px2 * m_per_px**2, 1)
        return {
            CONFIDENCE: self.confidence,
            **({OPEN: open_m} if open_m > _OPEN_M else {}),
            **({SURROUNDS: inside_m2} if inside_m2 >= _SURROUNDED_M2 else {}),
        }


def find_regions(segments: Segments) -> Regions:
    """Regions of floor of a page."""
    seen = segments.most_likely
    solid = np.isin(seen, SOLID)
    thickness_px = usual_thickness_px(solid)
    floor = np.isin(seen, (FLOOR, STAIRS)) | _enclosed(seen == OUTSIDE)
    floor |= _leaked(solid, floor, _LEAK * thickness_px)
    clear = floor & (segments.barrier < _CLEAR)
    return Regions(_parted(floor, clear, _NECK * thickness_px), solid, thickness_px)


def _enclosed(outside: BoolArray) -> BoolArray:
    """(H, W) what is seen as outside, but cannot be reached from the picture's edge: floors without
    anything on them look like paper."""
    _, labels = cv2.connectedComponents(np.pad(outside, 1, constant_values=True).astype(np.uint8))
    return outside & (labels != labels[0, 0])[1:-1, 1:-1]


def _leaked(solid: BoolArray, floor: BoolArray, gap_px: float) -> BoolArray:
    """(H, W) what is seen as outside in rooms that are mostly floor, since walls seem to have gaps.

    solid: what parts rooms. gap_px: through what is narrower nothing gets in.
    """
    free = np.pad(~solid, 1, constant_values=True).astype(np.uint8)
    wide = (cv2.distanceTransform(free, cv2.DIST_L2, 5) > gap_px / 2).astype(np.uint8)
    wide[[0, -1]] = wide[:, [0, -1]] = 1
    _, cores = cv2.connectedComponents(wide, connectivity=8)
    beyond = cores[0, 0]
    cores = cores[1:-1, 1:-1]
    sizes = np.bincount(cores.ravel())
    shares = np.bincount(cores[floor], minlength=len(sizes)) / np.maximum(sizes, 1)
    rooms = np.flatnonzero((shares >= _MOSTLY) & (shares < 1.0))
    inside = np.isin(cores, rooms[(rooms > 0) & (rooms != beyond)])
    if not inside.any():
        return inside
    to_room, to_page = (
        cv2.distanceTransform((~near).astype(np.uint8), cv2.DIST_L2, 5)
        for near in (inside, cores == beyond)
    )
    return ~solid & ~floor & (to_room <= _TO_CORNER * gap_px) & (to_room < to_page)


def _parted(floor: BoolArray, clear: BoolArray, neck_px: float) -> Labels:
    """(H, W) numbers of floors; those that hang together by a neck only are two.

    clear: floor on which hardly anything that parts rooms is suspected.
    """
    depths = cv2.distanceTransform(clear.astype(np.uint8), cv2.DIST_L2, 5)
    count, whole = cv2.connectedComponents(floor.astype(np.uint8), connectivity=4)
    _, cores = cv2.connectedComponents((depths > neck_px / 2).astype(np.uint8), connectivity=8)
    parts: Labels = np.asarray(whole, np.int32)
    for label in range(1, count):
        region = whole == label
        numbers = np.unique(cores[region])
        numbers = numbers[numbers > 0]
        if len(numbers) < 2:
            continue
        # Each pixel goes to the core that it is nearest to.
        away = np.array([
            cv2.distanceTransform((cores != number).astype(np.uint8), cv2.DIST_L2, 5)[region]
            for number in numbers
        ])  # fmt: skip
        nearest = away.argmin(axis=0)
        parts[region] = np.where(nearest == 0, label, parts.max() + nearest)
    return parts


# Rooms -------------------------------------------------------------------------------------------


def room_outlines(regions: Regions, segments: Segments, m_per_px: float) -> list[Outline]:
    """Outlines of the regions that are large enough for rooms."""
    noise_px = 0.5 + max(_NOISE * regions.thickness_px, _GRAINS * segments.grain_px)
    masks = [regions.labels == number for number in large_regions(regions.labels, m_per_px)]
    polygons = [_polygon(mask, noise_px, regions.thickness_px) for mask in masks]
    if polygons and not is_askew(polygons):
        pairs = zip(polygons, masks, strict=True)
        polygons = [squared(polygon, mask, regions.thickness_px) for polygon, mask in pairs]
    return [
        _outline(polygon, mask, segments) for polygon, mask in zip(polygons, masks, strict=True)
    ]


def large_regions(labels: Labels, m_per_px: float) -> Labels:
    """Numbers of the regions, (H, W) with 0 for none, that are large enough for rooms.

    One that another one encloses is none: a shaft, or the well of a staircase.
    """
    areas = np.bincount(labels.ravel())
    # Half of the room's least width is how far its middle must be from its walls.
    depths = cv2.distanceTransform((labels > 0).astype(np.uint8), cv2.DIST_L2, 3)
    wide = np.unique(labels[depths * m_per_px >= _NARROWEST_ROOM_M / 2])
    large: Labels = wide[(areas[wide] * m_per_px**2 >= _SMALLEST_ROOM_M2) & (wide > 0)]
    return large[~_is_enclosed(labels, large)]


def _is_enclosed(labels: Labels, numbers: Labels) -> BoolArray:
    """Which of the regions lie inside the outer edge of another."""
    inside = np.zeros(len(numbers), bool)
    starts = [np.argwhere(labels == number)[0, ::-1] for number in numbers]
    for number in numbers:
        outer, _ = cv2.findContours(
            (labels == number).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE
        )
        for at, start in enumerate(starts):
            spot = (float(start[0]), float(start[1]))
            is_in = any(cv2.pointPolygonTest(edge, spot, False) > 0 for edge in outer)
            inside[at] |= is_in and numbers[at] != number
    return inside


def _outline(polygon: FloatArray, mask: BoolArray, segments: Segments) -> Outline:
    floor = segments.built[FLOOR][mask] + segments.built[STAIRS][mask]
    rim = (cv2.dilate(mask.astype(np.uint8), np.ones((7, 7), np.uint8)) > 0) & ~mask
    sure = float(min(floor.mean(), segments.barrier[rim].mean()))
    beside = (cv2.dilate(mask.astype(np.uint8), _BLOCK) > 0) & ~mask
    open_px = float((segments.most_likely[beside] == OUTSIDE).sum())
    return Outline(
        polygon, round(sure, 2), open_px, surrounded_px2(mask),
        segments.kinds[:, mask].mean(axis=1), float(segments.built[STAIRS][mask].mean()),
    )  # fmt: skip


def surrounded_px2(mask: BoolArray) -> float:
    """Area of the holes of a region."""
    whole = mask.astype(np.uint8)
    outer, _ = cv2.findContours(whole, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    return float(cv2.drawContours(whole, outer, -1, (1,), cv2.FILLED).sum() - mask.sum())


def stair_outlines(segments: Segments, m_per_px: float) -> list[FloatArray]:
    """(N, 2) corners of each flight of stairs: the least rectangles that hold them, and of what is
    round a circle's."""
    seen = (segments.most_likely == STAIRS).astype(np.uint8)
    torn = max(1, round(_TORN_M / m_per_px))
    closed = cv2.morphologyEx(seen, cv2.MORPH_CLOSE, np.ones((torn, torn), np.uint8))
    outlines = []
    for outline in cv2.findContours(closed, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)[0]:
        around = cv2.minAreaRect(outline)
        if min(around[1]) * m_per_px >= _LEAST_FLIGHT_M[0] and (
            max(around[1]) * m_per_px >= _LEAST_FLIGHT_M[1]
        ):
            circle = _circle_of(np.asarray(outline[:, 0], np.float64))
            corners = cv2.boxPoints(around) if circle is None else circle
            outlines.append(np.asarray(corners, np.float64) + 0.5)
    return outlines


def _circle_of(outline: FloatArray) -> FloatArray | None:
    """(N, 2) corners of the circle that an outline (N, 2) is about; None where it is no circle."""
    if len(outline) < 4:
        return None
    around = Polygon(outline).convex_hull
    if not isinstance(around, Polygon) or not is_round(around):
        return None
    circle = around.centroid.buffer(math.sqrt(around.area / math.pi))
    return np.asarray(circle.exterior.coords)[:-1]


def _polygon(mask: BoolArray, noise_px: float, thickness_px: float) -> FloatArray:
    """The outline of a room, with no more corners than rooms have: torn rims are smoothed."""
    polygon = polygon_from_mask(mask, noise_px)
    for teeth in _TEETH if _is_torn(polygon, thickness_px) else ():
        whole = _without_teeth(mask, max(3, round(teeth * thickness_px)))
        is_alike = (whole & mask).sum() > _FILLS * (whole | mask).sum()
        smooth = polygon_from_mask(whole, noise_px) if is_alike else polygon
        if len(smooth) <= _USUAL_CORNERS:
            return smooth
    if len(polygon) > _MOST_CORNERS:
        polygon = np.array(Polygon(polygon).simplify(noise_px).exterior.coords)[:-1]
    return polygon


def _is_torn(polygon: FloatArray, thickness_px: float) -> bool:
    """Whether most edges of an outline with many corners are no longer than teeth."""
    lengths = np.hypot(*(np.roll(polygon, -1, axis=0) - polygon).T)
    short = lengths < _TOOTH * thickness_px
    return len(polygon) > _USUAL_CORNERS and bool(short.mean() > 0.5)


def _without_teeth(mask: BoolArray, size_px: int) -> BoolArray:
    """A region (H, W) without gaps and spikes narrower than a square of this size."""
    square = np.ones((size_px, size_px), np.uint8)
    padded = np.pad(mask.astype(np.uint8), size_px)
    for way in (cv2.MORPH_CLOSE, cv2.MORPH_OPEN):
        padded = np.asarray(cv2.morphologyEx(padded, way, square), np.uint8)
    return padded[size_px:-size_px, size_px:-size_px] > 0


def is_stairwell(outline: Outline) -> bool:
    """Whether a room is there for its stairs."""
    return outline.stairs > _STAIRWELL
