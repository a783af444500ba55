"""What stands where doors, drawers and flaps of furniture swing, of a draft of a room.

Categories say how deep that floor is (fronts.SWINGS_M); places.swept looks at leaves of meshes.
"""

from __future__ import annotations

import numpy as np

from chord_usd.base.metrics.design.shell import TOUCH_M
from chord_usd.base.metrics.design.view import View
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.scene.types import BoolArray

_HALF_OPEN = 0.7
"""Of its floor, what a door takes that opens by half a right angle."""


def shut_in(view: View) -> tuple[BoolArray, BoolArray]:
    """(N,) which pieces stop leaves, and (N,) whose leaves pieces or walls stop."""
    before = before_leaves(view)
    return before.any(axis=1), before.any(axis=0) | before_walls(view)


def before_leaves(view: View) -> BoolArray:
    """(N, N) which pieces stand before others that open. Kitchen units before each other are left
    out: what opens in a corner of a run is decided where runs are composed."""
    is_unit = np.array([name in KITCHEN_UNITS for name in view.categories], np.bool_)
    before = stand_before(view, view) & ~(is_unit[:, None] & is_unit[None])
    np.fill_diagonal(before, val=False)
    return before


def stand_before(view: View, others: View) -> BoolArray:
    """(N, M) which pieces of one view stand where leaves of others swing."""
    swing = opens(others)
    meets = np.zeros((len(view.items), len(others.items)), np.bool_)
    if swing.any():
        meets[:, swing] = view.rects.depths(others.leaf_floors().of(swing)) > TOUCH_M
    return meets & view.stands[:, None]


def before_walls(view: View, share: float = 1.0) -> BoolArray:
    """(N,) which pieces open against a wall. share: of the floor that their leaves need."""
    stopped = opens(view)
    if stopped.any():
        stopped[stopped] = view.leaf_floors(share).of(stopped).crossed_by(view.shell.walls)
    return stopped


def stuck(view: View) -> BoolArray:
    """(N,) which pieces a wall keeps shut: nothing is taken out or put in."""
    return before_walls(view, _HALF_OPEN)


def opens(view: View) -> BoolArray:
    """(N,) which pieces have leaves."""
    return view.swings_m > 0
