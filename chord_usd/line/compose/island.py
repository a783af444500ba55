"""An island before the run with the sink, where a kitchen has room to walk all round it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.compose.cut import DOUBLE, Unit, box_at
from chord_usd.line.compose.prices import AISLE_M
from chord_usd.line.compose.search import Found
from chord_usd.line.compose.site import Site, Wall

FROM_M2 = 14.0
"""Smaller kitchens have none."""
SHARE = 0.6
"""Of the kitchens that have room for one."""
WALKWAY_M = 0.91
"""All round it; a work aisle on the side of the run [NKBA 6, 7]."""
_DEPTH_M = 0.6
_LENGTHS_M = 2.0, 1.6, 1.2
_STEP_M = 0.1


def island_of(
    site: Site, floor: shapely.Polygon, found: Found, units: Sequence[Unit], height: float,
    rng: np.random.Generator,
) -> list[Unit]:  # fmt: skip
    """Two units that face the run with the sink, [] where they have no room or are not drawn."""
    if site.area_m2 < FROM_M2 or rng.random() >= SHARE:
        return []
    run = found.shape.runs[found.sink[0]]
    taken = [footprint_polygon(unit.box) for unit in units]
    free = floor.difference(shapely.union_all([*taken, *site.pieces]))
    keep = shapely.union_all(list(site.swings))
    near = run.depth + AISLE_M
    middle = (run.low + run.high) / 2
    for length in _LENGTHS_M:
        starts = np.arange(run.low, run.high - length + 1e-6, _STEP_M)
        for low in sorted(starts.tolist(), key=lambda s: abs(s + length / 2 - middle)):
            shape = shapely.Polygon(run.wall.rectangle(low, low + length, near, near + _DEPTH_M))
            around = shape.buffer(WALKWAY_M, join_style="mitre")
            if free.covers(around) and not keep.intersects(shape):
                return [
                    _unit(run.wall, low + at * length / 2, length / 2, near, height)
                    for at in (0, 1)
                ]
    return []


def _unit(wall: Wall, low: float, length: float, near: float, height: float) -> Unit:
    box = box_at(wall, low, low + length, _DEPTH_M, height)
    x_m, y_m = wall.at(low + length / 2, near + _DEPTH_M / 2)
    box = replace(
        box, center_m=(float(x_m), float(y_m), 0.0), yaw_deg=wrap_deg(box.yaw_deg + 180.0)
    )
    return Unit(DOUBLE, box, "island")
