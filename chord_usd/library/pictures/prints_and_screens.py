"""What is printed on things or shines on their screens, drawn by code."""

from __future__ import annotations

from functools import cache

import numpy as np
from PIL import Image, ImageDraw

from chord_usd.library.kit.forms import rng_of
from chord_usd.library.pictures import art, art_nature
from chord_usd.library.surfaces.drawn import DrawnFinishes
from chord_usd.library.surfaces.finishes import Finish, finish_table

_ICONS = (
    (214, 92, 74),
    (236, 178, 76),
    (96, 150, 110),
    (84, 132, 184),
    (150, 110, 170),
    (230, 226, 218),
)


def _finish(image: Image.Image, roughness: float, glow: float = 0.0) -> Finish:
    mean = np.asarray(image, dtype=np.float64).reshape(-1, 3).mean(axis=0)
    red, green, blue = (int(value) for value in mean)
    return Finish((red, green, blue), roughness, glow=glow, texture=image)


def _window(pen: ImageDraw.ImageDraw, box: tuple[int, int, int, int], dark: bool) -> None:
    """A window with a side bar and lines of text."""
    ground, line = ((40, 43, 50), (150, 156, 166)) if dark else ((246, 246, 244), (150, 154, 160))
    left, top, right, bottom = box
    pen.rounded_rectangle(box, 7, fill=ground)
    for index, tone in enumerate(((222, 100, 88), (226, 180, 84), (112, 176, 104))):
        pen.ellipse((left + 8 + 11 * index, top + 6, left + 14 + 11 * index, top + 12), fill=tone)
    side = left + (right - left) // 4
    pen.rectangle(
        (left + 2, top + 18, side, bottom - 6), fill=tuple(max(c - 12, 0) for c in ground)
    )
    rng = rng_of(f"window/{box}")
    for row, y in enumerate(range(top + 26, bottom - 10, 9)):
        wide = float(rng.uniform(0.35, 0.95)) * (right - side - 24)
        tone = (96, 138, 190) if row % 7 == 0 else line
        pen.rectangle((side + 10, y, side + 10 + wide, y + 3), fill=tone)
        if y < bottom - 60:
            pen.rectangle((left + 10, y, left + 10 + 0.6 * (side - left - 20), y + 3), fill=line)


@cache
def desktop_screen() -> Finish:
    """Mountains behind two windows and a row of icons."""
    size = (512, 288)
    image = art_nature.mountains(rng_of("desktop"), size)
    pen = ImageDraw.Draw(image)
    _window(pen, (44, 34, 300, 220), dark=False)
    _window(pen, (236, 78, 470, 236), dark=True)
    pen.rounded_rectangle((150, 262, 362, 283), 6, fill=(226, 226, 228))
    for index in range(8):
        left = 160 + 25 * index
        pen.rounded_rectangle((left, 265, left + 15, 280), 4, fill=_ICONS[index % 6])
    return _finish(image, 0.15, 0.1)


@cache
def laptop_screen() -> Finish:
    """One wide document."""
    image = art.colour_field(rng_of("laptop"), (512, 320), art.PALE)
    pen = ImageDraw.Draw(image)
    _window(pen, (60, 30, 452, 270), dark=False)
    pen.rounded_rectangle((130, 292, 382, 314), 6, fill=(226, 226, 228))
    for index in range(9):
        left = 142 + 26 * index
        pen.rounded_rectangle((left, 295, left + 16, 311), 4, fill=_ICONS[(index + 2) % 6])
    return _finish(image, 0.15, 0.1)


def _home(size: tuple[int, int], columns: int, rows: int, name: str) -> Image.Image:
    """Icons over a soft picture; the foot of the picture is the foot of the device."""
    image = art_nature.mountains(rng_of(name), size, art.PALE)
    pen = ImageDraw.Draw(image)
    width, height = size
    step, side = width / columns, width / columns * 0.56
    for row in range(rows):
        for column in range(columns):
            if row == rows - 2 and column > 1:
                continue
            left = step * (column + 0.5) - side / 2
            top = height * 0.1 + row * step * 1.12 if row < rows - 1 else height - step * 1.05
            pen.rounded_rectangle(
                (left, top, left + side, top + side),
                side * 0.24,
                fill=_ICONS[(3 * row + column) % 6],
            )
    return image


@cache
def phone_screen() -> Finish:
    """A phone's first page."""
    return _finish(_home((200, 400), 4, 6, "phone"), 0.12, 0.06)


@cache
def tablet_screen() -> Finish:
    """A tablet's first page."""
    return _finish(_home((280, 400), 5, 5, "tablet"), 0.12, 0.06)


@cache
def photo(name: str, wide: bool) -> Finish:
    """A picture for a small frame."""
    draw = {
        "sea": art_nature.sea,
        "hills": art_nature.mountains,
        "fern": art_nature.fronds,
        "face": art.line_face,
    }[name]
    return _finish(draw(rng_of(f"photo/{name}"), (320, 230) if wide else (230, 320)), 0.4)


@cache
def cover() -> Finish:
    """A magazine: a title's bar, a still life, lines of text."""
    image = art_nature.still_life(rng_of("magazine"), (360, 480), art.EARTH)
    pen = ImageDraw.Draw(image)
    for index, wide in enumerate((34, 28, 40, 30, 36, 26)):
        left = 30 + 51 * index
        pen.rectangle((left, 28, left + wide, 74), fill=(52, 48, 46))
        pen.rectangle((left + 9, 40, left + wide - 9, 62), fill=art.EARTH[0])
    for row in range(5):
        pen.rectangle(
            (30, 116 + 15 * row, 30 + (110, 84, 0, 120, 96)[row], 121 + 15 * row), fill=(92, 84, 78)
        )
    for bar in range(18):
        pen.rectangle((300 + 2 * bar, 440, 300 + 2 * bar + bar % 2, 464), fill=(30, 30, 30))
    return _finish(image, 0.3)


PRINTED = DrawnFinishes(
    finish_table("dry"),
    {
        "desktop_screen": desktop_screen,
        "laptop_screen": laptop_screen,
        "phone_screen": phone_screen,
        "tablet_screen": tablet_screen,
        "magazine_cover": cover,
        "photo_sea": lambda: photo("sea", True),
        "photo_hills": lambda: photo("hills", True),
        "photo_fern": lambda: photo("fern", False),
        "photo_face": lambda: photo("face", False),
    },
)
"""All finishes of dry rooms, and what is printed."""
