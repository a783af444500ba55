"""A rough layout that the network starts from and may correct: the pieces of a list, painted.

Which pieces a room has is decided before pixels are (lists/); where each of them stands to the
centimetre is what pictures are good at. The network sees the draft beside the plan, in the code
words of the state, and nothing at all where there is no list.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from chord_usd.base.raster import canvas
from chord_usd.base.scene.types import BoolArray, ByteArray, Item, PixelFrame, Room
from chord_usd.line.layout.codes import STATE_CHANNELS, encode
from chord_usd.line.layout.schedule import State

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
