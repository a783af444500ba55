"""What of a piece of furniture moves, and how: doors, flaps and lids turn, drawers slide."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.solids import Axis, Solid

DOOR_SWING_DEG = 100.0
"""What cup hinges of furniture let a door turn."""

Inside = Literal["shelves", "nothing"]
PointM = tuple[float, float, float]


@dataclass(frozen=True)
class Hinge:
    """Turns about an axis of the model."""

    at_m: PointM
    """A point on the axis."""
    axis: Axis
    opens_deg: float
    """Turn when it is wide open, counter-clockwise looking down the axis; shut is 0."""

    def starts(self, point_m: FloatArray) -> FloatArray:
        """(3,) the direction, of any length, in which it first moves a point, (3,)."""
        turn = np.eye(3)["xyz".index(self.axis)] * math.copysign(1.0, self.opens_deg)
        return np.cross(turn, point_m - np.array(self.at_m))


@dataclass(frozen=True)
class Slide:
    """Runs along an axis of the model."""

    at_m: PointM
    """Where it is when it is shut."""
    axis: Axis
    opens_m: float
    """Signed way when it is wide open; shut is 0."""

    def starts(self, point_m: FloatArray) -> FloatArray:
        """(3,) the direction in which it moves every point."""
        return np.eye(3)["xyz".index(self.axis)] * math.copysign(1.0, self.opens_m)


Motion = Hinge | Slide


@dataclass(frozen=True, eq=False)
class Leaf:
    """Something that moves as one: a door with its handle, a drawer."""

    kind: str
    """What its prim is called, with a number: Door, Drawer, Lid."""
    motion: Motion
    holds: bool = False
    """Whether things are put into it rather than behind it: a drawer, a tilting flap."""
    inside: Inside = "shelves"
    """What is behind a door."""


@dataclass(frozen=True, eq=False)
class Moving:
    """What of a part belongs to a leaf."""

    leaf: Leaf
    solid: Solid
    colliders: tuple[Solid, ...] = ()
    """Solids whose bounding boxes collide in place of its own."""


def drawer(front: Solid) -> Leaf:
    """A drawer behind a front, towards -y; how far it opens depends on the body around it."""
    low, high = front.bounds_m()
    x, z = (float(low[axis] + high[axis]) / 2 for axis in (0, 2))
    return Leaf("Drawer", Slide((x, float(low[1]), z), "y", -0.4), holds=True)


def door(
    panel: Solid, *, hung: Literal["left", "right"], inside: Inside = "shelves",
    opens_deg: float = DOOR_SWING_DEG,
) -> Leaf:  # fmt: skip
    """A door that opens towards -y, hung at one side as one sees it from the front.

    It turns about the outer edge of its face, so that it never reaches beyond its own width.
    """
    low, high = panel.bounds_m()
    x, sign = (low[0], -1.0) if hung == "left" else (high[0], 1.0)
    at = (float(x), float(low[1]), float(low[2]))
    return Leaf("Door", Hinge(at, "z", sign * opens_deg), inside=inside)


def flap(
    panel: Solid, *, opens_deg: float, holds: bool = False, inside: Inside = "shelves"
) -> Leaf:
    """A door that falls open towards -y about the lower edge of its face."""
    low, high = panel.bounds_m()
    at = (float(low[0] + high[0]) / 2, float(low[1]), float(low[2]))
    return Leaf("Flap", Hinge(at, "x", opens_deg), holds=holds, inside=inside)


def lid(panel: Solid, *, opens_deg: float) -> Leaf:
    """A lid that is raised about the lower edge of its back, at +y."""
    low, high = panel.bounds_m()
    at = (float(low[0] + high[0]) / 2, float(high[1]), float(low[2]))
    return Leaf("Lid", Hinge(at, "x", -opens_deg), inside="nothing")


def fitted_leaf(leaf: Leaf, shift_m: FloatArray, factor: FloatArray) -> Leaf:
    """The leaf of a model that is shifted, then stretched."""
    x, y, z = (np.add(leaf.motion.at_m, shift_m) * factor).tolist()
    return replace(leaf, motion=replace(leaf.motion, at_m=(x, y, z)))


def leaves_of(moving: Sequence[Moving]) -> list[Leaf]:
    """Each leaf once, in order."""
    return list(dict.fromkeys(move.leaf for move in moving))
