"""Floors that furniture, rugs and photographs cut in two become whole again.

Between rooms there is a wall with a door in it, or an opening with jambs. Where most of what parts
two floors is neither wall nor door, one of them is unsure and has no name, and that border is much
of its rim, the border is the edge of a table, a bed or a rug. A floor that a piece of furniture
covers and no door leads to is that piece, one as narrow as a worktop on which a sink or a hob is
drawn is that worktop. A floor that a bath or a shower covers is a niche: of the bathroom beside,
which a toilet or a basin marks, or else of the room that it opens into.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import cv2
import numpy as np
import shapely
from shapely.geometry import Point, Polygon

from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.types import BoolArray, FloatArray, Item, PixelFrame
from chord_usd.base.scene.units import m_from_px
from chord_usd.line.plan.regions import Labels, Regions
from chord_usd.line.plan.seen import SeenReading
from chord_usd.line.plan.wall_openings import borders_between

_OPEN, _DOOR = 0.65, 0.15
"""Of a border, the least share that is no wall, and the greatest that is a door."""
_OF_RIM = 0.16
"""...and its least share of the rim of the floor that is unsure."""
_UNSURE = 0.66
"""Greatest confidence of such a floor."""
_REACH = 2.0
"""What parts two floors is filled up to so many thicknesses of a wall."""

_FURNITURE = frozenset(("bed", "sofa", "single_sofa", "dining_table", "table", "coffee_table"))
NICHES = frozenset(("bathtub", "shower"))
"""Categories that take up all of their niches, onto which no door leads."""
_ON_WORKTOPS = frozenset(("sink_cabinet", "cooker_cabinet"))
_COVERED, _WITHIN = 0.55, 0.65
"""Least share of a floor that is a piece, or its niche, that the piece covers; and of the piece
that lies on it."""
_NICHE_OPEN, _WET_OPEN = 0.5, 0.2
"""Least share of a niche's border that is no wall: with any room, and with a bathroom."""
_WET = frozenset(("toilet", "washbasin"))
_WORKTOP_M, _REST = 0.75, 0.05
"""A floor is a worktop if no more than this share of it is left of what is wider."""

Borders = Mapping[tuple[int, int], FloatArray]


def without_false_borders(reading: SeenReading, named: Sequence[bool]) -> SeenReading:
    """A reading with floors joined that no wall parts. named: whether each room has a name."""
    rims = [Polygon(polygon).length for polygon in reading.polygons_px]
    pairs = []
    for pair, sums in _borders(reading).items():
        length, is_open, is_door = sums.tolist()
        is_false = is_open >= _OPEN * length and is_door <= _DOOR * length
        unsure = [
            room for room in pair
            if not named[room] and reading.outlines[room].confidence <= _UNSURE
        ]  # fmt: skip
        if is_false and any(length >= _OF_RIM * rims[room] for room in unsure):
            pairs.append(pair)
    return _joined(reading, pairs)


def without_pieces(
    reading: SeenReading, named: Sequence[bool], pieces: Sequence[Item], frame: PixelFrame
) -> SeenReading:
    """A reading without floors that are furniture, worktops, baths or showers.

    named: whether each room has a name. pieces: what is drawn, metres. frame: of the reading."""
    floors = [Polygon(m_from_px(polygon, frame)).buffer(0) for polygon in reading.polygons_px]
    unnamed = [room for room, is_named in enumerate(named) if not is_named]
    wet = {room for room, floor in enumerate(floors) if _holds(floor, pieces, _WET)}
    borders: Borders = {}
    pairs = []
    for room in unnamed:
        is_niche = _is_covered(floors[room], pieces, NICHES)
        if not (is_niche or _is_covered(floors[room], pieces, _FURNITURE)
                or _is_worktop(floors[room], pieces)):  # fmt: skip
            continue
        borders = borders or _borders(reading)
        of_room = {pair: sums for pair, sums in borders.items() if room in pair}
        of_bathroom = {
            pair: sums for pair, sums in of_room.items() if wet.intersection(pair) - {room}
        }
        if is_niche:
            joined = _widest(of_room, of_bathroom, _WET_OPEN) or _widest(
                of_room, of_room, _NICHE_OPEN
            )
        else:
            joined = _widest(of_room, of_room, 0.0)
        pairs += joined
    return _joined(reading, pairs)


