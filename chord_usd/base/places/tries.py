"""Places to try for a box, in a fixed order: at walls, beside a piece, over the floor. Metres."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from chord_usd.base.scene.geometry import front_direction, room_polygon, room_sides
from chord_usd.base.scene.types import Box, FloatArray, Room
from chord_usd.base.scene.units import wrap_deg

_SQUARE = 0.7
"""Cosine from which a front points along a direction rather than across it."""


def placed(box: Box, at_m: Sequence[float] | FloatArray, yaw_deg: float) -> Box:
    """The box with its middle at (x, y) and turned; to a tenth of a millimetre."""
    center_m = (round(float(at_m[0]), 4), round(float(at_m[1]), 4), box.center_m[2])
    return replace(box, center_m=center_m, yaw_deg=wrap_deg(round(yaw_deg, 4)))


def beside(
    box: Box, anchor: Box, gap_m: float, step_m: float, *, looks_at_it: bool = False
) -> Iterator[Box]:
    """The box along the four sides of an anchor, the middle of each side first.

    looks_at_it: its front faces the anchor; otherwise it is turned as the anchor is, away from it,
    or a quarter.
    """
    front = front_direction(anchor.yaw_deg)
    right = np.array([-front[1], front[0]])
    middle, (length_m, depth_m, _) = np.array(anchor.center_m[:2]), anchor.size_m
    for out, half_m, width_m in (
        (right, length_m / 2, depth_m),
        (-right, length_m / 2, depth_m),
        (front, depth_m / 2, length_m),
        (-front, depth_m / 2, length_m),
    ):
        outward_deg = float(np.degrees(np.arctan2(out[0], -out[1])))
        around = (anchor.yaw_deg, outward_deg, anchor.yaw_deg + 90, anchor.yaw_deg - 90)
        yaws = (outward_deg + 180.0,) if looks_at_it else around
        sideways = np.array([-out[1], out[0]])
        steps = int(width_m / 2 / step_m)
        for yaw_deg in dict.fromkeys(round(wrap_deg(yaw), 4) for yaw in yaws):
            is_ahead = abs(float(front_direction(yaw_deg) @ out)) > _SQUARE
            reach_m = half_m + gap_m + (box.size_m[1] if is_ahead else box.size_m[0]) / 2
            for step in sorted(range(-steps, steps + 1), key=abs):
                at_m = middle + out * reach_m + sideways * (step * step_m)
                yield placed(box, at_m, yaw_deg)


def over_floor(box: Box, room: Room, step_m: float) -> Iterator[Box]:
    """The box on a grid over a room, turned in the four directions of the room's longest side."""
    start, end = max(room_sides(room), key=lambda side: float(np.hypot(*np.subtract(*side))))
    along = float(np.degrees(np.arctan2(*(end - start)[::-1])))
    yaws = [wrap_deg(round(along + turn, 6)) for turn in (0.0, 90.0, 180.0, 270.0)]
    west, south, east, north = room_polygon(room).bounds
    for x_m in np.arange(west + step_m / 2, east, step_m):
        for y_m in np.arange(south + step_m / 2, north, step_m):
            for yaw_deg in yaws:
                yield placed(box, (x_m, y_m), yaw_deg)


def around(box: Box, step_m: float, most_m: float) -> Iterator[Box]:
    """The box moved by no more than most_m, on a grid, the nearest first."""
    reach = np.arange(-most_m, most_m + step_m / 10, step_m)
    x, y, z = box.center_m
    steps = [(across, along) for across in reach for along in reach]
    for across, along in sorted(steps, key=lambda step: float(np.hypot(*step))):
        if np.hypot(across, along) <= most_m:
            yield replace(box, center_m=(float(x + across), float(y + along), z))
