"""evaluate text, evaluate outlines: held-out wishes and open plans -> planned floors -> scores."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

from chord_usd.base.runtime.counting import counted
from chord_usd.faces.commands.common import (
    Outcome,
    Parser,
    Verbs,
    add_verb,
    stopwatch,
    whole_number,
)
from chord_usd.faces.commands.evaluate_options import (
    add_checkpoint,
    add_records,
    add_report,
    load_layout_model,
    reported,
)
from chord_usd.faces.commands.house_options import add_options

if TYPE_CHECKING:
    from chord_usd.base.metrics.scores import Score
    from chord_usd.line.pipeline.planner import Planned
    from chord_usd.line.planning.choose import Candidate
    from chord_usd.workshop.evaluation.floors import FloorCase, Pairs

SHEET_ROWS = 6
SEEDS = 4
"""Floors of one wish, of as many seeds, on the sheet and for diversity."""


def add(group: Verbs) -> None:
    """Adds the verbs to evaluate."""
    text = add_verb(group, "text", run_text, "score floors planned from held-out texts")
    _add_options(text, "texts", "text2plan")
    outlines = add_verb(group, "outlines", run_outlines, "score rooms planned in open plans")
    _add_options(outlines, "open plans of held-out houses", "outline2plan")


def _add_options(parser: Parser, what: str, checkpoint: str) -> None:
    parser.add_argument(
        "--n",
        dest="cases",
        type=whole_number(1, 1_000_000),
        default=500,
        metavar="N",
        help=f"{what} (500)",
    )
    add_records(parser)
    add_checkpoint(parser, checkpoint)
    add_options(parser, "steps")
    add_report(parser)


def run_text(options: argparse.Namespace) -> Outcome:
    """Runs evaluate text."""
    from chord_usd.base.runtime.locations import checkpoint_folder
    from chord_usd.line.pipeline import Settings
    from chord_usd.line.pipeline.planner import (
        TEXT_CHECKPOINT,
        carry_out,
        commission_of_text,
        planner_of,
    )
    from chord_usd.line.planning.encoder import encoder_of
    from chord_usd.workshop.evaluation import floors

    planner = planner_of(load_layout_model(options, TEXT_CHECKPOINT))
    encoder = encoder_of(options.checkpoint or checkpoint_folder(TEXT_CHECKPOINT))

    def planned(case: FloorCase, seed: int) -> Planned:
        commission = commission_of_text(case.text, lambda: encoder)
        return carry_out(commission, planner, Settings(seed=seed, steps=options.steps))

    return _run(
        options, planned, floors.wish_scores, planner.content_hash, "Floors from texts", True
    )


def run_outlines(options: argparse.Namespace) -> Outcome:
    """Runs evaluate outlines."""
    from chord_usd.line.pipeline import Settings
    from chord_usd.line.pipeline.planner import (
        OUTLINE_CHECKPOINT,
        carry_out,
        commission_in_shell,
        planner_of,
    )
    from chord_usd.workshop.evaluation import floors

    planner = planner_of(load_layout_model(options, OUTLINE_CHECKPOINT))

    def planned(case: FloorCase, seed: int) -> Planned:
        commission = commission_in_shell(case.shell)
        return carry_out(commission, planner, Settings(seed=seed, steps=options.steps))

    return _run(
        options, planned, floors.shell_scores, planner.content_hash, "Floors in open plans", False
    )


def _run(
    options: argparse.Namespace,
    planned: Callable[[FloorCase, int], Planned],
    scores_of: Callable[[Pairs], dict[str, Score]],
    networks: str,
    title: str,
    aligned: bool,
) -> Outcome:
    from chord_usd.workshop.evaluation import floors
    from chord_usd.workshop.evaluation.floor_records import measure_all
    from chord_usd.workshop.evaluation.report import picture_png

    def planner(case: FloorCase) -> tuple[tuple[Candidate, ...], Candidate]:
        floor = planned(case, options.seed)
        return floor.tried, floor.chosen

    watch = stopwatch(options)
    cases = floors.held_out_cases(options.cases, aligned)
    split = floors.split_of(cases)
    settings = f"{networks}, seed {options.seed}, steps {options.steps or 'default'}"
    with watch.step("plan") as progress:
        results = measure_all(cases, planner, settings, options.records, progress)
    columns = {
        "chosen": scores_of([(c, r.chosen) for c, r in zip(cases, results, strict=True)]),
        "first alone": scores_of([(c, r.first) for c, r in zip(cases, results, strict=True)]),
    }
    seeds = range(options.seed, options.seed + SEEDS)
    with watch.step("sheet"):
        rows = [[planned(case, seed).plan for seed in seeds] for case in cases[:SHEET_ROWS]]
    different = [floors.diversity(row) for row in rows]
    notes = [
        f"split {split}, {counted(len(cases), 'case')}; {floors.tried_text(results)}",
        f"diversity over {SEEDS} seeds of {len(rows)} wishes: "
        + ", ".join(f"{value:.2f}" for value in different),
    ]
    data = {
        "split": split,
        "n": len(cases),
        "scores": floors.as_data(columns),
        "diversity": different,
        "seconds": watch.seconds,
    }
    pictures = {"": picture_png(floors.sheet(rows))}
    return reported(options, floors.as_markdown(title, columns, notes), data, pictures, [])
