"""The dining group: a table with chairs around it, and a dining cabinet."""

from __future__ import annotations

from typing import NamedTuple

from chord_usd.workshop.data.furnish import sizes
from chord_usd.workshop.data.furnish.floor import Floor, Size
from chord_usd.workshop.data.furnish.free_spans import MARGIN_M, REACH, Wall
from chord_usd.workshop.data.furnish.storage import put_dining_cabinet
from chord_usd.workshop.data.furnish.walkways import path_faults

PULL_OUT_M = 0.2
"""Free floor behind the chairs, to pull them out."""

ELBOW_M = 0.1
"""Free floor beside the table where nobody sits."""

HIGHEST_M = 0.9
"""Chairs are no higher, so that they may stand under a window."""

MOST_PLACES = 4
"""Places tried for one group before a smaller one is taken."""

_TABLE_M = {8: (2.0, 1.0), 6: (1.6, 0.85), 4: (1.2, 0.8), 3: (1.0, 0.75), 2: (0.8, 0.75)}
"""Least length and width of a table by its seats."""


_SIZES = (
    (8, False), (6, False), (4, False), (4, True), (3, True), (2, False), (2, True)
)  # fmt: skip
"""Seats, and whether the table stands at a wall; what one would like best first."""


class Group(NamedTuple):
    """A table with its chairs, in the table's frame: along it, and across it away from the wall."""

    table: Size
    chair: Size
    chairs: tuple[tuple[float, float, int], ...]
    """Along, across, and the way each chair faces as quarter turns from looking off the wall."""
    length_m: float
    """Of the whole group."""
    deep_m: float
    at_wall: bool
    """The table's back touches the wall and nobody sits there."""


class Place(NamedTuple):
    """Where the group may go: the middle of its rectangle."""

    score: float
    wall: Wall
    s: float
    t: float
    turned: bool
    """The table stands across the wall."""


def furnish_dining(floor: Floor) -> None:
    """The table in the middle of the room, a cabinet at a wall."""
    put_dining_table(floor, core=True)
    if floor.dice.random() < floor.mix.dining_cabinet:
        longest = floor.dice.uniform(1.2, 2.0)
        put_dining_cabinet(floor, longest)


def put_dining_table(floor: Floor, *, core: bool = False) -> bool:
    """The largest group that fits, of 8 seats down to 2. Returns whether one was put."""
    dice = floor.dice
    if floor.area_m2 > 16.0:
        wanted = dice.choices((8, 6, 4), (0.2, 0.5, 0.3))[0]
    else:
        wanted = 6 if floor.area_m2 > 9.0 and dice.random() < 0.5 else 4
    return any(
        _put_group(floor, _group(floor, seats, at_wall=at_wall), core)
        for seats, at_wall in _SIZES
        if seats <= wanted
    )


def _group(floor: Floor, seats: int, *, at_wall: bool) -> Group:
    dice = floor.dice
    length, width = _TABLE_M[max(seats, 3) if at_wall else seats]
    table = (
        length + sizes.between(dice, 0.0, 0.2 if seats in (2, 3, 8) else 0.5),
        width + sizes.between(dice, 0.0, 0.2 if 3 < seats < 8 else 0.0),
        sizes.between(dice, 0.72, 0.78, 0.01),
    )
    chair = (
        sizes.between(dice, 0.44, 0.56, 0.02),
        sizes.between(dice, 0.48, 0.58, 0.02),
        sizes.between(dice, 0.8, HIGHEST_M),
    )
    ends = 2 if seats == 8 or (at_wall and seats == 4) else int(at_wall and seats == 3)
    sides = (1,) if at_wall else (-1, 1)
    most_m = table[0] * len(sides) / max(seats - ends, 1) - MARGIN_M
    chair = (min(chair[0], most_m), chair[1], chair[2])
    off = chair[1] / 2
    chairs = [
        (along, side * (table[1] / 2 + off), 2 if side > 0 else 0)
        for side in sides
        for along in _seats_along(table[0], (seats - ends) // len(sides))
    ]
    chairs += [(-table[0] / 2 - off, 0.0, 3), (table[0] / 2 + off, 0.0, 1)][:ends]
    seat_m = off + chair[1] / 2
    # One chair at an end takes its room on both, which keeps the table in the middle.
    length_m = table[0] + 2 * (seat_m if ends else ELBOW_M)
    return Group(table, chair, tuple(chairs), length_m, table[1] + len(sides) * seat_m, at_wall)


def _seats_along(length: float, seats: int) -> list[float]:
    return [(i + 0.5) * length / seats - length / 2 for i in range(seats)]


def _put_group(floor: Floor, group: Group, core: bool) -> bool:
    """Put it where it leaves the ways through the room free."""
    for place in _places(floor, group)[:MOST_PLACES]:
        mark = floor.mark()
        _stand(floor, place, group, core)
        if not path_faults(floor):
            return True
        floor.undo(mark)
    return False


def _places(floor: Floor, group: Group) -> list[Place]:
    """Best first: as central in the free floor as possible."""
    places = []
    for wall in floor.walls:
        if group.at_wall:
            places += _places_at(floor, wall, group.length_m, group.deep_m, 0.0, False)
            continue
        for turned in (False, True):
            wide, deep = group.length_m, group.deep_m
            if turned:
                wide, deep = group.deep_m + 2 * PULL_OUT_M, group.length_m
            if wall.length < wide:
                continue
            near = ELBOW_M if turned else PULL_OUT_M
            across = _across(floor, wall)
            middle = (across[0] - deep) / 2
            if across[1] and near + deep > across[1] + 0.05:
                continue
            if middle > near - 0.05:
                places += _places_at(floor, wall, wide, deep, max(near, middle), turned)
            if middle > near + 0.3 or middle < near - 0.05:
                places += _places_at(floor, wall, wide, deep, near, turned)
    places.sort(key=lambda place: place.score, reverse=True)
    return places


def _places_at(
    floor: Floor, wall: Wall, wide: float, deep: float, near: float, turned: bool
) -> list[Place]:
    places = []
    reach = ELBOW_M if turned else PULL_OUT_M
    for s_from, s_to in wall.gaps(deep, HIGHEST_M, reach, wide, near):
        s = (s_from + s_to) / 2
        if s_to - s_from > wide + 2.0:
            s = s_from + wide / 2 + 0.5
        score = floor.dice.random() * 0.8 + min(s_to - s_from - wide, 1.0) + min(near, 0.8)
        places.append(Place(score, wall, s, near + deep / 2, turned))
    return places


def _across(floor: Floor, wall: Wall) -> tuple[float, float]:
    """Distances to the nearest and the farthest wall that face this one; 0 where none does."""
    depths = [wall.local(other.x, other.y)[1] for other in floor.facing(wall)]
    return min(depths, default=0.0), max(depths, default=0.0)


def _stand(floor: Floor, place: Place, group: Group, core: bool) -> None:
    """Put the table and its chairs, and keep the floor they take."""
    _, wall, s, t, turned = place
    floor.new_group()
    table_t = group.table[1] / 2 if group.at_wall else t
    quarter = 1 if turned else 0
    floor.put_turned("dining_table", wall, s, table_t, group.table, quarter, core=core)
    for along, across, facing in group.chairs:
        if turned:
            along, across = -across, along
        facing = (facing + quarter) % 4
        floor.put_turned("chair", wall, s + along, table_t + across, group.chair, facing, core=core)
    half_s, half_t = group.length_m / 2, group.deep_m / 2
    if turned:
        half_s, half_t = half_t, half_s
    floor.keep(wall, s - half_s, s + half_s, t - half_t, t + half_t, REACH)
