"""Walls that are drawn hollow or hatched: what lies between their two faces, filled.

A hollow wall is a long strip of paper, of one width, with ink all round. A hatched one is cut into
crumbs of paper by its hatching.
"""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.plan.ink import border_values
from chord_usd.scene.types import BoolArray, FloatArray

_WIDEST = 0.045
"""Walls are no thicker than this share of the drawing; a corridor is wider."""

_LEAST_STRIP_PX = 1.5
_ELONGATED = 2.0
"""A strip is at least so many times as long as wide."""

_UNEVEN, _UNEVEN_LONG = 1.75, 2.3
"""At a crossing a strip is so many times as wide as elsewhere, no more; a long one at jogs, too."""

_LONG = 20.0
"""So many times as long as wide."""

_SLIM, _STOUT = 0.4, 1.7
"""Inner and outer walls, as shares of the usual wall's width."""

_PANE = 0.72
"""Two strips side by side, each narrower than this share of the usual wall, are a window."""

_CRUMB_WIDTH, _CRUMB_LENGTH = 0.015, 0.16
"""A hatched wall's crumbs are narrower and shorter than these shares of the drawing."""

_LEAST_CRUMBS = 150
_FEWEST_CRUMBS = 4.0
"""In a drawing, and in a piece of wall; a basin is a crumb of its own."""

_PANE_SHAPE, _PANE_CRUMBS = 1.5, 2.5
"""What is so many times as long as wide and as most crumbs are is a pane, not a crumb."""

_BLOCK_FILL = 0.85
_BLOCK_SLACK = 0.25
_SHORTEST_BLOCK = 0.5
"""Between two openings a piece of wall may be as short as this share of its width."""

_LARGEST_RING = 18.0
"""Rings smaller than so many wall widths are beds, baths and basins."""

Labels = npt.NDArray[np.int32]

_FACE_PX = 3
"""A face is drawn no wider than this."""

_BLOCK = np.ones((3, 3), np.uint8)

_RIM_DEPTH_PX = 1.5
"""Pixels that touch ink, if only at a corner, are no deeper."""


def filled_bodies(ink: BoolArray) -> Iterator[BoolArray]:
    """(H, W) the hatched walls filled, with their faces, then the hollow ones.

    Nothing is yielded where there are none.

    ink: (H, W) everything drawn.
    """
    extent = _extent(ink)
    paper = (~ink).astype(np.uint8)
    _, found, stats, _ = cv2.connectedComponentsWithStats(paper, connectivity=4)
    labels: Labels = np.asarray(found, np.int32)
    areas = stats[:, cv2.CC_STAT_AREA].astype(np.float64)
    areas[0] = 0.0
    areas[border_values(labels)] = 0.0
    widths, depths = _widths(ink, labels, areas)
    narrowest = np.maximum(widths, 1.0)
    is_crumb = (areas > 0) & (areas < _CRUMB_LENGTH * extent * narrowest)
    is_crumb &= (narrowest < _CRUMB_WIDTH * extent) & (
        stats[:, 2:4].max(axis=1) < _CRUMB_LENGTH * extent
    )
    long = areas / np.maximum(widths, 1.0) ** 2
    is_strip = (
        (widths >= _LEAST_STRIP_PX)
        & (widths <= _WIDEST * extent)
        & (depths <= np.where(long > _LONG, _UNEVEN_LONG, _UNEVEN) * widths)
        & (long >= _ELONGATED)
    )
    bounds = stats[:, cv2.CC_STAT_WIDTH] * stats[:, cv2.CC_STAT_HEIGHT]
    is_full = areas >= _BLOCK_FILL * bounds
    if is_crumb.sum() >= _LEAST_CRUMBS:
        sides = np.sort(stats[:, 2:4], axis=1)
        is_pane = is_full & (sides[:, 1] > _PANE_SHAPE * sides[:, 0])
        is_pane &= sides[:, 1] > _PANE_CRUMBS * np.median(sides[is_crumb, 1])
        yield _hatching(ink, labels, areas, is_crumb & ~is_pane)
        is_strip &= ~is_crumb
    is_block = is_full & ~is_strip
    if is_strip.any():
        yield from _hollow(ink, labels, areas, widths, is_strip, np.where(is_block, depths, 0.0))


def _extent(ink: BoolArray) -> float:
    rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
    return float(max(np.ptp(rows), np.ptp(columns))) if len(rows) else 0.0


