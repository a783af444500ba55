"""Views around one room, which stands alone and open, as a model on a turntable."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from chord_usd.base.errors import RenderError
from chord_usd.base.runtime.stages import open_stage, room_prims
from chord_usd.base.scene.types import ROOM_HEIGHT_M, FloatArray
from chord_usd.line.image.stage_cameras import StageCamera

FOCAL_M = 0.04
APERTURE_M = 0.036
_ELEVATION_DEG = 32.0
_FRAME = (0.5, 0.5 * 9 / 16)
"""Half of the picture's width and height, over its width."""

_MARGIN = 1.05
_FIRST_DEG = 45.0


def turn_cameras(path: Path, room: str, count: int) -> tuple[StageCamera, ...]:
    """count views around a room, counter-clockwise, evenly spaced: Turn_000 and on.

    Raises StageError, and RenderError for a room that is not there.
    """
    corners_m = _corners(path, room)
    middle = (corners_m.min(axis=0) + corners_m.max(axis=0)) / 2
    turns_deg = _FIRST_DEG + np.arange(count) * 360.0 / count
    distance_m = max(_distance_m(corners_m - middle, turn) for turn in np.arange(0.0, 360.0, 15.0))
    digits = max(3, len(str(count - 1)))
    return tuple(
        _camera(f"Turn_{at:0{digits}d}", room, middle, float(turn), distance_m)
        for at, turn in enumerate(turns_deg)
    )


def _corners(path: Path, room: str) -> FloatArray:
    """(2 N, 3) corners of a room, on its floor and its ceiling."""
    stage = open_stage(path, load=False)
    rooms = {prim.GetName(): prim for prim in room_prims(stage)}
    if room not in rooms or not rooms[room].HasAttribute("chord:polygon_m"):
        raise RenderError(
            f"has no room named '{room}'",
            where=str(path),
            expected=f"one of {', '.join(rooms)}" if rooms else "a house that chord-usd wrote",
        )
    outline = np.array(rooms[room].GetAttribute("chord:polygon_m").Get(), dtype=np.float64)
    levels = [np.column_stack([outline, np.full(len(outline), z)]) for z in (0.0, ROOM_HEIGHT_M)]
    return np.concatenate(levels)


def _axes(turn_deg: float) -> FloatArray:
    """(3, 3) rows: right, up and backwards of a camera that looks down at the middle."""
    turn, rise = math.radians(turn_deg), math.radians(_ELEVATION_DEG)
    back = np.array(
        [math.cos(turn) * math.cos(rise), math.sin(turn) * math.cos(rise), math.sin(rise)]
    )
    right = np.array([-math.sin(turn), math.cos(turn), 0.0])
    return np.stack([right, np.cross(back, right), back])


def _distance_m(offsets_m: FloatArray, turn_deg: float) -> float:
    """How far off a camera has to be for all points to be in its picture."""
    right, up, back = _axes(turn_deg) @ offsets_m.T
    reach = np.maximum(np.abs(right) / _FRAME[0], np.abs(up) / _FRAME[1])
    return _MARGIN * float((reach * FOCAL_M / APERTURE_M + back).max())


def _camera(
    name: str, room: str, middle: FloatArray, turn_deg: float, distance_m: float
) -> StageCamera:
    axes = _axes(turn_deg)
    eye = middle + axes[2] * distance_m
    rows = [(*(float(x) for x in axes[:, row]), float(eye[row])) for row in range(3)]
    return StageCamera(
        name=name,
        room=room,
        matrix=(*rows, (0.0, 0.0, 0.0, 1.0)),
        focal_m=FOCAL_M,
        aperture_m=APERTURE_M,
        shift=(0.0, 0.0),
        orthographic=False,
        clip_m=(0.05, 1000.0),
        focus_m=0.0,
        f_stop=0.0,
        from_above=True,
        is_alone=True,
    )
