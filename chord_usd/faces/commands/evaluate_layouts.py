"""evaluate layouts: plans -> layouts -> scores, beside the paper's."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING

from chord_usd.base.runtime.progress import Stopwatch
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
    add_drawer,
    add_fid,
    add_inception,
    add_plans,
    add_report,
    add_sampling,
    load_boxes_or_lists,
    load_cases,
    load_encoder,
    load_layout_model,
    load_lists_of,
    reported,
    sampling_of,
)

if TYPE_CHECKING:
    from chord_usd.workshop.evaluation.cases import Case, Cases
    from chord_usd.workshop.evaluation.encoders import Encoder
    from chord_usd.workshop.evaluation.layouts import Furnished, Sampling
    from chord_usd.workshop.evaluation.realism import Realism


def add(group: Verbs) -> None:
    """Adds the verb to the verbs of evaluate."""
    parser = add_verb(
        group,
        "layouts",
        run,
        "score first draws of the layout model, nothing moved, and the same arranged",
    )
    add_plans(parser, count=100)
    add_checkpoint(parser)
    add_sampling(parser)
    parser.add_argument(
        "--furnisher", action="store_true", help="score the training data's furnisher instead"
    )
    add_drawer(parser)
    parser.add_argument(
        "--unpainted", type=whole_number(1, 100), metavar="N",
        help="score the lists alone, nothing painted, of each room the best of N",
    )  # fmt: skip
    parser.add_argument(
        "--boxes", type=Path, metavar="DIR",
        help="with --unpainted: a checkpoint of train boxes in place of the lists",
    )  # fmt: skip
    parser.add_argument(
        "--from", dest="source", type=Path, metavar="DIR",
        help="score the furnished houses of a folder of CHOrD JSON instead",
    )  # fmt: skip
    add_fid(parser)
    add_inception(parser)
    add_report(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.workshop.evaluation import layout_report, layouts
    from chord_usd.workshop.evaluation.cases import Case

    if options.boxes and not options.unpainted:
        raise UsageError("boxes are not painted over", where="--boxes", expected="--unpainted N")
    watch = stopwatch(options)
    warnings: list[str] = []
    encoder = load_encoder(options, warnings)
    with watch.step("plans"):
        cases = _cases(options)
        warnings += cases.warnings
        # What is to be scored is no standard for itself.
        bare = [Case(case.id, case.plan) if options.source else case for case in cases.cases]
    sampling = sampling_of(options)
    before = process_time()
    furnished, made_by, sampling = _furnished(options, cases, sampling, watch, warnings)
    seconds = (process_time() - before) / max(len(furnished), 1)
    with watch.step("score"):
        scores = layouts.score_layouts(furnished, made_by, sampling)
    realism: dict[str, Realism] = {}
    if encoder:
        with watch.step("realism"):
            realism = _realism(furnished, bare, sampling, encoder, warnings)
    timing = {"processor_seconds_per_house": round(seconds, 3), "seconds": watch.seconds}
    data = {**layout_report.as_data(scores, realism), **timing}
    markdown = layout_report.as_markdown(scores, realism)
    markdown += f"\n{seconds:.2f} s of processor time a house, from plan to pieces\n"
    return reported(options, markdown, data, {"": layout_report.plot(scores)}, warnings)


def _cases(options: argparse.Namespace) -> Cases:
    if options.source:
        options.houses, options.split = options.source, "all"
    return load_cases(options)


def _furnished(
    options: argparse.Namespace,
    cases: Cases,
    sampling: Sampling,
    watch: Stopwatch,
    warnings: list[str],
) -> tuple[list[Furnished], str, Sampling]:
    """The layouts to score, who made them, and how."""
    from chord_usd.workshop.evaluation import layouts

    if options.furnisher or options.source:
        with watch.step("layout"):
            made_by = str(options.source) if options.source else "furnisher"
            return list(layouts.drawn(cases.cases, sampling)), made_by, replace(sampling, steps=0)
    if options.unpainted:
        drawer = load_boxes_or_lists(options)
        with watch.step("list"):
            listed = list(layouts.listed(drawer, cases.cases, sampling, options.unpainted))
        return listed, drawer.content_hash, replace(sampling, steps=0)
    with watch.step("load"):
        model = load_layout_model(options)
        lists = load_lists_of(options, model)
    sampling = sampling.settled(model.config)
    with watch.step("layout") as progress:
        furnished = list(
            layouts.sampled(model, cases.cases, sampling, lists, progress, warn=warnings.append)
        )
    return furnished, layouts.made_by(model, lists), sampling


def _realism(
    furnished: list[Furnished],
    cases: Sequence[Case],
    sampling: Sampling,
    encoder: Encoder,
    warnings: list[str],
) -> dict[str, Realism]:
    """Against what cases are furnished with: the same for the floor, others for both."""
    from chord_usd.workshop.evaluation.realism import (
        LEAST_PICTURES,
        realism_by_part,
        reference_layouts,
    )

    real, others = reference_layouts(cases, sampling)
    if len(real) < LEAST_PICTURES:
        warnings.append(f"no FID and KID: they take at least {LEAST_PICTURES} pictures a set")
    return realism_by_part(furnished[: len(real)], real, others, encoder, sampling)
