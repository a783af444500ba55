"""evaluate plans: drawn plans in many styles, read back."""

from __future__ import annotations

import argparse

from chord_usd.commands.common import (
    Outcome,
    Verbs,
    add_verb,
    seed,
    stopwatch,
    whole_number,
)
from chord_usd.commands.evaluate_options import add_records, add_report, told


def add(group: Verbs) -> None:
    """Adds the verb to the verbs of evaluate."""
    parser = add_verb(group, "plans", run, "score the reader on plans drawn in many styles")
    parser.add_argument(
        "--count",
        type=whole_number(1, 100_000),
        default=10,
        metavar="N",
        help="plans per style (10)",
    )
    parser.add_argument(
        "--seed", type=seed, default=0, metavar="N", help="same seed, same drawings (0)"
    )
    parser.add_argument(
        "--unseen", action="store_true", help="the styles that the reader was not made on"
    )
    add_records(parser)
    add_report(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.data.drawn.styles import FAMILIES, HELD_OUT
    from chord_usd.evaluation.plans import Reader, as_markdown, measure_reading, summaries
    from chord_usd.evaluation.plans_records import Records
    from chord_usd.plan.drawing import read_drawing
    from chord_usd.plan.placement import frame_of, straightening_of
    from chord_usd.plan.sheet import straightening_matrix

    families = HELD_OUT if options.unseen else FAMILIES
    records = Records(options.records, options.seed, families)
    watch = stopwatch(options)
    with watch.step("plans") as progress:
        reader = Reader(
            read_drawing,
            frame_of,
            lambda plan, shape: straightening_matrix(straightening_of(plan), shape)[0],
        )
        scores = measure_reading(
            reader, options.count, progress, families, options.seed, records.scores, records.keep
        )
    data = {"styles": summaries(scores), "seed": options.seed, "seconds": watch.seconds}
    return told(options, as_markdown(scores), data, {}, [])
