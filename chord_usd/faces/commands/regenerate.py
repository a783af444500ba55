"""regenerate: stage -> stage, one room furnished again."""

from __future__ import annotations

import argparse
from pathlib import Path

from chord_usd.base.runtime.alone import alone_with
from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.files import deliver
from chord_usd.base.runtime.inputs import STAGE_SUFFIXES
from chord_usd.base.scene.styles import MIXED, STYLES
from chord_usd.faces.commands.certified import certified, holds, reported
from chord_usd.faces.commands.common import (
    Outcome,
    Verbs,
    add_verb,
    add_view,
    existing_file,
    stopwatch,
)
from chord_usd.faces.commands.house_options import add_options, settings_of
from chord_usd.faces.commands.paths import in_place_of, output_file, with_suffixes


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(
        verbs, "regenerate", run, "furnish one room of a stage again and leave the rest as it is"
    )
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda or house.usdz")
    parser.add_argument(
        "--room",
        required=True,
        metavar="NAME",
        help="such as 'Bedroom 1', or its prim's name, such as Bedroom_0",
    )
    parser.add_argument(
        "--keep", action="append", default=[], metavar="NAME",
        help="furniture or dressing that stays, such as Bed_0; may be given several times",
    )  # fmt: skip
    parser.add_argument(
        "--with", dest="wanted", action="append", metavar="PIECES",
        help='pieces of the room, such as "desk, two chairs"',
    )  # fmt: skip
    parser.add_argument(
        "--without",
        action="append",
        metavar="PIECES",
        help="pieces to leave out, such as sofa",
    )
    parser.add_argument(
        "--edits", type=Path, metavar="LAYER",
        help="a layer over STAGE that moves things: the room is furnished as it is seen there",
    )  # fmt: skip
    target = parser.add_argument(
        "-o", "--output", type=output_file, metavar="PATH", help="the new stage (STAGE itself)"
    )
    in_place_of(target, "STAGE")
    with_suffixes(target, STAGE_SUFFIXES)
    add_options(
        parser, "steps", "lists", "arrange", "tabletop", "dressing", "asset_folders", "device",
        unset=("seed", "style"),
        seed="(one more than the last seed of the room)",
        style=f"{', '.join(STYLES)} or {MIXED} (that of the stage)",
    )  # fmt: skip
    parser.add_argument(
        "--layout-out", type=output_file, metavar="PNG", help="also write the layout"
    )
    parser.add_argument(
        "--graph-out", type=output_file, metavar="JSON", help="also write the scene graph"
    )
    add_view(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb. All outputs appear together, at the end."""
    from chord_usd.base.raster.raster_files import write_raster
    from chord_usd.base.scene.chord_json import write_scene
    from chord_usd.line.arrange.rules import edits_told
    from chord_usd.line.lists.wishes import read_pieces
    from chord_usd.line.pipeline.one_room import regenerate, write_regenerated

    source = existing_file(options.stage)
    edits = existing_file(options.edits) if options.edits else None
    target = options.output or source
    settings = settings_of(options)
    wishes = read_pieces(
        *(lines and "\n".join(lines) for lines in (options.wanted, options.without))
    )
    watch = stopwatch(options)
    with alone_with(source), deliver() as delivery:
        layout_out = delivery.place(options.layout_out) if options.layout_out else None
        graph_out = delivery.place(options.graph_out) if options.graph_out else None
        made = regenerate(
            source, options.room, settings, watch, options.seed,
            keep=options.keep, edits=edits, wishes=wishes,
        )  # fmt: skip
        if layout_out:
            write_raster(made.layout, layout_out)
        if graph_out:
            write_scene(made.graph, graph_out)
        with watch.step("stage"):
            write_regenerated(made, target)
        if options.view:
            from chord_usd.line.stage.export.gltf import write_view

            with watch.step("view"):
                write_view(target, delivery.place(options.view))
    check = certified(target, watch)
    pieces = list(made.graph.items_of(made.room.id))
    new_ids = {piece.id for piece in made.new_items}
    furniture = len(pieces)
    seed = made.layout.provenance.seed
    data = {
        "stage": str(target),
        "room": made.room_name,
        "seed": seed,
        "style": made.style,
        "furniture": furniture,
        "items": furniture + sum(len(piece.children) for piece in pieces),
        "dressing": sum(1 for _ in made.graph.dressing_of(made.room.id)),
        "kept": list(made.kept),
        "edits": [edit for edit in edits_told(made.graph) if edit["item"] in new_ids],
        "seconds": watch.seconds,
        "certificate": check,
    }
    made_told = (
        f"{target}: {counted(len(made.new_items), 'new piece')} in {made.room_name}, seed {seed}"
    )
    return Outcome(reported(check, made_told), data, holds(check))
