"""evaluate speed: how many sampler steps are worth their time."""

from __future__ import annotations

import argparse

from chord_usd.base.scene.settings import SAMPLERS
from chord_usd.faces.commands.common import Outcome, Verbs, add_verb, names, stopwatch
from chord_usd.faces.commands.evaluate_options import (
    add_checkpoint,
    add_fid,
    add_plans,
    add_report,
    load_cases,
    load_encoder,
    load_layout_model,
    reported,
)


def add(group: Verbs) -> None:
    """Adds the verb to the verbs of evaluate."""
    parser = add_verb(group, "speed", run, "seconds per layout and scores against sampler steps")
    add_plans(parser, count=20)
    add_checkpoint(parser)
    parser.add_argument(
        "--steps", type=_steps, default=(1, 2, 5, 10, 20, 50, 100), metavar="N,N,…",
        help="(1,2,5,10,20,50,100)",
    )  # fmt: skip
    parser.add_argument(
        "--sampler", type=_samplers, default=SAMPLERS, metavar="NAME,…",
        help=f"of {', '.join(SAMPLERS)} (all)",
    )  # fmt: skip
    add_fid(parser)
    add_report(parser)


def _steps(text: str) -> tuple[int, ...]:
    steps = tuple(int(word) if word.isdecimal() else 0 for word in names(text))
    if not steps or min(steps) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a list such as 5,10,20")
    return steps


def _samplers(text: str) -> tuple[str, ...]:
    wanted = names(text)
    unknown = [name for name in wanted if name not in SAMPLERS]
    if unknown or not wanted:
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of {', '.join(SAMPLERS)}")
    return wanted


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.workshop.evaluation import speed
    from chord_usd.workshop.evaluation.layouts import Sampling

    watch = stopwatch(options)
    warnings: list[str] = []
    encoder = load_encoder(options, warnings)
    with watch.step("plans"):
        cases = load_cases(options)
        warnings += cases.warnings
    with watch.step("load"):
        model = load_layout_model(options)
    with watch.step("speed") as progress:
        scores = speed.measure_speed(
            model,
            cases.cases,
            Sampling(seed=options.seed, shaded=not options.unshaded),
            options.steps,
            options.sampler,
            encoder,
            progress,
            warnings.append,
        )
    data = {**speed.as_data(scores), "seconds": watch.seconds}
    return reported(options, speed.as_markdown(scores), data, {"": speed.plot(scores)}, warnings)
