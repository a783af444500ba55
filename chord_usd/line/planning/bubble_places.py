"""Where bubbles of a diagram can still go, so that none touches another or lies outside.

The sketching network has learned what is likely; this is what is possible. A value that is not is
never drawn.
"""

from __future__ import annotations

import numpy as np

from chord_usd.base.raster.bubbles import LEAST_RADIUS_M
from chord_usd.base.scene.types import BoolArray
from chord_usd.line.planning import sketch_tokens as tokens

_PLACES_M = tokens.place_m(np.arange(tokens.PLACES))


def everywhere() -> BoolArray:
    """(PLACES, PLACES) by x and y: a sheet with nothing on it."""
    return np.ones((tokens.PLACES, tokens.PLACES), np.bool_)


class FreePlaces:
    """The ground of one diagram, while bubbles are put on it."""

    def __init__(self, ground: BoolArray) -> None:
        """ground: (PLACES, PLACES) by x and y, where a room's middle can be."""
        self._free = ground.copy()
        self._taken: list[tuple[float, float, float]] = []

    def possible(self, values: tokens.Ints, slot: int) -> BoolArray:
        """(places or radii,) what can stand in a slot, given those before it; all, where nothing
        can: a diagram that slips is better than none.

        values: (SLOTS,) of the bubble that is being told.
        """
        if slot == 0:
            found = self._free.any(axis=1)
        elif slot == 1:
            found = self._free[tokens.place_index(values)[0]]
        else:
            x_m, y_m = (_PLACES_M[index] for index in tokens.place_index(values))
            clear_m = min(
                (np.hypot(x_m - x, y_m - y) - radius for x, y, radius in self._taken),
                default=np.inf,
            )
            found = tokens.radius_m(np.arange(tokens.RADII)) < clear_m
        return found if found.any() else np.ones_like(found)

    def take(self, values: tokens.Ints) -> None:
        """Put a bubble down: (SLOTS,) values."""
        x_m, y_m = (_PLACES_M[index] for index in tokens.place_index(values))
        radius = float(tokens.radius_m(tokens.radius_index(values)))
        self._taken.append((x_m, y_m, radius))
        away_m = np.hypot(_PLACES_M[:, None] - x_m, _PLACES_M[None] - y_m)
        self._free &= away_m > radius + LEAST_RADIUS_M
