"""Rooms that no way leads into get the likeliest one; scraps of neighbours are left out.

People enter every room. Where the reading shows no door between a part of the house and the rest,
a window onto a balcony is a glazed door, an outer door before which the swing of its leaf cut a
floor leads onto that floor, and else a door stands where the wall between looks least like one,
clear of what is drawn. Such doors are guesses: they are marked, drawn as unsure, and say nothing
of kinds, scale, dwellings or the verdict. A floor without a name that the picture's edge cuts off,
and that no sure door joins to the plan, belongs to the neighbours.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.polygon import orient

from chord_usd.base.raster.page_labels import DOOR, FLOOR, PASSAGE, STAIRS
from chord_usd.base.scene.geometry import hanging_together, polygons_of, seams
from chord_usd.base.scene.types import WET_KINDS, FloatArray, Opening, Room
from chord_usd.line.plan.openings import CONFIDENCE
from chord_usd.line.plan.scale_choice import USUAL_DOOR_M
from chord_usd.line.plan.seen import SeenReading
from chord_usd.line.plan.wall_openings import Wall, WallOpening, door_in, profile_of, walls_between

_PASSED_M = 0.5
"""What is narrower is no way."""
_LEAST_M2 = 1.0
"""Of the floor of a part that needs a way in."""
_LEAST_SIGN = 0.12
"""Share that is no wall; below it nothing shows where in a wall a door is."""
_BEFORE_M = 0.6
"""Before a guessed door nothing is drawn so near, where another place in its wall will do."""
_TOUCHED_M2 = 0.02
_STEPPED_M, _ONTO = 0.5, 0.6
"""A door leads onto a bath that covers such a share of its floor, so deep."""
_SHUT = {"bedroom", "unknown", *WET_KINDS}
_PASSED = (DOOR, PASSAGE, FLOOR, STAIRS)
_TOUCH_PX = 1.0
_SURE = 0.5
"""Least chance of a door that joins a floor at the picture's edge to the plan."""
_AT_EDGE = 0.012
"""Of the picture's shorter side: a floor that comes so near to its edge is cut off there."""
_MOST_CUT = 0.2
"""Share of all floor from which on what is cut off is no scrap."""


@dataclass(frozen=True, eq=False)
class _Way:
    """A door that may lead into a room."""

    sign: float
    """How much speaks for it."""
    door: WallOpening
    floor_px: FloatArray | None = None
    """Outline of the second room with the floor before the door; None where it stays."""


def with_ways_in(
    reading: SeenReading, m_per_px: float, drawn_px: Sequence[Polygon] = ()
) -> SeenReading:
    """A reading in which each part that no way leads into has the likeliest one, if there is any
    sign of it. drawn_px: footprints of drawn furniture and fixtures."""
    groups = _groups(reading, _PASSED_M / m_per_px)
    if len(groups) < 2:
        return reading
    group_of = {room: number for number, group in enumerate(groups) for room in group}
    entered = {group_of[o.rooms[0][0]] for o in reading.openings
               if o.kind == "door" and len(o.rooms) == 1}  # fmt: skip
    # Nobody enters niches and shafts.
    floors = [Polygon(polygon).area * m_per_px**2 for polygon in reading.polygons_px]
    sizes = [sum(floors[room] for room in group) for group in groups]
    entered |= {number for number, size in enumerate(sizes) if size < _LEAST_M2}
    # Of parts of as many rooms, the largest is where people come from.
    main = max(range(len(groups)), key=lambda index: (len(groups[index]), sizes[index]))
    openings, outlines = list(reading.openings), list(reading.outlines)
    joined: list[tuple[int, int]] = []
    for way in sorted(_ways(reading, m_per_px, drawn_px), key=lambda each: -each.sign):
        inside, beyond = (room for room, _ in way.door.rooms)
        ends = group_of[inside], group_of[beyond]
        together = next(part for part in hanging_together(len(groups), joined) if ends[0] in part)
        is_needed = any(end != main and end not in entered for end in ends)
        if way.sign >= _LEAST_SIGN and ends[1] not in together and is_needed:
            joined.append(ends)
            openings = [o for o in openings if not _is_replaced(o, way.door)] + [way.door]
            if way.floor_px is not None:
                outlines[beyond] = replace(outlines[beyond], polygon_px=way.floor_px)
    return replace(reading, openings=openings, outlines=outlines)


