"""Everything that one run of generate makes, in a folder to look into, with a contact sheet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from chord_usd.base.scene.types import ByteArray
    from chord_usd.line.pipeline.whole_house import FurnishedStorey


def write_kept(storeys: Sequence[FurnishedStorey], folder: Path) -> None:
    """What every step made of each storey: of several, in a folder of its own."""
    for made in storeys:
        target = folder / f"storey_{made.storey.index}" if len(storeys) > 1 else folder
        target.mkdir(exist_ok=True)
        _write_storey(made, target)


def _write_storey(made: FurnishedStorey, folder: Path) -> None:
    """plan, list, first layout, what was read in it, last layout and house, as CHOrD JSON and as
    pictures of the layouts; sheet.png has them side by side."""
    from chord_usd.base.raster.raster_files import write_raster
    from chord_usd.base.scene.chord_json import write_scene
    from chord_usd.line.image.picture_sheet import write_sheet

    graphs = {"plan": made.plan.scene(), "list": made.listed, "read": made.first_graph,
              "house": made.graph}  # fmt: skip
    for name, graph in graphs.items():
        if graph is not None:
            write_scene(graph, folder / f"{name}.json")
    for name, image in (("plan", made.plan_image), ("layout_first", made.first_layout),
                        ("layout", made.layout)):  # fmt: skip
        write_raster(image, folder / f"{name}.png")
    write_sheet(list(_pictures(made)), folder / "sheet.png")


def _pictures(made: FurnishedStorey) -> Iterator[tuple[str, ByteArray]]:
    from chord_usd.base.raster.canvas import layout_image
    from chord_usd.line.image.preview import preview_rgb

    yield "plan", made.plan_image.rgb
    if made.listed is not None:
        yield "list", layout_image(made.plan_image, made.listed.items).rgb
    yield "first layout", made.first_layout.rgb
    yield "read and arranged", layout_image(made.plan_image, made.first_graph.items).rgb
    yield "last layout", made.layout.rgb
    yield "house", preview_rgb(made.graph)
