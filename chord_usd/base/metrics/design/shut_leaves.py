"""What stands where doors, drawers and flaps of furniture swing."""

from __future__ import annotations

import numpy as np

from chord_usd.base.metrics.design.shell import TOUCH_M, Rects
from chord_usd.base.metrics.design.view import View
from chord_usd.base.metrics.fronts import OPENING, SWING_M
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.scene.types import BoolArray


def before_leaves(view: View) -> BoolArray:
    """(N, N) which pieces stand before others that open. Kitchen units before each other are left
    out: what opens in a corner of a run is decided where runs are composed."""
    is_unit = np.array([name in KITCHEN_UNITS for name in view.categories], np.bool_)
    before = stand_before(view, view) & ~(is_unit[:, None] & is_unit[None])
    np.fill_diagonal(before, val=False)
    return before


def stand_before(view: View, others: View) -> BoolArray:
    """(N, M) which pieces of one view stand where leaves of others swing."""
    meets: BoolArray = view.rects.depths(leaf_floors(others)) > TOUCH_M
    return meets & view.stands[:, None] & opens(others)[None]


def opens(view: View) -> BoolArray:
    """(N,) which pieces have leaves."""
    return np.array([name in OPENING for name in view.categories], np.bool_)


def leaf_floors(view: View) -> Rects:
    """The floor before each piece that its leaves need to open."""
    half = np.stack([np.maximum(view.length / 2 - 2 * TOUCH_M, 0.0),
                     np.full(len(view.items), SWING_M / 2)], axis=-1)  # fmt: skip
    at = view.at + view.front * (view.depth / 2 + SWING_M / 2)[:, None]
    return Rects(at, view.right, view.front, half)
