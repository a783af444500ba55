"""The same house from another side: mirrored, turned, scaled. Exact, on vectors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from chord_usd.types import Box, FloatArray, Opening, Plan, Room, SceneGraph, frozen_array
from chord_usd.units import rotation_2d, wrap_deg

House = TypeVar("House", Plan, SceneGraph)

SKEW_CHANCE = 0.1
"""Share of houses that random_pose turns by any angle; most plans are drawn axis-aligned."""


@dataclass(frozen=True)
class Pose:
    """Mirror x, then scale, then turn counter-clockwise about the origin."""

    mirrored: bool = False
    scale: float = 1.0
    yaw_deg: float = 0.0

    def points(self, points_m: FloatArray) -> FloatArray:
        """(N, 2) points in metres, posed."""
        mirror = np.array([-1.0 if self.mirrored else 1.0, 1.0])
        return points_m * mirror * self.scale @ rotation_2d(self.yaw_deg).T

    def box(self, box: Box) -> Box:
        """The box, posed. A front that looked north-east looks north-west in the mirror."""
        x_m, y_m = self.points(np.array([box.center_m[:2]]))[0]
        length_m, width_m, height_m = box.size_m
        yaw_deg = -box.yaw_deg if self.mirrored else box.yaw_deg
        return Box(
            (float(x_m), float(y_m), box.center_m[2]),
            (length_m * self.scale, width_m * self.scale, height_m),
            wrap_deg(yaw_deg + self.yaw_deg),
        )


def posed(house: House, pose: Pose) -> House:
    """The house under a pose; rooms stay counter-clockwise, heights stay as they are.

    Children of items are posed in their parent's frame: a turned parent carries them along, but a
    mirrored or scaled one would not. Raises ValueError for such a pose of a scene with children.
    """

    def room(room: Room) -> Room:
        points = pose.points(room.polygon_m)
        return replace(room, polygon_m=frozen_array(points[::-1] if pose.mirrored else points))

    def opening(opening: Opening) -> Opening:
        return replace(opening, box=pose.box(opening.box))

    rooms = tuple(map(room, house.rooms))
    openings = tuple(map(opening, house.openings))
    if isinstance(house, Plan):
        return replace(house, rooms=rooms, openings=openings)
    if (pose.mirrored or pose.scale != 1.0) and any(item.children for item in house.items):
        raise ValueError("a scene with tabletop items can be turned, not mirrored or scaled")
    items = tuple(replace(item, box=pose.box(item.box)) for item in house.items)
    return replace(house, rooms=rooms, openings=openings, items=items)


def random_pose(house: House, rng: np.random.Generator) -> House:
    """One of the eight symmetries of the square; with SKEW_CHANCE any angle instead."""
    mirrored = bool(rng.integers(2))
    quarter_deg = 90.0 * int(rng.integers(4))
    skew_deg = float(rng.uniform(-45.0, 45.0)) if rng.random() < SKEW_CHANCE else 0.0
    return posed(house, Pose(mirrored, 1.0, quarter_deg + skew_deg))
