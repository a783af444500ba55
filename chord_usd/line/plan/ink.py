"""What each pixel of a plan raster shows: wall, door, window, or the floor of some room kind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.scene import palette
from chord_usd.base.scene.types import BoolArray, ByteArray, RoomKind

_DARKEST_FLOOR = 128
"""Floors are light; the darkest room shade is 172."""

_LEAST_COLOR = 40
"""Difference between channels from which a pixel is door or window, not a shade of grey."""

_SHADE_STEP = 4
"""A floor within so many grey levels of a room kind's shade is of that kind."""

_KINDS = tuple(palette.ROOM_SHADES)
_SHADES = np.array([palette.ROOM_SHADES[kind][0] for kind in _KINDS])
_WHITE = _KINDS.index("unknown")


@dataclass(frozen=True, eq=False)
class Ink:
    """A plan raster, sorted. All arrays (H, W)."""

    wall: BoolArray
    door: BoolArray
    window: BoolArray
    shade: ByteArray
    """Floors: index of the room kind, or some number beyond for shades of no kind."""

    @property
    def solid(self) -> BoolArray:
        """Everything that stands between rooms: walls, doors and windows."""
        return self.wall | self.door | self.window

    @property
    def white(self) -> BoolArray:
        """Outside, passages, and floors of unknown kind."""
        return (self.shade == _WHITE) & ~self.solid

    @property
    def is_shaded(self) -> bool:
        """Whether rooms are told apart by shade."""
        return bool(np.any((self.shade != _WHITE) & ~self.solid))


def sort_pixels(rgb: ByteArray) -> Ink:
    """Sort the pixels of a plan raster (H, W, 3) by the palette's plan colours."""
    darkest, lightest = rgb.min(axis=2), rgb.max(axis=2)
    colored = lightest.astype(np.int16) - darkest > _LEAST_COLOR
    nearest = np.argmin(
        [
            np.abs(rgb.astype(np.int16) - np.array(palette.category(name).rgb)).sum(axis=2)
            for name in ("door", "window")
        ],
        axis=0,
    )
    wall = ~colored & (lightest < _DARKEST_FLOOR)
    return Ink(wall, colored & (nearest == 0), colored & (nearest == 1), _shade_codes()[lightest])


def _shade_codes() -> ByteArray:
    """(256,) code of each grey level."""
    distances = np.abs(np.arange(256)[:, None] - _SHADES)
    codes = np.argmin(distances, axis=1)
    foreign = distances.min(axis=1) > _SHADE_STEP
    codes[foreign] = len(_KINDS) + np.flatnonzero(foreign) // 8
    return codes.astype(np.uint8)


def kind_of_shade(code: int) -> RoomKind:
    """The room kind of a shade code; unknown for a shade of no kind."""
    return _KINDS[code] if code < len(_KINDS) else "unknown"


def label_floors(ink: Ink, closed: BoolArray) -> npt.NDArray[np.int32]:
    """(H, W) a number for each room, 0 for what is none: connected floor of one shade.

    closed: pixels that part rooms besides the solid ones (passages). White floor that reaches the
    border of the raster is outside.
    """
    floor = ~(ink.solid | closed)
    labels = np.zeros(floor.shape, np.int32)
    count = 0
    for code in np.unique(ink.shade[floor]):
        part = (floor & (ink.shade == code)).astype(np.uint8)
        parts, numbers = cv2.connectedComponents(part, connectivity=4)
        inner = np.arange(parts)
        if code == _WHITE:
            inner[border_values(numbers)] = 0
        labels += np.where(inner > 0, inner + count, 0)[numbers].astype(np.int32)
        count += parts
    return labels


def border_values(image: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The distinct values along the four sides of an image."""
    return np.unique(np.concatenate([image[0], image[-1], image[:, 0], image[:, -1]]))
