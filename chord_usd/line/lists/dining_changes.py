"""Dining tables: as many seats as those who sleep in a home need, on free floor, or with a side or
an end of the table at a wall."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from chord_usd.base.metrics.design import judged_room
from chord_usd.base.metrics.design.dining_rules import chairs_of
from chord_usd.base.metrics.design.view import View
from chord_usd.base.metrics.design.way_rules import leaves_ways
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.places.free_places import free_boxes
from chord_usd.base.places.wall_frames import WallFrame
from chord_usd.base.scene.geometry import front_direction, to_world
from chord_usd.base.scene.types import Box, Item
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.lists.changes import Change, Propose, Size, at_walls, but, loose, new_piece
from chord_usd.line.lists.improve import free_of_clashes

DEPTH_M, HEIGHT_M = 0.8, 0.75
CHAIR_M = (0.45, 0.5, 0.9)
CHAIR_OUT_M = 0.25
"""From the table's edge to the middle of a chair."""
PULL_OUT_M = 0.76
"""From the table's edge, to pull a chair out; dining_rules asks for 0.75."""
LENGTHS_M = {0: (0.8,), 1: (0.8,), 2: (1.4, 1.25), 3: (2.05, 1.9)}
"""Of tables, by how many sit at a long side."""
_CLOSE_M = 0.5
"""A seat at a table that is as long as it is drawn."""
_GRID_M = 0.4
_GRID_PLACES = 1000
"""About so many over the floor of a room: halls have them farther apart."""
"""Between places of a table on free floor."""
_STEP_M = 0.4
"""Between places along a wall."""
_LAID = 32
"""Tables beside which ways are looked for."""

_LOOSE = ("table", "chair", "leisure_sofa", "lounge", "side_coffee_table", "dining_cabinet")
"""Where no dining table is: what stands there while the home has none."""
_COMPOSED = 10
"""Tables around which a kitchen is composed."""

_MOST_LOST = 0.1
"""Share of a kitchen's rules that a table in it is worth: two of them."""

Compose = Callable[[View, Sequence[Item]], Sequence[Item]]
"""Kitchen units for a room, beside pieces that stay."""
Counts = tuple[int, int, int, int]
"""How many chairs stand before the front, the back, and the ends of a table."""


@dataclass(frozen=True, eq=False)
class _Spot:
    """Where a table would stand, and who would sit at it."""

    box: Box
    counts: Counts

    def seated(self, nth: int) -> Box:
        """The table with chairs pulled out before its long sides (0), or at its ends (1)."""
        length, depth, _ = self.box.size_m
        front, back, left, right = (PULL_OUT_M * bool(count) for count in self.counts)
        size, place = (
            ((length + left + right, depth, 0.0), ((left - right) / 2, 0.0))
            if nth
            else ((length, depth + front + back, 0.0), (0.0, (back - front) / 2))
        )
        x, y = to_world(self.box, place)
        return replace(self.box, center_m=(float(x), float(y), 0.0), size_m=size)


def seats_at(view: View) -> int:
    """How many sit at the dining tables of a room."""
    return len({chair for table in view.of("dining_table") for chair in chairs_of(view, table)})


def laid_table(view: View, seats: int, table: int | None = None) -> Iterator[Change]:
    """A table with so many seats at each place that it fits.

    table: number of the one that is there and moves, with its chairs; None adds another.
    """
    chairs = [] if table is None else chairs_of(view, table)
    size = next((item.box.size_m for item in view.items if item.category == "chair"), CHAIR_M)
    rest = view.items if table is None else but(view, [table, *chairs])
    number = len(view.of("dining_table"))
    for spot in _free_spots(view, rest, list(_spots(view, seats))):
        laid = (
            new_piece(view, "dining_table", spot.box, number)
            if table is None
            else replace(view.items[table], box=spot.box)
        )
        yield (*rest, laid, *round_table(spot.box, spot.counts, size, view.shell.room.id))


