"""One scale for drafts of rooms and homes: planning rules that are broken, and faults.

0 is a room that keeps every rule and has no fault; 1 is one that keeps none. A fault
(metrics.violations) weighs FAULT times what it weighs there.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from contextvars import ContextVar
from types import MappingProxyType

import cv2
import numpy as np

from chord_usd.base.metrics.design import judged_home, rules_of
from chord_usd.base.metrics.design.rule import Rule, broken_weight, judge
from chord_usd.base.metrics.design.shell import CELL_M, TOUCH_M, Shell, inside
from chord_usd.base.metrics.design.shut_leaves import before_leaves, before_walls
from chord_usd.base.metrics.design.view import HomeView, View, distances, view_home
from chord_usd.base.metrics.overlap import overlaps_by_nature
from chord_usd.base.scene.types import ByteArray, FloatArray, SceneGraph

FAULT = 4.0
"""Of violations.room_faults, beside a share of rules: it counts per piece."""
HOME = 3.0
"""A home's rules beside those of one room."""
_NEARER, _MOST_MISSING = 0.02, 10.0
"""Of a value, in its unit, that a rule of the home misses."""
STANDARD = 2.0
"""Clauses of a standard beside the table."""
_NONE: Mapping[str, tuple[Rule[View], ...]] = MappingProxyType({})
CLAUSES: ContextVar[Mapping[str, tuple[Rule[View], ...]]] = ContextVar("clauses", default=_NONE)
"""Clauses that rooms are planned to, by kind of room (standard.planning_to)."""
TIGHT = 0.04
"""A piece in another, in a wall or before an opening; faults weigh how far."""

_SIDEWAYS = np.ones((5, 5), np.uint8)
_WALKER = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (7, 7))
"""Gaps of 20 and of 40 cm on the raster of a shell; cells at edges count as taken."""
_PART_M2 = 0.1
"""Smaller parts of it, without the 10 cm at their edges, are no floor that is missed."""


def broken_share(view: View, most: float = math.inf) -> float:
    """Share of the rules that a room breaks, by weight; its dining table's are among them. Clauses
    of a standard that the home is planned to cost more.

    most: where the share is above this, any larger value may come back, sooner.
    """
    broken = _broken_share(view, most) if math.isfinite(most) else view.once(_broken_share)
    shell = view.shell
    if clauses := CLAUSES.get().get(shell.kind):
        kept = judge(clauses, view, shell.room.id, shell.kind, shell.area_m2)
        broken += STANDARD * (1.0 - kept.share)
    return broken


def _broken_share(view: View, most: float = math.inf) -> float:
    sets = list(rules_of(view))
    bound = most * sum(rule.weight for rules, _, _ in sets for rule in rules)
    broken, asked = 0.0, 0.0
    for rules, _, area_m2 in sets:
        more, of = broken_weight(rules, view, area_m2, bound - broken)
        broken, asked = broken + more, asked + of
        if broken > bound:
            return math.inf
    return broken / asked if asked else 0.0


def home_price(home: HomeView) -> float:
    """What the rules that a home breaks cost, and a little by how much it breaks them: what one
    room cannot give alone, others give the rest of."""
    judged = judged_home(home)
    missing = sum(
        min(abs(finding.have - finding.need) / _MOST_MISSING, 1.0) for finding in judged.findings
    )
    return HOME * (1.0 - judged.share) + _NEARER * missing


def tight(view: View) -> int:
    """How many pieces stand in others, in walls, before openings or leaves, or open against walls,
    how many parts of the floor pieces cut off, and how many ways: an estimate that is fast enough
    for every draft."""
    wrong = (conflicts(view) > TOUCH_M).any(axis=1) | before_leaves(view).any(axis=1)
    return int((wrong | before_walls(view)).sum()) + cut_off(view)


def cut_off(view: View) -> int:
    """How many parts of the floor one gets to over no gap that is passed sideways, beyond the
    largest, and how many doors and passages one does not walk to from most others."""
    ground = view.shell.ground
    floor = ground.between(ground.floor, view.corners[view.stands])
    eroded = cv2.erode(floor, _SIDEWAYS)
    count, _, stats, _ = cv2.connectedComponentsWithStats(eroded, connectivity=4)
    areas_m2 = stats[1:count, cv2.CC_STAT_AREA] * CELL_M**2
    return max(0, int((areas_m2 > _PART_M2).sum()) - 1) + _ways_parted(view.shell, floor)


def _ways_parted(shell: Shell, floor: ByteArray) -> int:
    """Ways of a room beyond those that hang together on a raster of its floor."""
    if len(shell.ground.ways) < 2:
        return 0
    _, labels = cv2.connectedComponents(cv2.erode(floor, _WALKER), connectivity=4)
    met = [set(np.unique(labels[rows, columns]).tolist()) - {0}
           for rows, columns in shell.ground.ways]  # fmt: skip
    most = Counter(part for parts in met for part in parts).most_common(1)
    return len(met) - (most[0][1] if most else 0)


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
    each = (deep.max(axis=1), blocks.max(axis=1, initial=0.0), beyond_walls(view.corners, shell))
    return np.stack(each, axis=1)


def beyond_walls(corners: FloatArray, shell: Shell) -> FloatArray:
    """(N,) how far the farthest corner of each footprint (N, 4, 2) is outside a room, metres."""
    points = corners.reshape(-1, 2)
    if not len(points):
        return np.zeros(0)
    out = ~inside(points, shell.room.polygon_m)
    away = np.zeros(len(points))
    away[out] = distances(points[out], shell.sides).min(axis=1)
    farthest: FloatArray = away.reshape(-1, 4).max(axis=1)
    return farthest


def quick_price(view: View, faults: int | None = None, most: float = math.inf) -> float:
    """The price of a draft by its rules and the estimate of its faults.

    faults: of tight, where it is known. most: as broken_share takes it, of the whole price.
    """
    wrong = TIGHT * (tight(view) if faults is None else faults)
    return broken_share(view, most - wrong) + wrong


def room_prices(graph: SceneGraph, faults: Mapping[str, float]) -> dict[str, float]:
    """What each room of a house costs, by id. faults: of violations.room_faults, by room id."""
    return {
        room.shell.room.id: quick_price(room) + FAULT * faults.get(room.shell.room.id, 0.0)
        for room in view_home(graph).rooms
    }


def house_price(graph: SceneGraph, faults: Mapping[str, float]) -> float:
    """What a house costs."""
    return sum(room_prices(graph, faults).values()) + home_price(view_home(graph))
