"""batch: many plans -> many houses, and their pictures."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.runtime.counting import counted
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.scene.roof_forms import NO_ROOF
from chord_usd.faces.commands.common import (
    Outcome,
    Parser,
    UsageError,
    Verbs,
    add_output,
    add_verb,
    positive,
    stopwatch,
    whole_number,
)
from chord_usd.faces.commands.house_options import add_options, settings_of
from chord_usd.faces.commands.paths import output_place
from chord_usd.faces.commands.render import add_look, look_of

if TYPE_CHECKING:
    from chord_usd.base.runtime.progress import Stopwatch
    from chord_usd.faces.batch.engine import Engine
    from chord_usd.faces.batch.run import Done
    from chord_usd.faces.batch.work_units import Unit
    from chord_usd.faces.commands.results import Batch
    from chord_usd.line.image.options import RenderOptions
    from chord_usd.line.pipeline import Settings

_HOUSE_MINUTES, _PICTURES_MINUTES = 60, 24 * 60
"""What a house may take, and one with pictures: far more than any has needed."""

MOST_TOLD = 5
"""Failures printed on stderr; --json and the index list all."""


def add(verbs: Verbs) -> None:
    """Adds the verb."""
    parser = add_verb(verbs, "batch", run, "make many houses, and pictures of them; resumable")
    parser.add_argument(
        "plans", type=Path, nargs="*", metavar="PLAN",
        help="floor plans as generate takes them, or folders of them",
    )  # fmt: skip
    add_output(
        parser, "folder for the houses, one folder each; finished ones in it are kept", output_place
    )
    _add_plans(parser)
    add_houses(parser)
    add_pictures(parser)
    add_exports(parser)
    add_workers(parser)


def _add_plans(parser: Parser) -> None:
    group = parser.add_argument_group("plans")
    add_options(group, "seed")
    group.add_argument(
        "--seeds", type=whole_number(1, 1_000_000), default=1, metavar="N",
        help="houses for each plan, from --seed on (1)",
    )  # fmt: skip
    group.add_argument(
        "--synth", type=whole_number(1, 1_000_000), default=0, metavar="N",
        help="also the procedural plans 0 to N-1",
    )  # fmt: skip
    add_options(group, "m_per_px")


def add_houses(parser: Parser) -> None:
    """The options of houses whatever their plans, for house_settings."""
    group = parser.add_argument_group("houses")
    add_options(
        group, "style", "texture_px", "articulation", "roof", "steps", "lists", "arrange",
        "redraws", "tabletop", "dressing", "asset_folders",
    )  # fmt: skip


def add_pictures(parser: Parser) -> None:
    """The options of pictures, for make_houses."""
    group = parser.add_argument_group("pictures")
    group.add_argument(
        "--renders",
        action="store_true",
        help="also render every camera of every house, with its roof, where --roof gives it one",
    )
    add_look(group)


def add_exports(parser: Parser) -> None:
    """The options --parquet and --webdataset, for make_houses."""
    group = parser.add_argument_group("exports, beside index.jsonl")
    group.add_argument("--parquet", action="store_true", help="the index as index.parquet, too")
    group.add_argument(
        "--webdataset", action="store_true", help="houses and pictures as tar files in shards/"
    )


def add_workers(parser: Parser) -> None:
    """The options of workers, for make_houses."""
    group = parser.add_argument_group("workers")
    group.add_argument(
        "--engine", choices=("local", "ray"), default="local",
        help="processes of this machine, or a Ray cluster (local)",
    )  # fmt: skip
    group.add_argument(
        "--workers", type=whole_number(1, 4096), metavar="N",
        help="how many (as many as cores and memory allow)",
    )  # fmt: skip
    group.add_argument(
        "--timeout", type=whole_number(1, 10_080), metavar="MINUTES",
        help="give up a house that takes longer (60, with pictures a day)",
    )  # fmt: skip
    group.add_argument(
        "--address", metavar="HOST:PORT", help="of the Ray cluster (one on this machine alone)"
    )
    group.add_argument(
        "--cpus",
        type=whole_number(1, 4096),
        default=1,
        metavar="N",
        help="cores of a Ray worker (1)",
    )
    group.add_argument(
        "--gpus", type=positive, default=0.0, metavar="SHARE",
        help="GPUs of a Ray worker, such as 0.25 for four workers on one (0)",
    )  # fmt: skip
    add_options(group, "device")


def run(options: argparse.Namespace) -> Outcome:
    """Runs the verb. Finished houses stay, whatever becomes of the others."""
    from chord_usd.faces.batch.work_units import list_units

    if not options.plans and not options.synth:
        raise UsageError("no plans", expected="PLAN, or --synth N", try_="chord-usd batch --help")
    settings = house_settings(options)
    seeds = range(options.seed, options.seed + options.seeds)
    units = list_units(options.plans, options.synth, seeds, settings)
    watch = stopwatch(options)
    done = make_houses(units, settings, options, watch)
    return outcome_of(done, options, watch.seconds)


def make_houses(
    units: Sequence[Unit],
    settings: Settings,
    options: argparse.Namespace,
    watch: Stopwatch,
    *,
    named_only: bool = False,
) -> Done:
    """Make what is due of the units, as the options of pictures, exports and workers say.

    named_only: index and shards leave out other houses that are in the folder.
    """
    from chord_usd.faces.batch.index import require_parquet
    from chord_usd.faces.batch.run import Exports, run_batch
    from chord_usd.faces.batch.work_units import Order

    if options.parquet:
        require_parquet()
    minutes = options.timeout or (_PICTURES_MINUTES if options.renders else _HOUSE_MINUTES)
    folder = absolute(options.output)
    order = Order(folder, settings, _render_options(options), timeout_s=60.0 * minutes)
    engine = _engine(options, order.folder)
    exports = Exports(options.parquet, options.webdataset, named_only)
    try:
        return run_batch(units, order, engine, exports, watch)
    except KeyboardInterrupt as reason:
        raise type(reason)("finished houses were kept; run this again to make the others") from None


def house_settings(options: argparse.Namespace) -> Settings:
    """Settings of all houses: seeds are those of units, and folders hold from any worker."""
    folders = tuple(absolute(folder) for folder in options.asset_folders)
    return replace(settings_of(options), seed=0, asset_folders=folders)


def _render_options(options: argparse.Namespace) -> RenderOptions | None:
    """Raises RenderError for what cannot be rendered, before any house is made."""
    if not options.renders:
        return None
    from chord_usd.line.image.options import RenderOptions

    roof = "" if options.roof == NO_ROOF else options.roof
    return RenderOptions(**look_of(options), device=options.device, skip_existing=True, roof=roof)


def _engine(options: argparse.Namespace, folder: Path) -> Engine:
    """Raises UsageError for an option of the other engine."""
    if options.engine == "ray":
        from chord_usd.faces.batch.ray_engine import RayEngine

        return RayEngine(options.address, options.workers, options.cpus, options.gpus, folder)
    for name in ("address", "gpus"):
        if getattr(options, name):
            raise UsageError("is for Ray", where=f"--{name}", try_=f"--engine ray --{name} ...")
    from chord_usd.faces.batch.local import LocalEngine, usual_workers

    return LocalEngine(options.workers or usual_workers())


def outcome_of(done: Done, options: argparse.Namespace, seconds: dict[str, float]) -> Outcome:
    """The summary of a batch."""
    failures = {result.unit.name: result.why for result in done.failures}
    data: Batch = {
        "folder": str(options.output),
        "made": len(done.made),
        "kept": len(done.kept),
        "failed": len(failures),
        "failures": failures,
        "holds": not done.not_holding,
        "holding": done.holding,
        "not_holding": list(done.not_holding),
        "pictures": done.pictures,
        "files": [str(file) for file in done.files],
        "seconds": seconds,
    }
    text = (
        f"{options.output}: {counted(len(done.made), 'house')} made in {seconds['houses']:.1f} s, "
        f"{len(done.kept)} kept, {len(failures)} failed; the certificate of {done.holding} holds"
    )
    if done.not_holding:
        more = f", and {len(done.not_holding) - 1} more" if len(done.not_holding) > 1 else ""
        text += f"; that of {done.not_holding[0]}{more} does not"
    warnings = [f"{name}: {why}" for name, why in failures.items()][:MOST_TOLD]
    if len(failures) > MOST_TOLD:
        warnings.append(f"{len(failures)} failed in all; {done.files[0]} lists them")
    return Outcome(text, data, holds=not failures and not done.not_holding, warnings=warnings)
