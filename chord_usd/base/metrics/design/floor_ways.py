"""The widest way that joins places over a raster of free floor."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.types import ByteArray, FloatArray

Cells = tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]
"""Rows and columns."""
Goal = tuple[Cells, FloatArray]
"""Cells before a place, and how far each is before it, in cells."""
WIDEST, _NARROWEST = 19, 5
"""In cells; wider ways count as so wide, and narrower ones as none."""
_NEAR = 3.0
"""In cells: a walker has come to a place whose edge is no farther from it."""


@dataclass(frozen=True, eq=False)
class _Reach:
    """Where walkers of one width come to."""

    parts: npt.NDArray[np.int32]
    """(H, W) number of the part of the floor that a walker's middle is in; 0 for none."""
    main: int
    """The part that most goals are at."""
    met: list[set[int]]
    """The parts that each goal is at."""

    @property
    def apart(self) -> list[int]:
        """Numbers of the goals that are not at the main part."""
        return [at for at, parts in enumerate(self.met) if self.main not in parts]


class Floor:
    """Free floor, (H, W), 1 where it is free, and the places to go to."""

    def __init__(self, floor: ByteArray, goals: Sequence[Goal]) -> None:
        self._goals = goals
        self._away = cv2.distanceTransform(floor, cv2.DIST_L2, 5)

    def apart(self, width: int) -> list[int]:
        """Numbers of the places that walkers so many cells wide do not come to from most others."""
        return self._reach(width).apart

    def widest(self) -> tuple[int, tuple[int, int] | None]:
        """Width of the widest walkers who do, in cells, to a cell less, 0 where it is narrower than
        any; row and column of the place that is too narrow for wider ones."""
        wider = self._reach(WIDEST)
        if not wider.apart:
            return WIDEST, None
        low, high, passed = _NARROWEST, WIDEST, None
        while high - low > 1:
            width = (low + high) // 2
            reach = self._reach(width)
            if not reach.apart:
                low, passed = width, reach
            else:
                high, wider = width, reach
        return (low, _strait(passed, wider)) if passed else (0, None)

    def _reach(self, width: int) -> _Reach:
        wide = (self._away >= width / 2).astype(np.uint8)
        parts = np.asarray(cv2.connectedComponents(wide, connectivity=8)[1], np.int32)
        met = []
        for (rows, columns), ahead in self._goals:
            near = ahead <= width / 2 + _NEAR
            there = np.bincount(parts[rows[near], columns[near]])
            met.append({*np.flatnonzero(there).tolist()} - {0})
        most = Counter(part for parts in met for part in parts).most_common(1)
        return _Reach(parts, most[0][0] if most else 0, met)


def _strait(passed: _Reach, wider: _Reach) -> tuple[int, int] | None:
    """The middle of what joins two parts of the floor for narrower walkers alone."""
    joint = (passed.parts > 0) & (wider.parts == 0)
    parted = wider.met[wider.apart[0]]
    if not joint.any() or not parted:
        return None
    away = np.zeros(joint.shape, np.float32)
    for parts in ({wider.main}, parted):
        other = np.ones(int(wider.parts.max()) + 1, np.uint8)
        other[[*parts]] = 0
        away = np.maximum(away, cv2.distanceTransform(other[wider.parts], cv2.DIST_L2, 3))
    row, column = np.unravel_index(int(np.where(joint, away, np.inf).argmin()), away.shape)
    return int(row), int(column)
