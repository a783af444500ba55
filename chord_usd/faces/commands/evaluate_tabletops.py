"""evaluate tabletops: supporting pieces -> what is laid on them, by list or by pixels -> scores."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

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
    add_report,
    add_sampling,
    load_layout_model,
    reported,
)

if TYPE_CHECKING:
    from chord_usd.line.layout.sample import LayoutModel
    from chord_usd.line.lists.things import TopLister
    from chord_usd.workshop.evaluation.tabletop_cases import Case
    from chord_usd.workshop.evaluation.tabletops import ReaderScores, Workplace

DATA = "data"
"""Column of what the data's own rules lay: what the model is to come up to."""

BATCH_OF = 10
"""Tables of the house that is timed."""

SOFT_NOISE = 2.0
"""Noise-to-signal ratio from which known tabletops are drawn again to test the reader: as soft as
what the model draws by itself."""


def add(group: Verbs) -> None:
    """Adds the verb to the verbs of evaluate."""
    parser = add_verb(group, "tabletops", run, "score the table model, before and after placing")
    parser.add_argument(
        "--n", dest="tops", type=whole_number(1, 1_000_000), default=200, metavar="N",
        help="held-out procedural tops (200)",
    )  # fmt: skip
    parser.add_argument(
        "--houses", type=whole_number(0, 100_000), default=20, metavar="N",
        help="held-out houses, furnished as homes, whose pieces are laid (20)",
    )  # fmt: skip
    which = parser.add_mutually_exclusive_group()
    which.add_argument(
        "--lists", type=Path, metavar="DIR", help="checkpoint of lists instead of the shipped one"
    )
    which.add_argument(
        "--no-list", action="store_true", help="score the diffusion model of tops, as in the paper"
    )
    parser.add_argument(
        "--drafts", type=whole_number(1, 64), metavar="N",
        help="lists drawn of each top, of which the best is taken (as generate does)",
    )  # fmt: skip
    add_checkpoint(parser, "table")
    add_sampling(parser)
    add_report(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    from chord_usd.workshop.evaluation import tabletop_cases, tabletop_report, tabletops

    watch = stopwatch(options)
    with watch.step("load"):
        painter = _painter(options)
        at = _workplace(options, painter)
    cases = tabletop_cases.procedural_cases(options.tops)
    with watch.step("tops") as progress:
        judged = {
            DATA: tabletops.judge(at, cases, [case.truth or () for case in cases]),
            "tops": tabletops.drawn(at, cases, progress),
        }
    if options.houses:
        with watch.step("houses") as progress:
            pieces = tabletop_cases.house_cases(at.database, at.reliefs, options.houses)
            judged["houses"] = tabletops.drawn(at, pieces, progress)
    with watch.step("time"):
        timed = [top.case for top in list(judged.values())[-1][:BATCH_OF]]
        seconds = tabletops.cpu_seconds(at, timed)
    columns = {name: tabletops.score_tabletops(these, at) for name, these in judged.items()}
    with watch.step("read"):
        readers = _readers(painter, cases)
    made = tabletop_report.Made(at.model.content_hash, _how(options, painter), seconds, len(timed))
    data = {**tabletop_report.as_data(columns, readers, made), "seconds": watch.seconds}
    sheet = tabletop_report.draw_sheet(list(judged.values()))
    markdown = tabletop_report.as_markdown(columns, readers, made)
    return reported(options, markdown, data, {"": sheet}, [])


def _how(options: argparse.Namespace, painter: LayoutModel | None) -> str:
    from chord_usd.line.lists.things import DRAFTS

    if painter is None:
        return f"the best of {options.drafts or DRAFTS} lists of each top"
    config = painter.config
    steps = options.steps or config.default_steps
    return f"{counted(steps, 'step')} of {options.sampler or config.default_sampler}"


def _workplace(options: argparse.Namespace, painter: LayoutModel | None) -> Workplace:
    """The model and the meshes."""
    from chord_usd.library.asset_shapes import relief_of
    from chord_usd.library.database import load_database
    from chord_usd.line.graph.table_items import TopPainter
    from chord_usd.workshop.evaluation.tabletops import Workplace

    if painter is None:
        return Workplace(_lister(options), load_database(), relief_of, options.seed)
    sample = partial(painter.sample_batch, steps=options.steps, sampler=options.sampler)
    model = TopPainter(sample, painter.checkpoint.content_hash)
    return Workplace(model, load_database(), relief_of, options.seed)


def _lister(options: argparse.Namespace) -> TopLister:
    from chord_usd.base.runtime.locations import checkpoint_folder
    from chord_usd.line.lists.things import DRAFTS, load_lister
    from chord_usd.line.pipeline import THINGS_CHECKPOINT

    folder = options.lists or checkpoint_folder(THINGS_CHECKPOINT)
    return load_lister(folder, options.drafts or DRAFTS)


def _painter(options: argparse.Namespace) -> LayoutModel | None:
    """The diffusion model, where it is asked for. Raises UsageError for one of another level."""
    if not options.no_list and not options.checkpoint:
        return None
    model = load_layout_model(options, "table")
    if model.config.level != "table":
        raise UsageError(
            "is a model of houses",
            where=str(options.checkpoint),
            expected="one of tabletops",
            try_="chord-usd evaluate layouts",
        )
    return model


def _readers(painter: LayoutModel | None, cases: Sequence[Case]) -> dict[str, ReaderScores]:
    """How well rasters are read, clean ones and soft ones; nothing where none are painted."""
    from chord_usd.workshop.evaluation.tabletop_cases import redrawn
    from chord_usd.workshop.evaluation.tabletops import score_reader

    if painter is None:
        return {}
    return {
        "drawn": score_reader(cases, [case.drawn for case in cases]),
        "drawn anew": score_reader(cases, redrawn(painter, cases, SOFT_NOISE)),
    }
