"""Everything that one run of generate makes, in a folder to look into, with a contact sheet."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from chord_usd.base.scene.types import ByteArray
    from chord_usd.line.pipeline import House


def write_kept(house: House, folder: Path) -> None:
    """plan, list, first layout, what was read in it, last layout and house, as CHOrD JSON and as
    pictures of the layouts; sheet.png has them side by side."""
    from chord_usd.base.raster.raster_files import write_raster
    from chord_usd.base.scene.chord_json import write_scene
    from chord_usd.line.image.picture_sheet import write_sheet

    first = house.first
    graphs = {"plan": house.plan.scene(), "list": first.listed, "read": first.graph,
              "house": house.graph}  # fmt: skip
    for name, graph in graphs.items():
        if graph is not None:
            write_scene(graph, folder / f"{name}.json")
    for name, image in (("plan", house.plan_image), ("layout_first", first.layout),
                        ("layout", house.layout)):  # fmt: skip
        write_raster(image, folder / f"{name}.png")
    write_sheet(list(_pictures(house)), folder / "sheet.png")


def _pictures(house: House) -> Iterator[tuple[str, ByteArray]]:
    from chord_usd.base.raster.canvas import layout_image
    from chord_usd.line.image.preview import preview_rgb

    first = house.first
    yield "plan", house.plan_image.rgb
    if first.listed is not None:
        yield "list", layout_image(house.plan_image, first.listed.items).rgb
    yield "first layout", first.layout.rgb
    yield "read and arranged", layout_image(house.plan_image, first.graph.items).rgb
    yield "last layout", house.layout.rgb
    yield "house", preview_rgb(house.graph)
