"""The colours that a layout can show, and layouts in shifted ones brought back to them.

Another screen or another program shifts all colours alike. Two of every layout are known by their
place: the background along the rim, and the walls, the darkest of what is common. They give a gain
and an offset for each channel.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.palette import (
    BACKGROUND_RGB,
    CATEGORIES,
    FRONT_MARK_OPACITY,
    HOUSE_CATEGORIES,
    PLAN_CATEGORIES,
    ROOM_SHADES,
    painted,
)
from chord_usd.base.scene.types import BoolArray, ByteArray

Floats = npt.NDArray[np.float64]

_RIM_PX = 2

_DARK = 64
"""Walls have no channel above it, shifted or not."""

_LEAST_CONTRAST = 100
"""Levels between background and walls, below which a picture is no layout."""

_MOST_CLIPPED = 8
"""Levels that a shift may have driven a colour beyond the scale, where it was clipped."""

_MOST_COLOURS = 1500
"""A picture with more is not drawn in flat colours."""

_ROUNDING = 2
"""Levels off the palette that rounding leaves."""

_LEAST_SHARE = 0.995
"""Share of the pixels that must lie on the palette when a picture counts as drawn in it."""


def _item_rgb() -> npt.NDArray[np.float32]:
    """(shade, 2 * category + marked or bare floor last, 3) colours."""
    rows = []
    for shade_rgb in ROOM_SHADES.values():
        colours = []
        for row in HOUSE_CATEGORIES:
            body = painted(shade_rgb, row.rgb)
            colours += [body, painted(body, (0, 0, 0), FRONT_MARK_OPACITY)]
        rows.append([*colours, shade_rgb])
    return np.array(rows, dtype=np.float32)


ITEM_RGB = _item_rgb()
"""(shade, 2 * category + marked or bare floor last, 3)."""

STRUCTURE_RGB = np.array([row.rgb for row in PLAN_CATEGORIES], dtype=np.int16)
"""(PLAN category, 3)."""


def packed(rgb: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint32]:
    """(...) one number for each of (..., 3) colours."""
    red, green, blue = np.moveaxis(rgb.astype(np.uint32), -1, 0)
    return np.asarray((red << 16) | (green << 8) | blue, dtype=np.uint32)


def unpacked(colours: npt.NDArray[np.uint32]) -> ByteArray:
    """(..., 3) the colours of these numbers."""
    return np.stack([colours >> 16, (colours >> 8) & 255, colours & 255], axis=-1).astype(np.uint8)


def is_exact(rgb: ByteArray) -> bool:
    """Whether nearly every pixel of (H, W, 3) has exactly a colour of the palette."""
    return _share_near(rgb, 0) >= _LEAST_SHARE


def calibrated(rgb: ByteArray) -> ByteArray | None:
    """(H, W, 3) the picture in the palette's colours; None where no shift explains the colours.

    Blurred, compressed and hand-painted pictures have colours between those of the palette.
    """
    rim = np.ones(rgb.shape[:2], bool)
    rim[_RIM_PX:-_RIM_PX, _RIM_PX:-_RIM_PX] = False
    dark = rgb.max(axis=2) < _DARK
    if not dark.any():
        return None
    background, wall = _commonest(rgb[rim]), _commonest(rgb[dark])
    if (background - wall).min() < _LEAST_CONTRAST:
        return None
    colours, back, counts = np.unique(packed(rgb), return_inverse=True, return_counts=True)
    if len(colours) > _MOST_COLOURS:
        return None
    seen = unpacked(colours)
    shown = max(
        (_stretched(seen, white, black) for white in _unclipped(background, 255)
         for black in _unclipped(wall, 0)),
        key=lambda one: float(counts @ _near_palette(_ROUNDING)[packed(one)]),
    )  # fmt: skip
    picture = shown[back].reshape(rgb.shape)
    return picture if _share_near(picture, _ROUNDING) >= _LEAST_SHARE else None


def _unclipped(anchor: Floats, end: int) -> Iterator[Floats]:
    """(3,) what an anchor may have been, where it was clipped at an end of the scale."""
    beyond = np.copysign(np.arange(0.0, _MOST_CLIPPED + 1, 2.0), end - 1)
    own = [level + (beyond if level == end else beyond[:1]) for level in anchor]
    return (np.array(levels) for levels in itertools.product(*own))


def _stretched(rgb: ByteArray, background: Floats, wall: Floats) -> ByteArray:
    """(N, 3) with these two where the palette has them; what was clipped stays at its end."""
    white, black = np.array(BACKGROUND_RGB), np.array(CATEGORIES["wall"].rgb)
    levels = black + (rgb - wall) * ((white - black) / (background - wall))
    levels = np.where((rgb == 0) | (rgb == 255), rgb, levels)
    return np.clip(np.rint(levels), 0, 255).astype(np.uint8)


def _commonest(colours: ByteArray) -> npt.NDArray[np.float64]:
    """(3,) of (N, 3)."""
    values, counts = np.unique(packed(colours), return_counts=True)
    return unpacked(values[counts.argmax()]).astype(np.float64)


def _share_near(rgb: ByteArray, reach: int) -> float:
    return float(_near_palette(reach)[packed(rgb)].mean())


@lru_cache(maxsize=2)
def _near_palette(reach: int) -> BoolArray:
    """(2^24,) whether a packed colour is within so many levels of one of the palette."""
    table = np.zeros(1 << 24, dtype=bool)
    colours = np.concatenate([ITEM_RGB.reshape(-1, 3), STRUCTURE_RGB]).astype(np.int16)
    steps = np.arange(-reach, reach + 1)
    offsets = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 1, 3)
    table[packed(np.clip(colours + offsets, 0, 255).astype(np.uint8).reshape(-1, 3))] = True
    return table
