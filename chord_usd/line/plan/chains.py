"""Chains of dimensions: lengths printed in a row say the scale by where their numbers stand.

A number stands in the middle of what it measures. From the middle of one length to the middle of
the next it is half of both, whatever ticks and lines are drawn: no line has to be seen.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from chord_usd.line.plan.measures import parse_measure
from chord_usd.line.plan.text import Text

_IN_ROW = 0.8
"""Numbers of a chain stand within so many letter heights of a line."""
_BARE = re.compile(r"\d+")
_THOUSANDS = re.compile(r"\d{1,2}[.,]\d{3}")
_MM_FROM = 1000
"""Bare numbers count millimetres on a sheet on which some of them are so large."""


@dataclass(frozen=True)
class _Length:
    text: str
    length_m: float
    along_px: float
    across_px: float
    height_px: float


def chain_scales(texts: Sequence[Text]) -> Iterator[tuple[float, str]]:
    """(metres per pixel, what is printed) of each two lengths that follow one another in a row
    along or up the sheet. Where a number between them was not read the scale is wrong."""
    for _, row in _chains(texts):
        for length, other in pairwise(row):
            apart_px = other.along_px - length.along_px
            if apart_px > max(length.height_px, other.height_px):
                between_m = (length.length_m + other.length_m) / 2
                yield between_m / apart_px, f"{length.text} | {other.text}"


def chain_lengths(texts: Sequence[Text]) -> Iterator[tuple[float, float, int]]:
    """(metres, middle in pixels, axis along which it is measured: 0 for x, 1 for y) of each length
    in a row."""
    for axis, row in _chains(texts):
        for length in row:
            yield length.length_m, length.along_px, axis


def _chains(texts: Sequence[Text]) -> Iterator[tuple[int, list[_Length]]]:
    """(axis, lengths in order) of each row of lengths."""
    bare = [int(text.text) for text in texts if _BARE.fullmatch(text.text)]
    are_mm = any(value >= _MM_FROM for value in bare) or any(
        _THOUSANDS.fullmatch(text.text) for text in texts
    )
    for axis in (0, 1):
        lengths = [
            length
            for text in texts
            if text.is_upright == (axis == 1) and (length := _length(text, are_mm)) is not None
        ]
        yield from ((axis, row) for row in _rows(lengths))


def _length(text: Text, are_mm: bool) -> _Length | None:
    """What a text says of a length, along the direction in which it is read."""
    measure = parse_measure(text.text)
    if measure is None or measure.kind != "length":
        return None
    if text.text.startswith("0") and _BARE.fullmatch(text.text):
        return None  # read upside down
    length_m = measure.values[0]
    if are_mm and _BARE.fullmatch(text.text):
        length_m = int(text.text) / 1000
    x, y = (float(at) for at in text.center_px)
    along, across = (y, x) if text.is_upright else (x, y)
    return _Length(text.text, length_m, along, across, text.height_px)


def _rows(lengths: Sequence[_Length]) -> Iterator[list[_Length]]:
    """Lengths that stand on one line, in order."""
    left = sorted(lengths, key=lambda length: length.across_px)
    while left:
        first = left[0]
        reach = first.across_px + _IN_ROW * first.height_px
        row = [length for length in left if length.across_px <= reach]
        left = left[len(row) :]
        if len(row) > 1:
            yield sorted(row, key=lambda length: length.along_px)