def _holds(floor: Polygon, pieces: Sequence[Item], names: Collection[str]) -> bool:
    """Whether the middle of such a piece is drawn on a floor."""
    spots = (Point(piece.box.center_m[:2]) for piece in pieces if piece.category in names)
    return any(floor.covers(spot) for spot in spots)


def _is_covered(floor: Polygon, pieces: Sequence[Item], names: Collection[str]) -> bool:
    """Whether a floor is such pieces, and most of these lies on it."""
    outlines = [footprint_polygon(piece.box) for piece in pieces if piece.category in names]
    covered = shapely.union_all(outlines).intersection(floor).area
    touched = sum(outline.area for outline in outlines if outline.intersects(floor))
    return bool(covered >= _COVERED * floor.area and covered >= _WITHIN * touched)


def _is_worktop(floor: Polygon, pieces: Sequence[Item]) -> bool:
    """Whether a floor is as narrow as a worktop, and holds a sink or a hob."""
    wider = floor.buffer(-_WORKTOP_M / 2).buffer(_WORKTOP_M / 2)
    return wider.area <= _REST * floor.area and _holds(floor, pieces, _ON_WORKTOPS)


def _widest(of_room: Borders, among: Borders, least_open: float) -> list[tuple[int, int]]:
    """Of the borders of a room the pair where most of its rim lies, or is no wall if it has to be
    open; none for a room with a door. among: those to choose from."""
    doors, rim = (sum(float(sums[at]) for sums in of_room.values()) for at in (2, 0))
    sizes = {
        pair: float(sums[1] if least_open else sums[0])
        for pair, sums in among.items()
        if sums[1] >= least_open * sums[0]
    }
    return [max(sizes, key=lambda pair: sizes[pair])] if sizes and doors <= _DOOR * rim else []


def _borders(reading: SeenReading) -> Borders:
    return borders_between(reading.polygons_px, reading.segments, reading.regions.thickness_px)


def _joined(reading: SeenReading, pairs: Sequence[tuple[int, int]]) -> SeenReading:
    """A reading with pairs of rooms, by index, as one floor each."""
    if not pairs:
        return reading
    regions = reading.regions
    labels, solid = regions.labels.copy(), regions.solid.copy()
    numbers = [_number_of(polygon, labels) for polygon in reading.polygons_px]
    reach = max(2, round(_REACH * regions.thickness_px))
    count = 0
    for room, other in pairs:
        first, second = numbers[room], numbers[other]
        gap = _between(labels == first, labels == second, reach) & (labels == 0)
        if 0 in (first, second) or first == second or not _joins(gap, labels, first, second):
            continue
        labels[gap | (labels == second)] = first
        solid[gap] = False
        numbers = [first if number == second else number for number in numbers]
        count += 1
    return reading.with_joined(Regions(labels, solid, regions.thickness_px), count)


def _joins(gap: BoolArray, labels: Labels, first: int, second: int) -> bool:
    """Whether two regions hang together once a gap is floor."""
    whole = gap | (labels == first) | (labels == second)
    _, parts = cv2.connectedComponents(whole.astype(np.uint8), connectivity=4)
    return bool(np.isin(parts[labels == first], parts[labels == second]).any())


def _number_of(polygon_px: FloatArray, labels: Labels) -> int:
    """The number of a room's region."""
    inner = Polygon(polygon_px).representative_point()
    return int(labels[int(inner.y), int(inner.x)])


def _between(first: BoolArray, second: BoolArray, reach_px: int) -> BoolArray:
    """(H, W) what lies between two regions along a row or a column, no farther from either."""
    contact = np.zeros(first.shape, bool)
    for size, ends in (((reach_px, 1), ((0, 0), (reach_px - 1, 0))),
                       ((1, reach_px), ((0, 0), (0, reach_px - 1)))):  # fmt: skip
        kernel = np.ones(size[::-1], np.uint8)
        grown = [
            [cv2.dilate(mask.astype(np.uint8), kernel, anchor=end) > 0 for end in ends]
            for mask in (first, second)
        ]
        contact |= (grown[0][0] & grown[1][1]) | (grown[0][1] & grown[1][0])
    return contact
