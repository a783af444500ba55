"""Layout raster -> what every pixel shows: structure, floor shade, item category, front mark.

An item's colour depends on the floor it is painted over, so the shades are read first: one room
region (pixels enclosed by walls, doors and windows) has one shade, an open-plan region several.
Rasters whose colours differ from the palette (JPEG, noise) are smoothed within their flat areas
before they are read.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.errors import SceneError
from chord_usd.base.raster.windows import Window, components
from chord_usd.base.scene.palette import (
    BACKGROUND_RGB,
    CATEGORIES,
    FRONT_MARK_OPACITY,
    HOUSE_CATEGORIES,
    PLAN_CATEGORIES,
    ROOM_SHADES,
    Mount,
    painted,
)
from chord_usd.base.scene.types import BoolArray, ByteArray

# The colours that a layout can show, and layouts in shifted ones brought back to them ------------

# Another screen or another program shifts all colours alike. Two of every layout are known by
# their place: the background along the rim, and the walls, the darkest of what is common. They
# give a gain and an offset for each channel.

Floats = npt.NDArray[np.float64]

_RIM_PX = 2

_WALL_MOST = 64
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

    Blurred, compressed and hand-painted pictures have colours between the palette's.
    """
    rim = np.ones(rgb.shape[:2], bool)
    rim[_RIM_PX:-_RIM_PX, _RIM_PX:-_RIM_PX] = False
    dark = rgb.max(axis=2) < _WALL_MOST
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
        key=lambda candidate: float(counts @ _near_palette(_ROUNDING)[packed(candidate)]),
    )  # fmt: skip
    picture = shown[back].reshape(rgb.shape)
    return picture if _share_near(picture, _ROUNDING) >= _LEAST_SHARE else None


def _unclipped(anchor: Floats, end: int) -> Iterator[Floats]:
    """(3,) what an anchor may have been, where it was clipped at an end of the scale."""
    beyond = np.copysign(np.arange(0.0, _MOST_CLIPPED + 1, 2.0), end - 1)
    choices = [level + (beyond if level == end else beyond[:1]) for level in anchor]
    return (np.array(levels) for levels in itertools.product(*choices))


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


LabelArray = npt.NDArray[np.int16]

CLEAR = -1
"""Structure label of pixels that are neither wall, door nor window."""

NO_ITEM = -1
"""Item label of bare floor, of structure and of everything outside the house."""

SHADE_KINDS = tuple(ROOM_SHADES)
"""Room kind of each shade label."""

_SHADE_LEVELS = np.array([rgb[0] for rgb in ROOM_SHADES.values()], dtype=np.float32)
_NEAREST_SHADE = (
    np.abs(np.arange(3 * 255 + 1)[:, None] / 3 - _SHADE_LEVELS).argmin(axis=1).astype(np.int16)
)
"""Shade whose grey is nearest, by the sum of the channels."""
_DARK = 64
"""Every structure colour has a channel below, its blends with black too; floors and items on them
have none below 84."""
_GREY_REACH = 13
"""Greatest spread of the channels of a floor pixel under noise of 8 levels, smoothed."""
_LEAST_SHADE_SHARE, _LEAST_SHADE_PX, _SURE_SHADE_PX = 0.03, 4, 150
"""With noise, a region has a shade if this share of its floor shows it, or so many pixels."""
_MIXED_COST = 30.0
"""Squared levels from the palette above which a smoothed pixel is taken for a mixture."""
_FAR_SHADE_COST, _FAR_SHADE_COST_CLEAN = 20.0, 0.5
"""Squared levels that speak against a shade other than that of the nearest bare floor."""


@dataclass(frozen=True, eq=False)
class LayoutPixels:
    """What each pixel of a layout raster shows. All arrays are (H, W)."""

    structure: LabelArray
    """detector_class of a PLAN category (0 wall, 1 door, 2 window), or CLEAR."""
    shade: LabelArray
    """Index into SHADE_KINDS of the floor here, under items too; 0 (white) elsewhere."""
    item: LabelArray
    """detector_class of a HOUSE category, or NO_ITEM."""
    front: BoolArray
    """Whether the pixel belongs to a front mark."""
    clean: bool = True
    """Whether the colours are the palette's, or shifted alike; else others painted it."""

    def window(self, part: tuple[slice, slice]) -> LayoutPixels:
        """The same of a part of the canvas."""
        return LayoutPixels(
            self.structure[part], self.shade[part], self.item[part], self.front[part], self.clean
        )


