"""The same house from another side: mirrored, scaled, turned, moved. Exact, on vectors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from chord_usd.base.scene.drawn_pieces import DRAWN, drawn_items, to_entry
from chord_usd.base.scene.types import (
    Box,
    FloatArray,
    Item,
    Opening,
    Plan,
    Room,
    SceneGraph,
    frozen_array,
)
from chord_usd.base.scene.units import rotation_2d, wrap_deg

House = TypeVar("House", Plan, SceneGraph)


@dataclass(frozen=True)
class Pose:
    """Mirror x, then scale, then turn counter-clockwise about the origin, then move."""

    mirrored: bool = False
    scale: float = 1.0
    yaw_deg: float = 0.0
    offset_m: tuple[float, float] = (0.0, 0.0)

    def points(self, points_m: FloatArray) -> FloatArray:
        """(N, 2) points in metres, posed."""
        mirror = np.array([-1.0 if self.mirrored else 1.0, 1.0])
        turned = points_m * mirror * self.scale @ rotation_2d(self.yaw_deg).T
        return turned + np.array(self.offset_m)

    def yaw(self, yaw_deg: float) -> float:
        """A direction, posed."""
        return wrap_deg((-yaw_deg if self.mirrored else yaw_deg) + self.yaw_deg)

    def box(self, box: Box) -> Box:
        """The box, posed. A front that looked north-east looks north-west in the mirror."""
        x_m, y_m = self.points(np.array([box.center_m[:2]]))[0]
        length_m, width_m, height_m = box.size_m
        return Box(
            (float(x_m), float(y_m), box.center_m[2]),
            (length_m * self.scale, width_m * self.scale, height_m),
            self.yaw(box.yaw_deg),
        )


def posed(house: House, pose: Pose) -> House:
    """The house under a pose; rooms stay counter-clockwise, heights stay as they are.

    Walls are WALL_THICKNESS_M by definition: rooms scaled by anything but 1 are no longer one
    wall apart. Fixtures noted in extra (data.flats) move along.
    """

    def room(room: Room) -> Room:
        points = pose.points(room.polygon_m)
        return replace(room, polygon_m=frozen_array(points[::-1] if pose.mirrored else points))

    def opening(opening: Opening) -> Opening:
        return replace(opening, box=pose.box(opening.box))

    rooms = tuple(map(room, house.rooms))
    openings = tuple(map(opening, house.openings))
    extra = _posed_extra(house.extra, pose)
    if isinstance(house, Plan):
        return replace(house, rooms=rooms, openings=openings, extra=extra)
    items = tuple(_posed_item(item, pose) for item in house.items)
    return replace(house, rooms=rooms, openings=openings, items=items, extra=extra)


def _posed_item(item: Item, pose: Pose) -> Item:
    # Children are posed in their parent's frame, which carries them: only what changes shapes
    # reaches them.
    child_pose = Pose(pose.mirrored, pose.scale)
    children = item.children
    if child_pose != Pose():
        children = tuple(_posed_item(child, child_pose) for child in children)
    return replace(item, box=pose.box(item.box), children=children)


def _posed_extra(extra: Mapping[str, Any], pose: Pose) -> Mapping[str, Any]:
    if DRAWN in extra:
        items = [_posed_item(item, pose) for item in drawn_items(extra)]
        extra = {**extra, DRAWN: to_entry(items)}
    if "fixtures" not in extra:
        return extra
    fixtures = []
    for fixture in extra["fixtures"]:
        x_m, y_m = pose.points(np.array([[fixture["x"], fixture["y"]]]))[0].tolist()
        sides = {"w": fixture["w"] * pose.scale, "h": fixture["h"] * pose.scale}
        yaw_deg = pose.yaw(fixture.get("yaw", 0.0))
        fixtures.append({**fixture, "x": x_m, "y": y_m, **sides, "yaw": yaw_deg})
    return {**extra, "fixtures": fixtures}
