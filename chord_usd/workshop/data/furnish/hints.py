"""Fixtures that a drawing shows: they say what a room is for and where its pieces stand."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from chord_usd.workshop.data.furnish.floor import Floor

_CATEGORY = {
    "toilet": "toilet",
    "bathtub": "bathtub",
    "shower": "shower",
    "washing_basin": "washbasin",
    "washbasin": "washbasin",
    "washing_machine": "washing_machine",
    "cooking_counter": "cooker_cabinet",
}
"""Names that drawings use, as categories of the palette."""


def attach_fixtures(floors: Sequence[Floor], fixtures: Sequence[Mapping[str, Any]]) -> None:
    """Give each floor the fixtures whose middle lies on it; unknown names are passed over.

    fixtures: {category, x, y, ...}, x and y the middle in metres.
    """
    for fixture in fixtures:
        category = _CATEGORY.get(fixture["category"])
        if category is None:
            continue
        for floor in floors:
            if _contains(floor.corners, fixture["x"], fixture["y"]):
                floor.hints.append((category, fixture["x"], fixture["y"]))


def hinted_distance(floor: Floor, category: str, x: float, y: float) -> float:
    """Metres from a place to the nearest fixture of this category; 0 where there is none."""
    away = [math.hypot(hx - x, hy - y) for name, hx, hy in floor.hints if name == category]
    return min(away, default=0.0)


def _contains(corners: Sequence[tuple[float, float]], x: float, y: float) -> bool:
    inside = False
    ax, ay = corners[-1]
    for bx, by in corners:
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            inside = not inside
        ax, ay = bx, by
    return inside
