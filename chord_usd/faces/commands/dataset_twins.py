"""dataset twins: sound houses -> the same houses, each with one fault that is known."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.files import output_folder
from chord_usd.faces.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_output_folder,
    add_verb,
    folder_mode,
    stopwatch,
    whole_number,
)
from chord_usd.faces.commands.house_options import add_options

if TYPE_CHECKING:
    from chord_usd.base.scene.types import SceneGraph


def add(group: Verbs) -> None:
    """Adds the verb to dataset."""
    parser = add_verb(
        group, "twins", run, "write houses again, each with one named fault at a known place"
    )
    parser.add_argument(
        "houses", type=Path, metavar="HOUSES",
        help="folder of houses that generate or batch wrote (stages), or of CHOrD JSON",
    )  # fmt: skip
    parser.add_argument(
        "--count",
        type=whole_number(1, 1_000_000),
        metavar="N",
        help="no further house once there are N pairs",
    )
    add_output_folder(parser, "folder for the pairs; twins.jsonl lists them")
    add_options(parser, "seed")


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb. The twins of a house depend on the seed and its place in the folder only."""
    from chord_usd.workshop.data import twins

    rows, houses = [], 0
    watch = stopwatch(options)
    with (
        output_folder(options.output, folder_mode(options)) as folder,
        watch.step("twins") as progress,
    ):
        for number, (name, graph, stage) in enumerate(_houses(options.houses)):
            # The folder is put in its place at the end: layers point from there.
            seen = os.path.relpath(stage, options.output.resolve()) if stage else ""
            rows += twins.write_twins(name, graph, seen, folder, (options.seed, number))
            houses += 1
            progress(len(rows), options.count or len(rows))
            if options.count and len(rows) >= options.count:
                break
        if not rows:
            raise UsageError(
                "holds no house in which a fault has a place", where=str(options.houses),
                expected="furnished houses: stages, or CHOrD JSON",
            )  # fmt: skip
        twins.write_manifest(rows, folder)
    table = twins.shares(rows)
    lines = [
        f"  {row['fault']} ({'named' if row['named_by_a_rule'] else 'unnamed'}): {row['judge']} "
        f"finds {row['found']} of {row['pairs']}, {row['at_its_place']} at their place"
        for row in table
    ]
    text = f"{options.output}: {counted(len(rows), 'pair')} from {counted(houses, 'house')}"
    data = {
        "folder": str(options.output), "pairs": len(rows), "houses": houses, "shares": table,
        "seconds": watch.seconds,
    }  # fmt: skip
    return Outcome("\n".join([text, *lines]), data)


def _houses(folder: Path) -> Iterator[tuple[str, SceneGraph, Path | None]]:
    """Houses with the stages that they come from; those of several storeys are passed over."""
    from chord_usd.base.runtime.stages import open_stage
    from chord_usd.line.stage.check.check_scene import read_storeys
    from chord_usd.workshop.data.foreign import Models, foreign_houses, stages_in

    if not folder.is_dir():
        raise UsageError("no such folder", where=str(folder), expected="a folder of houses")
    stages = stages_in(folder)
    for name, path in stages:
        storeys = read_storeys(open_stage(path))
        if len(storeys) == 1:
            yield name, storeys[0].graph, path.resolve()
    if not stages:
        for name, house, _ in foreign_houses(folder, Models()):
            if house is not None:
                yield name, house, None
