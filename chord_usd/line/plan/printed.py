"""What printed measures say of a drawing's scale: room sizes and areas, dimension lines, bars."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from shapely.geometry import Point, Polygon
from shapely.ops import unary_union

from chord_usd.base.scene.types import BoolArray, FloatArray
from chord_usd.line.plan.chains import chain_scales
from chord_usd.line.plan.measures import M_PER_FOOT, Measure, distinct, parse_measure
from chord_usd.line.plan.room_sizes import scales_by_sides
from chord_usd.line.plan.text import Text

_REACH = 2.5
"""A dimension line runs within so many letter heights of its number."""

_SHORTEST_LINE = 1.5
"""And is so many times as long as its number is wide, at least."""

_TICK_REACH_PX = 4
_BREAK_PX = 3

_BETWEEN_SHARE = 0.03
"""Of a plan's longer side are at most half of the walls between its rooms thick."""

_BAR_NUMBERS = 3
_BAR_SLACK = 0.05

STATED = "stated scale"
"""Witness: a scale such as 1:100, on paper whose size is known."""

CHAINS = "dimension chains"
"""Witness: lengths printed in a row."""

HOME_M2 = 25.0
"""From this area on, one may be printed for a whole home."""

_RATHER_HOME = 3
"""By so much a sheet's only area is likelier that of the home than that of its room."""

FLOOR_AREA = "floor area"
"""Witness: the area of all that the outer walls surround, printed under or over a plan."""

_NAMES = {"size": "room sizes", "area": "room areas", "length": "dimension lines"}


@dataclass(frozen=True)
class Estimate:
    """One printed measure's word on the scale."""

    witness: str
    """Room sizes, room areas, dimension lines or chains, scale bar or stated scale."""
    m_per_px: float
    text: str
    """What is printed."""
    is_sure: bool = True
    """False where the unit is a guess."""
    choices: int = 1
    """Readings of this measure, of which one at most is right."""


def estimates(
    texts: Sequence[Text], polygons_px: Sequence[FloatArray], ink: BoolArray | None = None
) -> list[Estimate]:
    """What every printed measure says.

    polygons_px: rooms; ink: (H, W) everything drawn, for dimension lines.
    """
    rooms = [Polygon(polygon) for polygon in polygons_px]
    all_estimates = [*_from_rooms(texts, rooms), *_from_bar(texts)]
    all_estimates += _from_titles(texts, rooms)
    all_estimates += [Estimate(CHAINS, scale, said) for scale, said in chain_scales(texts)]
    if ink is None:
        return all_estimates
    return [*all_estimates, *(e for text in texts for e in _from_line(text, ink))]


def _from_rooms(texts: Sequence[Text], rooms: Sequence[Polygon]) -> Iterator[Estimate]:
    printed: dict[int, dict[Measure, Text]] = defaultdict(dict)
    for text in texts:
        measure = parse_measure(text.text)
        if measure is None or measure.kind == "length":
            continue
        inside = next((i for i, r in enumerate(rooms) if r.contains(Point(*text.center_px))), None)
        if inside is not None:
            # Equal areas of two parts of a room are two.
            while measure in printed[inside]:
                measure = replace(measure, values=tuple(v * (1 + 1e-9) for v in measure.values))
            printed[inside][measure] = text
    sheet = [m for said in printed.values() for m in distinct(list(said)) if m.kind == "area"]
    is_of_home = len(sheet) == 1 and sheet[0].values[0] >= HOME_M2
    for index, said in printed.items():
        kept = distinct(list(said))
        sizes = sum(measure.kind == "size" for measure in kept)
        for measure in kept:
            if measure.kind == "size":
                label, sides = said[measure], measure.values
                at = label.center_px
                scales = scales_by_sides(rooms[index], sides, at, sizes)
                for scale in scales:
                    yield Estimate(_NAMES["size"], scale, label.text, choices=len(scales))
        # An open plan may name the area of each of its parts.
        areas = [measure for measure in kept if measure.kind == "area"]
        if areas:
            total = sum(measure.values[0] for measure in areas)
            together = " + ".join(said[measure].text for measure in areas)
            scale = math.sqrt(total / rooms[index].area)
            # Where rooms have areas, each has one: the only one is rather that of the home.
            yield Estimate(
                _NAMES["area"], scale, together, choices=_RATHER_HOME if is_of_home else 1
            )
    if is_of_home:
        total_px = sum(room.area for room in rooms)
        area_m2 = sheet[0].values[0]
        yield Estimate(FLOOR_AREA, math.sqrt(area_m2 / total_px), f"{area_m2:g} m2 in all")


