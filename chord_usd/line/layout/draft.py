"""A rough layout that the network starts from and may correct: the pieces of a list, painted.

Which pieces a room has is decided before pixels are (lists/); where each of them stands to the
centimetre is what pictures are good at. The network sees the draft beside the plan, in the code
words of the state, and nothing at all where there is no list.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from chord_usd.base.raster import canvas
from chord_usd.base.scene.palette import HOUSE_CATEGORIES
from chord_usd.base.scene.types import BoolArray, ByteArray, Item, PixelFrame, Room
from chord_usd.line.layout.schedule import State

# Categories as code words: what the default model diffuses in place of RGB -----------------------

# Blended palette colours look like third categories (half bed, half floor is close to a bed
# background), so a colour regressed at the edge of an item decodes as a ring of wrong ones. Code
# words of a first-order Reed-Muller code have no such neighbours: every two differ in at least half
# of their bits. This is the paper's image-space diffusion with analog bits (Chen et al., 2022) for
# channels; labels are painted to the paper's colours afterwards.

StateArray = npt.NDArray[np.float32]

CODE_BITS = 16
CLASS_COUNT = 1 + len(HOUSE_CATEGORIES)
"""Label 0 is bare floor, label 1 + detector_class an item."""

STATE_CHANNELS = CODE_BITS + 1
"""The code word and one bit for the front mark."""


def codebook(count: int = CLASS_COUNT) -> npt.NDArray[np.float32]:
    """(count, CODE_BITS) of -1 and +1: words of the Reed-Muller code RM(1, 4), count <= 32.

    Any two words differ in 8 or 16 of 16 bits.
    """
    if count > 2 * CODE_BITS:
        raise ValueError(f"RM(1, 4) has {2 * CODE_BITS} words, {count} asked for")
    words = []
    for index in range(count):
        mask, sign = index % CODE_BITS, index // CODE_BITS
        parity = [(position & mask).bit_count() for position in range(CODE_BITS)]
        words.append([(bit + sign) % 2 for bit in parity])
    return 1.0 - 2.0 * np.array(words, np.float32)


def encode(
    labels: ByteArray, front: BoolArray, count: int = CLASS_COUNT, front_amplitude: float = 1.0
) -> StateArray:
    """(STATE_CHANNELS, H, W) clean state of labels (H, W) < count and their front marks."""
    words = codebook(count)[labels].transpose(2, 0, 1)
    mark = np.float32(front_amplitude)
    return np.concatenate([words, np.where(front & (labels > 0), mark, -mark)[None]])


DRAFT_PLANES = STATE_CHANNELS


@dataclass(frozen=True, eq=False)
class Draft:
    """Pieces painted over a plan raster."""

    labels: ByteArray
    """(H, W) as canvas.draw_items gives them."""
    front: BoolArray
    """(H, W)"""
    known: BoolArray
    """(H, W) the floor of the rooms that have a list; the draft says nothing elsewhere."""

    @classmethod
    def of(cls, items: Iterable[Item], rooms: Iterable[Room], frame: PixelFrame) -> Draft:
        """items: the lists of these rooms, posed in the world."""
        known = np.zeros((frame.height_px, frame.height_px), np.bool_)
        for room in rooms:
            known |= canvas.room_pixels(room, frame)
        return cls(*canvas.draw_items(items, frame), known)

    def planes(self, classes: int) -> State:
        """(DRAFT_PLANES, H, W) what the network sees: -1 and 1 as codes.encode has them, 0 where
        nothing is known, whatever amplitude the network's own state gives its front marks."""
        return encode(self.labels, self.front, classes) * self.known