def without_doors_onto_baths(
    reading: SeenReading, m_per_px: float, baths_px: Sequence[Polygon]
) -> SeenReading:
    """A reading without inner doors and passages that lead onto a drawn bath or shower, whose rim
    looks like a leaf. baths_px: their footprints."""
    baths = shapely.union_all(baths_px)
    before = _STEPPED_M / m_per_px

    def is_onto_bath(opening: WallOpening) -> bool:
        span, deep = (-opening.length_px / 2, opening.length_px / 2), opening.depth_px / 2
        steps = [_strip(opening.center_px, opening.along, -outward, span, (deep, deep + before))
                 for _, outward in opening.rooms]  # fmt: skip
        return any(baths.intersection(step).area >= _ONTO * step.area for step in steps)

    kept = [
        opening for opening in reading.openings
        if opening.kind == "window" or len(opening.rooms) < 2 or not is_onto_bath(opening)
    ]  # fmt: skip
    return replace(reading, openings=kept)


def _groups(reading: SeenReading, least_px: float, least_sure: float = 0.0) -> list[list[int]]:
    """Rooms that ways join of so many pixels, and as sure."""
    floors = [Polygon(polygon).buffer(0) for polygon in reading.polygons_px]
    pairs = [(first, other) for first, other, _ in seams(floors, _TOUCH_PX)]
    pairs += [
        (o.rooms[0][0], o.rooms[1][0])
        for o in reading.openings
        if o.kind != "window" and len(o.rooms) == 2
        and o.length_px - sum(o.insets_px) >= least_px and o.confidence >= least_sure
    ]  # fmt: skip
    return hanging_together(len(floors), pairs)


def _ways(reading: SeenReading, m_per_px: float, drawn_px: Sequence[Polygon]) -> Iterator[_Way]:
    """Windows between two rooms and outer doors before floors, as doors, and a door in each wall
    between two rooms."""
    for opening in reading.openings:
        if opening.kind == "window" and len(opening.rooms) == 2:
            yield _Way(1.0, replace(opening, kind="door", is_guess=True))
        elif opening.kind != "window" and len(opening.rooms) == 1:
            yield from _before_cut_floor(opening, reading)
    thickness_px = reading.regions.thickness_px
    length, before = round(USUAL_DOOR_M / m_per_px), _BEFORE_M / m_per_px
    for wall in walls_between(reading.polygons_px, reading.segments, thickness_px):
        is_short = wall.high - wall.low < length
        if wall.other is None or is_short or wall.is_deep(thickness_px):
            continue
        passed = profile_of(wall, reading.segments)[list(_PASSED)].sum(axis=0)
        means = np.convolve(passed, np.full(length, 1.0 / length), "valid")
        clear = _clear(wall, len(means), length, before, drawn_px, _TOUCHED_M2 / m_per_px**2)
        first = int((means + clear).argmax())
        sign = float(means[first])
        yield _Way(sign, door_in(wall, wall.low + first, length, sign))


def _clear(
    wall: Wall,
    count: int,
    length: int,
    before_px: float,
    drawn_px: Sequence[Polygon],
    touched: float,
) -> FloatArray:
    """(count,) 1 where a door from that pixel of a wall on has nothing drawn before it, else 0."""
    edge, across = wall.edge, (-before_px, wall.depth + before_px)
    free = np.ones(count)
    for first in range(count) if drawn_px else ():
        along = wall.low + first, wall.low + first + length
        zone = _strip(edge.start, edge.along, edge.outward, along, across)
        free[first] = all(zone.intersection(piece_px).area <= touched for piece_px in drawn_px)
    return free


def _strip(
    start: FloatArray,
    along: FloatArray,
    outward: FloatArray,
    span: tuple[float, float],
    depth: tuple[float, float],
) -> Polygon:
    """A rectangle by its span along a wall and its depth across, from a point of its face."""
    ends = [(0, 0), (1, 0), (1, 1), (0, 1)]
    return Polygon([start + span[i] * along + depth[j] * outward for i, j in ends])


