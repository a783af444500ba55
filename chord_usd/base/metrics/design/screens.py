"""Televisions: on cabinets, and on walls that a sofa faces."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.metrics.design.shell import TOUCH_M, Rects
from chord_usd.base.scene.types import Box, FloatArray
from chord_usd.base.scene.units import wrap_deg

if TYPE_CHECKING:
    from chord_usd.base.metrics.design.view import View

SIZES_M = ((1.1, 0.05, 0.64), (0.9, 0.05, 0.52))
"""Of screens on walls, as rooms are planned: smaller where no wall has more place."""
BASE_M = 0.85
SEEN_FROM_M = (1.85, 3.95)
"""From the middle of the sofa."""
_FARTHEST = 2.5
"""Diagonals from which a screen smaller than the first is seen (THX, SMPTE)."""
MOST_ASIDE_DEG = 19.0
_OPPOSED = -0.97
BESIDE_M, BESIDE_CURTAINS_M = 0.1, 0.36
"""From a screen to an opening or to a piece that is higher than BASE_M; the same where curtains are
drawn aside."""
_NEAR_WALL_M = 0.3
_HIDES_M = 1.05
"""Pieces higher than this hide a screen; backs of chairs do not."""


@dataclass(frozen=True, eq=False)
class Screen:
    """A television as rules see it."""

    id: str
    """Of its cabinet; empty for one on a wall."""
    at: FloatArray
    """(2,) its middle."""
    right: FloatArray
    front: FloatArray
    """(2,) unit vectors."""
    length: float
    depth: float

    @classmethod
    def of(cls, box: Box, name: str = "") -> Screen:
        """One of this size, or the cabinet that carries it."""
        turn = math.radians(box.yaw_deg)
        right = np.array([math.cos(turn), math.sin(turn)])
        front = np.array([math.sin(turn), -math.cos(turn)])
        return cls(name, np.array(box.center_m[:2]), right, front, *box.size_m[:2])

    @property
    def point(self) -> tuple[float, float]:
        """In the world."""
        return float(self.at[0]), float(self.at[1])

    def own(self, points: FloatArray) -> FloatArray:
        """(..., 2) points as u to its right and v to its front."""
        ahead = points - self.at
        return np.stack([ahead @ self.right, ahead @ self.front], axis=-1)


def planned_screen(view: View) -> Box | None:
    """The largest screen that a wall of a room has place for, beside doors of cabinets."""
    leaves = view.leaf_floors().of((view.swings_m > 0) & (view.height > BASE_M))
    boxes = [box for size_m in SIZES_M for box in places_on_walls(view, size_m)]
    shut = (Rects.of_boxes(boxes).depths(leaves) > TOUCH_M).any(axis=1)
    return next((box for box, is_shut in zip(boxes, shut, strict=True) if not is_shut), None)


def places_on_walls(
    view: View, size_m: tuple[float, float, float], beside_m: float = BESIDE_M
) -> Iterator[Box]:
    """Where a screen may hang before the longest sofa, or else a bed, from the middle of its view
    outwards: clear of openings, and of pieces higher than its lower edge. Of each bare stretch of
    wall its ends are among them. beside_m: from openings and such pieces."""
    seats = view.of("sofa") or view.of("bed")
    sofa = max(seats, key=lambda at: view.length[at], default=None)
    if sofa is None:
        return
    free = []
    nearest, farthest = SEEN_FROM_M
    if size_m[0] < SIZES_M[0][0]:
        farthest = min(farthest, _FARTHEST * math.hypot(size_m[0], size_m[2]))
    for start, end in view.shell.walls:
        long = float(np.hypot(*(end - start)))
        along = (end - start) / max(long, 1e-6)
        inward = np.array([-along[1], along[0]])
        away = float((start - view.at[sofa]) @ view.front[sofa])
        if inward @ view.front[sofa] > _OPPOSED or not (nearest <= away - size_m[1] <= farthest):
            continue
        axis = float((view.at[sofa] - start) @ along)
        half = size_m[0] / 2
        for low, high in _free_spans(view, start, along, inward, long, beside_m):
            if high - low < size_m[0]:
                continue
            aside = away * math.tan(math.radians(MOST_ASIDE_DEG))
            first, last = max(low + half, axis - aside), min(high - half, axis + aside)
            yaw = wrap_deg(math.degrees(math.atan2(inward[0], -inward[1])))
            for s in dict.fromkeys((min(max(axis, first), last), first, last)):
                if first <= s <= last:
                    x, y = (start + along * s + inward * size_m[1] / 2).tolist()
                    free.append((abs(s - axis), Box((x, y, BASE_M), size_m, round(yaw, 6))))
    yield from (box for _, box in sorted(free, key=lambda ranked: ranked[0]))


def _free_spans(
    view: View,
    start: FloatArray,
    along: FloatArray,
    inward: FloatArray,
    long: float,
    beside_m: float,
) -> list[tuple[float, float]]:
    """Stretches of a wall without openings and high pieces."""
    lines = [(hole.ends, _NEAR_WALL_M) for hole in view.shell.holes]
    lines += [(view.corners[at], _NEAR_WALL_M if view.height[at] > _HIDES_M else BESIDE_M)
              for at in range(len(view.items))
              if view.stands[at] and view.height[at] > BASE_M]  # fmt: skip
    spans = [(0.0, long)]
    for points, near in lines:
        s, v = (points - start) @ along, (points - start) @ inward
        if v.min() > near or v.max() < -near:
            continue
        low, high = float(s.min()) - beside_m, float(s.max()) + beside_m
        spans = [
            (first, last)
            for a, b in spans
            for first, last in ((a, min(b, low)), (max(a, high), b))
            if last > first
        ]
    return spans
