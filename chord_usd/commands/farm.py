"""farm: stage -> a job for render farms."""

from __future__ import annotations

import argparse
from pathlib import Path

from chord_usd.commands.common import (
    Outcome,
    Verbs,
    add_group,
    add_output_folder,
    add_verb,
    existing_file,
    folder_mode,
    whole_number,
)
from chord_usd.commands.render import add_how, add_what, render_options, words_of


def add(verbs: Verbs) -> None:
    """Adds the verbs."""
    group = add_group(verbs, "farm", "spread the rendering of a stage over many machines")
    parser = add_verb(
        group, "bundle", run_bundle, "write an Open Job Description bundle that renders a stage"
    )
    parser.add_argument("stage", type=Path, metavar="STAGE", help="house.usda")
    add_output_folder(parser, "folder of the bundle")
    parts = parser.add_argument_group("division")
    parts.add_argument(
        "--tiles",
        type=whole_number(1, 1000),
        default=1,
        metavar="N",
        help="bands of each picture (1)",
    )
    parts.add_argument(
        "--sample-blocks", type=whole_number(1, 1000), default=1, metavar="N",
        help="equal shares of the samples (1)",
    )  # fmt: skip
    parts.add_argument("--gpu", action="store_true", help="ask for workers with a GPU")
    add_what(parser)
    add_how(parser)


def run_bundle(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from dataclasses import replace

    from chord_usd.farm.bundle import Work, write_bundle
    from chord_usd.image.render import camera_names
    from chord_usd.image.stage_cameras import stage_files

    stage = existing_file(options.stage)
    wanted = render_options(options)
    # Refuses what no task could render before a farm is asked to.
    replace(wanted, tile=(0, options.tiles), sample_block=(0, options.sample_blocks))
    work = Work(
        stage=stage,
        files=tuple(stage_files(stage)),
        cameras=tuple(camera_names(stage, wanted)),
        words=tuple(words_of(options)),
        tiles=options.tiles,
        blocks=options.sample_blocks,
        gpu=options.gpu,
    )
    files = write_bundle(work, options.output, folder_mode(options))
    tasks = len(work.tasks())
    text = f"{options.output}: {tasks} tasks and a merge. Try: openjd run {files[0]}"
    return Outcome(text, {"template": str(files[0]), "tasks": tasks})
