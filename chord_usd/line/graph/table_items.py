"""Tops -> what the diffusion model paints on them, read by the pixel reader of the house level.

What lies underfoot (a mat below a laptop) is seen in parts only: it is read on its own, with the
items over it taken for parts of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Protocol

import cv2
import numpy as np

from chord_usd.base.raster.table_top import NEIGHBOURS, TableTop, border_rgb, draw_table
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.palette import (
    BACKGROUND_RGB,
    FRONT_MARK_OPACITY,
    TABLE_CATEGORIES,
    TOP_SHADES,
    Mount,
    painted,
)
from chord_usd.base.scene.types import BoolArray, ByteArray, Facts, Item, LayoutImage, PlanImage
from chord_usd.line.graph.colours import CLEAR, NO_ITEM, LayoutPixels
from chord_usd.line.graph.directions import Directions
from chord_usd.line.graph.match import box_of
from chord_usd.line.graph.snap import FoundItem, find_items

_WALL = 0
"""Structure label of walls."""

_UNDERFOOT = tuple(row.detector_class for row in TABLE_CATEGORIES if row.mount is Mount.UNDERFOOT)

_LEAST_PART_PX = 12
"""Fewer pixels of something underfoot are specks."""

_DARK = 40

STRAIGHT_DEG = 3.0
"""Smaller turns are noise of the pixels."""

_NONE = np.zeros(0, np.intp)
_STRAIGHT = Directions(np.zeros(1), np.zeros((0, 4)), _NONE, _NONE)
"""Items keep to the sides of the top unless their pixels clearly draw another direction."""


class SampleRasters(Protocol):
    """A layout model of tops, ready to be called (layout.sample.LayoutModel.sample_batch)."""

    def __call__(
        self, images: Sequence[PlanImage], *, seeds: Sequence[int], progress: Progress | None
    ) -> list[LayoutImage]:
        """A raster over each top view."""


class TopPainter:
    """Paints what stands on tops, as the paper does."""

    def __init__(self, sample: SampleRasters, content_hash: str) -> None:
        """content_hash: of the weights."""
        self._sample, self.content_hash = sample, content_hash

    def layouts(
        self, tops: Sequence[TableTop], seeds: Sequence[int], progress: Progress | None = None
    ) -> list[LayoutImage]:
        """A raster of each top."""
        return self._sample([draw_table(top) for top in tops], seeds=seeds, progress=progress)

    def things(
        self, tops: Sequence[TableTop], seeds: Sequence[int], progress: Progress | None = None
    ) -> list[list[Item]]:
        """Things on each top, in its frame."""
        layouts = self.layouts(tops, seeds, progress)
        return [
            things_seen(layout, top.category) for layout, top in zip(layouts, tops, strict=True)
        ]


def things_seen(layout: LayoutImage, category: str) -> list[Item]:
    """The items of a raster in the frame of the piece, in no room and without meshes."""
    things = []
    for index, item in enumerate(read_items(layout, category)):
        box = box_of(item.detection, layout.frame)
        nearest = round(box.yaw_deg / 90.0) * 90.0
        if abs(box.yaw_deg - nearest) < STRAIGHT_DEG:
            box = replace(box, yaw_deg=nearest)
        name = item.detection.category
        facts = Facts(front_from="mark" if item.front_seen else "guess")
        score = round(item.detection.score, 4)
        things.append(Item(f"{name}_{index}", name, box, score=score, facts=facts))
    return things


def read_items(layout: LayoutImage, category: str) -> list[FoundItem]:
    """What stands on the top of a piece of this category, in a raster painted over its top view."""
    pixels = read_table_pixels(layout.rgb, category)
    m_per_px = layout.frame.m_per_px
    underfoot = np.isin(pixels.item, _UNDERFOOT)
    standing = LayoutPixels(
        pixels.structure, pixels.shade, np.where(underfoot, NO_ITEM, pixels.item).astype(np.int16),
        pixels.front & ~underfoot,
    )  # fmt: skip
    items = find_items(standing, m_per_px, _STRAIGHT, categories=TABLE_CATEGORIES)
    if underfoot.any():
        whole = _uncovered(pixels, underfoot)
        items += find_items(whole, m_per_px, _STRAIGHT, categories=TABLE_CATEGORIES)
    return items


def read_table_pixels(rgb: ByteArray, category: str) -> LayoutPixels:
    """Every pixel's item: the nearest colour that the palette gives over a top of this category."""
    colors = _colors(category)
    flat, back = np.unique(rgb.reshape(-1, 3), axis=0, return_inverse=True)
    gaps = ((flat[:, None].astype(np.int32) - colors) ** 2).sum(axis=2)
    code = gaps.argmin(axis=1)[back.reshape(-1)].reshape(rgb.shape[:2])
    ground = 2 * len(TABLE_CATEGORIES)
    item = np.where(code < ground, code // 2, NO_ITEM).astype(np.int16)
    structure = np.where(rgb.max(axis=2) < _DARK, _WALL, CLEAR).astype(np.int16)
    shade = np.zeros(item.shape, np.int16)
    return LayoutPixels(structure, shade, item, (code < ground) & (code % 2 == 1))


@lru_cache(maxsize=16)
def _colors(category: str) -> np.ndarray:
    """(2 * categories + ..., 3) items, each without and with its mark, then what is no item."""
    shade = TOP_SHADES[category]
    colors = []
    for row in TABLE_CATEGORIES:
        body = painted(shade, row.rgb)
        colors += [body, painted(body, (0, 0, 0), FRONT_MARK_OPACITY)]
    return np.array([*colors, shade, BACKGROUND_RGB, *map(border_rgb, NEIGHBOURS)], np.int32)


def _uncovered(pixels: LayoutPixels, underfoot: BoolArray) -> LayoutPixels:
    """What lies underfoot alone, whole: with what covers it, within the hull of its parts."""
    item = np.full(pixels.item.shape, NO_ITEM, np.int16)
    for label in _UNDERFOOT:
        member = pixels.item == label
        if not member.any():
            continue
        covered = (pixels.item != NO_ITEM) & ~underfoot
        _, regions = cv2.connectedComponents((member | covered).astype(np.uint8), connectivity=8)
        for region in np.unique(regions[member]):
            parts = _without_specks(member & (regions == region))
            if parts.any():
                item[parts | (covered & _hull(parts))] = label
    return LayoutPixels(
        pixels.structure, pixels.shade, item, pixels.front & underfoot & (item != NO_ITEM)
    )


def _without_specks(parts: BoolArray) -> BoolArray:
    _, labels, stats, _ = cv2.connectedComponentsWithStats(parts.astype(np.uint8), connectivity=8)
    large = np.flatnonzero(stats[:, cv2.CC_STAT_AREA] >= _LEAST_PART_PX)
    return np.asarray(parts & np.isin(labels, large), np.bool_)


def _hull(parts: BoolArray) -> BoolArray:
    """(H, W) the convex hull of some pixels."""
    rows, columns = np.nonzero(parts)
    points = np.stack([columns, rows], axis=1).astype(np.int32)
    canvas = np.zeros(parts.shape, np.uint8)
    cv2.fillConvexPoly(canvas, cv2.convexHull(points), (1,))
    return canvas.astype(bool)
