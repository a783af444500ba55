"""stage: scene graph -> USD stage."""

from __future__ import annotations

import argparse
from pathlib import Path

from chord_usd.base.runtime.counting import counted_rooms
from chord_usd.base.runtime.files import deliver
from chord_usd.base.runtime.house_history import Deed, recorded
from chord_usd.base.scene.styles import MIXED, STYLES
from chord_usd.faces.commands.certified import add_check, certified, holds, reported
from chord_usd.faces.commands.common import (
    Outcome,
    Verbs,
    add_stage_output,
    add_verb,
    existing_file,
    stopwatch,
)
from chord_usd.faces.commands.house_options import add_options, settings_of


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "stage", run, "write a scene graph as a USD stage")
    parser.add_argument("scene", type=Path, metavar="SCENE", help="scene graph, CHOrD JSON")
    add_stage_output(parser)
    add_options(
        parser, "seed", "texture_px", "articulation", "arrange", "sky", "state", "roof",
        "asset_folders",
        unset=("style",),
        style=f"{', '.join(STYLES)} or {MIXED} (that of the scene, else one of them by the seed)",
    )  # fmt: skip
    add_check(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.base.scene.estimates import of_stage
    from chord_usd.line.arrange.rules import edits_told
    from chord_usd.line.pipeline import read_scene_file, require, settle, write_stage

    settings = settings_of(options)
    require(settings)
    scene_file = existing_file(options.scene)
    watch = stopwatch(options)
    with recorded(options.output, Deed("stage", scene_file.name)), deliver() as delivery:
        target = delivery.place(options.output)
        with watch.step("load"):
            graph = read_scene_file(scene_file, settings)
            estimate = of_stage(graph)
            estimate.require_memory(str(scene_file))
            watch.announce(estimate.said())
        with watch.step("stage"):
            graph = settle(graph, settings)
            stage = write_stage(graph, target, settings)
        check = None if options.no_check else certified(target, watch)
    data = {
        "stage": str(options.output),
        "style": graph.style,
        "rooms": len(graph.rooms),
        "furniture": len(graph.items),
        "dressing": len(graph.dressing),
        "edits": edits_told(graph),
        "content_hash": stage.content_hash,
        "seconds": watch.seconds,
        "certificate": check,
    }
    made = f"{options.output}: {counted_rooms(data)}"
    return Outcome(reported(check, made), data, holds(check))
