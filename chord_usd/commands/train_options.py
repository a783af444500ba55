"""Options that several verbs of train have."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from chord_usd.commands.common import (
    Parser,
    UsageError,
    add_output,
    add_seed,
    positive,
    whole_number,
)
from chord_usd.commands.paths import output_run
from chord_usd.errors import SceneError

if TYPE_CHECKING:
    from chord_usd.evaluation.cases import Split
    from chord_usd.scene.types import SceneGraph
    from chord_usd.training.loop import RunConfig
    from chord_usd.training.trainer import TrainingConfig

ConfigT = TypeVar("ConfigT", bound="RunConfig | TrainingConfig")


def add_training_options(parser: Parser, *, minutes: float, batch: int | None) -> None:
    """Where the run lies, how long it goes on, in what batches, on what, and its seed."""
    add_output(parser, "folder of the run; the checkpoint comes to lie in it", output_run)
    parser.add_argument(
        "--minutes", type=positive, default=minutes, metavar="N", help=f"budget ({minutes:g})"
    )
    parser.add_argument(
        "--batch",
        type=whole_number(1, 65_536),
        default=batch,
        metavar="N",
        help=f"({batch or 'the preset decides'})",
    )
    parser.add_argument("--device", default="cpu", metavar="NAME", help="cpu, cuda or cuda:1 (cpu)")
    add_seed(parser)


def add_processor_time(parser: Parser) -> None:
    """Whose minutes count."""
    parser.add_argument(
        "--processor-time",
        action="store_true",
        help="minutes of this process's processor time, not of the clock: for comparisons",
    )


def add_flats(parser: Parser) -> None:
    """Real plans."""
    parser.add_argument(
        "--flats", type=Path, metavar="JSONL", help="real floor plans to learn from beside our own"
    )


def add_houses(parser: Parser) -> None:
    """How many different houses there are."""
    parser.add_argument(
        "--houses",
        type=whole_number(1, 10_000_000),
        metavar="N",
        help="learn from N procedural houses, again and again, in new poses (no two alike)",
    )


def add_furnished(parser: Parser) -> None:
    """Whose houses."""
    parser.add_argument(
        "--furnished",
        type=Path,
        metavar="DIR",
        help="learn from the training share of a folder of furnished CHOrD JSON, not from our own",
    )


def unseen_of(options: argparse.Namespace) -> list[SceneGraph]:
    """The furnished houses of the folder that are held out; none where it is too small for any."""
    try:
        return furnished_of(options, "test")
    except SceneError:
        return []


def furnished_of(options: argparse.Namespace, split: Split = "train") -> list[SceneGraph]:
    """The furnished houses of a split in the folder that is asked for; none where none is.

    Raises UsageError where other houses are asked for beside them or the folder is none, and
    SceneError where nothing in it is furnished.
    """
    from chord_usd.evaluation.cases import folder_cases

    folder: Path | None = options.furnished
    if folder is None:
        return []
    if options.flats or options.houses:
        raise UsageError(
            "takes the place of our own houses",
            where="--furnished",
            expected="neither --flats nor --houses beside it",
        )
    if not folder.is_dir():
        raise UsageError("no such folder", where=str(folder), try_="check the path")
    cases = folder_cases(folder, split).cases
    found = [case.furnished for case in cases if case.furnished]
    if not found:
        raise SceneError(
            f"nothing of split {split!r} is furnished", where=str(folder), expected="CHOrD JSON"
        )
    return found


def add_loop_options(parser: Parser) -> None:
    """Options of whatever the one training loop trains."""
    parser.add_argument(
        "--workers",
        type=whole_number(0, 4096),
        default=1,
        metavar="N",
        help="processes that draw (1)",
    )
    add_start(parser)


def add_start(parser: Parser) -> None:
    """Whose weights a run begins with."""
    parser.add_argument(
        "--start", type=Path, metavar="DIR", help="checkpoint to start from where no run is there"
    )


def device_of(options: argparse.Namespace) -> str:
    """The device that is asked for. Raises what choose_device does where it is not there."""
    from chord_usd.layout.device import choose_device

    return choose_device(options.device)


def run_of(options: argparse.Namespace, base: ConfigT) -> ConfigT:
    """The settings of a run, as far as the options of its verb have them."""
    names = ("minutes", "seed", "workers", "processor_time", "kinds_only")
    told = {name: getattr(options, name) for name in names if hasattr(options, name)}
    batch = options.batch or base.batch
    return replace(base, **told, batch=batch, device=device_of(options))
