"""What doors and windows tell of the items before them: edges to half a pixel, and heights.

An edge that reaches less than half a pixel into the floor that a door keeps free was drawn beside
it. A picture from above shows no heights: what is drawn before a window is one of the lower pieces
of its category, where there are such.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from chord_usd.geometry import footprint_polygon
from chord_usd.graph.flush import Standing
from chord_usd.metrics.openings import clearances
from chord_usd.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.palette import Category, Mount, category
from chord_usd.types import Box, Item, Opening, Room

BELOW_SILL = "below_sill_m"
"""Key of Item.extra: height of the sill of the window that the item stands before."""

_EDGES = ("u0", "u1", "v0", "v1")


class FreeFloor:
    """The floor that the openings of a house keep free."""

    def __init__(self, rooms: Sequence[Room], openings: Sequence[Opening]) -> None:
        pairs = list(clearances(rooms, openings))
        self._openings = [opening for opening, _ in pairs]
        self._tree = shapely.STRtree([floor for _, floor in pairs])

    def kept(self, standing: Standing, box: Box, row: Category, reach_m: float) -> Box:
        """The box on its footprint, edges within reach_m of the free floor's on them."""
        if row.mount is Mount.FLOOR:
            for index in self._before(standing.on(box)):
                sill_m = self._openings[index].box.center_m[2]
                if row.height_m[0] > sill_m:
                    standing = _backed_off(standing, self._tree.geometries[index], box, reach_m)
        return standing.on(box)

    def below_sill(self, item: Item) -> Item:
        """The item as low as the window it stands before asks, where its category can be."""
        row = category(item.category)
        if row.mount is not Mount.FLOOR:
            return item
        sills = [self._openings[index].box.center_m[2] for index in self._before(item.box)]
        lowest = min((sill for sill in sills if sill >= row.height_m[0]), default=None)
        if lowest is None:
            return item
        length, width, height = item.box.size_m
        box = replace(item.box, size_m=(length, width, min(height, lowest)))
        return replace(item, box=box, extra={**item.extra, BELOW_SILL: lowest})

    def _before(self, box: Box) -> list[int]:
        """Which free floors a box stands on, by index."""
        shape = footprint_polygon(box)
        near = self._tree.query(shape, predicate="intersects")
        floors = self._tree.geometries[near]
        shares = shapely.area(shapely.intersection(shape, floors))
        return [int(index) for index in np.sort(near[shares > MIN_OVERLAP_M2])]


def _backed_off(standing: Standing, free: shapely.Geometry, box: Box, reach_m: float) -> Standing:
    """The one edge moved off the free floor that needs least; none where that is over reach_m."""
    rectangle = standing.rectangle
    shared = footprint_polygon(standing.on(box)).intersection(free)
    if shared.area <= MIN_OVERLAP_M2:
        return standing
    own = rectangle.local(shapely.get_coordinates(shared))
    low, high = own.min(axis=0), own.max(axis=0)
    places = (float(high[0]), float(low[0]), float(high[1]), float(low[1]))
    moves = [
        abs(place - getattr(rectangle, name)) for name, place in zip(_EDGES, places, strict=True)
    ]
    least = int(np.argmin(moves))
    if moves[least] > reach_m:
        return standing
    return replace(standing, rectangle=replace(rectangle, **{_EDGES[least]: places[least]}))
