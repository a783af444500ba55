"""Openings that are filled with a colour: what most of one colour are, all of them are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chord_usd.plan.openings import Bar
from chord_usd.types import ByteArray, FloatArray

_LEAST_CHROMA = 40
_SAME_COLOR = 40
"""Levels by which JPEG and scaling change the colour of so small a patch."""

_LEAST_FLAT = 0.6
"""Share of a filled bar that has its colour."""

_CONFIDENCE = 0.8


def alike_by_color(bars: Sequence[Bar], rgb: ByteArray) -> list[Bar]:
    """The bars, doors or windows as most bars of their colour are; where as many are either, and
    where no vivid colour fills them, unchanged.

    An entrance that is drawn as a pink bar like the doors inside is no window. rgb: (H, W, 3) the
    picture that the bars lie in.
    """
    colors = [None if bar.kind == "passage" else _flat_color(bar, rgb) for bar in bars]
    alike = []
    for bar, color in zip(bars, colors, strict=True):
        if color is not None:
            kinds = Counter(
                other.kind
                for other, own in zip(bars, colors, strict=True)
                if own is not None and np.abs(own - color).max() <= _SAME_COLOR
            )
            kind = max(kinds, key=lambda name: kinds[name])
            if kinds[kind] > kinds[bar.kind]:
                bar = replace(bar, kind=kind, confidence=_CONFIDENCE)
        alike.append(bar)
    return alike


def _flat_color(bar: Bar, rgb: ByteArray) -> FloatArray | None:
    """The vivid colour that fills a bar, if one does."""
    pixels = rgb[bar.mask].astype(np.float64)
    if len(pixels) == 0:
        return None
    color = np.median(pixels, axis=0)
    flat = (np.abs(pixels - color).max(axis=1) <= _SAME_COLOR).mean()
    return color if np.ptp(color) >= _LEAST_CHROMA and flat >= _LEAST_FLAT else None
