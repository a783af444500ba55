"""Places near a piece of furniture that it could move to, and whether they are free.

Seen from above; the caller passes what counts as taken. Metres.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy.typing as npt
import shapely

from chord_usd.base.metrics.clear_floor import ClearFloor, is_high_enough
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2, overlaps_by_nature
from chord_usd.base.scene.geometry import footprint_polygon, to_world
from chord_usd.base.scene.types import Box, FloatArray, Item

_IN_ROOM_M = 1e-3
"""A piece flush with a wall is in its room, whatever was rounded."""


def places_near(box: Box, ways: FloatArray, step_m: float, farthest_m: float) -> Iterator[Box]:
    """Where a piece may go, from near to far.

    ways: (N, 2) directions of length 1 in its own frame; of equal distances the first comes first.
    """
    for step in range(1, round(farthest_m / step_m) + 1):
        distance_m = round(step * step_m, 3)
        for way in ways:
            yield _moved(box, way * distance_m)


def _moved(box: Box, by_m: npt.ArrayLike) -> Box:
    """The box moved by (x, y) of its own frame."""
    x_m, y_m = to_world(box, by_m)
    center_m = (round(float(x_m), 6), round(float(y_m), 6), box.center_m[2])
    return replace(box, center_m=center_m)


class FreePlaces:
    """Floor of a piece's room on which nothing stands that it must not run into."""

    def __init__(
        self,
        box: Box | None,
        floor: shapely.Polygon | None,
        others: Sequence[shapely.Geometry],
        *,
        touch_m2: float,
    ) -> None:
        """box: the piece as it stands; what it stands on of others is no worse for its moving on.
        None for one that is placed anew.

        floor: of its room; None where it may stand anywhere. touch_m2: shapes that share no more
        than this only touch.
        """
        self._floor = floor.buffer(_IN_ROOM_M) if floor else None
        taken = shapely.union_all(others)
        self._taken = taken.difference(footprint_polygon(box)) if box else taken
        self._touch_m2 = touch_m2

    def has(self, box: Box) -> bool:
        """Whether the piece may stand here."""
        shape = footprint_polygon(box)
        if self._floor is not None and not self._floor.covers(shape):
            return False
        return bool(self._taken.intersection(shape).area <= self._touch_m2)


def free_places(
    item: Item,
    floor: shapely.Polygon | None,
    items: Iterable[Item],
    clear: Iterable[ClearFloor],
    *,
    anew: bool = False,
) -> FreePlaces:
    """Places in an item's room where it is in no other item and before no opening.

    floor: of its room, None where it is in none. items: all of the house; those that overlap it by
    nature are not in its way. It comes no farther before openings that it stands before; anew: it
    comes before none.
    """
    others = [
        footprint_polygon(other.box)
        for other in items
        if other.id != item.id and not overlaps_by_nature(item, other)
    ]
    kept_free = [ground for opening, ground in clear if is_high_enough(item, opening)]
    here = None if anew else item.box
    return FreePlaces(here, floor, [*others, *kept_free], touch_m2=MIN_OVERLAP_M2)
