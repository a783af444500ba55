"""One scale for drafts of rooms and homes: planning rules that are broken, and faults.

0 is a room that keeps every rule and has no fault; 1 is one that keeps none. A fault
(metrics.violations) weighs FAULT times what it weighs there.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from chord_usd.base.metrics.design import judged_home, judged_room
from chord_usd.base.metrics.design.shell import TOUCH_M, inside
from chord_usd.base.metrics.design.view import HomeView, View, distances, view_home
from chord_usd.base.metrics.overlap import overlaps_by_nature
from chord_usd.base.scene.types import FloatArray, SceneGraph

FAULT = 4.0
"""Of violations.room_faults, beside a share of rules: it counts per piece."""
HOME = 3.0
"""A home's rules beside those of one room."""
_TIGHT = 0.04
"""A piece in another, in a wall or before an opening; faults weigh how far."""


def broken_share(view: View) -> float:
    """Share of the rules that a room breaks, by weight; its dining table's are among them."""
    judged = list(judged_room(view))
    weight = sum(one.weight for one in judged)
    return 1.0 - sum(one.won for one in judged) / weight if weight else 0.0


def home_price(home: HomeView) -> float:
    """What the rules that a home breaks cost."""
    return HOME * (1.0 - judged_home(home).share)


def tight(view: View) -> int:
    """How many pieces stand in others, in walls or before openings: an estimate that is fast
    enough for every draft."""
    return int((conflicts(view) > TOUCH_M).any(axis=1).sum())


def conflicts(view: View) -> FloatArray:
    """(N, 3) how deep each piece is in one before it, before an opening, and beyond its room,
    metres."""
    if not view.items:
        return np.zeros((0, 3))
    shell, items = view.shell, view.items
    deep = np.tril(view.depths, -1)
    for at, other in np.argwhere(deep > TOUCH_M):
        if overlaps_by_nature(items[at], items[other]):
            deep[at, other] = 0.0
    blocks = view.rects.depths(shell.clear)
    blocks[view.height[:, None] <= shell.clear_from_m + TOUCH_M] = 0.0
    each = (deep.max(axis=1), blocks.max(axis=1, initial=0.0), beyond_walls(view))
    return np.stack(each, axis=1)


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


def full_price(view: View, fault: float) -> float:
    """What a room costs. fault: of violations.room_faults."""
    return quick_price(view) + FAULT * fault


def room_prices(graph: SceneGraph, faults: Mapping[str, float]) -> dict[str, float]:
    """What each room of a house costs, by id. faults: of violations.room_faults, by room id."""
    return {
        room.shell.room.id: broken_share(room) + FAULT * faults.get(room.shell.room.id, 0.0)
        for room in view_home(graph).rooms
    }


def house_price(graph: SceneGraph, faults: Mapping[str, float]) -> float:
    """What a house costs."""
    return sum(room_prices(graph, faults).values()) + home_price(view_home(graph))
