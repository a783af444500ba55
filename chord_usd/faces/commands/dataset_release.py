"""dataset release: houses by the thousand as a data set that others can cite and check."""

from __future__ import annotations

import argparse
from dataclasses import replace

from chord_usd.base.runtime.locations import absolute
from chord_usd.faces.commands.batch import (
    add_exports,
    add_houses,
    add_pictures,
    add_workers,
    house_settings,
    make_houses,
    outcome_of,
)
from chord_usd.faces.commands.common import (
    Outcome,
    Verbs,
    add_output,
    add_verb,
    stopwatch,
    whole_number,
)
from chord_usd.faces.commands.house_options import add_options
from chord_usd.faces.commands.paths import output_place


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(
        verbs,
        "release",
        run,
        "houses with plans, scores, splits, hashes, licence and card; resumable",
    )
    add_output(parser, "folder of the data set; finished houses in it are kept", output_place)
    parser.add_argument(
        "--count", type=whole_number(1, 1_000_000), default=1000, metavar="N", help="(1000)"
    )
    add_options(parser, "seed")
    add_houses(parser)
    add_pictures(parser)
    add_exports(parser)
    add_workers(parser)


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb. House N stands on the procedural plan N and has the seed N."""
    from chord_usd.faces.batch.release import require_own, write_release
    from chord_usd.faces.batch.work_units import numbered_units

    require_own(options.output)
    settings = house_settings(options)
    units = numbered_units(range(options.seed, options.seed + options.count), settings)
    watch = stopwatch(options)
    done = make_houses(units, settings, options, watch, named_only=True)
    with watch.step("release"):
        release = write_release(absolute(options.output), [unit.name for unit in units])
    outcome = outcome_of(done, options, watch.seconds)
    text = f"{outcome.text}\n{release.summary}"
    return replace(outcome, text=text, data={**outcome.data, "release": release.as_json()})
