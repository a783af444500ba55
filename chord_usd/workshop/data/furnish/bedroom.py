"""Bedrooms: the bed group, a wardrobe, a desk, sometimes a television or an armchair."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from chord_usd.workshop.data.furnish import sizes
from chord_usd.workshop.data.furnish.floor import Floor, Size, Spot
from chord_usd.workshop.data.furnish.free_spans import MARGIN_M, REACH, SOLID, Wall
from chord_usd.workshop.data.furnish.mix import count_of
from chord_usd.workshop.data.furnish.storage import put_armchair, put_cabinet
from chord_usd.workshop.data.furnish.walkways import path_faults
from chord_usd.workshop.data.furnish.workplace import put_desk

SIDE_M = 0.5
"""Room to get into bed."""

FOOT_M = 0.55
"""Room to walk past the foot of the bed."""


SLIT_M = 0.02, 0.4
"""Between bed and wall this much is too little to walk and too much to leave."""

MOST_PLACES = 4
"""Places tried for one bed before a narrower one is taken."""


class BedPlace(NamedTuple):
    """Where the bed may go."""

    score: float
    wall: Wall
    s: float
    left_m: float
    """Free floor between the bed and what is beside it, towards smaller s."""
    right_m: float


def furnish_bedroom(floor: Floor) -> None:
    """Furnish in the order of importance; what no longer fits is left out."""
    dice, mix = floor.dice, floor.mix
    place = put_bed(floor)
    storage = mix.storage if floor.area_m2 > 8.0 else mix.storage_small
    _put_storage_and_desk(floor, dice.random() < storage, dice.random() < mix.desk)
    if place and floor.area_m2 > 10.0 and dice.random() < mix.bedroom_television:
        _put_television(floor, place)
    if floor.area_m2 > mix.bedroom_armchair_from_m2 and dice.random() < mix.bedroom_armchair:
        put_armchair(floor)
    if floor.area_m2 > mix.chest_from_m2 and dice.random() < mix.chest_besides:
        put_cabinet(floor, tall=False, longest=1.4)


def _put_storage_and_desk(floor: Floor, has_storage: bool, has_desk: bool) -> None:
    """The desk, which needs the larger place, first; but not in the wardrobe's stead."""
    mark = floor.mark()
    if has_desk and put_desk(floor) and (not has_storage or _put_wardrobe(floor)):
        return
    if has_storage:
        floor.undo(mark)
        _put_wardrobe(floor)


def _put_wardrobe(floor: Floor) -> bool:
    """A wardrobe, or a chest of drawers, where that is all the storage there is."""
    dice = floor.dice
    if dice.random() < floor.mix.chest:
        return put_cabinet(floor, tall=False, longest=dice.uniform(0.8, 1.3))
    usual = min(2.8, max(0.8, 0.8 + 0.08 * floor.area_m2 + dice.uniform(-0.4, 0.6)))
    return put_cabinet(floor, tall=True, longest=usual)


def put_bed(floor: Floor) -> BedPlace | None:
    """The widest bed that suits the room's area and fits; narrower ones after it."""
    dice = floor.dice
    spare: tuple[BedPlace, Size, Size | None] | None = None
    for size in _bed_sizes(floor):
        has_panel = size[0] >= 1.2 and dice.random() < 0.8
        panel = sizes.panel(dice, "bed_background", size[0]) if has_panel else None
        for place in _places(floor, size, panel[1] if panel else 0.0)[:MOST_PLACES]:
            mark = floor.mark()
            _put_bed_group(floor, place, size, panel)
            if not _is_tricky(floor) or not path_faults(floor):
                return place
            floor.undo(mark)
            spare = spare or (place, size, panel)
    if spare:
        _put_bed_group(floor, *spare)
        return spare[0]
    return None


def _bed_sizes(floor: Floor) -> Iterator[Size]:
    """Beds that suit the room, widest first; where it is tight a short and low one last."""
    for length in sizes.BED_LENGTHS_M:
        widest = 0.75 + floor.mix.bed_m_per_m2 * floor.area_m2 + floor.dice.uniform(-0.1, 0.25)
        if length <= max(0.9, widest):
            yield sizes.bed(floor.dice, length)
    if floor.squeezed:
        yield sizes.LEAST_BED


def _is_tricky(floor: Floor) -> bool:
    """Whether a bed may cut this room in two, as it cannot in a plain one."""
    return len(floor.corners) > 4 or len(floor.doors) > 1


def _places(floor: Floor, size: Size, panel_m: float) -> list[BedPlace]:
    """Places for the bed, best first; those with room to pass its foot, if there are any."""
    depth = panel_m + size[1]
    # A panel hangs higher than any sill.
    height = 9.0 if panel_m else size[2]
    for foot in (FOOT_M, 0.0):
        places = []
        for wall in floor.walls:
            if wall.length < size[0]:
                continue
            spans = wall.gaps(depth, height, foot, size[0])
            walkable = wall.bare_spans(depth + foot, size[0]) if spans else []
            for s_from, s_to in spans:
                low, high = _containing(walkable, s_from, s_to)
                for s in _positions(Spot(wall, s_from, s_to), size[0], low, high):
                    left, right = s - size[0] / 2 - low, high - s - size[0] / 2
                    if max(left, right) >= SIDE_M:
                        score = _score(floor, wall, s, size, left, right)
                        places.append(BedPlace(score, wall, s, left, right))
        if places:
            places.sort(key=lambda place: place.score, reverse=True)
            return places
    return []


