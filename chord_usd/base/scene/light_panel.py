"""Where a room's light hangs: a rectangle at its centre, sized to it (CHOrD, section 4)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry import Point, Polygon, box

_SHARE_OF_ROOM = 0.4
"""Length and width of the panel as a share of the room's."""

_FROM_WALL_M = 0.1


@dataclass(frozen=True)
class Panel:
    """A rectangle under the ceiling that shines down."""

    center_m: tuple[float, float]
    yaw_deg: float
    size_m: tuple[float, float]
    """Along its own x and y."""


def panel_for(floor: Polygon) -> Panel:
    """The panel of a room with this floor; it lies over the floor whatever its shape."""
    centre = _centre(floor)
    yaw_deg, extent = _main_axes(floor)
    size = _SHARE_OF_ROOM * extent
    free = floor.buffer(-_FROM_WALL_M)
    while size.min() > 0.05 and not free.covers(_rectangle(centre, yaw_deg, size)):
        size = size * 0.9
    width, height = (round(float(side), 3) for side in size)
    return Panel((round(centre.x, 4), round(centre.y, 4)), round(yaw_deg, 3), (width, height))


def _centre(floor: Polygon) -> Point:
    """The centroid, where it lies well inside; in bent rooms the point farthest from all walls."""
    radius_line = shapely.maximum_inscribed_circle(floor, tolerance=0.01)
    centroid = floor.centroid
    inside = floor.contains(centroid)
    if inside and floor.exterior.distance(centroid) > 0.6 * radius_line.length:
        return centroid
    return Point(radius_line.coords[0])


def _main_axes(floor: Polygon) -> tuple[float, np.ndarray]:
    """Direction of the room's longer side in (-90, 90], and its length and width."""
    corners = np.asarray(shapely.minimum_rotated_rectangle(floor).exterior.coords)
    sides = corners[1:3] - corners[:2]
    lengths = np.hypot(*sides.T)
    x, y = sides[int(np.argmax(lengths))]
    angle = math.degrees(math.atan2(y, x))
    angle = angle - 180.0 if angle > 90.0 else angle + 180.0 if angle <= -90.0 else angle
    return angle, np.sort(lengths)[::-1]


def _rectangle(centre: Point, yaw_deg: float, size: np.ndarray) -> Polygon:
    half = size / 2
    around = box(centre.x - half[0], centre.y - half[1], centre.x + half[0], centre.y + half[1])
    return affinity.rotate(around, yaw_deg, origin=centre)
