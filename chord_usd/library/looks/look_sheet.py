"""Contact sheets of wall and floor looks: a piece of each at one scale, in light from aside."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.scene.types import ByteArray
from chord_usd.library.looks.look_wood import Maps
from chord_usd.library.textures.fields import normal_map

if TYPE_CHECKING:
    from PIL import Image

CELL_PX = 300
CELL_M = 2.4
"""What a cell shows: about the height of a wall."""

_CAPTION_PX = 30
_LIGHT = np.array([-0.5, 0.5, 0.7071], dtype=np.float32)
_PAPER = (246, 246, 244)


def draw_looks(cells: Sequence[tuple[str, str, Maps]], *, columns: int = 6) -> Image.Image:
    """A sheet of looks. cells: two lines of caption, and the maps."""
    from PIL import Image, ImageDraw

    columns = min(columns, len(cells))
    tall = CELL_PX + _CAPTION_PX
    rows = -(-len(cells) // columns)
    sheet = Image.new("RGB", (columns * (CELL_PX + 6), rows * tall), _PAPER)
    pen = ImageDraw.Draw(sheet)
    for number, (title, subtitle, maps) in enumerate(cells):
        left, top = number % columns * (CELL_PX + 6), number // columns * tall
        sheet.paste(Image.fromarray(swatch(maps)), (left, top))
        pen.text((left + 2, top + CELL_PX + 2), title, fill=(40, 40, 40))
        pen.text((left + 2, top + CELL_PX + 15), subtitle[:52], fill=(120, 120, 120))
    return sheet


def swatch(maps: Maps, side_px: int = CELL_PX, side_m: float = CELL_M) -> ByteArray:
    """(side_px, side_px, 3) a piece of a look, side_m wide and high, from its lower left corner."""
    from PIL import Image

    normals = 2.0 * normal_map(maps.height_m, maps.ground.tile_m) - 1.0
    light = np.clip(normals @ _LIGHT / _LIGHT[2], 0.0, 1.6)[..., None]
    lit = np.clip(maps.rgb * light, 0, 255).astype(np.uint8)
    across, up = maps.ground.tile_m
    size = (max(1, round(side_px * across / side_m)), max(1, round(side_px * up / side_m)))
    tile = np.asarray(Image.fromarray(lit).resize(size, Image.Resampling.BOX))
    many = np.tile(tile, (side_px // size[1] + 1, side_px // size[0] + 1, 1))
    return np.ascontiguousarray(many[-side_px:, :side_px])
