"""A drawing's rooms and openings by its strokes: thick dark ones are walls, what they enclose is
floor.

Walls that are drawn plainly are found to a pixel, whatever the network has seen; where furniture,
dimension lines or pages of text stand about them, they are not.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Polygon

from chord_usd.plan.classical.bar_colors import alike_by_color
from chord_usd.plan.classical.drawn_regions import (
    Enclosed,
    find_regions,
    parting_gaps,
    room_outlines,
    sides,
    without_open_plan,
)
from chord_usd.plan.classical.gaps import Gap, find_gaps
from chord_usd.plan.classical.strokes import Strokes, find_strokes
from chord_usd.plan.openings import Bar, read_openings
from chord_usd.plan.regions import Outline, Regions
from chord_usd.plan.scale_choice import USUAL_DOOR_M
from chord_usd.scene.types import (
    WALL_THICKNESS_M,
    ByteArray,
    FloatArray,
    Opening,
    OpeningKind,
    PixelFrame,
)

_ENOUGH_DOORS = 2

_GOOD_SHARE = 0.8
"""A reading that encloses this share of what the best one does is as good."""

_ENTERED_SHARE = 0.6
"""And which finds this share of the rooms that another does; fewer, and it missed the walls."""

_LINES_WEIGHT = 0.6
_SHUT_WEIGHT = 0.6
"""Rooms without any opening are most likely none."""

_AT_ONCE = 2
"""Ways read at the same time: more memory for no more speed on two cores."""


@dataclass(frozen=True, eq=False)
class StrokeReading:
    """What one way to tell walls from the rest makes of a drawing."""

    rgb: ByteArray
    """(H, W, 3)."""
    strokes: Strokes
    regions: Regions
    outlines: list[Outline]
    bars: list[Bar]
    frame: PixelFrame
    entered: int
    """Rooms that something opens into."""
    doors_m_per_px: float | None
    """By the doors; None where too few are drawn."""

    @property
    def weight(self) -> float:
        """Floor that walls with openings enclose; single lines count for less."""
        floor = sum(
            outline.confidence * Polygon(outline.polygon_px).area for outline in self.outlines
        )
        entered = self.entered / max(len(self.outlines), 1)
        shut = _SHUT_WEIGHT + (1.0 - _SHUT_WEIGHT) * entered
        return floor * shut * (_LINES_WEIGHT if self.strokes.are_lines else 1.0)

    def of(self, rooms: Sequence[int]) -> StrokeReading:
        """Of these rooms alone, by index."""
        return replace(self, outlines=[self.outlines[room] for room in rooms])

    def again(self, m_per_px: float) -> StrokeReading:
        """At another scale, which changes what is a room and what a cupboard."""
        return _read(self.strokes, m_per_px, self.rgb)

    def placed(self, room_ids: Sequence[str], frame: PixelFrame) -> tuple[Opening, ...]:
        """The openings in the walls of rooms."""
        polygons_px = [outline.polygon_px for outline in self.outlines]
        bars = alike_by_color(self.bars, self.rgb)
        return read_openings(bars, polygons_px, room_ids, self.strokes.thickness_px, frame)


def read_strokes(
    rgb: ByteArray, texts_px: Sequence[FloatArray], m_per_px: float | None
) -> StrokeReading | None:
    """The strictest of the readings that enclose as much as any; None for none."""
    # One way is read while the next is looked for.
    with ThreadPoolExecutor(_AT_ONCE) as readers:
        found = find_strokes(rgb, texts_px)
        readings = list(readers.map(lambda strokes: _read(strokes, m_per_px, rgb), found))
    most = max((reading.weight for reading in readings), default=0.0)
    good = [reading for reading in readings if reading.weight >= _GOOD_SHARE * most]
    rooms = max((reading.entered for reading in good), default=0)
    # The strictest reading takes the least furniture for walls.
    best = next((r for r in good if r.entered >= _ENTERED_SHARE * rooms), None)
    return best if best is not None and best.outlines else None


def _read(strokes: Strokes, m_per_px: float | None, rgb: ByteArray) -> StrokeReading:
    gaps = parting_gaps(strokes, find_gaps(strokes))
    doors = _scale_of_doors(gaps)
    m_per_px = m_per_px or doors or WALL_THICKNESS_M / strokes.thickness_px
    gaps = without_open_plan(strokes, gaps, m_per_px)
    enclosed = find_regions(strokes, gaps)
    outlines = room_outlines(enclosed, strokes, m_per_px)
    frame = PixelFrame(m_per_px, (0.0, 0.0), len(strokes.wall))
    bars = [_bar(gap, enclosed) for gap in gaps]
    entered = {side for gap in gaps for side in sides(gap, enclosed.labels)} - {0}
    regions = Regions(enclosed.labels, strokes.wall, strokes.thickness_px)
    inside = min(len(entered), len(outlines))
    return StrokeReading(rgb, strokes, regions, outlines, bars, frame, inside, doors)


# Meaning -----------------------------------------------------------------------------------------


def _scale_of_doors(gaps: Sequence[Gap]) -> float | None:
    """Metres per pixel, from doors drawn with their arcs, else with a leaf; None for too few."""
    for doors in (
        [g for g in gaps if g.has_arc],
        [g for g in gaps if g.has_leaf and not g.has_pane],
    ):
        if len(doors) >= _ENOUGH_DOORS:
            # Wider ones are double doors, or lead to a balcony.
            lengths_px = [gap.length_px for gap in doors]
            return USUAL_DOOR_M / float(np.percentile(lengths_px, 25))
    return None


def _bar(gap: Gap, regions: Enclosed) -> Bar:
    """Door by its arc, or by its leaf; window by its panes in an outer wall; else a passage."""
    kind, confidence = _kind(gap, inside=all(sides(gap, regions.labels)))
    return Bar(kind, gap.mask(regions.labels.shape), confidence)


def _kind(gap: Gap, *, inside: bool) -> tuple[OpeningKind, float]:
    if gap.has_arc:
        return "door", 0.95
    if gap.has_leaf and not (gap.has_pane and not inside):
        return "door", 0.8
    if gap.has_pane:
        return ("door", 0.6) if inside else ("window", 0.85)
    return ("passage", 0.7) if inside else ("door", 0.4)
