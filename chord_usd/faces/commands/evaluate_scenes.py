"""evaluate scenes: any layouts -> planning table, certificate and POR, side by side."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.faces.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_verb,
    existing_file,
    stopwatch,
)
from chord_usd.faces.commands.evaluate_options import add_report, reported

if TYPE_CHECKING:
    from chord_usd.base.scene.types import SceneGraph


def add(group: Verbs) -> None:
    """Adds the verb to the verbs of evaluate."""
    parser = add_verb(
        group, "scenes", run, "judge any layouts by planning table, certificate and POR"
    )
    parser.add_argument(
        "sources", type=Path, nargs="+", metavar="SOURCE",
        help="a set each: stages, CHOrD JSON, 3D-FRONT, ATISS, DiffuScene, InstructScene, "
        "PhyScene, ProcTHOR, RoboCasa (YAML) or ThreeDWorld; a file or a folder",
    )  # fmt: skip
    parser.add_argument(
        "--models", type=Path, metavar="JSON",
        help="model_info.json, asset-database.json, dataset_stats.txt or models_core.json",
    )  # fmt: skip
    parser.add_argument(
        "--hide", action="append", default=[], metavar="FACT",
        help="leave a fact out of every set, as others do not say it: doors, windows, walls, "
        "heights, sizes, home (repeatable)",
    )  # fmt: skip
    parser.add_argument(
        "--no-check", action="store_true", help="do not certify stages, which takes seconds each"
    )
    add_report(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.base.metrics.design.unsaid import FACTS
    from chord_usd.workshop.data.foreign import Models, read_models_file
    from chord_usd.workshop.evaluation import scenes

    for fact in options.hide:
        if fact not in FACTS:
            raise UsageError(
                f"there is no fact {fact!r}", where="--hide", expected=", ".join(FACTS)
            )
    for source in options.sources:
        if not source.is_dir():
            existing_file(source)
    models = read_models_file(existing_file(options.models)) if options.models else Models()
    read_stage = partial(_read_stage, certify=not options.no_check)
    watch = stopwatch(options)
    with watch.step("judge") as progress:
        parts = []
        judged = scenes.judged_sets(options.sources, models, options.hide, read_stage)
        for part in judged:
            parts.append(part)
            progress(len(parts), len(options.sources))
    warnings = []
    for part in parts:
        why = next(iter(part.skipped.values()), "")
        if not part.scenes:
            raise UsageError("holds no layout", where=part.source, expected=why)
        if part.skipped:
            warnings.append(f"{part.source}: {len(part.skipped)} layouts could not be read: {why}")
    data = {"sets": [scenes.as_data(part) for part in parts], "seconds": watch.seconds}
    return reported(options, scenes.as_markdown(parts), data, {}, warnings)


def _read_stage(path: Path, *, certify: bool) -> tuple[Sequence[SceneGraph], bool | None]:
    from chord_usd.base.runtime.stages import open_stage
    from chord_usd.line.stage.check.check_scene import read_storeys
    from chord_usd.line.stage.check.check_stage import check_stage

    graphs = [scene.graph for scene in read_storeys(open_stage(path))]
    return graphs, check_stage(path).holds if certify else None
