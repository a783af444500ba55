"""Gaps in walls that carry no leaf: where a plan raster lets one room run into the next.

In a shaded raster a passage is a white bar of the wall's thickness between grey rooms. In an
unshaded one it can only be told by the ends of the walls on both sides of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.raster.vectorize import rotated_box_from_mask
from chord_usd.base.scene.types import BoolArray
from chord_usd.line.plan.ink import Ink, border_values, label_floors

_T = TypeVar("_T", bound=np.generic)

_WIDEST_WALLS = 11.0
"""A gap of more wall thicknesses than this (2.64 m) is no passage but a room's own shape."""

_THICKNESS_SLACK_PX = 1.2


@dataclass(frozen=True)
class Gap:
    """A passage in a wall that runs along the rows of an image, or of the transposed image."""

    top: int
    bottom: int
    left: int
    right: int
    transposed: bool

    def inner(self, image: npt.NDArray[_T]) -> npt.NDArray[_T]:
        """View of the gap's pixels."""
        return self._turned(image)[self.top : self.bottom, self.left : self.right]

    def sides(self, image: npt.NDArray[_T]) -> tuple[_T, _T]:
        """The most frequent values along both faces of the wall."""
        rows = self._turned(image)[:, self.left : self.right]
        return _mode(rows[self.top - 1]), _mode(rows[self.bottom])

    def _turned(self, image: npt.NDArray[_T]) -> npt.NDArray[_T]:
        return image.T if self.transposed else image


def _mode(values: npt.NDArray[_T]) -> _T:
    found, counts = np.unique(values, return_counts=True)
    return found[np.argmax(counts)]


def find_passages(ink: Ink, thickness_px: float) -> list[BoolArray]:
    """One (H, W) mask for each passage of a plan raster with walls this thick."""
    passages = _white_bars(ink, thickness_px) if ink.is_shaded else []
    closed = np.zeros(ink.wall.shape, bool)
    for mask in passages:
        closed |= mask
    for gap in _parting_gaps(ink, closed, thickness_px):
        mask = np.zeros(ink.wall.shape, bool)
        gap.inner(mask)[:] = True
        passages.append(mask)
    return passages


def _white_bars(ink: Ink, thickness_px: float) -> list[BoolArray]:
    """White regions inside the house that are as thin as a wall."""
    count, labels = cv2.connectedComponents(ink.white.astype(np.uint8), connectivity=4)
    bars = []
    for label in sorted(set(range(1, count)) - set(border_values(labels).tolist())):
        mask = labels == label
        box = rotated_box_from_mask(mask)
        thin = abs(box.width_px - thickness_px) <= _THICKNESS_SLACK_PX
        if (
            thin
            and box.length_px > thickness_px
            and mask.sum() > 0.8 * box.length_px * box.width_px
        ):
            bars.append(mask)
    return bars


def _parting_gaps(ink: Ink, closed: BoolArray, thickness_px: float) -> list[Gap]:
    """Gaps between wall ends that part two rooms once they are all closed."""
    solid = ink.solid | closed
    gaps = _gaps_along_rows(solid, thickness_px, transposed=False)
    gaps += _gaps_along_rows(solid.T, thickness_px, transposed=True)
    gaps = [gap for gap in gaps if _is_paved_as_gap(ink, gap)]
    shut = closed.copy()
    for gap in gaps:
        gap.inner(shut)[:] = True
    labels = label_floors(ink, shut)
    return [gap for gap in gaps if len(set(gap.sides(labels))) == 2]


def _is_paved_as_gap(ink: Ink, gap: Gap) -> bool:
    """White, or with the floor of just one of its sides; else the floor merely runs past a wall."""
    own = np.unique(gap.inner(ink.shade))
    first, second = gap.sides(ink.shade)
    return len(own) == 1 and (first != second or bool(gap.inner(ink.white).all()))


def _gaps_along_rows(solid: BoolArray, thickness_px: float, *, transposed: bool) -> list[Gap]:
    """Open stretches between the end of a wall that runs along the rows and what it faces."""
    gaps = _gaps_to_the_right(solid, thickness_px, transposed)
    width = solid.shape[1]
    for gap in _gaps_to_the_right(solid[:, ::-1], thickness_px, transposed):
        mirrored = replace(gap, left=width - gap.right, right=width - gap.left)
        if mirrored not in gaps:
            gaps.append(mirrored)
    return gaps


def _gaps_to_the_right(solid: BoolArray, thickness_px: float, transposed: bool) -> list[Gap]:
    """As _gaps_along_rows, from wall ends that face right."""
    height = len(solid)
    starts = solid.copy()
    starts[1:] &= ~solid[:-1]
    starts[:, :-1] &= ~solid[:, 1:]
    starts[:, -1] = False
    longest = int(_WIDEST_WALLS * thickness_px)
    gaps = []
    for top, column in np.argwhere(starts).tolist():
        open_below = np.flatnonzero(~solid[top:, column])
        bottom = top + int(open_below[0]) if len(open_below) else height
        if abs(bottom - top - thickness_px) > _THICKNESS_SLACK_PX or not 0 < top < bottom < height:
            continue
        beyond = solid[top:bottom, column + 1 : column + 2 + longest]
        reached = np.flatnonzero(beyond.any(axis=0))
        if len(reached) == 0 or reached[0] < thickness_px or not beyond[:, reached[0]].all():
            continue
        gap = Gap(top, bottom, column + 1, column + 1 + int(reached[0]), transposed)
        along = slice(gap.left, gap.right)
        if not (solid[top - 1, along].any() or solid[bottom, along].any()):
            gaps.append(gap)
    return gaps
