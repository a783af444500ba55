"""Clearance of what opens: leaves are set in, so that they pass whatever stands beside them.

A leaf that hangs at the edge of its face sweeps its free edge outwards: by 3 mm, where it is 60 mm
thick and 0.6 m wide. A neighbour that stands flush then stops it after three degrees. A door that
hangs at a side of its piece stops before its handle passes that side, as hinges with a stop do: a
wall or a taller neighbour is there in every second place.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.moves import Hinge, Leaf, Moving, fitted_leaf, leaves_of
from chord_usd.library.kit.solids import Solid, joined

if TYPE_CHECKING:
    from chord_usd.library.kit.model import Part

CLEAR_M = 0.003
"""What stays free between a leaf and its neighbours, wherever the leaf is on its way."""

_AT_SIDE_M = 0.05
"""A door whose hinge is no farther from a side of its piece hangs at that side."""

_STOP_DEG = 0.5
"""Doors stop at multiples of it."""

_BESIDE_M = 0.001
"""Boxes that overlap by less across a gap do not face each other."""


@dataclass(frozen=True, eq=False)
class _Shut:
    """A leaf where it is shut."""

    leaf: Leaf
    bounds_m: FloatArray
    """(2, 3)"""

    def swings_m(self, axis: int, end: int) -> float:
        """How far the leaf leaves its bounds at one end of an axis, on its way."""
        motion = self.leaf.motion
        turn = "xyz".index(motion.axis)
        if not isinstance(motion, Hinge) or axis == turn:
            return 0.0
        deep = 3 - axis - turn
        away = self.bounds_m - np.array(motion.at_m)
        wide = abs(float(away[end, axis]))
        # The end at which it hangs turns inwards.
        if wide < abs(float(away[1 - end, axis])):
            return 0.0
        return float(np.hypot(wide, np.abs(away[:, deep]).max())) - wide

    def sides(self) -> Iterator[tuple[int, int]]:
        """Axes across its face, with both ends; a sliding door passes its neighbours."""
        facing = 2 if self.leaf.kind == "Lid" else 1
        moves = None if isinstance(self.leaf.motion, Hinge) else "xyz".index(self.leaf.motion.axis)
        return ((axis, end) for axis in (0, 2) if axis not in (facing, moves) for end in (0, 1))


def with_clearance(parts: tuple[Part, ...], size_m: Sequence[float]) -> tuple[Part, ...]:
    """Parts of a piece of a size, (3,) in metres, whose leaves keep CLEAR_M free on their way.

    What is free is measured to what stands still, to other leaves, and to the sides of the piece,
    where a neighbour may stand flush.
    """
    leaves = leaves_of([move for part in parts for move in part.moves])
    if not leaves:
        return parts
    shut = [
        _Shut(
            leaf, next(m.solid for part in parts for m in part.moves if m.leaf is leaf).bounds_m()
        )
        for leaf in leaves
    ]
    still = [box for part in parts if part.stays for box in part.collider_boxes_m().values()]
    length, width, height = size_m
    envelope = np.array([[-length / 2, -width / 2, 0.0], [length / 2, width / 2, height]])
    moved: dict[Leaf, _Fit] = {}
    for closed in shut:
        others = [other for other in shut if other is not closed]
        bounds = _set_in(closed, still, others, envelope)
        factor = (bounds[1] - bounds[0]) / (closed.bounds_m[1] - closed.bounds_m[0])
        fit = _Fit(closed.leaf, bounds[0] / factor - closed.bounds_m[0], factor)
        solids = [fit.solid(m.solid) for part in parts for m in part.moves if m.leaf is closed.leaf]
        fit.leaf = _within_sides(fit.leaf, [solid.bounds_m() for solid in solids], length)
        moved[closed.leaf] = fit
    return tuple(_fitted_part(part, moved) if part.moves else part for part in parts)


def _set_in(
    closed: _Shut, still: Sequence[FloatArray], others: Sequence[_Shut], envelope: FloatArray
) -> FloatArray:
    """Bounds, (2, 3), that a leaf may fill."""
    bounds = closed.bounds_m.copy()
    for axis, end in closed.sides():
        sign = 1.0 if end else -1.0
        swings = closed.swings_m(axis, end)
        gap = sign * float(envelope[end, axis] - closed.bounds_m[end, axis])
        inset = CLEAR_M + swings - gap
        for box in still:
            if (gap_m := _gap_m(closed.bounds_m, box, axis, end)) is not None:
                inset = max(inset, CLEAR_M + swings - gap_m)
        for other in others:
            if (gap_m := _gap_m(closed.bounds_m, other.bounds_m, axis, end)) is not None:
                most = max(swings, other.swings_m(axis, 1 - end))
                inset = max(inset, (CLEAR_M + most - gap_m) / 2)
        bounds[end, axis] -= sign * max(inset, 0.0)
    return bounds


def _gap_m(bounds: FloatArray, other: FloatArray, axis: int, end: int) -> float | None:
    """From an end of one box to another that faces it; None where it does not."""
    shared = np.minimum(bounds[1], other[1]) - np.maximum(bounds[0], other[0])
    across = [shared[n] for n in range(3) if n != axis]
    gap = float(other[0, axis] - bounds[1, axis] if end else bounds[0, axis] - other[1, axis])
    return gap if min(across) > _BESIDE_M and gap > -_BESIDE_M else None


def _within_sides(leaf: Leaf, bounds_m: Sequence[FloatArray], length_m: float) -> Leaf:
    """The leaf, a door at a side of its piece, with a stop where its solids would pass the side.

    bounds_m: (2, 3) each, while it is shut.
    """
    motion = leaf.motion
    if not isinstance(motion, Hinge) or motion.axis != "z":
        return leaf
    side = 1.0 if motion.at_m[0] > 0.0 else -1.0
    room_m = length_m / 2 - side * motion.at_m[0]
    # A door that opens towards the side that it hangs at turns against the sign of x there.
    if not 0.0 <= room_m < _AT_SIDE_M or side * motion.opens_deg < 0.0:
        return leaf
    steps = np.radians(np.arange(0.0, abs(motion.opens_deg) + _STOP_DEG / 2, _STOP_DEG))
    corners = np.array([
        (x, y) for low, high in bounds_m for x in (low[0], high[0]) for y in (low[1], high[1])
    ])  # fmt: skip
    x, y = (corners - motion.at_m[:2]).T
    # How far each corner is beyond the hinge, towards the side, at each step.
    beyond = np.outer(np.cos(steps), side * x) - np.outer(np.sin(steps), y)
    passes = (beyond > room_m - _BESIDE_M).any(axis=1) & (steps > 0.0)
    if not passes.any():
        return leaf
    stop_deg = float(np.degrees(steps[max(int(passes.argmax()) - 1, 0)]))
    return replace(leaf, motion=replace(motion, opens_deg=math.copysign(stop_deg, side)))


class _Fit:
    """A shift of a leaf and then a stretch, (3,) each."""

    def __init__(self, leaf: Leaf, shift_m: FloatArray, factor: FloatArray) -> None:
        self._shift_m, self._factor = shift_m, factor
        self.leaf = fitted_leaf(leaf, shift_m, factor)

    def solid(self, solid: Solid) -> Solid:
        return solid.moved(*self._shift_m).scaled(*self._factor)

    def moving(self, move: Moving) -> Moving:
        colliders = tuple(self.solid(box) for box in move.colliders)
        return Moving(self.leaf, self.solid(move.solid), colliders)


def _fitted_part(part: Part, fits: Mapping[Leaf, _Fit]) -> Part:
    moves = tuple(fits[move.leaf].moving(move) for move in part.moves)
    still = [] if part.still is None else [part.still]
    return replace(part, moves=moves, solid=joined([*(move.solid for move in moves), *still]))