def _from_titles(texts: Sequence[Text], rooms: Sequence[Polygon]) -> Iterator[Estimate]:
    """From the one area that is printed under or over a plan, of all within its outer walls."""
    if not rooms:
        return
    west, north, east, south = unary_union(rooms).bounds
    said = {
        measure: text
        for text in texts
        if (measure := parse_measure(text.text)) is not None
        and measure.kind == "area"
        and measure.values[0] >= HOME_M2
        and west < text.center_px[0] < east
        and not north < text.center_px[1] < south
    }
    areas = distinct(list(said))
    if len(areas) == 1:
        reach = _BETWEEN_SHARE * max(east - west, south - north)
        within = unary_union([room.buffer(reach, join_style="mitre") for room in rooms])
        floor = within.buffer(-reach, join_style="mitre").area
        scale = math.sqrt(areas[0].values[0] / floor)
        yield Estimate(FLOOR_AREA, scale, said[areas[0]].text)


# Dimension lines ---------------------------------------------------------------------------------


def _from_line(text: Text, ink: BoolArray) -> Iterator[Estimate]:
    """From a length and the line that it stands on, beside or within."""
    measure = parse_measure(text.text)
    if measure is None or measure.kind != "length":
        return
    corners = text.corners_px[:, ::-1] if text.is_upright else text.corners_px
    span_px = _dimension_px(corners, text.height_px, ink.T if text.is_upright else ink)
    if span_px is None:
        return
    yield Estimate(_NAMES["length"], measure.values[0] / span_px, text.text, measure.is_sure)
    if not measure.is_sure:
        # A bare number of three or four digits may count centimetres or millimetres.
        other = 10.0 if measure.values[0] < 10.0 else 0.1
        yield Estimate(
            _NAMES["length"], other * measure.values[0] / span_px, text.text, is_sure=False
        )


def _dimension_px(corners: FloatArray, height_px: float, ink: BoolArray) -> float | None:
    """Length between the ticks of the line along the rows at a number; None without a line."""
    (left, top), (right, bottom) = corners.min(axis=0), corners.max(axis=0)
    middle = (left + right) / 2
    best: tuple[int, int, int] | None = None
    for row in range(round(top - _REACH * height_px), round(bottom + _REACH * height_px) + 1):
        if not 0 < row < len(ink) - 1:
            continue
        beside = row < top or row > bottom
        span = _run(ink[row - 1 : row + 2].any(axis=0), middle, middle, middle) if beside else None
        span = span or _run(ink[row], middle, left - height_px, right + height_px)
        if span and (best is None or span[1] - span[0] > best[1] - best[0]):
            best = (*span, row)
    if best is None or best[1] - best[0] < _SHORTEST_LINE * (right - left):
        return None
    ticks = _ticks(ink, *best)
    before = [tick for tick in ticks if tick < middle]
    behind = [tick for tick in ticks if tick > middle]
    return (behind[0] - before[-1]) if before and behind else None


def _run(row: BoolArray, middle: float, left: float, right: float) -> tuple[int, int] | None:
    """First and last pixel of a line through the middle, which may be broken from left to right."""
    first, last = max(round(left), 0), min(round(right), len(row) - 1)
    if not 0 <= middle < len(row):
        return None
    begin, end = _walk(row, first, -1), _walk(row, last, 1)
    if begin == first or end == last:
        return None
    return begin, end


def _walk(row: BoolArray, start: int, step: int) -> int:
    """The last pixel of ink that can be reached without a break."""
    place = reached = start
    while 0 <= place < len(row) and abs(place - reached) <= _BREAK_PX:
        if row[place]:
            reached = place
        place += step
    return reached


