"""The space of a room that is taken: furniture, what openings keep clear, dressing so far."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

import numpy as np

from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.types import Box, FloatArray

TOUCH_M = 0.001
"""Boxes that share no more than this touch."""

Reason = Literal["piece", "dressing", "rug", "clear", "pane", "open", "front", "swing"]
"""What takes space: furniture and what stands on it; dressing; what lies underfoot; what doors keep
clear; a window's hole and what it keeps clear; a side of a room without a wall; the floor before
the front of a piece; what its doors and drawers pass."""


STOOD_ON_M = 0.005
"""Rugs and mats no thicker than this give way: furniture stands on them. Thicker ones have pile,
in which nothing may stand."""


def as_underfoot(box: Box) -> Reason:
    """The reason of a rug or mat: whether others may stand on it."""
    return "rug" if box.size_m[2] <= STOOD_ON_M else "dressing"


class TakenSpace:
    """Upright boxes, each with the reason why nothing else may be there."""

    def __init__(self) -> None:
        self._corners: list[FloatArray] = []
        self._bounds: list[tuple[float, float, float, float, float, float]] = []
        self._reasons: list[Reason] = []
        self._owners: list[str] = []
        self._upright: list[bool] = []
        self._arrays: tuple[FloatArray, FloatArray] | None = None

    def add(self, box: Box, reason: Reason, owner: str = "") -> None:
        """Take the space of a box. owner: id of what fills it."""
        corners = footprint(box)
        (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
        base_m = box.center_m[2]
        self._corners.append(corners)
        self._bounds.append((x0, y0, base_m, x1, y1, base_m + box.size_m[2]))
        self._reasons.append(reason)
        self._owners.append(owner)
        self._upright.append(_is_upright(box))
        self._arrays = None

    @property
    def corners_m(self) -> FloatArray:
        """(N, 4, 2) of the footprints."""
        return self._filled()[0]

    @property
    def bounds_m(self) -> FloatArray:
        """(N, 6) lowest x, y, z and highest x, y, z."""
        return self._filled()[1]

    @property
    def reasons(self) -> list[Reason]:
        """Of each box."""
        return self._reasons

    def _filled(self) -> tuple[FloatArray, FloatArray]:
        if self._arrays is None:
            self._arrays = (
                np.array(self._corners).reshape(-1, 4, 2),
                np.array(self._bounds).reshape(-1, 6),
            )
        return self._arrays

    def hits(self, box: Box, ignoring: Collection[str] = (), but: Collection[str] = ()) -> bool:
        """Whether a box shares more than a touch with one that is taken; arguments as of hit."""
        return self.hit(box, ignoring, but) is not None

    def hit(
        self, box: Box, ignoring: Collection[str] = (), but: Collection[str] = ()
    ) -> tuple[Reason, str] | None:
        """Reason and owner of the first box that shares more than a touch with this one.

        ignoring: reasons that do not count. but: owners whose boxes do not count.
        """
        if not self._bounds:
            return None
        corners, bounds = footprint(box), self.bounds_m
        (x0, y0), (x1, y1) = corners.min(axis=0) + TOUCH_M, corners.max(axis=0) - TOUCH_M
        base_m = box.center_m[2]
        meets = (bounds[:, 0] < x1) & (bounds[:, 3] > x0)
        meets &= (bounds[:, 1] < y1) & (bounds[:, 4] > y0)
        meets &= bounds[:, 2] < base_m + box.size_m[2] - TOUCH_M
        meets &= bounds[:, 5] > base_m + TOUCH_M
        upright = _is_upright(box)
        for index in np.flatnonzero(meets):
            reason, owner = self._reasons[index], self._owners[index]
            if reason in ignoring or owner in but:
                continue
            if (upright and self._upright[index]) or _overlap(corners, self._corners[index]):
                return reason, owner
        return None


def _is_upright(box: Box) -> bool:
    """Whether its sides run along the axes of the world, so that its bounds are itself."""
    return abs(box.yaw_deg % 90.0) < 1e-6


def _overlap(a: FloatArray, b: FloatArray) -> bool:
    """Whether two rectangles, (4, 2), share more than a touch: no side of either parts them."""
    for rect in (a, b):
        for axis in (rect[1] - rect[0], rect[2] - rect[1]):
            length = float(np.hypot(*axis))
            if length <= 0.0:
                continue
            along_a, along_b = a @ (axis / length), b @ (axis / length)
            if along_a.max() <= along_b.min() + TOUCH_M or along_b.max() <= along_a.min() + TOUCH_M:
                return False
    return True
