"""Categories as code words: what the default model diffuses in place of RGB.

Blended palette colours look like third categories (half bed, half floor is close to a bed
background), so a colour regressed at the edge of an item decodes as a ring of wrong ones. Code
words of a first-order Reed-Muller code have no such neighbours: every two differ in at least half
of their bits. This is the paper's image-space diffusion with analog bits (Chen et al., 2022) for
channels; labels are painted to the paper's colours afterwards.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.palette import HOUSE_CATEGORIES
from chord_usd.base.scene.types import BoolArray, ByteArray

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
