"""What a learned reader sees on a page, pixel by pixel, with how sure it is.

The network takes squares; a page of any size is brought to a few sizes, since nothing says how many
pixels its walls have, looked at in overlapping tiles, and what is seen at each size is averaged.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.page_labels import BUILT_NAMES, LAID_NAMES, POINT_NAMES, READER_INPUT
from chord_usd.page_labels import READER_MULTIPLE_PX as MULTIPLE_PX
from chord_usd.runtime.networks import Network, content_hash, load_network
from chord_usd.types import ByteArray, FloatArray

SIDES_PX = (544, 768)
"""Lengths that the longer side of a page is brought to."""

TILE_PX = 512
OVERLAP_PX = 128
"""Of neighbouring tiles; what lies near a tile's edge counts less."""

REMEDY = "chord-usd train reader, or reinstall chord-usd"

Chances = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Segments:
    """A page as the network sees it."""

    built: Chances
    """(7, h, w) chances of page_labels.BUILT_NAMES; they add up to one."""
    laid: Chances
    """(4, h, w) of LAID_NAMES."""
    points: Chances
    """(3, h, w) of POINT_NAMES, each from 0 to 1."""
    share: float
    """Pixels here for one of the picture."""

    @property
    def kinds(self) -> ByteArray:
        """(h, w) what is most likely built."""
        return self.built.argmax(axis=0).astype(np.uint8)

    @property
    def over(self) -> ByteArray:
        """(h, w) what is most likely drawn over it."""
        return self.laid.argmax(axis=0).astype(np.uint8)

    @property
    def confidence(self) -> Chances:
        """(h, w) chance of what is most likely built, [0, 1]."""
        return np.asarray(self.built.max(axis=0))

    def peaks(self, point: int, least: float = 0.3) -> FloatArray:
        """(N, 3) x and y in continuous pixels of the picture, and how sure; point: HINGE, ..."""
        heat = self.points[point]
        is_peak = (heat == cv2.dilate(heat, np.ones((7, 7), np.uint8))) & (heat > least)
        rows, columns = np.nonzero(is_peak)
        where = (np.stack([columns, rows], axis=1) + 0.5) / self.share
        return np.column_stack([where, heat[is_peak]])


class PageReader:
    """The network of a checkpoint."""

    def __init__(self, network: Network, content_hash: str) -> None:
        self._network = network
        self.content_hash = content_hash

    def read(self, rgb: ByteArray, sides_px: Sequence[int] = SIDES_PX) -> Segments:
        """See a picture, (H, W, 3), at several sizes; the result has the largest of them."""
        longer = max(rgb.shape[:2])
        share = max(sides_px) / longer
        size = _size(rgb, share)
        total = np.zeros((_CHANNELS, size[1], size[0]), np.float32)
        for side in sides_px:
            seen = self._at(_resized(rgb, _size(rgb, side / longer)))
            for channel, one in enumerate(seen):
                total[channel] += cv2.resize(one, size, interpolation=cv2.INTER_LINEAR)
        total /= len(sides_px)
        ends = np.cumsum([len(BUILT_NAMES), len(LAID_NAMES)])
        built, laid, points = np.split(total, ends)
        return Segments(built, laid, points, share)

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
                part = np.ascontiguousarray(scaled[None, :, rows, columns])
                seen = np.concatenate(self._network.run({READER_INPUT: part}), axis=1)[0]
                weight = np.outer(_ramp(seen.shape[1]), _ramp(seen.shape[2]))
                total[:, rows, columns] += seen * weight
                weights[rows, columns] += weight
        found: Chances = (total / weights)[:, :height, :width]
        return found


_CHANNELS = len(BUILT_NAMES) + len(LAID_NAMES) + len(POINT_NAMES)


def load_reader(folder: Path) -> PageReader:
    """The reader of a checkpoint folder. Raises CheckpointError."""
    return PageReader(load_network(folder, REMEDY), content_hash(folder))


def _size(rgb: ByteArray, share: float) -> tuple[int, int]:
    return max(1, round(rgb.shape[1] * share)), max(1, round(rgb.shape[0] * share))


def _resized(rgb: ByteArray, size: tuple[int, int]) -> ByteArray:
    way = cv2.INTER_AREA if size[0] < rgb.shape[1] else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(rgb, size, interpolation=way), np.uint8)


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
