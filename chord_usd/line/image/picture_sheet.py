"""Pictures side by side, each with its title."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from chord_usd.base.raster.lettering import write_text
from chord_usd.base.scene.types import ByteArray

CELL_PX = 640
"""Side of a picture on the sheet."""
_TITLE_PX, _LETTERS_PX, _MARGIN_PX = 36, 20, 4
_COLUMNS = 3


def write_sheet(pictures: Sequence[tuple[str, ByteArray]], path: Path) -> None:
    """Titles with (H, W, 3) pictures, three in a row, each as large as its cell."""
    rows = -(-len(pictures) // _COLUMNS)
    sheet = Image.new("RGB", (_COLUMNS * CELL_PX, rows * (CELL_PX + _TITLE_PX)), "white")
    draw = ImageDraw.Draw(sheet)
    for index, (title, rgb) in enumerate(pictures):
        left, top = index % _COLUMNS * CELL_PX, index // _COLUMNS * (CELL_PX + _TITLE_PX)
        write_text(draw, (left + 8, top + 6), title, _LETTERS_PX, anchor="la")
        sheet.paste(_fitted(rgb), (left + _MARGIN_PX, top + _TITLE_PX))
    sheet.save(path)


def _fitted(rgb: ByteArray) -> Image.Image:
    picture = Image.fromarray(np.ascontiguousarray(rgb))
    scale = (CELL_PX - 2 * _MARGIN_PX) / max(picture.size)
    filtered = Image.Resampling.LANCZOS if scale < 1.0 else Image.Resampling.NEAREST
    return picture.resize((round(picture.width * scale), round(picture.height * scale)), filtered)
