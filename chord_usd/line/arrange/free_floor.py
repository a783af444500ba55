"""What doors and windows tell of the items before them: edges to half a pixel, and heights.

An edge that reaches less than half a pixel into the floor that a door keeps free was drawn beside
it, and so was a piece of which the picture shows nothing there: its box only spans what is painted
around that floor's corner. A picture from above shows no heights: what is drawn before a window is
one of the lower pieces of its category, where there are such.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from chord_usd.base.metrics.clear_floor import ClearFloors
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.oriented_rect import Edge, Footprint
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.types import Box, Item, PixelFrame
from chord_usd.base.scene.units import m_from_px, px_from_m
from chord_usd.line.graph.colours import LabelArray

_EDGES: tuple[Edge, ...] = ("u0", "u1", "v0", "v1")

_BARE = 0.2
"""Floor of which a smaller share shows a piece shows nothing of it: torn edges are no piece."""

_MOST_CUT = 0.25
"""Share of a side that a box may lose to floor that shows nothing of the piece."""


@dataclass(frozen=True, eq=False)
class Painted:
    """What a raster shows of items."""

    labels: LabelArray
    """(H, W) detector_class of a HOUSE category, or colours.NO_ITEM."""
    frame: PixelFrame

    def share(self, shape: shapely.Geometry, detector_class: int) -> float:
        """How many of the pixels in a shape show the category; 0.0 where it holds no pixel."""
        ring_px = px_from_m(shapely.get_coordinates(shape), self.frame)
        (left, top), (right, bottom) = (
            np.clip(edge, 0, self.labels.shape[::-1]).astype(int)
            for edge in (np.floor(ring_px.min(axis=0)), np.ceil(ring_px.max(axis=0)))
        )
        rows, columns = np.mgrid[top:bottom, left:right]
        centers_m = m_from_px(np.stack([columns, rows], axis=-1) + 0.5, self.frame)
        within = shapely.contains_xy(shape, centers_m[..., 0], centers_m[..., 1])
        shown = self.labels[top:bottom, left:right][within] == detector_class
        return float(shown.mean()) if shown.size else 0.0


def kept_off(clear: ClearFloors, item: Item, reach_m: float, painted: Painted | None = None) -> Box:
    """The piece's box with edges within reach_m of the free floor's on them.

    painted: where it shows nothing of the piece on that floor, edges come from farther.
    """
    row, footprint = category(item.category), Footprint.of(item.box)
    if row.mount is not Mount.FLOOR:
        return item.box
    for opening, free in clear.before(item.box):
        shared = footprint_polygon(footprint.on(item.box)).intersection(free)
        # What gave way to one opening may have left another's floor, too.
        if row.height_m[0] <= opening.box.center_m[2] or shared.area <= MIN_OVERLAP_M2:
            continue
        is_bare = painted and painted.share(shared, row.detector_class) < _BARE
        footprint = _backed_off(footprint, shared, reach_m, _MOST_CUT if is_bare else 0.0)
    return footprint.on(item.box)


def _backed_off(
    footprint: Footprint, shared: shapely.Geometry, reach_m: float, most_cut: float
) -> Footprint:
    """The one edge moved off the floor it shares that needs least.

    None where that is farther than reach_m and than most_cut, a share of the side that it cuts.
    """
    rect = footprint.rect
    own = rect.local(shapely.get_coordinates(shared))
    low, high = own.min(axis=0), own.max(axis=0)
    places = (float(high[0]), float(low[0]), float(high[1]), float(low[1]))
    moves = [abs(place - getattr(rect, edge)) for edge, place in zip(_EDGES, places, strict=True)]
    least = int(np.argmin(moves))
    sides_m = rect.u1 - rect.u0, rect.v1 - rect.v0
    if moves[least] > max(reach_m, most_cut * sides_m[least // 2]):
        return footprint
    return footprint.moved_edge(_EDGES[least], places[least])
