"""What stairs are made of, and the rules that they keep. Numpy and shapely only.

A stair is an oriented box seen from above, its front (-y) where one steps on. Rules: every rise 16
to 20 cm, all alike; going 24 to 30 cm; flights 80 cm wide or more; 2 m of headroom.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from shapely.geometry import LineString, Polygon

from chord_usd.base.scene.types import Box

StairForm = Literal["straight", "L", "U", "winder_L", "winder_U", "spiral"]
"""L and U turn on a landing; a quarter-turn and a half-turn winder stair turn on tapered treads; a
spiral stair winds round a pole."""

IFC_FORMS: dict[StairForm, str] = {
    "straight": "STRAIGHT_RUN_STAIR", "L": "QUARTER_TURN_STAIR", "U": "HALF_TURN_STAIR",
    "winder_L": "QUARTER_WINDING_STAIR", "winder_U": "HALF_WINDING_STAIR", "spiral": "SPIRAL_STAIR",
}  # fmt: skip
"""IFC's words for them."""

Turn = Literal["left", "right"]
Leads = Literal["up", "down"]

HEADROOM_M = 2.0


@dataclass(frozen=True)
class StairRule:
    """What a stair keeps, metres."""

    rise_m: tuple[float, float]
    going_m: tuple[float, float]
    width_m: float
    """Of a flight, from side to side, at least."""


TO_RULE = StairRule((0.16, 0.20), (0.24, 0.30), 0.8)
STEEP = StairRule((0.16, 0.22), (0.22, 0.30), 0.65)
"""What a steep stair of an old house keeps: the steepest that British rules know (Approved Document
K), and narrower."""
RISE_M, GOING_M, LEAST_WIDTH_M = TO_RULE.rise_m, TO_RULE.going_m, TO_RULE.width_m

WELL_M = 0.1
"""Between the two flights of a U."""

CEILING_TO_FLOOR_M = 0.3
"""Thickness of what lies between two storeys."""


@dataclass(frozen=True)
class Stair:
    """A stair on the plan of a storey."""

    id: str
    form: StairForm
    box: Box
    """What it takes up; the front faces where one steps on below. Its height is not looked at."""
    turn: Turn = "right"
    """Which way one turns going up, where one turns."""
    leads: Leads = "up"
    """To the storey above, or to the one below."""
    rule: StairRule = TO_RULE


@dataclass(frozen=True, eq=False)
class Tread:
    """What one steps on: a step or a landing."""

    area_m: Polygon
    """In the stair's own frame, seen from above."""
    top_m: float
    """Over the lower floor."""
    is_landing: bool = False
    edges_m: tuple[LineString, LineString] | None = None
    """Of a tapered tread: over which one steps on it and off it, from newel or pole outwards."""


@dataclass(frozen=True)
class Flight:
    """A straight run of steps, in the stair's own frame."""

    start_m: tuple[float, float]
    """Middle of the edge of its first step."""
    ahead: tuple[int, int]
    """Direction in which it rises: (0, 1), (0, -1), (1, 0) or (-1, 0)."""
    length_m: float
    width_m: float
    low_m: float
    high_m: float
    """Heights of the floors or landings that it joins."""

    @property
    def end_m(self) -> tuple[float, float]:
        """Middle of the edge where it meets what it leads to."""
        (x, y), (ux, uy) = self.start_m, self.ahead
        return x + ux * self.length_m, y + uy * self.length_m
