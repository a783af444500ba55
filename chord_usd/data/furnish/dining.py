"""The dining group: a table with chairs on two or four sides, and a dining cabinet."""

from __future__ import annotations

from chord_usd.data.furnish import sizes
from chord_usd.data.furnish.floor import Floor
from chord_usd.data.furnish.storage import put_cabinet
from chord_usd.data.furnish.walls import REACH, Wall

PULL_OUT_M = 0.3
"""Free floor behind the chairs, to pull them out."""


def furnish_dining(floor: Floor) -> None:
    """The table in the middle of the room, a cabinet at a wall."""
    put_dining_table(floor, core=True)
    if floor.dice.random() < 0.6:
        put_cabinet(
            floor, tall=False, longest=floor.dice.uniform(1.2, 2.0), category="dining_cabinet"
        )


def put_dining_table(floor: Floor, *, core: bool = False) -> bool:
    """The largest group that fits: 6-8 chairs, 4, or 2. Returns whether one was put."""
    dice = floor.dice
    if floor.area_m2 > 16.0:
        wanted = dice.choices((8, 6, 4), (0.2, 0.5, 0.3))[0]
    else:
        wanted = 6 if floor.area_m2 > 9.0 and dice.random() < 0.5 else 4
    return any(_put_group(floor, seats, core) for seats in (8, 6, 4, 2) if seats <= wanted)


def _put_group(floor: Floor, seats: int, core: bool) -> bool:
    dice = floor.dice
    length, width = {8: (2.0, 1.0), 6: (1.6, 0.85), 4: (1.2, 0.8), 2: (0.8, 0.75)}[seats]
    table = (
        length + sizes.between(dice, 0.0, 0.2),
        width + sizes.between(dice, 0.0, 0.1 if seats > 2 else 0.0),
        sizes.between(dice, 0.72, 0.78, 0.01),
    )
    chair = (
        sizes.between(dice, 0.42, 0.5, 0.02),
        sizes.between(dice, 0.45, 0.55, 0.02),
        sizes.between(dice, 0.8, 1.0),
    )
    at_ends = seats == 8 or (seats == 6 and table[0] < 1.55)
    gap = sizes.between(dice, 0.0, 0.05, 0.01)
    sides = gap + chair[1] + PULL_OUT_M
    deep = table[1] + 2 * sides
    wide = table[0] + (2 * sides if at_ends else 0.2)
    for size, turned in _turns(floor, wide, deep):
        spot = _free_place(floor, *size)
        if spot:
            _stand(floor, spot, table, chair, seats, gap, at_ends, turned, core)
            _keep_group(floor, spot, size)
            return True
    return False


def _turns(floor: Floor, wide: float, deep: float) -> list[tuple[tuple[float, float], bool]]:
    """Along and across the wall, in random order."""
    turns = [((wide, deep), False), ((deep, wide), True)]
    if floor.dice.random() < 0.5:
        turns.reverse()
    return turns


def _free_place(floor: Floor, wide: float, deep: float) -> tuple[Wall, float, float] | None:
    """(wall, s, t) of the middle of a free rectangle, as central in its free space as possible."""
    best, best_score = None, -1.0
    for wall in floor.walls:
        if wall.length < wide:
            continue
        across = _depth_of(floor, wall)
        for near in {0.0, max(0.0, (across - deep) / 2)}:
            for s_from, s_to in wall.gaps(deep, 9.0, 0.0, wide, near):
                s = (s_from + s_to) / 2
                if s_to - s_from > wide + 2.0:
                    s = s_from + wide / 2 + 0.5
                score = floor.dice.uniform(0.0, 0.8) + min(s_to - s_from - wide, 1.0)
                score += min(near, 0.8)
                if score > best_score:
                    best, best_score = (wall, s, near + deep / 2), score
    return best


def _depth_of(floor: Floor, wall: Wall) -> float:
    """Distance to the nearest wall that faces this one; 0 where none does."""
    depths = [wall.local(other.x, other.y)[1] for other in floor.facing(wall)]
    return min(depths, default=0.0)


def _stand(
    floor: Floor,
    spot: tuple[Wall, float, float],
    table: sizes.Size,
    chair: sizes.Size,
    seats: int,
    gap: float,
    at_ends: bool,
    turned: bool,
    core: bool,
) -> None:
    """Put the table at the spot and the chairs around it, all facing it."""
    wall, s, t = spot
    floor.new_group()
    quarter = 1 if turned else 0
    floor.put_turned("dining_table", wall, s, t, table, quarter, core=core)
    off = gap + chair[1] / 2
    places = [
        (along, side * (table[1] / 2 + off), 2 if side > 0 else 0)
        for side in (-1, 1)
        for along in _seats_along(table[0], seats - 2 * at_ends)
    ]
    # Quarter turns of chairs: 0 looks away from the wall (+t), 2 towards it, 1 to -s, 3 to +s.
    if at_ends:
        places += [(-table[0] / 2 - off, 0.0, 3), (table[0] / 2 + off, 0.0, 1)]
    for along, across, facing in places:
        if turned:
            along, across = -across, along
        floor.put_turned("chair", wall, s + along, t + across, chair, (facing + quarter) % 4)


def _seats_along(length: float, seats: int) -> list[float]:
    per_side = max(1, seats // 2)
    return [(i + 0.5) * length / per_side - length / 2 for i in range(per_side)]


def _keep_group(floor: Floor, spot: tuple[Wall, float, float], size: tuple[float, float]) -> None:
    wall, s, t = spot
    floor.keep(wall, s - size[0] / 2, s + size[0] / 2, t - size[1] / 2, t + size[1] / 2, REACH)