def read_pixels(rgb: ByteArray) -> LayoutPixels:
    """Decode a layout raster, (H, W, 3) uint8; tolerates noise of about 8 levels.

    Raises SceneError when the array is not an RGB raster.
    """
    if rgb.ndim != 3 or rgb.shape[2] != 3 or rgb.dtype != np.uint8:
        raise SceneError(
            f"layout raster of shape {rgb.shape} and type {rgb.dtype}",
            expected="(height, width, 3) uint8",
        )
    exact = is_exact(rgb)
    known = rgb if exact else calibrated(rgb)
    clean = known is not None
    smooth = (
        np.asarray(cv2.bilateralFilter(rgb, 5, 25.0, 2.0), np.uint8) if known is None else known
    )
    structure = _read_structure(smooth)
    regions, windows = components(structure == CLEAR)
    shade, allowed = _read_shades(smooth, regions, windows, 0.0 if clean else _LEAST_SHADE_SHARE)
    far_cost = _FAR_SHADE_COST_CLEAN if exact else _FAR_SHADE_COST
    item, front, shade = _read_items(smooth, regions, shade, allowed, far_cost)
    if not clean:
        item, front = _without_rings(smooth, shade, item, front, structure)
        item, front = _settle(item, front, structure)
    return LayoutPixels(structure, shade, item, front, clean)


_FLOOR = ITEM_RGB.shape[1] - 1
_PANEL_CODES = {
    2 * row.detector_class + marked
    for row in HOUSE_CATEGORIES
    if row.mount is Mount.WALL
    for marked in (0, 1)
}


def _smoothed(rgb: ByteArray) -> ByteArray:
    """Within its flat areas."""
    return np.asarray(cv2.bilateralFilter(rgb, 5, 25.0, 2.0), np.uint8)


def _extremes(rgb: ByteArray) -> tuple[ByteArray, ByteArray]:
    """(H, W) least and greatest of the channels; numpy is slow along short axes."""
    red, green, blue = np.moveaxis(rgb, -1, 0)
    least = np.minimum(np.minimum(red, green), blue)
    return least, np.maximum(np.maximum(red, green), blue)


def _read_structure(rgb: ByteArray) -> LabelArray:
    least, _ = _extremes(rgb)
    structure = np.full(least.shape, CLEAR, dtype=np.int16)
    dark = least < _DARK
    spread = np.abs(rgb[dark][:, None, :].astype(np.int16) - STRUCTURE_RGB).max(axis=-1)
    structure[dark] = spread.argmin(axis=-1)
    return structure


def _read_shades(
    rgb: ByteArray,
    regions: npt.NDArray[np.int32],
    windows: Sequence[Window],
    least_share: float,
) -> tuple[LabelArray, dict[int, list[int]]]:
    """Shade of the nearest bare floor in each pixel's region, and the shades each region has."""
    total = rgb[..., 0].astype(np.int16) + rgb[..., 1] + rgb[..., 2]
    least, most = _extremes(rgb)
    bare = (most - least <= _GREY_REACH) & (regions > 0)
    bare &= total >= 3 * (_SHADE_LEVELS.min() - 8)
    nearest = _NEAREST_SHADE[total]
    shade = np.zeros(regions.shape, dtype=np.int16)
    allowed: dict[int, list[int]] = {}
    flat = bare & (cv2.boxFilter(bare.astype(np.float32), -1, (3, 3)) > 0.6)
    for region, window in enumerate(windows, start=1):
        inside = regions[window] == region
        votes, seen = nearest[window], bare[window] & inside
        shades = _shades_of(votes[seen & flat[window]], votes[seen], least_share)
        allowed[region] = shades
        floor = seen & np.isin(votes, shades)
        if len(shades) == 1:
            shade[window][inside] = shades[0]
        elif floor.any():
            shade[window][inside] = _spread_nearest(votes, floor)[inside]
    return shade, allowed


def _shades_of(flat: LabelArray, bare: LabelArray, least_share: float) -> list[int]:
    """Shades that cover a real part of a region; all of them where no floor is left to see."""
    for votes in (flat, bare):
        counts = np.bincount(votes, minlength=len(SHADE_KINDS))
        large = np.flatnonzero(
            counts >= max(_LEAST_SHADE_PX, min(least_share * counts.sum(), _SURE_SHADE_PX))
        )
        if len(large):
            return [int(index) for index in large]
    if len(bare):
        return [int(np.bincount(bare).argmax())]
    return list(range(len(SHADE_KINDS)))


def _spread_nearest(labels: LabelArray, known: BoolArray) -> LabelArray:
    """labels where known; elsewhere the label of the nearest known pixel."""
    _, index = cv2.distanceTransformWithLabels(
        (~known).astype(np.uint8), cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL
    )
    of_index = np.zeros(int(index.max()) + 1, dtype=np.int16)
    of_index[index[known]] = labels[known]
    return of_index[index]


