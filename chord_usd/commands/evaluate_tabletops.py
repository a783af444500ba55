"""evaluate tabletops: supporting pieces -> what the table model lays on them -> scores."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from chord_usd.commands.common import Outcome, UsageError, Verbs, add_verb, stopwatch, whole_number
from chord_usd.commands.evaluate_options import (
    add_checkpoint,
    add_report,
    add_sampling,
    load_layout_model,
    told,
)
from chord_usd.progress import Stopwatch

if TYPE_CHECKING:
    from chord_usd.evaluation.tabletops import Judged, ReaderScores, Workplace

DATA = "data"
"""Column of what the data's own rules lay: what the model is to come up to."""

BATCH_OF = 10
"""Tables of the house that is timed."""

SOFT_NOISE = 2.0
"""Noise-to-signal ratio from which known tabletops are drawn anew to test the reader: as soft as
what the model draws by itself."""


def add(group: Verbs) -> None:
    """Adds the verb to the verbs of evaluate."""
    parser = add_verb(group, "tabletops", run, "score the table model, before and after placing")
    parser.add_argument(
        "--n", dest="tops", type=whole_number(1, 1_000_000), default=200, metavar="N",
        help="held-out procedural tops (200)",
    )  # fmt: skip
    parser.add_argument(
        "--houses", type=whole_number(0, 100_000), default=10, metavar="N",
        help="held-out houses, furnished by the layout model, whose pieces are laid (10)",
    )  # fmt: skip
    add_checkpoint(parser, "table")
    add_sampling(parser)
    add_report(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.evaluation import tabletop_report, tabletops

    watch = stopwatch(options)
    with watch.step("load"):
        at = _workplace(options)
    judged, readers = _procedural(options, at, watch)
    if options.houses:
        judged["houses"] = _in_houses(options, at, watch)
    with watch.step("time"):
        timed = [one.case for one in list(judged.values())[-1][:BATCH_OF]]
        seconds = tabletops.cpu_seconds(at, timed)
    columns = {name: tabletops.score_tabletops(these, at) for name, these in judged.items()}
    for name in judged.keys() - {DATA}:
        columns[name].rows["filled_in_tries"] = tabletops.filled_in_tries(at, judged[name])
    made = tabletop_report.Made(
        at.model.checkpoint.content_hash, at.steps, at.sampler, seconds, len(timed)
    )
    data = {**tabletop_report.as_data(columns, readers, made), "seconds": watch.seconds}
    sheet = tabletop_report.draw_sheet(list(judged.values()))
    markdown = tabletop_report.as_markdown(columns, readers, made)
    return told(options, markdown, data, {"": sheet}, [])


def _workplace(options: argparse.Namespace) -> Workplace:
    """The model and the meshes. Raises UsageError for a model of another level."""
    from chord_usd.assets.database import load_database
    from chord_usd.assets.tops import relief_of
    from chord_usd.evaluation.tabletops import Workplace

    model = load_layout_model(options, "table")
    if model.config.level != "table":
        raise UsageError(
            "is a model of houses",
            where=str(options.checkpoint),
            expected="one of tabletops",
            try_="chord-usd evaluate layouts",
        )
    return Workplace(
        model, load_database(), relief_of, options.seed, options.steps, options.sampler
    )


def _procedural(
    options: argparse.Namespace, at: Workplace, watch: Stopwatch
) -> tuple[dict[str, list[Judged]], dict[str, ReaderScores]]:
    """Held-out tops as the data lays them and as the model does; how well both are read."""
    from chord_usd.evaluation.tabletop_cases import procedural_cases, redrawn
    from chord_usd.evaluation.tabletops import judge, sampled, score_reader

    cases = procedural_cases(options.tops)
    drawn = [case.drawn for case in cases]
    with watch.step("tops") as progress:
        made = sampled(at, cases, progress)
    with watch.step("read"):
        readers = {
            "drawn": score_reader(cases, drawn),
            "drawn anew": score_reader(cases, redrawn(at.model, cases, SOFT_NOISE)),
        }
        return {DATA: judge(at, cases, drawn), "tops": judge(at, cases, made)}, readers


def _in_houses(options: argparse.Namespace, at: Workplace, watch: Stopwatch) -> list[Judged]:
    """The supporting pieces of houses that the layout model furnishes, laid."""
    from chord_usd.evaluation.tabletop_cases import house_cases
    from chord_usd.evaluation.tabletops import judge, sampled
    from chord_usd.graph.detect import load_item_detector
    from chord_usd.pipeline import Settings, load_model

    with watch.step("houses") as progress:
        houses = load_model(Settings(device=options.device))
        detector = load_item_detector()
        cases = list(
            house_cases(houses, detector, at.database, at.reliefs, options.houses, progress)
        )
    with watch.step("pieces") as progress:
        return judge(at, cases, sampled(at, cases, progress))
