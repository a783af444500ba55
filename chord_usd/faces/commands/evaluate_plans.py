"""evaluate plans: drawn plans in many styles, read back; or the real files of a folder."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.faces.commands.common import (
    Outcome,
    UsageError,
    Verbs,
    add_verb,
    stopwatch,
    whole_number,
)
from chord_usd.faces.commands.evaluate_options import add_records, add_report, reported
from chord_usd.faces.commands.house_options import add_options

if TYPE_CHECKING:
    from chord_usd.base.scene.types import ByteArray, Plan
    from chord_usd.workshop.evaluation.plans import Reader


def add(group: Verbs) -> None:
    """Adds the verb to the verbs of evaluate."""
    parser = add_verb(group, "plans", run, "score the reader on crowded pages that it has not seen")
    parser.add_argument(
        "--count",
        type=whole_number(1, 100_000),
        default=10,
        metavar="N",
        help="pages of each kind (10)",
    )
    add_options(parser, seed="same seed, same drawings (0)")
    parser.add_argument(
        "--clean",
        action="store_true",
        help="clean drawings in thirteen styles, by other means than those it is trained on",
    )
    parser.add_argument(
        "--real", type=Path, metavar="FOLDER",
        help="read the files of a folder instead, onto a sheet for eyes; NAME.json is NAME's truth",
    )  # fmt: skip
    add_records(parser)
    add_report(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb."""
    if options.real is not None:
        return _run_real(options)
    from chord_usd.workshop.data.drawn.page_looks import KINDS
    from chord_usd.workshop.data.drawn.page_styles import FAMILIES
    from chord_usd.workshop.evaluation.plans import (
        as_markdown,
        clean,
        crowded,
        measure_reading,
        summaries,
    )
    from chord_usd.workshop.evaluation.plans_records import Records

    families = FAMILIES if options.clean else tuple(KINDS)
    records = Records(options.records, options.seed, families)
    watch = stopwatch(options)
    with watch.step("plans") as progress:
        scores = measure_reading(
            _reader(), options.count, progress, families, options.seed,
            clean if options.clean else crowded, records.scores, records.keep,
        )  # fmt: skip
    data = {"styles": summaries(scores), "seed": options.seed, "seconds": watch.seconds}
    return reported(options, as_markdown(scores), data, {}, [])


def _reader() -> Reader:
    from chord_usd.line.plan.drawing import read_drawing
    from chord_usd.line.plan.placement import frame_of, straightening_of
    from chord_usd.line.plan.sheet import straightening_matrix
    from chord_usd.workshop.evaluation.plans import Reader

    return Reader(
        read_drawing,
        frame_of,
        lambda plan, shape: straightening_matrix(straightening_of(plan), shape)[0],
    )


def _run_real(options: argparse.Namespace) -> Outcome:
    from chord_usd.line.plan.read import read_plan_file
    from chord_usd.workshop.evaluation.real_plans import (
        Eyes,
        as_markdown,
        as_rows,
        read_real,
        real_files,
        sheet_names,
        sheets,
    )

    if not options.real.is_dir():
        raise UsageError("no such folder", where=str(options.real), try_="check the path")
    watch = stopwatch(options)
    with watch.step("plans") as progress:
        readings = read_real(
            real_files(options.real), Eyes(read_plan_file, _shown, _reader()), progress
        )
    pictures = sheets(readings) if options.output else {}
    names = sheet_names(options.output, pictures) if options.output else []
    data = {"files": as_rows(readings), "seconds": watch.seconds}
    return reported(options, as_markdown(readings, names), data, pictures, [])


def _shown(plan: Plan | None, file: Path) -> ByteArray:
    """The overlay with its doubts, or the file as it is."""
    from chord_usd.line.plan.overlay import doubts_of, overlay_on, with_doubts
    from chord_usd.line.plan.picture import read_picture

    if plan is None:
        return read_picture(file).rgb
    return with_doubts(overlay_on(plan, file), doubts_of(plan))
