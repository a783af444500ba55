"""Openings that are filled with a colour: what most of one colour are, all of them are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from chord_usd.plan.openings import Bar
from chord_usd.scene.types import ByteArray, FloatArray, OpeningKind

_LEAST_CHROMA = 40
_SAME_COLOR = 40
"""Levels by which JPEG and scaling change the colour of so small a patch."""

_LEAST_FLAT = 0.6
"""Share of a filled bar that has its colour."""

_RIM_PX = 2
_MOST_BESIDE = 0.2
"""Share of what lies beside a bar that may have its colour."""

_MANY = 3
"""So many windows of one colour tell what a window looks like."""

_CONFIDENCE, _LONE_CONFIDENCE = 0.8, 0.4


def alike_by_color(bars: Sequence[Bar], rgb: ByteArray) -> list[Bar]:
    """The bars, doors or windows as most bars of their colour are; where as many are either, and
    where no vivid colour fills them, unchanged.

    An entrance that is drawn as a pink bar like the doors inside is no window; neither, most
    likely, is the one bar of its colour among windows of another. rgb: (H, W, 3) the picture that
    the bars lie in.
    """
    colors = [None if bar.kind == "passage" else _flat_color(bar, rgb) for bar in bars]
    votes = [_votes(color, bars, colors) for color in colors]
    has_windows = any(own["window"] >= _MANY for own in votes)
    return [
        _as_voted(bar, own, has_windows=has_windows) for bar, own in zip(bars, votes, strict=True)
    ]


def _votes(
    color: FloatArray | None, bars: Sequence[Bar], colors: Sequence[FloatArray | None]
) -> Counter[OpeningKind]:
    """How many bars of a colour are of each kind; none for no colour."""
    return Counter(
        bar.kind
        for bar, own in zip(bars, colors, strict=True)
        if color is not None and own is not None and np.abs(own - color).max() <= _SAME_COLOR
    )


def _as_voted(bar: Bar, votes: Counter[OpeningKind], *, has_windows: bool) -> Bar:
    if votes.total() == 1 and bar.kind == "window" and has_windows:
        return replace(bar, kind="door", confidence=_LONE_CONFIDENCE)
    kind = max(votes, key=lambda name: votes[name], default=bar.kind)
    if votes[kind] > votes[bar.kind]:
        return replace(bar, kind=kind, confidence=_CONFIDENCE)
    return bar


def _flat_color(bar: Bar, rgb: ByteArray) -> FloatArray | None:
    """The vivid colour that fills a bar, if one does: no paper or floor that shows in a gap."""
    rows, columns = np.nonzero(bar.mask)
    if len(rows) == 0:
        return None
    reach = min(int(np.ptp(rows)), int(np.ptp(columns))) + 1
    window = (
        slice(max(int(rows.min()) - reach, 0), int(rows.max()) + reach + 1),
        slice(max(int(columns.min()) - reach, 0), int(columns.max()) + reach + 1),
    )
    pixels, own = rgb[window].astype(np.float64), bar.mask[window]
    color = np.median(pixels[own], axis=0)
    alike = np.abs(pixels - color).max(axis=2) <= _SAME_COLOR
    beside = cv2.dilate(own.astype(np.uint8), np.ones((2 * _RIM_PX + 1,) * 2, np.uint8)) == 0
    is_vivid = np.ptp(color) >= _LEAST_CHROMA and alike[own].mean() >= _LEAST_FLAT
    return color if is_vivid and alike[beside].mean() < _MOST_BESIDE else None
