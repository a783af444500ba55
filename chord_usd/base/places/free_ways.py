"""Where one walks and stands in a house, and whether a thing on the floor leaves that free."""

from __future__ import annotations

from collections.abc import Iterable

import shapely

from chord_usd.base.metrics.clear_floor import border_sides, floor_across, has_way
from chord_usd.base.metrics.fronts import standing_places
from chord_usd.base.metrics.walk import SEAM_M, WALKER_RADIUS_M
from chord_usd.base.scene.geometry import footprint_polygon, polygons_of
from chord_usd.base.scene.types import Box, Item, SceneGraph

_AROUND_M = 0.8
"""How far beyond a room one looks."""

_PART_M2 = 0.02
"""Smaller parts of the walkable floor are nothing to walk on."""

_LOST = 0.12
"""Share of the walkable floor near it that one thing may take."""

_COMFORT_M = 0.28
"""Half of a way on which nobody has to turn sideways."""


_SLIM_M = 0.1
"""Half the width of a small robot, which cleans where nobody walks."""


class Borders:
    """Where rooms lie open to each other: a way across each border that has one stays."""

    def __init__(self, graph: SceneGraph) -> None:
        self._taken = [item.box for item in graph.items]
        self._open = [
            [(side, floor_across(side)) for side in sides]
            for sides in border_sides(graph)
            if any(has_way(side, self._taken) for side in sides)
        ]

    def stay_with(self, box: Box) -> bool:
        """Whether ways across all borders stay with a thing here."""
        shape, taken = footprint_polygon(box), [*self._taken, box]
        return all(
            any(has_way(side, taken) for side, _ in sides)
            for sides in self._open
            if any(shape.intersects(floor) for _, floor in sides)
        )

    def take(self, box: Box) -> None:
        """A thing stands there."""
        self._taken.append(box)


class Walkways:
    """The free floor about one room."""

    def __init__(
        self,
        free: shapely.Geometry,
        floor: shapely.Polygon,
        pieces: Iterable[Item],
        borders: Borders,
    ) -> None:
        """free: the floor of the house that nothing stands on. pieces: of the room. borders: of
        the house."""
        self._borders = borders
        self._places = [
            shapely.union_all(places) for item in pieces if (places := standing_places(item))
        ]
        around = floor.buffer(_AROUND_M, join_style="mitre")
        self._free = free.intersection(around)
        self._eroded: dict[float, shapely.Geometry] = {}

    def stay_with(self, box: Box, *, at_ease: bool = True) -> bool:
        """Whether people and small robots reach all that they reached before with a thing here.

        at_ease: people without turning sideways, too.
        """
        shape = footprint_polygon(box)
        radii_m = (_SLIM_M, WALKER_RADIUS_M, *((_COMFORT_M,) if at_ease else ()))
        return self._borders.stay_with(box) and all(self._stays(shape, r) for r in radii_m)

    def _stays(self, shape: shapely.Polygon, radius_m: float) -> bool:
        before = self._walkable(radius_m)
        reach = shape.buffer(radius_m + SEAM_M, quad_segs=2)
        if not reach.intersects(before):
            return True
        after = before.difference(reach)
        if after.area < (1.0 - _LOST) * before.area:
            return False
        near = [place for place in self._places if place.intersects(reach)]
        if any(before.intersects(place) and not after.intersects(place) for place in near):
            return False
        left = _parts(after)
        return all(sum(part.intersects(one) for one in left) < 2 for part in _parts(before))

    def take(self, box: Box) -> None:
        """Nobody walks there any more."""
        self._borders.take(box)
        self._free = self._free.difference(footprint_polygon(box))
        self._eroded.clear()

    def _walkable(self, radius_m: float) -> shapely.Geometry:
        if radius_m not in self._eroded:
            self._eroded[radius_m] = self._free.buffer(-radius_m - SEAM_M, quad_segs=2)
        return self._eroded[radius_m]


def _parts(area: shapely.Geometry) -> list[shapely.Polygon]:
    return [part for part in polygons_of(area) if part.area > _PART_M2]
