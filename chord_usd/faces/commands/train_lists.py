"""train lists, train boxes: what is in a room, as a list and as boxes denoised."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from chord_usd.base.runtime.counting import counted
from chord_usd.faces.commands.common import Outcome, UsageError, Verbs, add_verb, stopwatch
from chord_usd.faces.commands.train_options import (
    add_flats,
    add_furnished,
    add_houses,
    add_loop_options,
    add_processor_time,
    add_training_options,
    furnished_of,
    run_of,
    unseen_of,
)

if TYPE_CHECKING:
    from chord_usd.base.scene.types import SceneGraph
    from chord_usd.workshop.training.lists_trainer import ListTraining, Task

_MOST_UNSEEN = 500
"""Held-out rooms that a card's score is of."""


def add(group: Verbs) -> None:
    """Adds the verbs to train."""
    lists = add_verb(
        group, "lists", run_lists, "train the model that writes down what is in a room or on a top"
    )
    add_training_options(lists, minutes=60.0, batch=None)
    lists.add_argument(
        "--of",
        choices=("pieces", "things"),
        default="pieces",
        help="pieces of a room, or things on tables, desks and worktops (pieces)",
    )
    add_flats(lists)
    add_loop_options(lists)
    add_processor_time(lists)
    add_houses(lists)
    add_furnished(lists)
    boxes = add_verb(
        group, "boxes", run_boxes, "train a diffusion of boxes, the baseline beside the lists"
    )
    add_training_options(boxes, minutes=60.0, batch=None)
    add_flats(boxes)
    add_processor_time(boxes)
    add_houses(boxes)
    add_furnished(boxes)


def run_lists(options: argparse.Namespace) -> Outcome:
    """Runs train lists."""
    from chord_usd.workshop.training.lists_trainer import train_lists

    if options.of == "things" and (options.houses or options.furnished):
        raise UsageError(
            "things stand in no houses", where="--houses, --furnished", expected="--of pieces"
        )
    furnished = furnished_of(options)
    config = _list_training(options, len(furnished))
    is_of_things = options.of == "things"
    task = _things(config.batch) if is_of_things else _pieces(options, config.batch, furnished)
    with stopwatch(options).step("train") as progress:
        facts = train_lists(config, options.output, task, progress, options.start)
    data = {"checkpoint": str(options.output / "checkpoint"), **facts}
    return Outcome(f"{data['checkpoint']}: {counted(facts['steps'], 'step')}", data)


def run_boxes(options: argparse.Namespace) -> Outcome:
    """Runs train boxes."""
    from chord_usd.workshop.training.boxes_trainer import train_boxes

    furnished = furnished_of(options)
    config = _list_training(options, len(furnished))
    task = _pieces(options, config.batch, furnished)
    with stopwatch(options).step("train") as progress:
        facts = train_boxes(config, options.output, task.batches, task.held_out, progress)
    data = {"checkpoint": str(options.output / "checkpoint"), **facts}
    return Outcome(f"{data['checkpoint']}: {counted(facts['steps'], 'step')}", data)


def _list_training(options: argparse.Namespace, furnished: int) -> ListTraining:
    """How lists, and boxes beside them, are trained."""
    from chord_usd.workshop.training.lists_trainer import ListTraining

    return replace(run_of(options, ListTraining()), houses=options.houses, furnished=furnished)


def _pieces(options: argparse.Namespace, batch: int, furnished: Sequence[SceneGraph]) -> Task:
    """To write down what is in a room."""
    from chord_usd.line.lists.pieces import PIECES
    from chord_usd.workshop.data.flats import read_flats
    from chord_usd.workshop.training.lists_data import (
        HOMES_SHARE,
        batch_of,
        endless_batches,
        examples_in,
        held_out,
    )
    from chord_usd.workshop.training.lists_trainer import Task

    flats = read_flats(options.flats, part="train") if options.flats else []
    # A kept set holds homes alone; another's folder is learned as it is.
    is_foreign = options.furnished is not None and options.furnished.is_dir()
    batches = partial(
        endless_batches, flats, batch, procedural=options.houses, furnished=furnished,
        sparse_share=0.0 if is_foreign else 1.0 - HOMES_SHARE,
    )  # fmt: skip
    unseen = examples_in(unseen_of(options)) if furnished else held_out(50)
    return Task(PIECES, batches, batch_of(unseen[:_MOST_UNSEEN]) if unseen else None)


def _things(batch: int) -> Task:
    """To write down what stands on a supporting piece."""
    from chord_usd.line.lists.things import THINGS
    from chord_usd.workshop.training.lists_trainer import Task
    from chord_usd.workshop.training.things_data import batch_of, endless_batches, held_out

    return Task(THINGS, partial(endless_batches, batch), batch_of(held_out(500)))