def _before_cut_floor(opening: WallOpening, reading: SeenReading) -> Iterator[_Way]:
    """An outer door as one onto the floor ahead of it, no farther than its leaf is long."""
    (room, outward), *_ = opening.rooms
    half, thickness = opening.depth_px / 2, reading.regions.thickness_px
    ahead = LineString(
        [opening.center_px, opening.center_px + (half + opening.length_px) * outward]
    )
    floors = [Polygon(polygon).buffer(0) for polygon in reading.polygons_px]
    spots = {number: floor.intersection(ahead) for number, floor in enumerate(floors)
             if number != room and floor.intersects(ahead)}  # fmt: skip
    if not spots:
        return
    beyond = min(spots, key=lambda number: spots[number].distance(Point(opening.center_px)))
    far = spots[beyond].distance(Point(opening.center_px)) + thickness
    span = -opening.length_px / 2, opening.length_px / 2
    strip = _strip(opening.center_px, opening.along, outward, span, (half, far))
    grown = [part for part in polygons_of(floors[beyond].union(strip)) if part.intersects(strip)]
    others = shapely.union_all([floor for number, floor in enumerate(floors) if number != beyond])
    if len(grown) == 1 and not strip.intersects(others):
        corners = np.array(orient(Polygon(grown[0].exterior), -1.0).exterior.coords)[:-1]
        rooms = (*opening.rooms, (beyond, -outward))
        door = replace(opening, kind="door", rooms=rooms, is_guess=True)
        yield _Way(opening.confidence, door, corners)


def _is_replaced(opening: WallOpening, way: WallOpening) -> bool:
    """Whether a way takes the place of an opening between the same rooms, or is that opening."""
    between = opening.center_px - way.center_px
    is_near = bool(np.hypot(*between) < (opening.length_px + way.length_px) / 2)
    return is_near and {room for room, _ in opening.rooms} <= {room for room, _ in way.rooms}


def without_scraps(reading: SeenReading, named: Sequence[bool]) -> tuple[SeenReading, list[str]]:
    """A reading without floors of neighbours, and what to say of them. named: whether each room has
    a name."""
    floors = [Polygon(polygon).area for polygon in reading.polygons_px]
    left = set(range(len(floors)))
    for group in _groups(reading, 0.0, _SURE):
        is_cut = any(_is_cut_off(reading.polygons_px[room], reading) for room in group)
        is_small = sum(floors[room] for room in group) < _MOST_CUT * sum(floors)
        if is_cut and is_small and not any(named[room] for room in group):
            left -= set(group)
    if len(left) == len(floors):
        return reading, []
    gone = len(floors) - len(left)
    which = (
        "a floor that the picture's edge cuts off was"
        if gone == 1
        else f"{gone} floors that the picture's edge cuts off were"
    )
    return reading.of(sorted(left)), [f"{which} left out: without a name or a sure door"]


def _is_cut_off(polygon_px: FloatArray, reading: SeenReading) -> bool:
    """Whether a floor runs out of the picture."""
    height, width = reading.regions.solid.shape
    margin = max(4.0, _AT_EDGE * min(height, width))
    picture = shapely.box(margin, margin, width - margin, height - margin)
    return not picture.covers(Polygon(polygon_px))


def with_rooms_shut(openings: Sequence[Opening], rooms: Sequence[Room]) -> tuple[Opening, ...]:
    """The openings without unsure passages into bedrooms, wet rooms and what may be such, which
    people shut: such a passage is a door if the room has no other way, and else wall."""
    shut = {room.id for room in rooms if room.kind in _SHUT}
    number_of = {room.id: number for number, room in enumerate(rooms)}

    def is_doubtful(opening: Opening) -> bool:
        is_vague = opening.extra.get(CONFIDENCE, 1.0) < _SURE
        return opening.kind == "passage" and len(opening.room_ids) == 2 and is_vague and bool(
            shut.intersection(opening.room_ids)
        )  # fmt: skip

    kept = [opening for opening in openings if not is_doubtful(opening)]
    ways = [
        opening.room_ids
        for opening in kept
        if opening.kind != "window" and len(opening.room_ids) == 2
    ]
    pairs = [(number_of[a], number_of[b]) for a, b in ways]
    doors = count(1 + sum(opening.kind == "door" for opening in openings))
    for opening in filter(is_doubtful, openings):
        a, b = (number_of[room_id] for room_id in opening.room_ids)
        if not any(a in group and b in group for group in hanging_together(len(rooms), pairs)):
            pairs.append((a, b))
            kept.append(replace(opening, id=f"door{next(doors)}", kind="door"))
    return tuple(kept)
