"""evaluate detector: layouts whose furniture is known -> scores of the networks and the step."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.progress import Stopwatch
from chord_usd.faces.commands.common import (
    Outcome,
    Verbs,
    add_verb,
    existing_file,
    stopwatch,
    whole_number,
)
from chord_usd.faces.commands.house_options import add_options
from chord_usd.faces.commands.paths import output_file

if TYPE_CHECKING:
    from chord_usd.workshop.evaluation.detector_cases import Case

CLEAN, GENERATED, GIVEN = "clean", "generated", "given"


def add(group: Verbs) -> None:
    """Adds the verb to the verbs of evaluate."""
    parser = add_verb(
        group, "detector", run, "score the detector, by itself and with the whole graph step"
    )
    parser.add_argument(
        "--houses",
        type=whole_number(0, 1_000_000),
        default=300,
        metavar="N",
        help="drawings of held-out houses (300)",
    )
    parser.add_argument(
        "--generated",
        type=whole_number(0, 1_000_000),
        default=60,
        metavar="N",
        help="samples of the layout model (60)",
    )
    parser.add_argument(
        "--layouts",
        type=Path,
        nargs="+",
        default=[],
        metavar="PNG",
        help="layout rasters of yours; their colours are taken for the truth",
    )
    parser.add_argument(
        "--painters",
        type=whole_number(0, 1_000_000),
        default=0,
        metavar="N",
        help="houses as each of six other painters would leave them, read with the detector, "
        "without it, and by it alone (0)",
    )
    add_options(parser, "steps")
    parser.add_argument(
        "--items", type=Path, metavar="DIR", help="instead of the shipped detector_items"
    )
    parser.add_argument(
        "--rooms", type=Path, metavar="DIR", help="instead of the shipped detector_rooms"
    )
    parser.add_argument(
        "-o", "--output", type=output_file, metavar="MD", help="also write the table"
    )
    parser.add_argument(
        "--sheet",
        type=output_file,
        metavar="PICTURE",
        help="also draw what the networks propose, to look at (.png or .jpg)",
    )
    add_options(parser, "device")


def run(options: argparse.Namespace) -> Outcome:
    """Runs evaluate detector."""
    from chord_usd.line.graph.detect import load_item_detector, load_room_segmenter
    from chord_usd.workshop.evaluation import detector_scores, detector_sheet

    watch = stopwatch(options)
    with watch.step("load"):
        items = load_item_detector(options.items)
        rooms = load_room_segmenter(options.rooms)
    cases = _cases(options, watch)
    columns = {}
    for name, these in cases.items():
        with watch.step(f"score {name}") as progress:
            columns[name] = detector_scores.score_detector(these, items, rooms, progress)
    table = detector_scores.as_markdown(columns) if columns else ""
    data: dict[str, Any] = {name: asdict(scores) for name, scores in columns.items()}
    if options.painters:
        from chord_usd.workshop.evaluation import painters

        with watch.step("painters") as progress:
            by_read = painters.score_painters(items, options.painters, progress)
        table += ("\n" if table else "") + painters.as_markdown(by_read)
        data["painters"] = {
            name: {read: asdict(score) for read, score in by.items()}
            for name, by in by_read.items()
        }
    if options.output:
        write_atomic(options.output, table)
    if options.sheet:
        shown = [case for these in cases.values() for case in these[: detector_sheet.COLUMNS]]
        sheet = detector_sheet.draw_sheet(shown, items, rooms, options.sheet.suffix)
        write_atomic(options.sheet, sheet)
    return Outcome(table.rstrip(), {**data, "seconds": watch.seconds})


def _cases(options: argparse.Namespace, watch: Stopwatch) -> dict[str, list[Case]]:
    """The layouts to score, by the name of their column."""
    from chord_usd.line.pipeline import Settings, load_model
    from chord_usd.workshop.evaluation import detector_cases

    files = [existing_file(file) for file in options.layouts]
    cases: dict[str, list[Case]] = {}
    if options.houses:
        with watch.step("draw"):
            cases[CLEAN] = list(detector_cases.clean_cases(options.houses))
    if options.generated:
        with watch.step("layout") as progress:
            model = load_model(Settings(device=options.device))
            cases[GENERATED] = list(
                detector_cases.generated_cases(model, options.generated, options.steps, progress)
            )
    if files:
        cases[GIVEN] = list(detector_cases.cases_of_files(files))
    return cases
