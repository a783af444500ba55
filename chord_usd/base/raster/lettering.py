"""Text on pictures, in the scripts that rooms are named in.

The fonts are those that Blender's wheel ships (Inter, 0.3 MB; Noto Sans CJK, 11 MB; Noto Sans
Hebrew and others, below 0.3 MB each; all under the SIL Open Font License), the same on every
machine; a file is opened when its script is first written. A character that no font has is left
out.
"""

from __future__ import annotations

import importlib.util
import unicodedata
from collections.abc import Iterator
from functools import lru_cache
from itertools import groupby
from pathlib import Path
from typing import Literal

from PIL import ImageDraw, ImageFont

from chord_usd.base.scene.palette import Rgb

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont

_PLAIN = "Inter.woff2"
_SCRIPTS = (
    ("HEBREW", "NotoSansHebrew-Regular.woff2"),
    ("CJK", "Noto Sans CJK Regular.woff2"),
    ("HIRAGANA", "Noto Sans CJK Regular.woff2"),
    ("KATAKANA", "Noto Sans CJK Regular.woff2"),
    ("HANGUL", "Noto Sans CJK Regular.woff2"),
    ("IDEOGRAPHIC", "Noto Sans CJK Regular.woff2"),
    ("FULLWIDTH", "Noto Sans CJK Regular.woff2"),
    ("HALFWIDTH", "Noto Sans CJK Regular.woff2"),
    ("ARMENIAN", "NotoSansArmenian-VariableFont_wdth,wght.woff2"),
    ("GEORGIAN", "NotoSansGeorgian-VariableFont_wdth,wght.woff2"),
    ("THAI", "NotoSansThai-VariableFont_wdth,wght.woff2"),
)
"""By the first word of a character's name in Unicode."""

_LINE = 1.25
"""From one baseline to the next, in letter heights; the upper lies so far below the top as 1."""

Anchor = Literal["mm", "lm", "la", "mb"]
"""Which point of a text is put at its place: left or middle, then middle, top or bottom."""


def text_size(text: str, size_px: int) -> tuple[float, float]:
    """Width and height in pixels of a text, which may have several lines."""
    lines = text.split("\n")
    return max(_width(line, size_px) for line in lines), len(lines) * _LINE * size_px


def write_text(
    draw: ImageDraw.ImageDraw, at_px: tuple[float, float], text: str, size_px: int,
    fill: Rgb = (0, 0, 0), anchor: Anchor = "mm", halo: Rgb | None = None,
) -> None:  # fmt: skip
    """Write a text of one or several lines, centred on one another where the anchor is "m"."""
    lines = text.split("\n")
    height = len(lines) * _LINE * size_px
    top = at_px[1] - {"m": height / 2, "a": 0.0, "b": height}[anchor[1]]
    for number, line in enumerate(lines):
        x = at_px[0] - (_width(line, size_px) / 2 if anchor[0] == "m" else 0.0)
        # Cap height is 0.73 of a letter's size: so a line's capitals are in its middle.
        baseline = top + (number + 0.5) * _LINE * size_px + 0.36 * size_px
        for font, run in _runs(line, size_px):
            draw.text(
                (x, baseline), run, fill=fill, font=font, anchor="ls",
                stroke_width=1 if halo else 0, stroke_fill=halo,
            )  # fmt: skip
            x += font.getlength(run)


def _width(line: str, size_px: int) -> float:
    return sum(font.getlength(run) for font, run in _runs(line, size_px))


def _runs(line: str, size_px: int) -> Iterator[tuple[Font, str]]:
    """The line from left to right, in pieces of one font each."""
    shown = _from_left(unicodedata.normalize("NFC", line))
    for name, characters in groupby(shown, key=_file_of):
        font = _font(name, size_px)
        run = "".join(c for c in characters if _has(name, c))
        if run:
            yield font, run


def _from_left(line: str) -> str:
    """The line in the order in which it is seen: Hebrew runs from the right, numbers do not.

    The rules of Unicode's UAX 9 that names and measures need.
    """
    if not any(_is_leftward(c) for c in line):
        return line
    kinds = [unicodedata.bidirectional(c) for c in line]
    base = next(kind for kind in kinds if kind in ("L", "R")) == "R"
    strong = [kind if kind in ("L", "R", "EN") else "" for kind in kinds]
    sides = []
    for place, kind in enumerate(strong):
        around = {
            next((k for k in reversed(strong[:place]) if k), ""),
            next((k for k in strong[place:] if k), ""),
        }
        joins = around == {"L"} or (around == {"EN"} and line[place] in ".,:/")
        sides.append(kind == "R" or (not kind and base and not joins))
    runs = [
        (side, "".join(c for _, c in part))
        for side, part in groupby(zip(sides, line, strict=True), key=lambda pair: pair[0])
    ]
    seen = [text[::-1].translate(_MIRRORED) if side else text for side, text in runs]
    return "".join(reversed(seen) if base else seen)


_MIRRORED = str.maketrans("()[]<>", ")(][><")


def _is_leftward(character: str) -> bool:
    return unicodedata.bidirectional(character) == "R"


@lru_cache(4096)
def _file_of(character: str) -> str:
    name = unicodedata.name(character, "")
    return next((file for script, file in _SCRIPTS if name.startswith(script)), _PLAIN)


@lru_cache(64)
def _font(file: str, size_px: int) -> Font:
    folder = _folder()
    if folder is None or not (folder / file).is_file():
        return ImageFont.load_default(size_px)
    layout = ImageFont.Layout.BASIC  # The other one needs a library that not every machine has.
    return ImageFont.truetype(str(folder / file), size_px, layout_engine=layout)


@lru_cache(1)
def _folder() -> Path | None:
    """Blender's fonts. Its module need not be imported for them."""
    spec = importlib.util.find_spec("bpy")
    places = spec.submodule_search_locations if spec else None
    return next((p for place in places or () for p in Path(place).glob("*/datafiles/fonts")), None)


@lru_cache(4096)
def _has(file: str, character: str) -> bool:
    """Whether a font has a character: what it draws is not what it draws for none."""
    if character.isspace():
        return True
    font = _font(file, 24)
    drawn, none = font.getmask(character), font.getmask("\uffff")
    return drawn.size != none.size or bytes(drawn) != bytes(none)