def _read_items(
    rgb: ByteArray,
    regions: npt.NDArray[np.int32],
    shade: LabelArray,
    allowed: dict[int, list[int]],
    far_cost: float,
) -> tuple[LabelArray, BoolArray, LabelArray]:
    """Item and mark of each pixel, and the shade it was read with."""
    item = np.full(regions.shape, NO_ITEM, dtype=np.int16)
    front = np.zeros(regions.shape, dtype=bool)
    shade = shade.copy()
    floor_level = _SHADE_LEVELS[shade]
    least, most = _extremes(rgb)
    off_floor = (most > floor_level + 2) | (least < floor_level - 2)
    rows, columns = np.nonzero(off_floor & (regions > 0))
    of_pixel = regions[rows, columns]
    for region in np.unique(of_pixel):
        chosen = of_pixel == region
        at = (rows[chosen], columns[chosen])
        code, under = _nearest_colours(rgb[at], shade[at], allowed[int(region)], far_cost)
        item[at] = np.where(code == _FLOOR, NO_ITEM, code // 2)
        front[at] = (code != _FLOOR) & (code % 2 == 1)
        shade[at] = under
    return item, front, shade


def _nearest_colours(
    rgb: npt.NDArray[np.uint8], prior: LabelArray, shades: list[int], far_cost: float
) -> tuple[npt.NDArray[np.int64], LabelArray]:
    """Best (row of the item table, shade) for each of (N, 3) colours."""
    colours, back = np.unique(packed(rgb), return_inverse=True)
    distinct = unpacked(colours)
    cost = np.empty((len(shades), len(rgb)), dtype=np.float32)
    code = np.empty((len(shades), len(rgb)), dtype=np.int64)
    for position, shade in enumerate(shades):
        gap = ((distinct[:, None, :].astype(np.float32) - ITEM_RGB[shade]) ** 2).sum(axis=-1)
        best = gap.argmin(axis=1)
        code[position] = best[back]
        cost[position] = gap[np.arange(len(best)), best][back]
        cost[position] += np.where(prior == shade, 0.0, far_cost)
    winner = cost.argmin(axis=0)
    each = np.arange(len(rgb))
    return code[winner, each], np.array(shades, dtype=np.int16)[winner]


def _without_rings(
    rgb: ByteArray, shade: LabelArray, item: LabelArray, front: BoolArray, structure: LabelArray
) -> tuple[LabelArray, BoolArray]:
    """Give pixels of mixed colour to one of the flat areas beside them.

    Where a file blends two colours along an edge, the mixture may look like a third category. A
    pixel whose colour fits badly is therefore read again, with a choice only between what has
    flat areas within two pixels of it.
    """
    code = np.where(item == NO_ITEM, _FLOOR, 2 * item + front)
    clear = structure == CLEAR
    levels = rgb.astype(np.float32)
    least = np.full(code.shape, np.inf, dtype=np.float32)
    nearest = code.copy()
    by_wall = cv2.dilate((~clear).astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
    for label in np.unique(code):
        core = _core((code == label) & clear, by_wall if label in _PANEL_CODES else None)
        reach = cv2.dilate(core, np.ones((7, 7), np.uint8)) > 0
        cost = ((levels[reach] - ITEM_RGB[shade[reach], label]) ** 2).sum(axis=-1)
        better = cost < least[reach]
        least[reach] = np.where(better, cost, least[reach])
        nearest[reach] = np.where(better, label, nearest[reach])
    current = ((levels - ITEM_RGB[shade, code]) ** 2).sum(axis=-1)
    code = np.where(clear & (current > _MIXED_COST) & np.isfinite(least), nearest, code)
    labels = np.where(code == _FLOOR, NO_ITEM, code // 2).astype(np.int16)
    return labels, (code != _FLOOR) & (code % 2 == 1)


def _core(member: BoolArray, by_wall: BoolArray | None) -> ByteArray:
    """Where an area is flat; with by_wall, also lines there, which are panels and not mixtures."""
    whole = member.astype(np.uint8)
    core = cv2.erode(whole, np.ones((3, 3), np.uint8)) > 0
    if by_wall is not None:
        for line in (np.ones((1, 5), np.uint8), np.ones((5, 1), np.uint8)):
            core = core | ((cv2.erode(whole, line) > 0) & by_wall)
    return np.asarray(core.astype(np.uint8))


def _settle(
    item: LabelArray, front: BoolArray, structure: LabelArray
) -> tuple[LabelArray, BoolArray]:
    """Let lone pixels follow the majority around them: rings and specks that noise leaves."""
    code = np.where(item == NO_ITEM, 0, 1 + 2 * item + front).astype(np.int16)
    clear = structure == CLEAR
    for _ in range(2):
        present = np.unique(code)
        votes = np.stack(
            [
                cv2.boxFilter(
                    ((code == label) & clear).astype(np.float32), -1, (3, 3), normalize=False
                )
                for label in present
            ]
        )
        support = np.take_along_axis(votes, np.searchsorted(present, code)[None], axis=0)[0]
        lone = clear & (support <= 2) & (votes.max(axis=0) >= 5)
        code = np.where(lone, present[votes.argmax(axis=0)], code)
    return np.where(code == 0, NO_ITEM, (code - 1) // 2).astype(np.int16), (code > 0) & (
        (code - 1) % 2 == 1
    )
