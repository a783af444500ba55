"""Any other drawing -> Plan: thick dark strokes are walls, what they enclose are rooms.

A classical reader for clean drawings: black or dark walls, doors with a leaf or an arc or an empty
gap, windows as thin lines in the wall. What is printed gives rooms their kinds, and the scale.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Polygon

from chord_usd.errors import PlanError
from chord_usd.plan.bar_colors import alike_by_color
from chord_usd.plan.doubts import doubts, refuse_nonsense
from chord_usd.plan.fixtures import kind_by_fixtures
from chord_usd.plan.gaps import Gap, find_gaps
from chord_usd.plan.labels import label_rooms
from chord_usd.plan.openings import CONFIDENCE, Bar, read_openings
from chord_usd.plan.parts import parts_of
from chord_usd.plan.placement import DRAWING, WARNINGS, placement
from chord_usd.plan.printed import STATED, Estimate, estimates
from chord_usd.plan.regions import (
    Outline,
    Regions,
    find_regions,
    parting_gaps,
    room_outlines,
    sides,
    without_open_plan,
)
from chord_usd.plan.scale_choice import SCALE, Scale, choose_scale
from chord_usd.plan.settle import even_out
from chord_usd.plan.sheet import Sheet, prepare
from chord_usd.plan.strokes import Strokes, find_strokes, on_white
from chord_usd.plan.text import Text, read_texts, warm_up
from chord_usd.types import (
    WALL_THICKNESS_M,
    ByteArray,
    OpeningKind,
    PixelFrame,
    Plan,
    Room,
    frozen_array,
)
from chord_usd.units import m_from_px

_USUAL_DOOR_M = 0.8
_ENOUGH_DOORS = 2

_FARTHEST_MOVE = 0.5
"""Walls of a drawing vary; each face moves at most so many thicknesses to make them alike."""

_GOOD_SHARE = 0.8
"""A reading that encloses this share of what the best one does is as good."""

_ENTERED_SHARE = 0.6
"""And which finds this share of the rooms that another does; fewer, and it missed the walls."""

_LINES_WEIGHT = 0.6
_SHUT_WEIGHT = 0.6
"""Rooms without any opening are most likely none."""

_REREAD = math.log(1.1)
"""A scale that turns out so far from the assumed one changes what is a room and what a cupboard."""

_AT_ONCE = 2
"""Ways read at the same time: more memory for no more speed on two cores."""

_APART = 4.0
"""Rooms more wall thicknesses apart than this belong to two plans."""


@dataclass(frozen=True, eq=False)
class Known:
    """What is known of a picture beside its pixels."""

    texts: tuple[Text, ...] = ()
    """What is printed on it; empty where that has to be read from the pixels, too."""
    stated_m_per_px: float | None = None
    """By a scale such as 1:100 and the size of the paper."""


def read_drawing(
    rgb: ByteArray, m_per_px: float | None = None, part: int = 1, known: Known | None = None
) -> Plan:
    """The plan in a drawing, RGB (H, W, 3).

    m_per_px: of the picture as given; without it printed measures, doors (0.8 m) or else the walls
    (0.24 m) give the scale. part: which plan of a sheet with several, the largest being 1. Raises
    PlanError where no closed room is found, or what was found cannot be a house.
    """
    known = known or Known()
    # Loading is Python's work, straightening OpenCV's: they go side by side.
    with ThreadPoolExecutor(1) as aside:
        if not known.texts:
            aside.submit(warm_up)
        sheet = prepare(rgb)
    given = m_per_px and m_per_px / sheet.shrink
    texts = _texts(sheet, known)
    reading, told = _take_part(_best_reading(sheet.rgb, texts, given), part)
    stated = known.stated_m_per_px and known.stated_m_per_px / sheet.shrink
    scale = _scale(reading, texts, given, stated)
    if abs(math.log(scale.m_per_px / reading.frame.m_per_px)) > _REREAD:
        reading, told = _take_part(_read(reading.strokes, scale.m_per_px), part)
    reading = replace(
        reading,
        frame=replace(reading.frame, m_per_px=scale.m_per_px),
        bars=alike_by_color(reading.bars, sheet.rgb),
    )
    refuse_nonsense(reading.outlines, reading.strokes, reading.frame)
    plan = _plan(reading, texts)
    drawing = PixelFrame(scale.m_per_px * sheet.shrink, (0.0, 0.0), sheet.height_px)
    told += [*scale.warnings(), *doubts(plan, sheet.rgb, reading.strokes, texts, reading.frame)]
    entry = {**placement(drawing)[DRAWING], **sheet.straightening.entry()}
    extra = {DRAWING: entry, SCALE: scale.report(sheet.shrink)}
    return replace(plan, extra={**extra, **({WARNINGS: told} if told else {})})


def _texts(sheet: Sheet, known: Known) -> tuple[Text, ...]:
    """What is printed, in pixels of the working picture."""
    if known.texts and not sheet.straightening.entry():
        return tuple(replace(t, corners_px=t.corners_px * sheet.shrink) for t in known.texts)
    return tuple(
        replace(text, corners_px=text.corners_px / sheet.fine_per_px)
        for text in read_texts(on_white(sheet.fine))
    )


# Reading -----------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Reading:
    """What one way to tell walls from the rest makes of a drawing."""

    strokes: Strokes
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
        floor = sum(outline.walled * Polygon(outline.polygon_px).area for outline in self.outlines)
        entered = self.entered / max(len(self.outlines), 1)
        shut = _SHUT_WEIGHT + (1.0 - _SHUT_WEIGHT) * entered
        return floor * shut * (_LINES_WEIGHT if self.strokes.are_lines else 1.0)


def _best_reading(rgb: ByteArray, texts: Sequence[Text], m_per_px: float | None) -> _Reading:
    """The strictest of the readings that enclose as much as any. Raises PlanError for none."""
    boxes = [text.corners_px for text in texts]
    # One way is read while the next is looked for.
    with ThreadPoolExecutor(_AT_ONCE) as readers:
        found = find_strokes(rgb, boxes)
        readings = list(readers.map(lambda strokes: _read(strokes, m_per_px), found))
    most = max((reading.weight for reading in readings), default=0.0)
    good = [reading for reading in readings if reading.weight >= _GOOD_SHARE * most]
    rooms = max((reading.entered for reading in good), default=0)
    # The strictest reading takes the least furniture for walls.
    best = next((r for r in good if r.entered >= _ENTERED_SHARE * rooms), None)
    if best is None or not best.outlines:
        raise PlanError(
            "no closed room was found",
            expected="a floor plan with dark walls round its rooms",
            try_="a clearer drawing, cut to one floor, with the walls filled in black",
        )
    return best


def _read(strokes: Strokes, m_per_px: float | None) -> _Reading:
    gaps = parting_gaps(strokes, find_gaps(strokes))
    doors = _scale_of_doors(gaps)
    m_per_px = m_per_px or doors or WALL_THICKNESS_M / strokes.thickness_px
    gaps = without_open_plan(strokes, gaps, m_per_px)
    regions = find_regions(strokes, gaps)
    outlines = room_outlines(regions, strokes, m_per_px)
    frame = PixelFrame(m_per_px, (0.0, 0.0), len(strokes.wall))
    bars = [_bar(gap, regions) for gap in gaps]
    entered = {side for gap in gaps for side in sides(gap, regions.labels)} - {0}
    return _Reading(strokes, outlines, bars, frame, min(len(entered), len(outlines)), doors)


def _take_part(reading: _Reading, part: int) -> tuple[_Reading, list[str]]:
    """One plan of the sheet, and what to say if there are more. Raises PlanError."""
    polygons = [outline.polygon_px for outline in reading.outlines]
    parts = parts_of(polygons, _APART * reading.strokes.thickness_px)
    if part > len(parts):
        raise PlanError(
            f"part {part} was asked for, but the sheet shows {len(parts)}",
            expected=f"--part 1 to {len(parts)}" if len(parts) > 1 else "no --part",
        )
    chosen = replace(reading, outlines=[reading.outlines[i] for i in parts[part - 1]])
    if len(parts) == 1:
        return chosen, []
    which = "the largest was taken" if part == 1 else f"number {part} by size was taken"
    return chosen, [f"the sheet shows {len(parts)} plans; {which}, --part N takes another"]


def _scale(
    reading: _Reading, texts: Sequence[Text], given: float | None, stated: float | None
) -> Scale:
    polygons = [outline.polygon_px for outline in reading.outlines]
    printed = estimates(texts, polygons, reading.strokes.ink)
    if stated:
        printed.append(Estimate(STATED, stated, "1:n"))
    walls = WALL_THICKNESS_M / reading.strokes.thickness_px
    return choose_scale(printed, reading.doors_m_per_px, walls, given)


def _plan(reading: _Reading, texts: Sequence[Text]) -> Plan:
    """Rooms pulled to walls of the usual thickness, and openings in these."""
    frame = reading.frame
    thickness_px = WALL_THICKNESS_M / frame.m_per_px
    drawn = [outline.polygon_px for outline in reading.outlines]
    polygons = even_out(drawn, thickness_px, _FARTHEST_MOVE * thickness_px)
    strokes = reading.strokes
    fitted = [
        kind_by_fixtures(polygon, strokes.fine, strokes.letters, frame.m_per_px)
        for polygon in drawn
    ]
    rooms = label_rooms(
        [
            Room("", "unknown", frozen_array(m_from_px(polygon, frame)), extra=_sure(outline))
            for polygon, outline in zip(polygons, reading.outlines, strict=True)
        ],
        texts,
        frame,
        fitted,
    )
    room_ids = [room.id for room in rooms]
    openings = read_openings(reading.bars, polygons, room_ids, thickness_px, frame)
    return Plan(rooms, tuple(opening for opening in openings if opening.room_ids))


def _sure(outline: Outline) -> dict[str, float]:
    return {CONFIDENCE: round(min(1.0, outline.walled), 2)}


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
            return _USUAL_DOOR_M / float(np.percentile(lengths_px, 25))
    return None


def _bar(gap: Gap, regions: Regions) -> Bar:
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
