"""One scale for drafts of rooms and homes: planning rules that are broken, and faults.

0 is a room that keeps every rule and has no fault; 1 is one that keeps none. A fault
(metrics.violations) weighs FAULT times what it weighs there.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from chord_usd.base.metrics.design import judged_home, judged_room
from chord_usd.base.metrics.design.shell import TOUCH_M, inside
from chord_usd.base.metrics.design.view import HomeView, View, distances
from chord_usd.base.metrics.overlap import overlaps_by_nature
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import FloatArray

FAULT = 4.0
"""Of violations.room_faults, beside a share of rules: it counts per piece."""
HOME = 2.0
"""A home's rules beside those of one room."""
_TIGHT = 0.02
"""A pair of pieces in each other, or a piece in a wall, in the quick estimate."""


def broken_share(view: View) -> float:
    """Share of the rules that a room breaks, by weight; its dining table's are among them."""
    judged = list(judged_room(view))
    weight = sum(one.weight for one in judged)
    return 1.0 - sum(one.won for one in judged) / weight if weight else 0.0


def home_price(home: HomeView) -> float:
    """What the rules that a home breaks cost."""
    return HOME * (1.0 - judged_home(home).share)


def tight(view: View) -> int:
    """How many pairs of pieces stand in each other, and how many pieces in walls or before
    openings: an estimate that is fast enough for every draft."""
    return sum(depth > TOUCH_M for depth in conflicts(view))


def conflicts(view: View) -> list[float]:
    """How deep each piece is in one before it, before an opening, or beyond its room, metres."""
    if not view.items:
        return []
    shell, items = view.shell, view.items
    deep = np.tril(view.depths, -1)
    for at, other in np.argwhere(deep > TOUCH_M):
        if overlaps_by_nature(items[at], items[other]):
            deep[at, other] = 0.0
    blocks = view.rects.depths(shell.clear)
    lows = np.array([CATEGORIES[name].height_m[0] for name in view.categories])
    blocks[lows[:, None] <= shell.clear_from_m] = 0.0
    worst = np.maximum(deep.max(axis=1), blocks.max(axis=1, initial=0.0))
    found: list[float] = np.maximum(worst, beyond_walls(view)).tolist()
    return found


def beyond_walls(view: View) -> FloatArray:
    """(N,) how far the farthest corner of each piece is outside its room, metres."""
    corners = view.corners.reshape(-1, 2)
    if not len(corners):
        return np.zeros(0)
    polygon = view.shell.room.polygon_m
    away = distances(corners, view.shell.sides).min(axis=1)
    away[inside(corners, polygon)] = 0.0
    found: FloatArray = away.reshape(-1, 4).max(axis=1)
    return found


def quick_price(view: View) -> float:
    """The price of a draft by its rules and the estimate of its faults."""
    return broken_share(view) + _TIGHT * tight(view)


def room_price(share: float, fault: float) -> float:
    """What a room costs. share: of rules broken; fault: of violations.room_faults."""
    return share + FAULT * fault


def broken_shares(home: HomeView) -> Iterable[tuple[str, float]]:
    """Id and share of every room of a home."""
    return ((view.shell.room.id, broken_share(view)) for view in home.rooms)
