"""Items as arrays of shapely footprints, which every metric starts from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.palette import CATEGORIES, Mount
from chord_usd.base.scene.types import FloatArray, Item, SceneGraph

GRID_M = 1e-9
"""Overlays are computed on a grid this fine.

In full floating point GEOS now and then calls two rectangles that share nearly parallel edges one
inside the other; on a grid it does not.
"""

PolygonArray = npt.NDArray[Any]
"""One-dimensional object array of shapely polygons."""


@dataclass(frozen=True, eq=False)
class Footprints:
    """N items seen from above, in the frame their boxes are given in."""

    items: tuple[Item, ...]
    polygons: PolygonArray
    """(N,) oriented rectangles, metres."""
    areas_m2: FloatArray
    """(N,)"""
    base_m: FloatArray
    """(N,) height of the underside."""
    top_m: FloatArray
    """(N,) height of the upper side."""


def footprints_of(items: Sequence[Item]) -> Footprints:
    """The footprints of these items; children are not followed."""
    boxes = [item.box for item in items]
    corners = np.array([footprint(box) for box in boxes]).reshape(-1, 4, 2)
    base_m = np.array([box.center_m[2] for box in boxes])
    polygons = np.atleast_1d(shapely.polygons(corners))
    return Footprints(
        items=tuple(items),
        polygons=polygons,
        areas_m2=shapely.area(polygons),
        base_m=base_m,
        top_m=base_m + np.array([box.size_m[2] for box in boxes]),
    )


def sibling_groups(graph: SceneGraph) -> Iterator[tuple[Item, ...]]:
    """Items that are compared with each other: first the house's, then each table's.

    Children are posed in the frame of their parent, so a group never mixes frames.
    """
    yield graph.items
    waiting = list(graph.items)
    while waiting:
        item = waiting.pop()
        if item.children:
            yield item.children
            waiting.extend(item.children)


def is_underfoot(item: Item) -> bool:
    """Whether others may stand on it and people walk over it (rugs, mouse pads)."""
    row = CATEGORIES.get(item.category)
    return row is not None and row.mount is Mount.UNDERFOOT
