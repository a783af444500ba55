"""Everything that one run of generate makes, in a folder to look into, with a contact sheet."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.image.preview import preview_rgb
from chord_usd.raster.canvas import layout_image
from chord_usd.raster.lettering import write_text
from chord_usd.raster.raster_files import write_raster
from chord_usd.scene.chord_json import write_scene
from chord_usd.scene.types import ByteArray

if TYPE_CHECKING:
    from chord_usd.pipeline import House

CELL_PX = 640
"""Side of a picture on the sheet."""
_TITLE_PX, _LETTERS_PX = 36, 20
_COLUMNS = 3


def write_kept(house: House, folder: Path) -> None:
    """plan, list, first layout, what was read in it, last layout and house, as CHOrD JSON and as
    pictures of the layouts; sheet.png has them side by side."""
    first = house.first
    graphs = {"plan": house.plan.scene(), "list": first.listed, "read": first.graph,
              "house": house.graph}  # fmt: skip
    for name, graph in graphs.items():
        if graph is not None:
            write_scene(graph, folder / f"{name}.json")
    write_raster(house.plan_image, folder / "plan.png")
    write_raster(first.layout, folder / "layout_first.png")
    write_raster(house.layout, folder / "layout.png")
    _write_sheet(list(_pictures(house)), folder / "sheet.png")


def _pictures(house: House) -> Iterator[tuple[str, ByteArray]]:
    first = house.first
    yield "plan", house.plan_image.rgb
    if first.listed is not None:
        yield "list", layout_image(house.plan_image, first.listed.items).rgb
    yield "first layout", first.layout.rgb
    yield "read and arranged", layout_image(house.plan_image, first.graph.items).rgb
    yield "last layout", house.layout.rgb
    yield "house", preview_rgb(house.graph)


def _write_sheet(pictures: list[tuple[str, ByteArray]], path: Path) -> None:
    from PIL import Image, ImageDraw

    rows = -(-len(pictures) // _COLUMNS)
    size = (_COLUMNS * CELL_PX, rows * (CELL_PX + _TITLE_PX))
    sheet = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(sheet)
    for index, (title, rgb) in enumerate(pictures):
        left, top = index % _COLUMNS * CELL_PX, index // _COLUMNS * (CELL_PX + _TITLE_PX)
        picture = Image.fromarray(np.ascontiguousarray(rgb))
        scale = (CELL_PX - 8) / max(picture.size)
        filtered = Image.Resampling.LANCZOS if scale < 1.0 else Image.Resampling.NEAREST
        shown = picture.resize(
            (round(picture.width * scale), round(picture.height * scale)), filtered
        )
        write_text(draw, (left + 8, top + 6), title, _LETTERS_PX, anchor="la")
        sheet.paste(shown, (left + 4, top + _TITLE_PX))
    sheet.save(path)
