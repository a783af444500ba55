"""Rooms too cramped for the furniture of their kind: the one small piece that still fits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from chord_usd.data.furnish.floor import Floor, Size
from chord_usd.data.furnish.paths import CUT_OFF, path_faults
from chord_usd.data.furnish.walls import REACH, Wall
from chord_usd.types import RoomKind


class Small(NamedTuple):
    """The smallest form of a piece, and the free floor it needs in front."""

    category: str
    size: Size
    reach_m: float


SMALL: dict[RoomKind, tuple[Small, ...]] = {
    "bathroom": (
        Small("toilet", (0.4, 0.62, 0.78), 0.4),
        Small("toilet", (0.36, 0.5, 0.78), 0.35),
        Small("washbasin", (0.45, 0.35, 0.85), 0.4),
        Small("washbasin", (0.35, 0.25, 0.85), 0.3),
    ),
    "kitchen": (
        Small("sink_cabinet", (0.9, 0.55, 0.85), 0.5),
        Small("sink_cabinet", (0.6, 0.5, 0.85), 0.45),
    ),
    "bedroom": (
        Small("cabinet", (1.2, 0.6, 2.2), 0.45),
        Small("cabinet", (0.8, 0.55, 2.0), 0.4),
        Small("table", (0.8, 0.45, 0.75), 0.5),
        Small("cabinet", (0.6, 0.4, 0.8), 0.35),
        Small("leisure_sofa", (0.6, 0.6, 0.75), 0.3),
    ),
    "living": (
        Small("leisure_sofa", (0.8, 0.8, 0.8), 0.4),
        Small("leisure_sofa", (0.6, 0.6, 0.75), 0.3),
        Small("tv_cabinet", (1.0, 0.3, 0.45), 0.4),
        Small("cabinet", (0.6, 0.4, 0.8), 0.35),
    ),
    "dining": (
        Small("dining_table", (0.8, 0.75, 0.75), 0.3),
        Small("dining_cabinet", (0.8, 0.35, 0.85), 0.4),
    ),
    "study": (
        Small("table", (0.8, 0.45, 0.75), 0.5),
        Small("cabinet", (0.6, 0.4, 0.8), 0.35),
    ),
}
"""By kind of room, what one would rather have first."""


def furnish_least(floor: Floor) -> None:
    """Stand the first of SMALL that cuts off no door; nothing where none does.

    To be called for a room that holds nothing yet, with narrow paths allowed.
    """
    best: tuple[int, Small, Wall, float] | None = None
    for small in SMALL.get(floor.kind, ()):
        for wall, s in _middles(floor, small):
            mark = floor.mark()
            _stand(floor, small, wall, s)
            faults = path_faults(floor)
            if not faults:
                return
            floor.undo(mark)
            if faults < CUT_OFF and (best is None or faults < best[0]):
                best = faults, small, wall, s
    if best:
        _stand(floor, *best[1:])


def _middles(floor: Floor, small: Small) -> Iterator[tuple[Wall, float]]:
    """Both ends and the middle of every span that is free, those far from the doors first."""
    found: list[tuple[float, int, Wall, float]] = []
    length, depth, height = small.size
    for spot in floor.spots(depth, height, small.reach_m, length):
        low, high = spot.s_from + length / 2, spot.s_to - length / 2
        for s in dict.fromkeys((low, high, (low + high) / 2)):
            away = floor.distance_to_door(*spot.wall.world(s, depth / 2))
            found.append((-away, len(found), spot.wall, s))
    found.sort(key=lambda place: place[:2])
    for _, _, wall, s in found:
        yield wall, s


def _stand(floor: Floor, small: Small, wall: Wall, s: float) -> None:
    floor.new_group()
    floor.put(small.category, wall, s, small.size, core=True)
    half, depth = small.size[0] / 2, small.size[1]
    floor.keep(wall, s - half, s + half, depth, depth + small.reach_m, REACH)
