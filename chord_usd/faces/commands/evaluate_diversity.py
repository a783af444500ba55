"""evaluate diversity: one plan, many layouts."""

from __future__ import annotations

import argparse

from chord_usd.faces.commands.common import Outcome, Verbs, add_verb, stopwatch, whole_number
from chord_usd.faces.commands.evaluate_options import (
    add_checkpoint,
    add_drawer,
    add_plans,
    add_report,
    add_sampling,
    load_cases,
    load_layout_model,
    load_lists_of,
    reported,
    sampling_of,
)


def add(group: Verbs) -> None:
    """Adds the verb to the verbs of evaluate."""
    parser = add_verb(group, "diversity", run, "how different the layouts of one plan are")
    add_plans(parser, count=3)
    add_checkpoint(parser)
    add_sampling(parser)
    add_drawer(parser)
    parser.add_argument(
        "--seeds", type=whole_number(2, 10_000), default=8, metavar="N", help="layouts per plan (8)"
    )
    add_report(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.workshop.evaluation import diversity
    from chord_usd.workshop.evaluation.report import picture_png

    watch = stopwatch(options)
    with watch.step("plans"):
        cases = load_cases(options)
    warnings = cases.warnings
    with watch.step("load"):
        model = load_layout_model(options)
        lists = load_lists_of(options, model)
    with watch.step("layout") as progress:
        scores, sheet = diversity.measure_diversity(
            model,
            cases.cases,
            sampling_of(options),
            options.seeds,
            lists,
            progress,
            warnings.append,
        )
    data = {**diversity.as_data(scores), "seconds": watch.seconds}
    markdown = diversity.as_markdown(scores)
    return reported(options, markdown, data, {"": picture_png(sheet)}, warnings)
