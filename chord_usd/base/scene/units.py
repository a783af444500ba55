"""The only conversions between centimetres and metres, pixels and the world, degrees and radians.

The world is right-handed, Z up, in metres; yaw is in degrees counter-clockwise from +x, seen from
above. Images have their origin at the top left, y down; continuous pixel coordinates put the
centre of pixel (row 0, column 0) at (0.5, 0.5).
"""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.types import FloatArray, PixelFrame

CM_PER_M = 100.0


def m_from_cm(length_cm: float) -> float:
    """Centimetres (CHOrD JSON) to metres."""
    return length_cm / CM_PER_M


def cm_from_m(length_m: float) -> float:
    """Metres to centimetres (CHOrD JSON)."""
    return length_m * CM_PER_M


def wrap_deg(angle_deg: float) -> float:
    """The same direction in (-180, 180]."""
    wrapped = math.fmod(angle_deg, 360.0)
    if wrapped > 180.0:
        return wrapped - 360.0
    return wrapped + 360.0 if wrapped <= -180.0 else wrapped


Angle = TypeVar("Angle", float, FloatArray)


def fold_deg(angle_deg: Angle) -> Angle:
    """The same pair of perpendicular directions, in [-45, 45)."""
    return (angle_deg + 45.0) % 90.0 - 45.0


def rotation_2d(yaw_deg: float) -> FloatArray:
    """(2, 2) matrix that turns column vectors counter-clockwise by yaw_deg.

    Multiples of 90 degrees give exact zeros and ones, so that axis-aligned boxes stay so.
    """
    quarter_turns, rest_deg = divmod(yaw_deg, 90.0)
    if rest_deg == 0.0:
        cos, sin = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarter_turns) % 4]
    else:
        cos, sin = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    return np.array([[cos, -sin], [sin, cos]])


def px_from_m(points_m: npt.ArrayLike, frame: PixelFrame) -> FloatArray:
    """World points (..., 2) in metres to continuous pixel coordinates (x right, y down)."""
    points = np.asarray(points_m, dtype=np.float64)
    x_px = (points[..., 0] - frame.origin_m[0]) / frame.m_per_px
    y_px = frame.height_px - (points[..., 1] - frame.origin_m[1]) / frame.m_per_px
    return np.stack([x_px, y_px], axis=-1)


def m_from_px(points_px: npt.ArrayLike, frame: PixelFrame) -> FloatArray:
    """Continuous pixel coordinates (..., 2) to world points in metres; inverse of px_from_m."""
    points = np.asarray(points_px, dtype=np.float64)
    x_m = frame.origin_m[0] + points[..., 0] * frame.m_per_px
    y_m = frame.origin_m[1] + (frame.height_px - points[..., 1]) * frame.m_per_px
    return np.stack([x_m, y_m], axis=-1)
