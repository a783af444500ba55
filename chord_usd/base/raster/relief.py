"""How high an asset is, seen from above: what items are stood on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import cv2
import numpy as np
from shapely.geometry import box as rectangle

from chord_usd.base.scene.geometry import footprint, footprint_polygon
from chord_usd.base.scene.types import Asset, BoolArray, Box, FloatArray

LEVEL_M = 0.006
"""Heights this close to each other are one level: bevels and grooves."""

LEAST_HEIGHT = 0.3
"""What lies lower than this share of the piece is no top, but a shelf or a foot."""

_FINE = 16
"""Parts of a cell in which outlines are drawn."""


@dataclass(frozen=True, eq=False)
class Relief:
    """The highest point of a piece in every cell of its footprint, in its own frame."""

    heights_m: FloatArray
    """(rows, columns), first row at the back, first column at the left; 0 where nothing is."""
    size_m: tuple[float, float, float]
    """Length, width and height of the piece."""
    colliders_m: FloatArray | None = None
    """The same for the piece's colliders; None where all that is seen collides."""

    @cached_property
    def level_m(self) -> float:
        """Height of the level that most of the piece is at: its top."""
        high = self.heights_m[self.heights_m > LEAST_HEIGHT * self.size_m[2]]
        if not high.size:
            return self.size_m[2]
        bins = np.round(high / LEVEL_M).astype(int)
        most = int(np.bincount(bins).argmax())
        return float(np.median(high[bins == most]))

    @cached_property
    def free(self) -> BoolArray:
        """(rows, columns) cells of the top itself, without what rises from it.

        Visible parts without a collider carry nothing in a simulator: the rim of a round top.
        """
        free = np.abs(self.heights_m - self.level_m) <= LEVEL_M
        if self.colliders_m is not None:
            free &= self.colliders_m >= self.level_m - LEVEL_M
        return np.asarray(free, np.bool_)

    def scaled(self, size_m: tuple[float, float, float]) -> Relief:
        """The relief of the same piece at another size."""
        share = size_m[2] / self.size_m[2]
        colliders_m = None if self.colliders_m is None else self.colliders_m * share
        return Relief(self.heights_m * share, size_m, colliders_m)

    def under(self, box: Box) -> tuple[BoolArray, tuple[slice, slice]]:
        """The cells whose centres lie under a box: a mask, and the window of cells it is of.

        box: in the frame of the piece. The mask is empty where it lies beside the piece.
        """
        rows, columns = self.heights_m.shape
        scale = np.array([columns / self.size_m[0], -rows / self.size_m[1]])
        # Cell centres become whole numbers, which is how OpenCV counts.
        corners = footprint(box) * scale + (columns / 2 - 0.5, rows / 2 - 0.5)
        low = np.clip(np.floor(corners.min(axis=0)).astype(int), 0, (columns, rows))
        high = np.clip(np.ceil(corners.max(axis=0)).astype(int) + 1, 0, (columns, rows))
        window = (slice(low[1], high[1]), slice(low[0], high[0]))
        mask = np.zeros((max(high[1] - low[1], 0), max(high[0] - low[0], 0)), np.uint8)
        if mask.size:
            points = np.rint((corners - low) * _FINE).astype(np.int32)
            cv2.fillConvexPoly(mask, points, (1,), shift=4)
        return mask.astype(bool), window

    def highest_m(self, box: Box) -> float:
        """The highest point under a box in the frame of the piece; 0 where there is none."""
        mask, window = self.under(box)
        return float(self.heights_m[window][mask].max(initial=0.0))

    def free_share(self, box: Box) -> float:
        """Share of a box's footprint that lies over the top, [0, 1]."""
        mask, window = self.under(box)
        cells = box.size_m[0] * box.size_m[1] / self.cell_m2
        share = float(self.free[window][mask].sum()) / max(cells, float(mask.sum()), 1.0)
        # Cells at a rim count whole, and would make up for a centimetre beyond the piece.
        length, depth, _ = self.size_m
        piece = rectangle(-length / 2, -depth / 2, length / 2, depth / 2)
        shape = footprint_polygon(box)
        return min(share, float(shape.intersection(piece).area / shape.area))

    def is_level(self, box: Box) -> bool:
        """Whether nothing that rises from the top, as a television's foot, is under a box."""
        return self.highest_m(box) <= self.level_m + LEVEL_M

    @property
    def cell_m2(self) -> float:
        """Area of one cell."""
        return self.size_m[0] * self.size_m[1] / self.heights_m.size


class Reliefs(Protocol):
    """Where reliefs come from; chord_usd.library.asset_shapes has them."""

    def __call__(self, asset: Asset, /) -> Relief:
        """The relief of an asset at its own size."""