def _widths(ink: BoolArray, labels: Labels, areas: FloatArray) -> tuple[FloatArray, FloatArray]:
    """By label: the width of a strip with this area and rim, and the width where it is widest."""
    paper = (~ink).astype(np.uint8)
    rim = (paper > 0) & (cv2.erode(paper, _BLOCK, borderType=cv2.BORDER_CONSTANT) == 0)
    rims = np.bincount(labels[rim], minlength=len(areas)).astype(np.float64)
    depths = cv2.distanceTransform(paper, cv2.DIST_L2, 3)
    # Deeper pixels have neighbours of their own label only: the deepest is a local maximum.
    is_peak = (depths >= cv2.dilate(depths, _BLOCK)) | (depths <= _RIM_DEPTH_PX)
    is_peak &= paper > 0
    deepest = np.zeros(len(areas))
    np.maximum.at(deepest, labels[is_peak], depths[is_peak])
    # Strips of one or two pixels are all rim.
    widths = np.where(areas > rims, 2 * areas / np.maximum(rims, 1.0), 2 * deepest)
    return widths, 2 * deepest - 1


def _hollow(
    ink: BoolArray, labels: Labels, areas: FloatArray, widths: FloatArray, is_strip: BoolArray,
    blocks: FloatArray,
) -> Iterator[BoolArray]:  # fmt: skip
    """Strips about as wide as most, without window panes and small rings.

    blocks: the widths of what may be a short piece of wall between two openings, by label.
    """
    strips = np.flatnonzero(is_strip)
    lengths = areas / np.maximum(widths, 1.0)
    counts = np.bincount(np.rint(widths[strips]).astype(int), areas[strips])
    usual = float(np.argmax(np.convolve(counts, [1.0, 1.0, 1.0], mode="same")))
    near = is_strip & (widths >= _SLIM * usual) & (widths <= _STOUT * usual)
    near &= ~_panes(labels, is_strip & (widths < _PANE * usual), lengths)
    near &= ~_rings(labels, near, usual)
    near |= (np.abs(blocks / usual - 1.0) < _BLOCK_SLACK) & (areas > _SHORTEST_BLOCK * usual**2)
    if near.any():
        yield _with_faces(near[labels], ink, _SLIM * usual)


def _panes(labels: Labels, narrow: BoolArray, lengths: FloatArray) -> BoolArray:
    """Narrow strips that run side by side with another as long."""
    found = np.zeros(len(narrow), bool)
    mask = narrow[labels]
    if not mask.any():
        return found
    near = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
    _, groups = cv2.connectedComponents(near, connectivity=4)
    group_of = np.zeros(len(narrow), np.int64)
    group_of[labels[mask]] = groups[mask]
    for group in np.unique(group_of[narrow]):
        own = np.flatnonzero(narrow & (group_of == group))
        if len(own) > 1 and lengths[own].min() > 0.7 * lengths[own].max():
            found[own] = True
    return found


def _rings(labels: Labels, strips: BoolArray, width: float) -> BoolArray:
    """Small strips that run round something."""
    found = np.zeros(len(strips), bool)
    mask = strips[labels].astype(np.uint8)
    outlines, tree = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    for index, outline in enumerate(outlines):
        _, _, box_width, box_height = cv2.boundingRect(outline)
        is_outer = tree[0][index][3] < 0
        if (
            is_outer
            and tree[0][index][2] >= 0
            and max(box_width, box_height) < (_LARGEST_RING * width)
        ):
            column, row = outline[0][0]
            found[labels[row, column]] = True
    return found


def _hatching(ink: BoolArray, labels: Labels, areas: FloatArray, is_crumb: BoolArray) -> BoolArray:
    """Where many crumbs of paper lie side by side."""
    crumb_px = float(np.sqrt(np.median(areas[is_crumb])))
    filled = _with_faces(is_crumb[labels], ink, 0.5 * crumb_px)
    _, pieces, stats, _ = cv2.connectedComponentsWithStats(filled.astype(np.uint8), connectivity=8)
    is_wall = stats[:, cv2.CC_STAT_AREA] >= _FEWEST_CRUMBS * crumb_px**2
    is_wall[0] = False
    return np.asarray(is_wall[pieces])


def _with_faces(bodies: BoolArray, ink: BoolArray, least_px: float) -> BoolArray:
    """Bodies, the lines between them and those round them, without what leads away.

    least_px: no wall is thinner.
    """
    closed = cv2.morphologyEx(bodies.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
    near = cv2.dilate(closed, np.ones((2 * _FACE_PX + 1,) * 2, np.uint8)) > 0
    faced = ((cv2.dilate(closed, _BLOCK) > 0) | (near & ink)).astype(np.uint8)
    # Odd, so that opening does not shift the walls.
    side = 2 * max(round(least_px / 2), 2) + 1
    square = np.ones((side, side), np.uint8)
    return np.asarray(cv2.morphologyEx(faced, cv2.MORPH_OPEN, square) > 0)
