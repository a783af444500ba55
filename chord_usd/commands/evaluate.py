"""evaluate: checkpoints and held-out plans -> scores."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.commands.common import (
    Outcome,
    Verbs,
    add_device,
    add_group,
    add_seed,
    add_verb,
    stopwatch,
    whole_number,
)
from chord_usd.files import write_atomic

if TYPE_CHECKING:
    from chord_usd.types import Plan


def add(verbs: Verbs) -> None:
    """Adds the verbs."""
    group = add_group(verbs, "evaluate", "score checkpoints on held-out data")
    layouts = add_verb(
        group, "layouts", run_layouts, "score the layout model's raw output, nothing repaired"
    )
    layouts.add_argument(
        "--plans", type=whole_number(1), default=100, metavar="N", help="held-out plans (100)"
    )
    layouts.add_argument(
        "--flats", type=Path, metavar="JSONL", help="the held-out ones of these real floor plans"
    )
    layouts.add_argument(
        "--steps", type=whole_number(1), metavar="N", help="sampler steps (the checkpoint's own)"
    )
    layouts.add_argument(
        "--checkpoint", type=Path, metavar="DIR", help="instead of the shipped plan2layout"
    )
    layouts.add_argument(
        "--unshaded", action="store_true", help="plans that do not tell the kind of a room"
    )
    layouts.add_argument(
        "--furnisher", action="store_true", help="score the training data's furnisher instead"
    )
    layouts.add_argument("-o", "--output", type=Path, metavar="MD", help="also write the table")
    add_seed(layouts)
    add_device(layouts)


def _held_out(options: argparse.Namespace) -> tuple[list[Plan], list[str]]:
    """Plans that no training has seen, and their names."""
    from chord_usd.data.flats import read_flats
    from chord_usd.data.splits import TEST_SEED
    from chord_usd.evaluation.layouts import held_out_plans

    if options.flats:
        flats = read_flats(options.flats, part="test")[: options.plans]
        return flats, [str(flat.extra["source"]) for flat in flats]
    names = [f"procedural/{TEST_SEED + index}" for index in range(options.plans)]
    return held_out_plans(options.plans), names


def run_layouts(options: argparse.Namespace) -> Outcome:
    """Runs evaluate layouts."""
    from chord_usd.evaluation import layouts
    from chord_usd.layout.sample import LayoutModel
    from chord_usd.locations import checkpoint_folder

    watch = stopwatch(options)
    with watch.step("plans"):
        plans, ids = _held_out(options)
    if options.furnisher:
        with watch.step("layout"):
            scenes = layouts.procedural_scenes(plans, options.seed)
        name, steps = "furnisher", 0
    else:
        folder = options.checkpoint or checkpoint_folder("plan2layout")
        model = LayoutModel.load(folder, options.device)
        name = model.checkpoint.content_hash
        steps = options.steps or model.config.default_steps
        with watch.step("layout") as progress:
            scenes = list(
                layouts.sampled_scenes(
                    model,
                    plans,
                    shaded=not options.unshaded,
                    seed=options.seed,
                    steps=steps,
                    progress=progress,
                )
            )
    with watch.step("score"):
        scores = layouts.score_layouts(scenes, ids, name, steps)
    table = layouts.as_markdown(scores)
    if options.output:
        write_atomic(options.output, table)
    return Outcome(table.rstrip(), {**asdict(scores), "seconds": watch.seconds})
