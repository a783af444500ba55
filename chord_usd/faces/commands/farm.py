"""farm: stage -> a job for render farms."""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from chord_usd import __version__
from chord_usd.base.runtime.counting import counted
from chord_usd.faces.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_group,
    add_output_folder,
    add_verb,
    existing_file,
    folder_mode,
    frames,
    names,
    whole_number,
)
from chord_usd.faces.commands.paths import optional_input
from chord_usd.faces.commands.render import (
    add_how,
    add_what,
    name_rooms,
    named_files,
    parsed,
    picture_options,
    render_options,
    words_of,
)


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
    parts.add_argument(
        "--per-task", type=whole_number(1, 10_000), default=1, metavar="N",
        help="cameras or frames of a task, which share one import of the stage (1)",
    )  # fmt: skip
    parts.add_argument(
        "--gpu",
        action="store_true",
        help="ask for workers with a GPU, and fail without",
    )
    parts.add_argument(
        "--timeout", type=whole_number(1, 10_080), default=1440, metavar="MINUTES",
        help="end a task that takes longer (1440)",
    )  # fmt: skip
    add_what(parser)
    add_how(parser)
    due = add_verb(group, "due", run_due, "list the tasks of a bundle that are not finished")
    due.add_argument("job", type=Path, metavar="JOB", help="folder of a bundle")
    due.add_argument(
        "-o",
        "--output",
        type=optional_input,
        required=True,
        metavar="PATH",
        help="folder of its pictures",
    )


def run_bundle(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from dataclasses import replace

    from chord_usd.base.runtime.stages import files_of
    from chord_usd.faces.farm.bundle import Work, write_bundle
    from chord_usd.line.image.made import require_files
    from chord_usd.line.image.render import camera_names

    stage = existing_file(options.stage)
    _ask_for_gpu(options)
    name_rooms(options)
    wanted = render_options(options)
    # Refuses what no task could render before a farm is asked to.
    replace(wanted, tile=(0, options.tiles), sample_block=(0, options.sample_blocks))
    files = files_of(stage)
    require_files(stage, files)
    words, extra = _portable_words(options)
    work = Work(
        stage=stage,
        files=files,
        cameras=tuple(camera_names(stage, wanted)),
        words=tuple(words),
        tiles=options.tiles,
        blocks=options.sample_blocks,
        frames=bool(wanted.walkthrough or wanted.turntable),
        each=options.per_task,
        gpu=options.gpu,
        lists_all="instance" in options.passes,
        timeout_s=60 * options.timeout,
        extra=extra,
    )
    written = write_bundle(work, options.output, folder_mode(options))
    tasks = len(work.tasks())
    last = " and a merge" if work.has_last_step else ""
    text = f"{options.output}: {counted(tasks, 'task')}{last}. Try: openjd run {written[0]}"
    return Outcome(text, {"template": str(written[0]), "tasks": tasks})


def _ask_for_gpu(options: argparse.Namespace) -> None:
    """--device auto would take the CPU of a worker without a GPU. Raises UsageError."""
    if options.gpu and options.device == "cpu":
        raise UsageError("contradicts --gpu", where="--device cpu", try_="--device gpu")
    if options.gpu and options.device == "auto":
        options.device = "gpu"


def _portable_words(options: argparse.Namespace) -> tuple[list[str], tuple[Path, ...]]:
    """Words for every task, and the files that they name, which the bundle takes along."""
    from chord_usd.faces.farm.bundle import place_of

    named = named_files(options)
    places = {name: place_of(file) for name, file in named.items()}
    words = words_of(argparse.Namespace(**{**vars(options), **places}))
    return [*words, "--require-version", __version__], tuple(named.values())


def run_due(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from dataclasses import replace

    from chord_usd.faces.farm.bundle import CAMERA, FRAME, SCENE_FOLDER, tasks_of
    from chord_usd.line.image.job import Part
    from chord_usd.line.image.render import camera_names, unfinished

    words, tasks = tasks_of(options.job)
    values = {"Param.Scene": options.job / SCENE_FOLDER, "Param.OutputDir": options.output}
    if not tasks:
        return Outcome(None, {"due": 0, "tasks": 0})
    asked = parsed(_filled(words, {**values, **_of_task(tasks[0])}))
    wanted = replace(picture_options(asked), frame=None, cameras=())
    every = camera_names(asked.stage, wanted)
    division = wanted.part

    def part_of(task: dict[str, Any]) -> Part | None:
        if division is None:
            return None
        tiles, blocks = division.tile[1], division.block[1]
        return Part((task["Tile"], tiles), (task["Block"], blocks))

    def pictures_of(task: dict[str, Any]) -> set[tuple[str, Part | None]]:
        if FRAME in task:
            first, last = frames(task[FRAME])
            seen: Sequence[str] = every[first : last + 1]
        else:
            seen = names(task[CAMERA])
        return {(camera, part_of(task)) for camera in seen}

    pictures = [pictures_of(task) for task in tasks]
    cameras = tuple({camera: None for shown in pictures for camera, _ in shown})
    parts = list(dict.fromkeys(map(part_of, tasks)))
    left = set(unfinished(asked.stage, options.output, replace(wanted, cameras=cameras), parts))
    due = [json.dumps(task) for task, shown in zip(tasks, pictures, strict=True) if shown & left]
    return Outcome("\n".join(due) or None, {"due": len(due), "tasks": len(tasks)})


def _of_task(task: dict[str, Any]) -> dict[str, Any]:
    return {f"Task.Param.{name}": value for name, value in task.items()}


def _filled(words: Sequence[str], values: Mapping[str, Any]) -> list[str]:
    """Words with the values of what they name in double braces."""
    return [
        re.sub(r"\{\{([\w.]+)\}\}", lambda match: str(values.get(match[1], match[0])), word)
        for word in words
    ]
