"""What a learned reader sees on a page, pixel by pixel, with how sure it is.

Nothing says how many pixels a wall of a page has. The whole page is therefore looked at first, then
what is built on it, so near that its walls are as thick as the network knows them best.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.raster.page_labels import (
    BUILT_NAMES,
    DOOR,
    FLOOR,
    KIND_NAMES,
    KIND_STEP_PX,
    OUTSIDE,
    PASSAGE,
    READER_INPUT,
    STAIRS,
    WALL,
    WINDOW,
)
from chord_usd.base.raster.page_labels import READER_MULTIPLE_PX as MULTIPLE_PX
from chord_usd.base.runtime.networks import Network, content_hash, load_network
from chord_usd.base.scene.types import BoolArray, ByteArray

READER_CHECKPOINT = "reader"

FIRST_SIDE_PX = 544
"""Length that the longer side of a page is brought to at first."""

_WALL_PX = 7.0
"""How thick the usual wall is brought to, then."""

_HOUSE_PX = (260, 900)
"""Bounds of what the longer side of a house is brought to for that."""

SOLID = (WALL, DOOR, WINDOW, PASSAGE)
"""What parts rooms."""

_ENLARGED = 1.6
"""A picture is not enlarged more than this, as in training."""

_OTHER_LOOK = math.log(1.1)
"""Looks that differ by less see the same."""

_CLOSER_WEIGHT = 0.65
"""Of the second look."""

_PAPER = 0.04
"""Laid round a picture, as a share of its longer side."""

_PLAIN, _LIGHT = 24.0, 100.0
"""Paper is of one colour, within so many levels, and lighter than this one."""

_MARGIN = 0.05
"""Round what is built, as a share of its longer side."""

_LEAST_PART = 0.04
"""What is smaller than this share of the largest thing built on a page is a symbol or a legend."""

_INK, _APART = 60, 0.012
"""Ink differs from its paper by so many levels; plans stand farther apart than this share of the
page's longer side."""
_SEEN, _UNSEEN, _SHEET = 0.25, 0.03, 2
"""Least share of a plan where something is seen, greatest share of ink where nothing is, and how
many seen plans make a sheet."""
_ALIKE = math.log(1.8)
"""By how much the sides of plans of a sheet differ."""

TILE_PX = 512
OVERLAP_PX = 128
"""Of neighbouring tiles; what lies near a tile's edge counts less."""

REMEDY = ("<train=reader>", "<reinstall>")

Chances = npt.NDArray[np.float32]

_BUILT = len(BUILT_NAMES)
_CHANNELS = _BUILT + len(KIND_NAMES)


@dataclass(frozen=True, eq=False)
class Segments:
    """A picture as the network sees it, pixel by pixel."""

    built: Chances
    """(7, H, W) chances of page_labels.BUILT_NAMES; they add up to one."""
    kinds: Chances
    """(9, H, W) of KIND_NAMES: what a floor is of."""
    grain_px: float = 1.0
    """Pixels of the picture for one of those that were looked at."""

    @cached_property
    def most_likely(self) -> ByteArray:
        """(H, W) what is most likely built."""
        return self.built.argmax(axis=0).astype(np.uint8)

    @cached_property
    def barrier(self) -> Chances:
        """(H, W) chance of what parts rooms: walls, doors, windows, and passages."""
        return 1.0 - self.built[OUTSIDE] - self.built[FLOOR] - self.built[STAIRS]


