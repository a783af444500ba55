"""Places near a piece of furniture that it could move to, and whether they are free.

Seen from above; who asks says what counts as taken. Metres.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy.typing as npt
import shapely

from chord_usd.base.scene.geometry import footprint_polygon, to_world
from chord_usd.base.scene.types import Box, FloatArray

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