def _containing(gaps: list[tuple[float, float]], low: float, high: float) -> tuple[float, float]:
    """The gap around [low, high]; itself where none is."""
    for a, b in gaps:
        if a <= low + 1e-6 and b >= high - 1e-6:
            return a, b
    return low, high


def _positions(spot: Spot, length: float, low: float, high: float) -> list[float]:
    """Middles to try: centred on the wall, centred in the span, and close to its ends."""
    half = length / 2
    first, last = spot.s_from + half, spot.s_to - half
    positions = [min(max((low + high) / 2, first), last), (first + last) / 2]
    if length < 1.4:
        positions += [first, last]
    if last - first > 1.0:
        positions += [first + 0.6, last - 0.6]
    return positions


def _score(floor: Floor, wall: Wall, s: float, size: Size, left: float, right: float) -> float:
    """How well a designer would like the bed here."""
    score = floor.dice.uniform(0.0, 0.6) + 0.12 * wall.length
    free = (min(left, 0.7), min(right, 0.7))
    # A wide bed is entered from both sides, a narrow one may stand along a wall.
    score += 1.5 * min(free) if size[0] > 1.3 else 0.4 * max(free)
    score -= 0.3 * min(abs(left - right), 2.0)
    if SLIT_M[0] < min(left, right) < SLIT_M[1]:
        score -= 1.0
    if wall.has_window:
        score -= 1.2
    if wall.has_door:
        score -= 0.5
    x, y = wall.world(s, size[1] / 2)
    score += 0.25 * min(3.0, floor.distance_to_door(x, y))
    return score


def _put_bed_group(floor: Floor, place: BedPlace, size: Size, panel: Size | None) -> None:
    wall, s = place.wall, place.s
    floor.new_group()
    back = 0.0
    if panel:
        floor.put("bed_background", wall, s, panel)
        back = panel[1]
    floor.put("bed", wall, s, size, back=back, core=True)
    tables = _put_bedside_tables(floor, place, size)
    _keep_bed_sides(floor, place, size, back, tables)


def _put_bedside_tables(floor: Floor, place: BedPlace, size: Size) -> tuple[bool, bool]:
    """None, one or two of the same kind, beside the headboard, flush with the wall."""
    dice = floor.dice
    mix = floor.mix
    wanted = count_of(dice, mix.bedside_wide if size[0] > 1.3 else mix.bedside_narrow)
    usual = sizes.sampled(dice, "bedside_table", shortest=0.4, longest=0.6)
    usual = (usual[0], min(usual[1], usual[0]), usual[2])
    gap = dice.choice((0.0, 0.0, MARGIN_M))
    small = (0.35, 0.35, usual[2])
    for table, off in ((usual, gap), (small, 0.0)):
        put = _put_beside(floor, place, size, table, off, wanted)
        if any(put):
            return put
    return False, False


def _put_beside(
    floor: Floor, place: BedPlace, size: Size, table: Size, gap: float, wanted: int
) -> tuple[bool, bool]:
    """Up to so many of these tables. Returns whether one stands on the left, and the right."""
    dice = floor.dice
    sides = [-1, 1] if dice.random() < 0.5 else [1, -1]
    put = {-1: False, 1: False}
    for side in sides:
        s = place.s + side * (size[0] / 2 + gap + table[0] / 2)
        low, high = s - table[0] / 2, s + table[0] / 2
        if sum(put.values()) < wanted and place.wall.fits(low, high, 0.0, table[1], table[2]):
            floor.new_group()
            floor.put("bedside_table", place.wall, s, table)
            put[side] = True
    return put[-1], put[1]


def _keep_bed_sides(
    floor: Floor, place: BedPlace, size: Size, back: float, tables: tuple[bool, bool]
) -> None:
    """Keep the ways into the bed free: both sides of a wide one where there is room."""
    wall, half = place.wall, size[0] / 2
    front = back + size[1]
    sides = (
        (place.s - half - SIDE_M, place.s - half, place.left_m, tables[0]),
        (place.s + half, place.s + half + SIDE_M, place.right_m, tables[1]),
    )
    for low, high, free, has_table in sides:
        if free >= SIDE_M - 1e-6:
            near = 0.55 if has_table else back + 0.4
            if wall.fits(low, high, near, front, bits=SOLID):
                floor.keep(wall, low, high, near, front, REACH)
    if wall.fits(place.s - half, place.s + half, front, front + FOOT_M, bits=SOLID):
        floor.keep(wall, place.s - half, place.s + half, front, front + FOOT_M, REACH)


def _put_television(floor: Floor, place: BedPlace) -> None:
    """A low cabinet opposite the bed, on its axis."""
    dice = floor.dice
    size = sizes.sampled(dice, "tv_cabinet", longest=1.8, deepest=0.45)
    x, y = place.wall.world(place.s, 0.0)
    for wall in floor.facing(place.wall):
        axis, _ = wall.local(x, y)
        for s_from, s_to in wall.gaps(size[1], size[2], 0.6, size[0]):
            s = min(max(axis, s_from + size[0] / 2), s_to - size[0] / 2)
            if abs(s - axis) < 0.4:
                floor.new_group()
                floor.put("tv_cabinet", wall, s, size)
                return