def _ticks(ink: BoolArray, first: int, last: int, row: int) -> list[float]:
    """Where something crosses a line along a row; its ends, too."""
    top, bottom = row - _TICK_REACH_PX, row + _TICK_REACH_PX
    if top < 0 or bottom >= len(ink):
        return [float(first), float(last)]
    # An oblique tick leaves the line to one side above and to the other below.
    near = slice(max(first - _TICK_REACH_PX, 0), last + _TICK_REACH_PX + 1)
    above = _widened(ink[top : row - 1, near].sum(axis=0) >= 1)
    below = _widened(ink[row + 2 : bottom + 1, near].sum(axis=0) >= 1)
    columns = np.flatnonzero(above & below) + near.start
    groups = np.split(columns, np.flatnonzero(np.diff(columns) > 2) + 1) if len(columns) else []
    reach = _reach(ink, row)
    marks: list[float] = []
    for group in groups:
        mark = (
            _point(reach, group, (first, last))
            if np.ptp(group) >= _TICK_REACH_PX
            else float(group.mean())
        )
        # Arrows from both sides, and the line that they point at, are one mark.
        if marks and mark - marks[-1] <= 2 * _TICK_REACH_PX:
            mark = (marks.pop() + mark) / 2
        if np.ptp(group) < 8 * _TICK_REACH_PX:
            marks.append(mark)
    ends = [float(first), float(last)]
    return sorted([*marks, *(e for e in ends if all(abs(e - c) > 8 for c in marks))])


def _reach(ink: BoolArray, row: int) -> FloatArray:
    """(W,) how far what is drawn goes from a line along a row, to that side where it is less."""
    window = ink[max(row - 3 * _TICK_REACH_PX, 0) : row + 3 * _TICK_REACH_PX + 1]
    away = np.abs(np.arange(len(window)) - min(row, 3 * _TICK_REACH_PX))[:, None] * window
    middle = min(row, 3 * _TICK_REACH_PX)
    return np.minimum(away[:middle].max(axis=0), away[middle + 1 :].max(axis=0)).astype(float)


def _point(reach: FloatArray, columns: npt.NDArray[np.intp], ends: tuple[int, int]) -> float:
    """The place that a broad mark means: of an arrow, which grows steadily, its point."""
    low, high = int(columns[0]), int(columns[-1])
    columns = columns[reach[columns] > 0]
    if len(columns) < _TICK_REACH_PX or np.ptp(reach[columns]) == 0.0:
        return (low + high) / 2
    slope, offset = np.polyfit(columns, reach[columns], 1)
    is_arrow = np.corrcoef(columns, reach[columns])[0, 1] ** 2 > 0.7
    if not is_arrow:
        return (low + high) / 2
    point = -float(offset / slope)
    return next((float(end) for end in ends if abs(end - point) < 2 * _TICK_REACH_PX), point)


def _widened(row: BoolArray) -> BoolArray:
    wide = row.copy()
    wide[1:] |= row[:-1]
    wide[:-1] |= row[1:]
    return wide


# Scale bars --------------------------------------------------------------------------------------

_BAR_TOKEN = re.compile(r"^(\d{1,2}(?:[.,]\d)?)(m|ft|feet|metres|meters)?\.?$")


def _from_bar(texts: Sequence[Text]) -> Iterator[Estimate]:
    """From numbers that grow evenly from 0 along a line, as under a scale bar."""
    tokens = [token for text in texts if not text.is_upright for token in _tokens(text)]
    for x, y, value, _, height in tokens:
        if value != 0.0:
            continue
        row = sorted(t for t in tokens if abs(t[1] - y) < height and t[0] >= x)
        grown = [a for a, b in pairwise([*row, row[-1]]) if b[2] >= a[2]]
        if len(grown) < _BAR_NUMBERS or grown[-1][2] == 0.0:
            continue
        places, values = np.array([t[0] for t in grown]), np.array([t[2] for t in grown])
        slope, offset = np.polyfit(places, values, 1)
        if np.abs(slope * places + offset - values).max() < _BAR_SLACK * values.max() and slope > 0:
            foot = any(t[3] in ("ft", "feet") for t in grown)
            said = " ".join(f"{v:g}" for v in values)
            yield Estimate("scale bar", float(slope) * (M_PER_FOOT if foot else 1.0), said)


def _tokens(text: Text) -> Iterator[tuple[float, float, float, str, float]]:
    """(x, y, value, unit, letter height) of each number in a line of small ones."""
    parts = re.findall(r"\S+", text.text)
    matches = [_BAR_TOKEN.match(part.casefold()) for part in parts]
    left, right = float(text.corners_px[:, 0].min()), float(text.corners_px[:, 0].max())
    spots = [match.span() for match in re.finditer(r"\S+", text.text)]
    for match, (start, stop) in zip(matches, spots, strict=True):
        if match:
            share = (start + stop) / 2 / len(text.text)
            value = float(match[1].replace(",", "."))
            y = float(text.center_px[1])
            yield left + share * (right - left), y, value, match[2] or "", text.height_px
