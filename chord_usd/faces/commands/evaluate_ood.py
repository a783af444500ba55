"""evaluate ood: are colliding layouts unlikely to the layout model?"""

from __future__ import annotations

import argparse

from chord_usd.base.runtime.counting import counted
from chord_usd.faces.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_verb,
    stopwatch,
    whole_number,
)
from chord_usd.faces.commands.evaluate_options import (
    add_checkpoint,
    add_plans,
    add_report,
    load_cases,
    load_layout_model,
    reported,
)


def add(group: Verbs) -> None:
    """Adds the verb to the verbs of evaluate."""
    parser = add_verb(
        group, "ood", run, "compare the noise-prediction error of clean and colliding layouts"
    )
    add_plans(parser, count=20)
    add_checkpoint(parser)
    parser.add_argument(
        "--draws",
        type=whole_number(1, 100_000),
        default=100,
        metavar="N",
        help="noises per layout (100)",
    )
    parser.add_argument(
        "--per-room", type=whole_number(1, 100), default=1, metavar="N",
        help="pieces moved into others in each room (1)",
    )  # fmt: skip
    parser.add_argument(
        "--worst", type=whole_number(1, 100_000), metavar="N",
        help="as in the paper: N clean houses, and of --n other ones, their pieces moved by noise, "
        "the N with the highest PIoU",
    )  # fmt: skip
    add_report(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    if options.worst:
        return _run_worst(options)
    from chord_usd.line.layout.outlier import NoiseError
    from chord_usd.workshop.evaluation import ood

    watch = stopwatch(options)
    with watch.step("plans"):
        cases = load_cases(options)
    warnings = cases.warnings
    with watch.step("load"):
        errors = NoiseError(load_layout_model(options))
    with watch.step("errors") as progress:
        scores = ood.measure_ood(
            errors,
            cases.cases,
            draws=options.draws,
            per_room=options.per_room,
            seed=options.seed,
            progress=progress,
            warn=warnings.append,
        )
    data = {**ood.as_data(scores), "seconds": watch.seconds}
    return reported(options, ood.as_markdown(scores), data, {"": ood.plot(scores)}, warnings)


def _run_worst(options: argparse.Namespace) -> Outcome:
    """The experiment as in the paper."""
    from chord_usd.line.layout.outlier import NoiseError
    from chord_usd.workshop.evaluation import ood_worst

    watch = stopwatch(options)
    options.plans += options.worst
    with watch.step("plans"):
        cases = load_cases(options)
    if len(cases.cases) < 2 * options.worst:
        raise UsageError(
            f"takes {counted(2 * options.worst, 'house')} at least, not {len(cases.cases)}",
            where="--worst", expected="as many clean houses as colliding ones, and more to choose",
        )  # fmt: skip
    warnings = cases.warnings
    with watch.step("load"):
        errors = NoiseError(load_layout_model(options))
    with watch.step("errors") as progress:
        scores = ood_worst.measure_worst(
            errors,
            cases.cases,
            options.worst,
            draws=options.draws,
            seed=options.seed,
            progress=progress,
            warn=warnings.append,
        )
    data = {**ood_worst.as_data(scores), "seconds": watch.seconds}
    return reported(options, ood_worst.as_markdown(scores), data, {}, warnings)
