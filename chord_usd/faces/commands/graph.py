"""graph: layout raster -> scene graph, the detector."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.errors import SceneError
from chord_usd.base.runtime.counting import counted, counted_rooms
from chord_usd.base.runtime.files import deliver
from chord_usd.base.scene.limits import LARGEST_HOUSE_M
from chord_usd.faces.commands.common import (
    Outcome,
    Verbs,
    add_output,
    add_verb,
    existing_file,
    stopwatch,
)
from chord_usd.faces.commands.house_options import add_options, settings_of

if TYPE_CHECKING:
    from chord_usd.base.scene.types import Room


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "graph", run, "read a layout raster into a scene graph (CHOrD JSON)")
    parser.add_argument("layout", type=Path, metavar="LAYOUT", help="layout raster, layout.png")
    add_output(parser, "the scene graph, scene.json", suffixes=(".json",))
    add_options(parser, "arrange", "asset_folders", m_per_px="for pictures without a note of it")


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.base.raster.raster_files import read_layout
    from chord_usd.base.scene.chord_json import write_scene
    from chord_usd.line.arrange.rules import edits_told
    from chord_usd.line.pipeline import load_reader

    settings = settings_of(options)
    watch = stopwatch(options)
    layout = read_layout(existing_file(options.layout), options.m_per_px)
    with deliver() as delivery:
        target = delivery.place(options.output)
        with watch.step("load"):
            reader = load_reader(settings)
        with watch.step("graph"):
            graph = reader.read(layout)
        _refuse_sprawl(graph.rooms, options)
        write_scene(graph, target)
    data = {
        "graph": str(options.output),
        "rooms": len(graph.rooms),
        "furniture": len(graph.items),
        "openings": len(graph.openings),
        "edits": edits_told(graph),
        "seconds": watch.seconds,
    }
    return Outcome(
        f"{options.output}: {counted_rooms(data)}, {counted(len(graph.openings), 'opening')}",
        data,
    )


def _refuse_sprawl(rooms: Iterable[Room], options: argparse.Namespace) -> None:
    """Refuse what no later step would read, since the scale is wrong."""
    from chord_usd.base.scene.geometry import extent_m

    across_m = extent_m(rooms)
    if across_m > LARGEST_HOUSE_M:
        raise SceneError(
            f"the house would be {across_m:,.0f} m across",
            where=str(options.layout),
            expected=f"at most {LARGEST_HOUSE_M:.0f} m",
            try_="a smaller --scale",
        )
