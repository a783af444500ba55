"""Several pieces along the walls of one room, chosen together: what one takes, another may need.

A search over places at walls: each piece goes to an end of a free span, where it leaves most for
the others, the best liked first; where a later piece finds no place or people no way through, the
search goes back on earlier ones.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import permutations
from typing import NamedTuple

from chord_usd.workshop.data.furnish.floor import Floor, Size
from chord_usd.workshop.data.furnish.free_spans import REACH, Wall
from chord_usd.workshop.data.furnish.walkways import CUT_OFF, path_faults

NICHE_M = 0.3
"""A piece that grows, and leaves less than this beside it, fills the whole niche."""

BRANCHES = 6
"""Places looked at for one piece while the others stay."""


class Part(NamedTuple):
    """A piece that belongs to another: in its frame, along the wall and off it, metres."""

    category: str
    size: Size
    along_m: float
    off_m: float
    """Of its middle."""
    quarter_turns: int
    """As in Floor.put_turned."""


class Fitting(NamedTuple):
    """One piece to place with its back to a wall, and what belongs to it."""

    category: str
    size: Size
    reach_m: float
    """Free floor in front of it and its parts."""
    slot_m: float = 0.0
    """Width of wall it takes, where that is more than its length."""
    longest_m: float = 0.0
    """It may grow to this length to fill a niche."""
    parts: tuple[Part, ...] = ()
    deep_m: float = 0.0
    """Of the whole, where the parts reach farther than the piece."""

    @property
    def depth_m(self) -> float:
        """What it takes from the wall on."""
        return max(self.deep_m, self.size[1])


class Place(NamedTuple):
    """A fitting at a wall."""

    score: float
    wall: Wall
    s: float
    size: Size


Liking = Callable[[Fitting, Wall, float, int, Sequence[Wall]], float]
"""How well a fitting would stand at s of a wall, so many of its sides in corners (0 to 2), beside
the walls that were used for others before.
"""


def place_jointly(
    floor: Floor, fittings: Sequence[Fitting], liking: Liking, most: int, *, any_order: bool = False
) -> bool:
    """Stand all of them such that all doors connect and each can be used; else none.

    most: placements tried. any_order: so many for every order of the fittings, and narrow ways to
    pieces are borne as long as no door is cut off. Returns whether they stand.
    """
    if any_order and not all(_has_place(floor, fitting) for fitting in fittings):
        return False
    orders = permutations(fittings) if any_order else [tuple(fittings)]
    borne = CUT_OFF if any_order else 1
    return any(_place(floor, order, [], liking, [most], borne) for order in orders)


def _has_place(floor: Floor, fitting: Fitting) -> bool:
    """Whether it could stand here if it were alone, to spare orders of what never fits."""
    slot = max(fitting.slot_m, fitting.size[0])
    return any(floor.spots(fitting.depth_m, fitting.size[2], fitting.reach_m, slot))


def _place(
    floor: Floor, rest: Sequence[Fitting], used: list[Wall], liking: Liking, left: list[int],
    borne: int,
) -> bool:  # fmt: skip
    if not rest:
        return path_faults(floor) < borne
    for place in _places(floor, rest[0], used, liking)[:BRANCHES]:
        if left[0] == 0:
            return False
        left[0] -= 1
        mark = floor.mark()
        _put(floor, rest[0], place)
        used.append(place.wall)
        if _place(floor, rest[1:], used, liking, left, borne):
            return True
        used.pop()
        floor.undo(mark)
    return False


def _places(floor: Floor, fitting: Fitting, used: Sequence[Wall], liking: Liking) -> list[Place]:
    """Both ends of every free span, best first."""
    size, places = fitting.size, []
    slot = max(fitting.slot_m, size[0])
    for spot in floor.spots(fitting.depth_m, size[2], fitting.reach_m, slot):
        fills = fitting.longest_m > 0.0 and spot.length - slot < NICHE_M
        length = min(spot.length, fitting.longest_m) if fills else size[0]
        width = max(slot, length)
        for s in dict.fromkeys((spot.s_from + width / 2, spot.s_to - width / 2)):
            corners = (s - width / 2 < 1e-6) + (s + width / 2 > spot.wall.length - 1e-6)
            score = liking(fitting, spot.wall, s, corners, used) + floor.dice.random() * 0.5
            places.append(Place(score, spot.wall, s, (length, size[1], size[2])))
    places.sort(key=lambda place: place.score, reverse=True)
    return places


def _put(floor: Floor, fitting: Fitting, place: Place) -> None:
    floor.new_group()
    wall, s, size = place.wall, place.s, place.size
    floor.put(fitting.category, wall, s, size, core=True)
    for part in fitting.parts:
        floor.put_turned(part.category, wall, s + part.along_m, part.off_m, part.size,
                         part.quarter_turns, core=True)  # fmt: skip
    half, depth = max(fitting.slot_m, size[0]) / 2, fitting.depth_m
    floor.keep(wall, s - half, s + half, 0.0, depth + fitting.reach_m, REACH)
