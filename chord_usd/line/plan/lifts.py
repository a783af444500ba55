"""Lifts are no rooms: floors that are named so, or on which the cross of a cabin is drawn."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from shapely.geometry import Polygon, box

from chord_usd.base.scene.room_words import plain
from chord_usd.base.scene.types import BoolArray, FloatArray, Room
from chord_usd.line.plan.seen import SeenReading
from chord_usd.line.plan.text import Text

_SHOWS = "the plan shows "

_WORDS = frozenset((
    "lift", "elevator", "aufzug", "fahrstuhl", "personenaufzug", "ascenseur", "ascensor",
    "elevador", "ascensore", "montacargas", "hiss", "hissi", "heis", "winda", "vytah", "dizalo",
    "dvigalo", "asansor", "лифт", "电梯", "電梯", "エレベーター", "엘리베이터",
))  # fmt: skip
"""Words for lifts, without accents."""

_FLOOR_M2 = (2.0, 8.0)
"""Of a shaft: less is a shower or a cupboard with a cross."""
_OF_FLOOR = 0.25
"""Least share of the shaft that the cabin takes up."""
_OF_SIDE, _GAP = 0.4, 0.05
"""Least length of a diagonal, and greatest gap in it, as shares of the floor's shorter side."""
_MOST_INK = 0.3
"""Share of a floor that is drawn on, from which on it is hatched or tinted."""
_SLANT = 0.3
"""Least share of both sides in the length of a diagonal."""
_MIDDLE, _ALIKE = 0.1, 0.85
"""Middles of two diagonals are no farther apart, and lengths no less alike, as shares of the
longer one's length."""


def without_lifts(
    reading: SeenReading,
    rooms: Sequence[Room],
    texts: Sequence[Sequence[Text]],
    ink: BoolArray,
    m_per_px: float,
) -> tuple[SeenReading, list[str]]:
    """A reading without floors that are lifts, and what to say of them.

    rooms: with kinds by their names. texts: printed in each. ink: (H, W) what is drawn.
    """
    lifts = [
        is_lift(polygon, [text.text for text in room_texts], room.kind != "unknown", ink, m_per_px)
        for room, room_texts, polygon in zip(rooms, texts, reading.polygons_px, strict=True)
    ]
    count = sum(lifts)
    if not 0 < count < len(lifts):
        return reading, []
    shown = "a lift, which is no room" if count == 1 else f"{count} lifts, which are no rooms"
    rest = [index for index, skipped in enumerate(lifts) if not skipped]
    return reading.of(rest), [f"{_SHOWS}{shown}"]


def is_lift(
    polygon_px: FloatArray, texts: Sequence[str], named: bool, ink: BoolArray, m_per_px: float
) -> bool:
    """Whether a floor is a lift.

    texts: printed on it. named: whether they name a room. ink: (H, W) what is drawn.
    """
    if named:
        return False
    words = {word for text in texts for word in re.findall(r"\w+", plain(text.casefold()))}
    floor = Polygon(polygon_px).buffer(0)
    low, high = (m2 / m_per_px**2 for m2 in _FLOOR_M2)
    return not words.isdisjoint(_WORDS) or (low <= floor.area <= high and _is_crossed(floor, ink))


def _is_crossed(floor: Polygon, ink: BoolArray) -> bool:
    """Whether both diagonals of a rectangle are drawn on a floor."""
    lines = list(_slanted_lines(floor, ink))
    for index, first in enumerate(lines):
        for second in lines[index + 1 :]:
            if _cross(first, second):
                ends = np.concatenate([first, second])
                cabin = box(*ends.min(axis=0), *ends.max(axis=0))
                if cabin.intersection(floor).area >= _OF_FLOOR * floor.area:
                    return True
    return False


def _slanted_lines(floor: Polygon, ink: BoolArray) -> Iterator[FloatArray]:
    """Ends (2, 2) of long lines on a floor that are far from level and upright."""
    left, top, right, bottom = (round(at) for at in floor.bounds)
    part = ink[max(top, 0) : bottom, max(left, 0) : right].astype(np.uint8)
    side = min(right - left, bottom - top)
    if min(part.shape) < 2 or part.mean() > _MOST_INK:
        return
    least = max(8, round(_OF_SIDE * side))
    # Steps of thin slanted lines lie beside the line that is looked for.
    thick = cv2.dilate(part, np.ones((3, 3), np.uint8))
    lines = cv2.HoughLinesP(
        thick, 1.0, math.radians(1.0), least // 2, minLineLength=least, maxLineGap=_GAP * side
    )
    for x1, y1, x2, y2 in np.asarray([] if lines is None else lines).reshape(-1, 4):
        line = np.array([[x1, y1], [x2, y2]], np.float64)
        if np.abs(line[1] - line[0]).min() >= _SLANT * _length(line):
            yield line + np.array([max(left, 0), max(top, 0)])


def _cross(first: FloatArray, second: FloatArray) -> bool:
    """Whether two lines are the diagonals of one rectangle."""
    longer = max(_length(first), _length(second))
    (a, b), (c, d) = first[1] - first[0], second[1] - second[0]
    apart = np.linalg.norm(first.mean(axis=0) - second.mean(axis=0))
    alike = min(_length(first), _length(second)) >= _ALIKE * longer
    return bool(a * b * c * d < 0 and apart <= _MIDDLE * longer and alike)


def _length(line: FloatArray) -> float:
    return float(np.linalg.norm(line[1] - line[0]))
