"""What a kitchen pays for each published number that it misses.

Sources: NKBA, Kitchen Planning Guidelines with Access Standards (numbers in brackets); DIN 18022
for sizes of units. A price is paid in full where nothing of a number is kept, at 60 % where nearly
all of it is: whether it is kept matters most.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from chord_usd.base.scene.types import FloatArray

COOKER_SIDES_M = 0.3, 0.4
"""Beside the cooker, on both sides and on one [17]."""
SINK_SIDES_M = 0.45, 0.6
"""Beside the sink, on both sides and on one [11]."""
SINK_END_M = 0.15
"""A sink with less beside it stands at an end: no place to put down what is washed."""
PREPARATION_M = 0.9
"""In one piece, beside the sink [12]."""
LANDING_M = 0.4
"""Beside the refrigerator, on the side of its handle [16]."""
AISLE_M = 1.07
"""Before units [6]."""
NARROW_AISLE_M = 0.9
LEGS_M = 1.22, 2.74
"""From front to front of sink, cooker and refrigerator [3]."""
LEAST_LEG_M = 0.9
WORKTOP_M = ((5.0, 2.4), (7.0, 3.35), (np.inf, 4.01))
"""By area of the room, m2: all of it [25]; 3.35 m in compact kitchens."""
PLAIN_M = 1.2
"""Of it, without sink and cooker."""
CORNER_M = 0.3
"""From the cooker to an inner corner."""
DOOR_M = 0.36
"""From the cooker to the hole of a door."""
THREE_LEGS_M2 = 8.0
"""In smaller rooms two legs of the triangle are asked for."""
SMALL_M2 = 5.0
"""In smaller rooms only what SMALL names is asked for in full."""

PRICE = {
    "cooker between worktops": 12.0, "cooker beside 40": 3.0, "sink beside 45": 5.0,
    "sink at an end": 3.0, "sink beside 60": 4.0, "preparation": 4.0, "plain": 4.0,
    "worktop": 4.0, "aisle": 5.0, "narrow aisle": 9.0, "legs": 3.0, "least leg": 5.0,
    "cooker below a window": 8.0, "sink at a window": 4.5, "cooker at a door": 6.0,
    "cooker in a corner": 5.0, "sink in a corner": 1.5, "cooker touches": 6.0, "landing": 6.0,
    "apart": 6.0, "refrigerator apart": 9.0, "no refrigerator": 40.0, "dishwasher": 1.5,
    "way between": 3.0, "way shut": 8.0, "idle run": 6.0, "door hits": 1.5,
    "piece in place": 1.5, "shallow": 3.0,
}  # fmt: skip
"""Of each number missed."""

SMALL = frozenset((
    "cooker between worktops", "sink at an end", "sink beside 60", "cooker below a window",
    "cooker at a door", "cooker in a corner", "cooker touches", "apart", "no refrigerator",
    "narrow aisle", "way shut", "idle run", "piece in place",
))  # fmt: skip
_SCALE = 3.0
"""Of all prices, beside what tastes and likings weigh."""
_SMALL_SHARE = 0.25
"""What other numbers cost in rooms below SMALL_M2, which have no space for them."""


def price(name: str, area_m2: float) -> float:
    """Of one number missed in a room of this area."""
    share = _SMALL_SHARE if area_m2 < SMALL_M2 and name not in SMALL else 1.0
    return _SCALE * PRICE[name] * share


def short(value: Any, least: float, whole: float) -> FloatArray:
    """The price of values below least."""
    missed = 0.6 + 0.4 * (1.0 - np.clip(np.asarray(value) / least, 0.0, 1.0))
    return np.where(np.asarray(value) >= least - 0.005, 0.0, whole * missed)


def worktop_m(area_m2: float) -> float:
    """How much of it a kitchen of this area needs."""
    return next(need for below, need in WORKTOP_M if area_m2 < below)
