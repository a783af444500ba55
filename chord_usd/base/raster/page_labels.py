"""What a pixel of a drawn page can show: what is built there, and what is drawn over it.

Drawings are made with these labels (data/drawn), networks learn them, and the reader of plans takes
what a network says by them.
"""

from __future__ import annotations

import numpy as np

from chord_usd.base.scene.types import LEARNED_KINDS, ByteArray, RoomKind

OUTSIDE, FLOOR, WALL, DOOR, WINDOW, STAIRS, PASSAGE = range(7)
"""What is built. Doors, windows and passages are the holes in walls, as deep as the wall."""
BUILT_NAMES = ("outside", "floor", "wall", "door", "window", "stairs", "passage")
BUILT_WEIGHTS = (1.0, 1.0, 2.0, 6.0, 3.0, 4.0, 6.0)
"""Of these classes in the loss: thin ones have few pixels."""

NOTHING, SWING, PIECE, WRITING = range(4)
"""What is drawn over it: the sector that a door's leaf sweeps, furniture and fixtures, texts with
their dimension lines."""
LAID_NAMES = ("nothing", "swing", "piece", "writing")

LAID_SHIFT = 4
"""A label is what is built, and what is drawn over it from this bit on."""

HINGE, JAMB, CORNER = range(3)
"""Points: where a leaf hangs, where an opening ends, where the faces of a room meet."""
POINT_NAMES = ("hinge", "jamb", "corner")


def built_of(labels: ByteArray) -> ByteArray:
    """(H, W) what is built, of labels."""
    return np.asarray(labels & ((1 << LAID_SHIFT) - 1), np.uint8)


def laid_of(labels: ByteArray) -> ByteArray:
    """(H, W) what is drawn over it, of labels."""
    return np.asarray(labels >> LAID_SHIFT, np.uint8)


KIND_NAMES: tuple[RoomKind, ...] = tuple(kind for kind in LEARNED_KINDS if kind != "unknown")
"""What a floor is of."""

READER_INPUT = "rgb"
READER_OUTPUTS = ("built", "laid", "points", "kinds")
"""Of the network that reads pages: (B, 3, H, W) in [-1, 1]; chances, (B, n, H, W) each. Kinds of
floors are a quarter as fine, (B, n, H / KIND_STEP_PX, W / KIND_STEP_PX)."""
KIND_STEP_PX = 4
READER_MULTIPLE_PX = 32
"""Sides of what it is given are multiples of this."""

PIECE_NAMES = (
    "bathtub", "shower", "toilet", "washbasin", "sink_cabinet", "cooker_cabinet", "bed", "sofa",
    "single_sofa", "dining_table", "table", "coffee_table", "cabinet", "refrigerator",
    "washing_machine", "chair",
)  # fmt: skip
"""Drawn furniture and fixtures that are looked for, by category."""
PIECES_OUTPUTS = ("centres", "shapes")
"""Of the network that finds them, which takes READER_INPUT: (B, len(PIECE_NAMES), H, W) chances
that a piece has its centre in a cell, and (B, 6, H, W) of it: where in the cell (x, y), the
logarithms of its length and depth in pixels, and the direction of its front (x, y), y down."""
PIECE_STEP_PX = 4
"""A side of a cell."""
PIECE_M_PER_PX = 0.03
"""The scale at which pages are looked at for pieces."""
PIECE_MULTIPLE_PX = 16
"""Sides of what it is given are multiples of this."""
