"""Pieces that lie in one another: few in any house, thousands in a file made to keep machines busy.

Whatever looks for contact compares the meshes of each such pair, so that their number has a limit
beside that of the pieces.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.types import Item

MOST_PAIRS, MOST_PAIRS_EACH = 2000, 4
"""Pairs of footprints that cover each other: in all, and more for each piece."""

_AT_ONCE = 256


def is_piled(items: Sequence[Item]) -> bool:
    """Whether more pairs of items lie in one another than in any house; children are compared with
    children of the same parent."""
    groups = [items, *(item.children for item in items if len(item.children) > 1)]
    most = MOST_PAIRS + MOST_PAIRS_EACH * sum(map(len, groups))
    pairs = 0
    for group in groups:
        for more in _pairs(group):
            pairs += more
            if pairs > most:
                return True
    return False


def _pairs(items: Sequence[Item]) -> Iterator[int]:
    """Numbers of pairs, for some of the items at a time: all at once may not fit into memory."""
    corners = np.array([footprint(item.box) for item in items]).reshape(-1, 4, 2)
    low_m = np.array([item.box.center_m[2] for item in items])
    top_m = np.array([item.box.top_m for item in items])
    shapes = shapely.box(*corners.min(axis=1).T, *corners.max(axis=1).T)
    tree = shapely.STRtree(shapes)
    for begin in range(0, len(items), _AT_ONCE):
        first, other = tree.query(shapes[begin : begin + _AT_ONCE])
        first = first + begin
        meets = (first < other) & (low_m[first] < top_m[other]) & (low_m[other] < top_m[first])
        yield int(meets.sum())