def beside_ways(view: View, changes: Iterator[Change]) -> Iterator[Change]:
    """Those of some changes that leave ways through the room, evenly; without any, all."""
    every = list(changes)
    some = every[:: 1 + len(every) // _LAID]
    yield from [
        change for change in some if leaves_ways(View(view.shell, change, view.hung))
    ] or every


def laid_instead(view: View, seats: int) -> Iterator[Change]:
    """A table in place of what a room can do without: a desk, loose seats, side tables."""
    spare = loose(view, view.of(*_LOOSE))
    if spare:
        yield from laid_table(View(view.shell, but(view, spare), view.hung), seats)


def more_chairs(view: View, seats: int) -> Iterator[Change]:
    """So many chairs or more, spread evenly along the sides of the table where it stands."""
    for table in view.of("dining_table")[:1]:
        chairs = chairs_of(view, table)
        size = view.items[chairs[0]].box.size_m if chairs else CHAIR_M
        item = view.items[table]
        if item.facts.locked:
            yield from _more_at(view, table, seats, size)
            continue
        rest = but(view, [table, *chairs])
        for front, length, turn in product((1, 2, 3), (None, 1.4, 2.05), (0.0, 90.0)):
            top = _sized(item.box, length, turn)
            if front * 0.6 > top.size_m[0] or (length is None and turn):
                continue
            for counts in _layouts(front):
                if sum(counts) >= seats:
                    yield (*rest, replace(item, box=top),
                           *round_table(top, counts, size, view.shell.room.id))  # fmt: skip


def _more_at(view: View, table: int, seats: int, size: Size) -> Iterator[Change]:
    """Chairs at a table that the plan shows, on the sides where they find a place: at least two, at
    most as many as are wanted. Chairs that it shows stay; others that stand at no table go."""
    item = view.items[table]
    at_others = {chair for at in view.of("dining_table", "table") if at != table
                 for chair in chairs_of(view, at)}  # fmt: skip
    going = [at for at in view.of("chair") if at not in at_others]
    rest = but(view, loose(view, going))
    there = len(going) - len(loose(view, going))
    wanted = max(seats, 2) - there
    for front in (3, 2, 1, 0):
        for counts in _layouts(front) if front * _CLOSE_M <= item.box.size_m[0] else ():
            new = round_table(item.box, counts, size, view.shell.room.id)
            free = [
                change[-1] for change in free_of_clashes(view, [(*rest, chair) for chair in new])
            ]
            if there + len(free) >= 2:
                yield (*rest, *free[:wanted])


def composed_around(view: View, propose: Propose, compose: Compose) -> Iterator[Change]:
    """A kitchen with what is proposed where it has no units, which are composed around that; one
    that keeps nearly as many rules as before."""
    least = _share_kept(view) - _MOST_LOST
    units = [at for at, name in enumerate(view.categories) if name in KITCHEN_UNITS]
    options = list(propose(View(view.shell, but(view, units), view.hung)))
    for items in options[:: 1 + len(options) // _COMPOSED]:
        stays = [_pulled_out(item) if item.category == "chair" else item for item in items]
        composed = compose(view, stays)
        if composed and _share_kept(View(view.shell, (*items, *composed), view.hung)) >= least:
            yield (*items, *composed)


def _share_kept(kitchen: View) -> float:
    """Of the rules of the kitchen alone, by weight."""
    return next(judged.share for judged in judged_room(kitchen) if judged.kind == "kitchen")


def _pulled_out(chair: Item) -> Item:
    """A chair of round_table, with the floor that it is pulled out over."""
    length, _, height = chair.box.size_m
    x, y = to_world(chair.box, (0.0, PULL_OUT_M / 2 - CHAIR_OUT_M))
    box = Box((float(x), float(y), 0.0), (length, PULL_OUT_M, height), chair.box.yaw_deg)
    return replace(chair, box=box)


def _sized(box: Box, length: float | None, turn: float) -> Box:
    size = box.size_m if length is None else (length, max(box.size_m[1], DEPTH_M), box.size_m[2])
    return replace(box, size_m=size, yaw_deg=wrap_deg(box.yaw_deg + turn))


def _layouts(front: int) -> Iterator[Counts]:
    """With so many chairs before the front."""
    if front == 0:
        yield (0, 0, 1, 1)
        return
    for back in (front, 0):
        for left, right in ((1, 1), (1, 0), (0, 0)):
            yield (front, back, left, right)


def _spots(view: View, seats: int) -> Iterator[_Spot]:
    """Places of a table for so many: on a grid over the floor, with its back or an end at a
    wall."""
    for front, lengths in LENGTHS_M.items():
        for counts in _layouts(front):
            if sum(counts) != seats:
                continue
            for length in lengths:
                size = (length, DEPTH_M, HEIGHT_M)
                for box in _places(view, size):
                    yield _Spot(box, counts)
                if counts[1] == 0:
                    yield from (_Spot(box, counts) for box in at_walls(view, size, _STEP_M))
                if counts[3] == 0:
                    for box in at_walls(view, (DEPTH_M, length, HEIGHT_M), _STEP_M):
                        yaw = wrap_deg(box.yaw_deg + 90.0)
                        yield _Spot(replace(box, size_m=size, yaw_deg=yaw), counts)


def _places(view: View, size: tuple[float, float, float]) -> Iterator[Box]:
    """Over the floor of a room, in both directions of its longest wall."""
    low, high = view.shell.room.polygon_m.min(axis=0), view.shell.room.polygon_m.max(axis=0)
    step = max(_GRID_M, math.sqrt(float(np.prod(high - low)) / _GRID_PLACES))
    across, along = (np.arange(a + 0.6, b - 0.6, step) for a, b in zip(low, high, strict=True))
    start, end = max(view.shell.sides, key=lambda side: float(np.hypot(*(side[1] - side[0]))))
    yaw = WallFrame.between(start, end).yaw_deg
    for x, y, turn in product(across.tolist(), along.tolist(), (0.0, 90.0)):
        yield Box((x, y, 0.0), size, wrap_deg(yaw + turn))


def _free_spots(view: View, rest: Sequence[Item], spots: Sequence[_Spot]) -> list[_Spot]:
    """Those at which chairs can be pulled out; without any, those where the table stands free."""
    boxes = [spot.box for spot in spots]
    roomy = free = [spots[at] for at in free_boxes(view.shell, rest, boxes)]
    for nth in (0, 1):
        seated = [spot.seated(nth) for spot in roomy]
        roomy = [roomy[at] for at in free_boxes(view.shell, rest, seated)]
    return roomy or free


def round_table(
    table: Box, counts: Counts, size: tuple[float, float, float], room: str
) -> Iterator[Item]:
    """Chairs before the front, the back, and the ends of a table."""
    length, depth, _ = table.size_m
    number = 0
    for turn, count in zip((180.0, 0.0, 90.0, -90.0), counts, strict=True):
        edge, out = (length, depth) if turn in (0.0, 180.0) else (depth, length)
        ahead = front_direction(turn + 180.0)
        across = np.array([-ahead[1], ahead[0]])
        for nth in range(count):
            along = ((nth + 0.5) / count - 0.5) * edge
            place = ahead * (out / 2 + CHAIR_OUT_M) + across * along
            x, y = to_world(table, place)
            seat = Box((float(x), float(y), 0.0), size, wrap_deg(table.yaw_deg + turn))
            yield Item(f"{room}/chair_{number}", "chair", seat, room)
            number += 1
