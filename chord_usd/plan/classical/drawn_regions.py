"""Regions of a drawing between its walls: which are rooms, and what their outlines are."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from chord_usd.plan.classical.gaps import Gap, close_gaps
from chord_usd.plan.classical.strokes import Strokes
from chord_usd.plan.ink import border_values
from chord_usd.plan.regions import Labels, Outline, large_regions, surrounded_px2
from chord_usd.raster.vectorize import polygon_from_mask
from chord_usd.scene.types import FloatArray

_LARGEST_PASSAGE_M = 1.8
"""A wider gap between rooms in which nothing is drawn makes them one room."""

_LEAST_EDGE = 3.0
"""An edge this many wall thicknesses long is straight, not one of many that follow a curve."""

_LEAST_STRAIGHT = 0.6
"""Share of a room's outline that runs straight; a blob in a photograph has less."""

_LEAST_WALLED = 0.5
"""Share of a room's outline along walls; what lies between dimension lines has less."""

_BLOCK = np.ones((3, 3), np.uint8)


@dataclass(frozen=True, eq=False)
class Enclosed:
    """The rooms of a drawing as pixels."""

    labels: Labels
    """(H, W) a number for each room, 0 for walls and outside."""
    walled: FloatArray
    """By number: the share of the region's rim that lies along walls and openings."""


def find_regions(strokes: Strokes, gaps: list[Gap]) -> Enclosed:
    """What walls and closed gaps enclose.

    Between rooms only walls and gaps count; towards the outside any line does, since windows and
    balconies are often drawn with nothing else.
    """
    closed = close_gaps(strokes.wall, gaps)
    drawn = cv2.dilate((closed | strokes.ink).astype(np.uint8), _BLOCK)
    _, labels = cv2.connectedComponents(1 - drawn, connectivity=4)
    open_air = border_values(labels)
    reached = np.isin(np.arange(labels.max() + 1), open_air[open_air > 0])[labels]
    outside = cv2.dilate(reached.astype(np.uint8), _BLOCK) > 0
    # Odd, so that opening does not shift the region.
    side = 2 * max(round(0.25 * strokes.thickness_px), 1) + 1
    square = np.ones((side, side), np.uint8)
    inside = cv2.morphologyEx((~closed & ~outside).astype(np.uint8), cv2.MORPH_OPEN, square)
    count, labels = cv2.connectedComponents(inside, connectivity=4)
    near_wall = cv2.dilate(closed.astype(np.uint8), np.ones((2 * side + 1,) * 2, np.uint8)) > 0
    rim = (inside > 0) & (cv2.erode(inside, _BLOCK) == 0)
    rims = np.bincount(labels[rim], minlength=count)
    walled = np.bincount(labels[rim & near_wall], minlength=count)
    share = walled / np.maximum(rims, 1)
    is_room = share > _LEAST_WALLED
    is_room[0] = False
    numbers = np.where(is_room, np.arange(count), 0).astype(np.int32)
    return Enclosed(numbers[labels], share)


def sides(gap: Gap, regions: Labels) -> tuple[int, int]:
    """The regions on both sides of a gap."""
    along = np.linspace(0.25, 0.75, 7) * gap.length_px
    found = []
    for side in (-1.0, 1.0):
        beside = side * (gap.width_px / 2 + np.array([2.5, 4.5]))
        points = gap.start + gap.along * along[:, None, None] + gap.across * beside[None, :, None]
        columns = points[..., 0].astype(int).clip(0, regions.shape[1] - 1).ravel()
        rows = points[..., 1].astype(int).clip(0, regions.shape[0] - 1).ravel()
        found.append(int(np.bincount(regions[rows, columns]).argmax()))
    return found[0], found[1]


def parting_gaps(strokes: Strokes, gaps: list[Gap]) -> list[Gap]:
    """Gaps that have different regions on both sides once all are closed."""
    regions = find_regions(strokes, gaps).labels
    return [gap for gap in gaps if len(set(sides(gap, regions))) == 2]


def without_open_plan(strokes: Strokes, gaps: list[Gap], m_per_px: float) -> list[Gap]:
    """Without wide empty gaps between two rooms: those are one room."""
    regions = find_regions(strokes, gaps).labels
    kept = []
    for gap in gaps:
        if (
            gap.is_empty
            and gap.length_px * m_per_px > _LARGEST_PASSAGE_M
            and all(sides(gap, regions))
        ):
            continue
        kept.append(gap)
    return parting_gaps(strokes, kept)


def room_outlines(enclosed: Enclosed, strokes: Strokes, m_per_px: float) -> list[Outline]:
    """Outlines of the regions that are large and straight enough for rooms."""
    noise_px = 0.5 + 0.12 * strokes.thickness_px
    labels = enclosed.labels
    outlines = [
        Outline(
            polygon_from_mask(labels == label, noise_px),
            round(min(1.0, float(enclosed.walled[label])), 2),
            surrounded_px2=surrounded_px2(np.asarray(labels == label)),
        )
        for label in large_regions(labels, m_per_px)
    ]
    return [line for line in outlines if _is_straight(line.polygon_px, strokes.thickness_px)]


def _is_straight(outline: FloatArray, thickness_px: float) -> bool:
    """Whether most of an outline runs in long straight edges, as rooms do and blobs do not."""
    edges = np.roll(outline, -1, axis=0) - outline
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    return bool(
        lengths[lengths > _LEAST_EDGE * thickness_px].sum() > _LEAST_STRAIGHT * lengths.sum()
    )
