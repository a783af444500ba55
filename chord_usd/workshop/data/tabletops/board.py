"""A top that is being laid: what stands where, what still fits. Plain floats, for speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chord_usd.base.raster.table_top import Side
from chord_usd.base.scene.palette import CATEGORIES, Mount
from chord_usd.base.scene.types import BoolArray, Box, Item
from chord_usd.base.scene.units import wrap_deg
from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.tabletops.tabletop_sizes import Size

CELL_M = 0.01
"""Resolution of the mask of a top."""

GAP_M = 0.02
"""Air between items, so that painted items stay distinct."""

EDGE_M = 0.012
"""What stands on a top keeps this far from its edge."""

FACING_DEG: dict[Side, float] = {"front": 0.0, "right": 90.0, "back": 180.0, "left": -90.0}
"""Yaw of an item that faces this side."""

Corner = tuple[float, float]


@dataclass(frozen=True)
class Outline:
    """A rectangle with round corners, centred on the origin; round tables are all corner."""

    length_m: float
    width_m: float
    corner_m: float
    holes: tuple[Box, ...] = ()
    """What rises above the top itself (a television): nothing stands there."""

    def holds(self, x: float, y: float, margin_m: float = EDGE_M) -> bool:
        """Whether a point lies inside, this far from the edge."""
        over_x = abs(x) - (self.length_m / 2 - self.corner_m)
        over_y = abs(y) - (self.width_m / 2 - self.corner_m)
        reach = self.corner_m - margin_m
        if over_x <= 0.0 or over_y <= 0.0:
            return max(over_x, over_y) <= reach
        return math.hypot(over_x, over_y) <= max(reach, 0.0)

    def mask(self) -> BoolArray:
        """(rows, columns) cells of CELL_M of the footprint whose centres are free, back first."""
        rows = max(round(self.width_m / CELL_M), 1)
        columns = max(round(self.length_m / CELL_M), 1)
        x = ((np.arange(columns) + 0.5) / columns - 0.5) * self.length_m
        y = (0.5 - (np.arange(rows) + 0.5) / rows)[:, None] * self.width_m
        over_x = np.abs(x) - (self.length_m / 2 - self.corner_m)
        over_y = np.abs(y) - (self.width_m / 2 - self.corner_m)
        free = np.hypot(np.maximum(over_x, 0.0), np.maximum(over_y, 0.0)) <= self.corner_m
        for hole in self.holes:
            half_x, half_y = hole.size_m[0] / 2, hole.size_m[1] / 2
            free &= (np.abs(x - hole.center_m[0]) > half_x) | (
                np.abs(y - hole.center_m[1]) > half_y
            )
        return np.asarray(free, np.bool_)


@dataclass(frozen=True)
class Placed:
    """One item with its corners at hand."""

    category: str
    box: Box
    corners: tuple[Corner, ...]
    reach_m: float
    """From the centre to a corner."""


class Board:
    """Items on one top. Nothing overlaps but what lies underfoot and what stands on it."""

    def __init__(self, outline: Outline, dice: Dice) -> None:
        self.outline, self.dice = outline, dice
        self.placed: list[Placed] = []

    def put(self, category: str, size_m: Size, x: float, y: float, yaw_deg: float) -> Placed | None:
        """The item placed there, standing on what lies under it, if it fits; else None."""
        piece = _placed(category, size_m, x, y, wrap_deg(yaw_deg))
        if not all(self.outline.holds(*corner) for corner in piece.corners):
            return None
        if any(_overlap(piece, _placed("", hole.size_m, *hole.center_m[:2], 0.0), GAP_M)
               for hole in self.outline.holes):  # fmt: skip
            return None
        base_m = 0.0
        for other in self.placed:
            if not _overlap(piece, other, GAP_M):
                continue
            if _lies_underfoot(category) or not _lies_underfoot(other.category):
                return None
            if _overlap(piece, other, 0.0):
                base_m = max(base_m, other.box.top_m)
        raised = Box((x, y, base_m), size_m, piece.box.yaw_deg)
        self.placed.append(Placed(category, raised, piece.corners, piece.reach_m))
        return self.placed[-1]

    def items(self) -> tuple[Item, ...]:
        """What stands there, as children of the supporting piece."""
        return tuple(
            Item(f"{piece.category}_{index}", piece.category, piece.box)
            for index, piece in enumerate(self.placed)
        )


class Place:
    """A board as somebody sees it who is at one of its sides.

    along: to their right, from the middle of the side; depth: away from them, from the edge.
    """

    def __init__(self, board: Board, side: Side) -> None:
        self.board, self.side = board, side
        self.yaw_deg = FACING_DEG[side]
        outline = board.outline
        lies_along = side in ("front", "back")
        self.length_m = outline.length_m if lies_along else outline.width_m
        self.depth_m = outline.width_m if lies_along else outline.length_m

    def at(self, along: float, depth: float) -> tuple[float, float]:
        """The own coordinates (x, y) of a place."""
        across = self.depth_m / 2 - depth
        if self.side == "front":
            return along, -across
        if self.side == "back":
            return -along, across
        return (across, along) if self.side == "right" else (-across, -along)

    def along(self, offset_m: float) -> float:
        """Where a place of the edge, in own x or y as Border has it, lies along this side."""
        return offset_m if self.side in ("front", "right") else -offset_m

    def put(
        self,
        category: str,
        size_m: Size,
        along: Sequence[float],
        depth: Sequence[float],
        turn_deg: float = 0.0,
        tries: int = 3,
    ) -> Placed | None:
        """An item that faces this side, turned by up to turn_deg either way.

        along, depth: spans (from, to) of its centre; depths are from the edge. Where it does not
        fit it is tried elsewhere in the spans; None where that fails.
        """
        dice = self.board.dice
        for _ in range(tries):
            yaw_deg = self.yaw_deg + turn_deg * (2.0 * dice.unit() - 1.0)
            spot = self.at(_within(dice, along), _within(dice, depth))
            placed = self.board.put(category, size_m, *spot, yaw_deg)
            if placed:
                return placed
        return None


def _within(dice: Dice, span: Sequence[float]) -> float:
    return span[0] + (span[1] - span[0]) * dice.unit()


def _lies_underfoot(category: str) -> bool:
    row = CATEGORIES.get(category)
    return row is not None and row.mount is Mount.UNDERFOOT


def _placed(category: str, size_m: Size, x: float, y: float, yaw_deg: float) -> Placed:
    cos, sin = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    u, v = size_m[0] / 2, size_m[1] / 2
    corners = tuple(
        (x + cos * a - sin * b, y + sin * a + cos * b)
        for a, b in ((-u, v), (-u, -v), (u, -v), (u, v))
    )
    return Placed(category, Box((x, y, 0.0), size_m, yaw_deg), corners, math.hypot(u, v))


def _overlap(first: Placed, other: Placed, gap_m: float) -> bool:
    """Whether two rectangles come nearer than gap_m, by the axes of both (separating axes)."""
    (x0, y0, _), (x1, y1, _) = first.box.center_m, other.box.center_m
    if math.hypot(x1 - x0, y1 - y0) >= first.reach_m + other.reach_m + gap_m:
        return False
    for rectangle, points in ((first, other.corners), (other, first.corners)):
        corner, beside, behind = (rectangle.corners[k] for k in (1, 2, 0))
        for end, length in ((beside, rectangle.box.size_m[0]), (behind, rectangle.box.size_m[1])):
            ax, ay = (end[0] - corner[0]) / length, (end[1] - corner[1]) / length
            spans = [(x - corner[0]) * ax + (y - corner[1]) * ay for x, y in points]
            if max(spans) <= -gap_m or min(spans) >= length + gap_m:
                return False
    return True
