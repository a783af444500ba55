"""Panels end where the wall ends that they hang on: they are made to measure.

Behind a sofa at a corner that juts into the room the model paints its panel on past the corner,
where there is nothing to hang it on.
"""

from __future__ import annotations

import shapely

from chord_usd.geometry import footprint, resized
from chord_usd.types import Box

_ON_WALL_M = 0.001

_LEAST_HELD = 0.5
"""A panel with less of its back on one wall hangs elsewhere."""


def end_with_wall(box: Box, floor: shapely.Polygon) -> Box:
    """The panel cut back to the part of its back that is on a wall, or in one.

    A panel that hangs nowhere, or mostly free, stays as it is.
    """
    back = shapely.LineString(footprint(box)[[0, 3]])
    held = back.difference(floor.buffer(-_ON_WALL_M, join_style="mitre"))
    longest = max(shapely.get_parts(held), key=shapely.length, default=shapely.LineString())
    if not _LEAST_HELD * back.length <= longest.length < back.length - 2 * _ON_WALL_M:
        return box
    ends = shapely.line_locate_point(back, shapely.points(shapely.get_coordinates(longest)))
    start_m, stop_m = float(ends.min()), float(ends.max())
    length_m, depth_m, _ = box.size_m
    return resized(box, (stop_m - start_m, depth_m), ((start_m + stop_m - length_m) / 2, 0.0))
