"""Findings drawn on previews: a numbered disk at each place, and its text in a column beside."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from chord_usd.base.raster.lettering import write_text
from chord_usd.base.scene.palette import Rgb
from chord_usd.base.scene.types import PixelFrame
from chord_usd.base.scene.units import px_from_m

COLUMN_PX = 460
_LINE_PX, _FONT_PX, _SIDE_PX, _RADIUS_PX = 18, 13, 12, 9
_LETTERS = 60
"""Of a line in the column."""

FAULT: Rgb = (192, 32, 32)
FINDING: Rgb = (214, 122, 0)


@dataclass(frozen=True)
class Mark:
    """A finding and its place."""

    text: str
    at_m: tuple[float, float] | None
    """In the world; None for a finding of the whole house."""
    is_fault: bool = False
    """Whether the certificate does not hold for it."""

    @property
    def rgb(self) -> Rgb:
        """Colour of its disk."""
        return FAULT if self.is_fault else FINDING


def with_marks(picture: np.ndarray, frame: PixelFrame, marks: Sequence[Mark]) -> np.ndarray:
    """A picture (H, W, 3) with marks on it and a column of their texts at its right."""
    if not marks:
        return picture
    lines = [textwrap.wrap(mark.text, _LETTERS) for mark in marks]
    height = max(picture.shape[0], 2 * _SIDE_PX + _LINE_PX * sum(len(text) + 1 for text in lines))
    sheet = Image.new("RGB", (picture.shape[1] + COLUMN_PX, height), (255, 255, 255))
    sheet.paste(Image.fromarray(picture), (0, 0))
    draw = ImageDraw.Draw(sheet)
    left, y = picture.shape[1] + _SIDE_PX, float(_SIDE_PX + _LINE_PX)
    taken: list[np.ndarray] = []
    for number, (mark, text) in enumerate(zip(marks, lines, strict=True), start=1):
        _disk(draw, np.array([left, y]), number, mark.rgb)
        for line in text:
            write_text(draw, (left + 2 * _RADIUS_PX, y), line, _FONT_PX, anchor="lm")
            y += _LINE_PX
        y += _LINE_PX / 2
        if mark.at_m is not None:
            at = _beside(px_from_m(np.array(mark.at_m), frame), taken)
            taken.append(at)
            _disk(draw, at, number, mark.rgb)
    return np.asarray(sheet)


def _beside(at_px: np.ndarray, taken: Sequence[np.ndarray]) -> np.ndarray:
    """The place, or the next to its right that no disk covers."""
    while any(np.hypot(*(at_px - other)) < 2 * _RADIUS_PX for other in taken):
        at_px = at_px + np.array([2.0 * _RADIUS_PX, 0.0])
    return at_px


def _disk(draw: ImageDraw.ImageDraw, at_px: np.ndarray, number: int, rgb: Rgb) -> None:
    x, y = at_px.tolist()
    draw.ellipse((x - _RADIUS_PX, y - _RADIUS_PX, x + _RADIUS_PX, y + _RADIUS_PX), fill=rgb)
    write_text(draw, (x, y), str(number), 11, (255, 255, 255))
