"""Swept volumes: what doors, drawers, flaps and lids pass on their way, and how far they open.

A leaf is a set of boxes that turns about an axis or slides along one. Obstacles are boxes of any
direction, and the walls of a floor. Metres, degrees.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import shapely

from chord_usd.base.scene.types import BoolArray, Box, FloatArray

IndexArray = npt.NDArray[np.intp]

OPENS = 0.9
"""Share of its range from which a leaf counts as open."""

_STEP_M = 0.02
"""Of the farthest corner of a leaf, between two looks."""
_LEAST_STEPS, _MOST_STEPS = 4, 64
_TOUCH_M = 2e-4
"""Boxes that reach no deeper into each other touch."""
_LEAST_AXIS = 1e-6

_CORNERS = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)])


@dataclass(frozen=True, eq=False)
class Leaf:
    """What of a piece moves as one, in the piece's frame."""

    name: str
    turns: bool
    """Whether it turns about its axis; else it slides along it."""
    axis: int
    at_m: FloatArray
    """(3,) on its axis."""
    opens: float
    """Signed range, degrees or metres; 0 is shut."""
    boxes_m: FloatArray
    """(B, 2, 3) lowest and highest corners while it is shut."""

    def scaled(self, factor: FloatArray) -> Leaf:
        """The leaf of a piece that is stretched along its axes by factors (3,)."""
        opens = self.opens if self.turns else self.opens * float(factor[self.axis])
        return Leaf(self.name, self.turns, self.axis, self.at_m * factor, opens,
                    self.boxes_m * factor)  # fmt: skip

    @cached_property
    def shares(self) -> FloatArray:
        """(S,) shares of the range at which it is looked at, rising to 1."""
        reach = abs(self.opens)
        if self.turns:
            away = np.abs(self.boxes_m - self.at_m)
            away[..., self.axis] = 0.0
            reach = math.radians(reach) * float(np.sqrt((away**2).sum(axis=2)).max(initial=0.0))
        count = int(np.clip(math.ceil(reach / _STEP_M), _LEAST_STEPS, _MOST_STEPS))
        return np.linspace(0.0, 1.0, count + 1)[1:]

    @cached_property
    def boxes(self) -> Boxes:
        """(S * B) boxes of the leaf at each share."""
        low, high = self.boxes_m[:, 0], self.boxes_m[:, 1]
        middle, half = (low + high) / 2, (high - low) / 2
        steps, count = len(self.shares), len(middle)
        if self.turns:
            turns = np.stack([_turn(self.axis, self.opens * share) for share in self.shares])
        else:
            turns = np.broadcast_to(np.eye(3), (steps, 3, 3))
        moved = np.einsum("sij,bj->sbi", turns, middle - self.at_m) + self.at_m
        if not self.turns:
            moved[:, :, self.axis] += (self.shares * self.opens)[:, None]
        axes = np.broadcast_to(np.swapaxes(turns, 1, 2)[:, None], (steps, count, 3, 3))
        halves = np.broadcast_to(half, (steps, count, 3))
        return Boxes(moved.reshape(-1, 3), axes.reshape(-1, 3, 3), halves.reshape(-1, 3))


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes of any direction."""

    middle: FloatArray
    """(N, 3)"""
    axes: FloatArray
    """(N, 3, 3) unit vectors, a row each."""
    half: FloatArray
    """(N, 3) along these."""

    @classmethod
    def of(cls, bounds_m: FloatArray) -> Boxes:
        """Boxes (N, 2, 3) along the axes."""
        bounds_m = np.asarray(bounds_m, float).reshape(-1, 2, 3)
        axes = np.broadcast_to(np.eye(3), (len(bounds_m), 3, 3))
        return cls(bounds_m.mean(axis=1), axes, np.ptp(bounds_m, axis=1) / 2)

    @classmethod
    def filling(cls, box: Box) -> Boxes:
        """One box of the world."""
        length, depth, height = box.size_m
        bounds = np.array([[-length / 2, -depth / 2, 0.0], [length / 2, depth / 2, height]])
        return cls.of(bounds).placed(box)

    @classmethod
    def joined(cls, parts: Sequence[Boxes]) -> Boxes:
        """All of them."""
        empty = cls.of(np.zeros((0, 2, 3)))
        every = [empty, *parts]
        return cls(*(np.concatenate([getattr(part, name) for part in every])
                     for name in ("middle", "axes", "half")))  # fmt: skip

    def placed(self, box: Box) -> Boxes:
        """The same, given in the frame of a box, in the world."""
        turn = _turn(2, box.yaw_deg)
        return Boxes(self.middle @ turn.T + np.array(box.center_m), self.axes @ turn.T, self.half)

    def kept(self, which: IndexArray | BoolArray) -> Boxes:
        """Those at indices or of a mask."""
        return Boxes(self.middle[which], self.axes[which], self.half[which])

    @cached_property
    def bounds(self) -> FloatArray:
        """(N, 2, 3) lowest and highest corners in the world."""
        reach = (np.abs(self.axes) * self.half[:, :, None]).sum(axis=1)
        result: FloatArray = np.stack([self.middle - reach, self.middle + reach], axis=1)
        return result

    @cached_property
    def corners(self) -> FloatArray:
        """(N, 8, 3)"""
        signs = 2.0 * _CORNERS - 1.0
        steps = (signs[None] * self.half[:, None]) @ self.axes
        result: FloatArray = self.middle[:, None] + steps
        return result


WALL = -1
"""In place of the index of an obstacle."""


@dataclass(frozen=True)
class Way:
    """How far a leaf opens."""

    share: float
    """Of its range, [0, 1]."""
    stopped_by: int | None = None
    """Index of an obstacle, WALL, or None where it opens wide."""

    @property
    def is_free(self) -> bool:
        """Whether it opens as far as a leaf has to."""
        return self.share >= OPENS


def way_of(leaf: Leaf, box: Box, obstacles: Boxes, floor: shapely.Geometry) -> Way:
    """How far a leaf of a placed piece opens.

    obstacles: of other pieces. floor: over which it may pass, walls not included; prepared.
    """
    moving = leaf.boxes.placed(box)
    steps, boxes = len(leaf.shares), len(leaf.boxes_m)
    low, high = moving.bounds[:, 0].min(axis=0), moving.bounds[:, 1].max(axis=0)
    near = np.flatnonzero(
        ((obstacles.bounds[:, 0] < high) & (obstacles.bounds[:, 1] > low)).all(axis=1)
    )
    first, other = _meets(moving, obstacles.kept(near))
    hits = [(int(at) // boxes, int(near[by])) for at, by in zip(first, other, strict=True)]
    beyond = _beyond(moving, floor).reshape(steps, boxes).any(axis=1)
    hits += [(int(beyond.argmax()), WALL)] if beyond.any() else []
    if not hits:
        return Way(1.0)
    step, stopped_by = min(hits)
    return Way(float(leaf.shares[step - 1]) if step else 0.0, stopped_by)


def swept_box(leaf: Leaf, box: Box) -> Box:
    """The box in the world, turned as the piece is, that holds all that a leaf passes."""
    bounds = leaf.boxes.bounds
    low, high = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
    x, y, z = _turn(2, box.yaw_deg) @ np.array([*(low + high)[:2] / 2, low[2]]) + box.center_m
    length, depth, height = (high - low).tolist()
    return Box((float(x), float(y), float(z)), (length, depth, height), box.yaw_deg)


def _beyond(moving: Boxes, floor: shapely.Geometry) -> BoolArray:
    """(N,) whether a corner of a box lies beyond a floor."""
    corners = moving.corners
    inside = shapely.contains_xy(floor, corners[..., 0], corners[..., 1])
    result: BoolArray = ~inside.all(axis=1)
    return result


def _meets(boxes: Boxes, others: Boxes) -> tuple[IndexArray, IndexArray]:
    """Pairs of boxes of which one reaches into the other: no axis of either parts them."""
    apart = (boxes.bounds[:, None, 0] >= others.bounds[None, :, 1]) | (
        boxes.bounds[:, None, 1] <= others.bounds[None, :, 0]
    )
    first, second = np.nonzero(~apart.any(axis=2))
    deep = _deep(boxes.kept(first), others.kept(second))
    return first[deep], second[deep]


def _deep(boxes: Boxes, others: Boxes) -> BoolArray:
    """(P,) whether boxes of pairs share more than a touch, by their 15 separating axes."""
    crossed = np.cross(boxes.axes[:, :, None], others.axes[:, None, :]).reshape(-1, 9, 3)
    axes = np.concatenate([boxes.axes, others.axes, crossed], axis=1)
    length = np.linalg.norm(axes, axis=2)
    is_axis = length > _LEAST_AXIS
    axes = axes / np.where(is_axis, length, 1.0)[..., None]
    gap = np.abs(np.einsum("pki,pi->pk", axes, others.middle - boxes.middle))
    reach = sum(
        (np.abs(np.einsum("pki,pji->pkj", axes, each.axes)) * each.half[:, None]).sum(axis=2)
        for each in (boxes, others)
    )
    result: BoolArray = ((reach - gap > _TOUCH_M) | ~is_axis).all(axis=1)
    return result


def _turn(axis: int, angle_deg: float) -> FloatArray:
    """(3, 3) rotation about an axis."""
    angle = math.radians(angle_deg)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[first, first] = turn[second, second] = math.cos(angle)
    turn[first, second], turn[second, first] = -math.sin(angle), math.sin(angle)
    return turn