class PageReader:
    """The network of a checkpoint."""

    def __init__(self, network: Network, content_hash: str) -> None:
        self._network = network
        self.content_hash = content_hash

    def read(self, rgb: ByteArray) -> Segments:
        """See a picture, (H, W, 3), of a drawing on light paper."""
        margin = round(_PAPER * max(rgb.shape[:2]))
        # Walls at the very edge of a picture have an outside, too.
        sides, paper = (margin,) * 4, _paper_of(rgb)
        rgb = np.asarray(
            cv2.copyMakeBorder(rgb, *sides, cv2.BORDER_CONSTANT, value=paper), np.uint8
        )
        first = min(FIRST_SIDE_PX / max(rgb.shape[:2]), _ENLARGED)
        total = self._seen(rgb, first)
        rows, columns = _built_window(total[OUTSIDE] < 0.5)
        part = rgb[rows, columns]
        solid = np.isin(total[:_BUILT, rows, columns].argmax(axis=0), SOLID)
        low, high = (side / max(part.shape[:2]) for side in _HOUSE_PX)
        share = min(max(_WALL_PX / max(usual_thickness_px(solid), 0.5), low), high, _ENLARGED)
        is_closer = abs(math.log(share / first)) > _OTHER_LOOK
        if is_closer:
            window = total[:, rows, columns]
            window += _CLOSER_WEIGHT * (self._seen(part, share) - window)
        for block in _unseen_plans(rgb, total[OUTSIDE] < 0.5, paper):
            total[:, *block] = self._seen(rgb[block], share if is_closer else first)
        inner = total[:, margin : rgb.shape[0] - margin, margin : rgb.shape[1] - margin]
        return Segments(inner[:_BUILT], inner[_BUILT:], 1.0 / (share if is_closer else first))

    def _seen(self, rgb: ByteArray, share: float) -> Chances:
        """(channels, H, W) of a picture, looked at with so many pixels for one of its own."""
        height, width = rgb.shape[:2]
        small = max(1, round(width * share)), max(1, round(height * share))
        way = cv2.INTER_AREA if share < 1.0 else cv2.INTER_CUBIC
        seen = self._at(np.asarray(cv2.resize(rgb, small, interpolation=way), np.uint8))
        chances = np.empty((_CHANNELS, height, width), np.float32)
        for channel, channel_map in enumerate(seen):
            cv2.resize(
                channel_map, (width, height), dst=chances[channel], interpolation=cv2.INTER_LINEAR
            )
        return chances

    def _at(self, rgb: ByteArray) -> Chances:
        """(channels, H, W) of a picture at its own size."""
        height, width = rgb.shape[:2]
        tall, wide = (-(-side // MULTIPLE_PX) * MULTIPLE_PX for side in (height, width))
        padded = cv2.copyMakeBorder(rgb, 0, tall - height, 0, wide - width, cv2.BORDER_REPLICATE)
        scaled = padded.transpose(2, 0, 1).astype(np.float32) / 127.5 - 1.0
        total = np.zeros((_CHANNELS, tall, wide), np.float32)
        weights = np.zeros((tall, wide), np.float32)
        for rows in _tiles(tall):
            for columns in _tiles(wide):
                seen = self._tile(np.ascontiguousarray(scaled[None, :, rows, columns]))
                weight = np.outer(_ramp(seen.shape[1]), _ramp(seen.shape[2]))
                total[:, rows, columns] += seen * weight
                weights[rows, columns] += weight
        chances: Chances = (total / weights)[:, :height, :width]
        return chances

    def _tile(self, scaled: Chances) -> Chances:
        # What is drawn over floors, and points, are lessons: they help to learn the rest.
        built, *_, kinds = (batch[0] for batch in self._network.run({READER_INPUT: scaled}))
        wide = kinds.repeat(KIND_STEP_PX, axis=1).repeat(KIND_STEP_PX, axis=2)
        return np.concatenate([built, wide])


def usual_thickness_px(solid: BoolArray) -> float:
    """Of walls, (H, W) of them and the openings in them: twice the depth of their middle line; 0
    where there is none."""
    depths = cv2.distanceTransform(solid.astype(np.uint8), cv2.DIST_L2, 5)
    is_ridge = (depths >= cv2.dilate(depths, np.ones((3, 3), np.uint8))) & solid
    return float(2 * np.median(depths[is_ridge]) - 1) if is_ridge.any() else 0.0


def load_reader(folder: Path) -> PageReader:
    """The reader of a checkpoint folder. Raises CheckpointError."""
    return PageReader(load_network(folder, REMEDY), content_hash(folder))


def _paper_of(rgb: ByteArray) -> list[float]:
    """The colour of a picture's rim, where that is plain and light; else white."""
    rim = np.concatenate([rgb[0], rgb[-1], rgb[:, 0], rgb[:, -1]]).astype(np.float64)
    usual = np.median(rim, axis=0)
    is_plain = np.mean(np.abs(rim - usual).max(axis=1) < _PLAIN) > 0.6
    return list(usual) if is_plain and usual.min() > _LIGHT else [255.0] * 3


def _built_window(built: BoolArray) -> tuple[slice, slice]:
    """Rows and columns round everything built but specks; all of the picture where there is
    nothing."""
    count, _, stats, _ = cv2.connectedComponentsWithStats(built.astype(np.uint8))
    height, width = built.shape
    areas = stats[1:, cv2.CC_STAT_AREA]
    if count < 2:
        return slice(0, height), slice(0, width)
    kept = stats[1:][areas >= _LEAST_PART * areas.max()]
    low, high = kept[:, :2].min(axis=0), (kept[:, :2] + kept[:, 2:4]).max(axis=0)
    margin = round(_MARGIN * float((high - low).max())) + 4
    left, top = np.maximum(low - margin, 0).tolist()
    right, bottom = np.minimum(high + margin, (width, height)).tolist()
    return slice(top, bottom), slice(left, right)


def _unseen_plans(
    rgb: ByteArray, built: BoolArray, paper: Sequence[float]
) -> Iterator[tuple[slice, slice]]:
    """Where a sheet of several plans holds ink like theirs, and nothing was seen: rows and columns.

    built: (H, W) where something was. paper: its colour.
    """
    ink = np.abs(rgb.astype(np.int16) - np.array(paper, np.int16)).max(axis=2) > _INK
    near = np.ones((max(3, round(_APART * max(built.shape))),) * 2, np.uint8)
    blocks = cv2.dilate((ink | built).astype(np.uint8), near)
    boxes = cv2.connectedComponentsWithStats(blocks)[2][1:, : cv2.CC_STAT_HEIGHT + 1]
    windows = [(slice(y, y + high), slice(x, x + wide)) for x, y, wide, high in boxes.tolist()]
    shares = np.array([built[window].mean() for window in windows])
    sides = boxes[:, 2:].astype(np.float64)
    if np.count_nonzero(shares >= _SEEN) < _SHEET:
        return
    usual = np.median(sides[shares >= _SEEN], axis=0)
    alike = (np.abs(np.log(sides / usual)) < _ALIKE).all(axis=1)
    for index in np.flatnonzero(alike & (shares < _UNSEEN)):
        yield windows[index]


def _tiles(length: int) -> Iterator[slice]:
    """Overlapping pieces of a side; one alone where it is short."""
    if length <= TILE_PX + OVERLAP_PX:
        yield slice(0, length)
        return
    count = -(-(length - OVERLAP_PX) // (TILE_PX - OVERLAP_PX))
    for index in range(count):
        start = round(index * (length - TILE_PX) / (count - 1) / MULTIPLE_PX) * MULTIPLE_PX
        yield slice(start, start + TILE_PX)


def _ramp(length: int) -> Chances:
    """Weights along a side: all of it in the middle, little at the ends."""
    steps = np.arange(length) + 0.5
    return (np.minimum(np.minimum(steps, length - steps), OVERLAP_PX / 2)).astype(np.float32)
