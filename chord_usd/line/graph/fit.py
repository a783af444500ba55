"""How a mesh fills the box that it was found for: stretched a little, never out of proportion."""

from __future__ import annotations

import numpy as np

from chord_usd.base.scene.geometry import to_world
from chord_usd.base.scene.palette import Category, Level, Mount
from chord_usd.base.scene.types import Asset, Box

MOST_STRETCH = 1.05
"""Most that one side of a mesh is stretched against another."""

MOST_DRESSING_STRETCH = 1.15


_OWN_HEIGHT_FROM = 0.85
"""A mesh that is scaled down less than this keeps its height."""


def is_built_in(row: Category) -> bool:
    """Whether pieces of a category stand in a run along their wall: kitchen units."""
    return row.rooms == ("kitchen",)


def fitted_box(box: Box, asset: Asset, row: Category, *, is_guess: bool) -> Box:
    """The part of box that the mesh fills, against the back of the box and in the middle of it.

    Length and width never exceed those of the box, so that nothing collides that did not before;
    where the mesh has other proportions, it fills less of the longer side. Panels on walls have no
    proportions to keep, and kitchens no gaps: they fill their box. is_guess: the height is the
    category's usual one, which no picture shows; the mesh brings its own. Dressing keeps its own
    size, or nearly; what hangs from above fills the height.
    """
    if row.level is Level.DRESSING:
        return _hung_box(box, asset, row)
    ratio = np.array(box.size_m) / np.array(asset.size_m)
    if row.mount is Mount.WALL or is_built_in(row):
        scale, least = ratio, 1.0
    else:
        least = float(ratio[:2].min())
        scale = np.minimum(ratio, least * MOST_STRETCH)
    if is_guess:
        scale[2] = min(1.0, least / _OWN_HEIGHT_FROM)
    size_m = np.round(np.array(asset.size_m) * scale, 6)
    x, y = to_world(box, (0.0, (box.size_m[1] - size_m[1]) / 2))
    length, width, height = (float(side) for side in size_m)
    return Box((float(x), float(y), box.center_m[2]), (length, width, height), box.yaw_deg)


def _hung_box(box: Box, asset: Asset, row: Category) -> Box:
    """What dressing fills, its back at the back of the box, its top or underside where that is."""
    most = MOST_DRESSING_STRETCH if "to_measure" in row.traits else 1.0
    ratio = np.array(box.size_m) / np.array(asset.size_m)
    scale = np.clip(ratio, 1.0 / most, most)
    if row.mount in (Mount.CEILING, Mount.WINDOW):
        scale[2] = ratio[2]
    length, width, height = (float(v) for v in np.round(np.array(asset.size_m) * scale, 6))
    at_wall = row.mount in (Mount.WALL, Mount.WINDOW)
    x, y = to_world(box, (0.0, (box.size_m[1] - width) / 2 if at_wall else 0.0))
    return Box((float(x), float(y), box.center_m[2]), (length, width, height), box.yaw_deg)
