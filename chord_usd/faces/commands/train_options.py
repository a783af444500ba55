"""Options that several verbs of train have."""

from __future__ import annotations

import argparse
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from chord_usd.base.errors import CheckpointError, SceneError
from chord_usd.base.runtime.locations import RUN_CHECKPOINT, checkpoint_folder
from chord_usd.faces.commands.common import Parser, UsageError, add_output, positive, whole_number
from chord_usd.faces.commands.house_options import add_options
from chord_usd.faces.commands.paths import optional_input, output_run

if TYPE_CHECKING:
    from chord_usd.base.scene.types import SceneGraph
    from chord_usd.workshop.evaluation.cases import Split
    from chord_usd.workshop.training.loop import RunConfig
    from chord_usd.workshop.training.trainer import TrainingConfig

_MOST_WORKERS = 15
"""A GPU learns from as many pages as so many processes draw."""

_JUDGES_A_MINUTE = 4

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
    add_options(parser, "seed")


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
        metavar="HOUSES",
        help="learn from the training share of furnished houses, not from our own: a folder of "
        "CHOrD JSON, or a kept set (dataset keep), beside which lists learn our sparse houses",
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
    from chord_usd.workshop.data.kept_set import read_kept
    from chord_usd.workshop.data.splits import part_of
    from chord_usd.workshop.evaluation.cases import folder_cases

    folder: Path | None = options.furnished
    if folder is None:
        return []
    if options.flats or options.houses:
        raise UsageError(
            "takes the place of our own houses",
            where="--furnished",
            expected="neither --flats nor --houses beside it",
        )
    if folder.is_file():
        houses = [kept.house for kept in read_kept(folder) if part_of(kept.name) == split]
    elif folder.is_dir():
        cases = folder_cases(folder, split).cases
        houses = [case.furnished for case in cases if case.furnished]
    else:
        raise UsageError("no such folder or file", where=str(folder), try_="check the path")
    if not houses:
        raise SceneError(
            f"nothing of split {split!r} is furnished", where=str(folder), expected="CHOrD JSON"
        )
    return houses


def add_loop_options(parser: Parser) -> None:
    """Options of whatever the one training loop trains."""
    parser.add_argument(
        "--workers",
        type=whole_number(0, 4096),
        metavar="N",
        help="processes that make data (1, lists 0; with a GPU all cores but one, at most 15)",
    )
    add_start(parser)


def add_start(parser: Parser) -> None:
    """Whose weights a run begins with."""
    parser.add_argument(
        "--start",
        type=optional_input,
        metavar="DIR",
        help="checkpoint to start from where no run is there; checkpoints/NAME: what ships",
    )


def start_of(options: argparse.Namespace) -> Path:
    """What --start names, checkpoints/NAME also outside of a checkout; a run that goes on needs
    none. Raises CheckpointError."""
    start: Path = options.start
    if start.exists() or (options.output / RUN_CHECKPOINT).is_dir():
        return start
    if start.parent.name == "checkpoints":
        return checkpoint_folder(start.name)
    raise CheckpointError(
        "there is no checkpoint", where=str(start), expected="a folder with safetensors weights",
        try_="--start checkpoints/reader, a shipped one",
    )  # fmt: skip


def judges_of(options: argparse.Namespace, most: int) -> int:
    """How many held-out examples score a run: few where it is short, since they are drawn first."""
    return max(2, min(most, round(_JUDGES_A_MINUTE * options.minutes)))


def device_of(options: argparse.Namespace) -> str:
    """The device that is asked for. Raises what choose_device does where it is not there."""
    from chord_usd.line.layout.device import choose_device

    return choose_device(options.device)


def run_of(options: argparse.Namespace, base: ConfigT) -> ConfigT:
    """The settings of a run, as far as the options of its verb have them."""
    names = ("minutes", "seed", "workers", "processor_time", "kinds_only")
    named = {name: getattr(options, name, None) for name in names}
    chosen: dict[str, Any] = {name: value for name, value in named.items() if value is not None}
    device = device_of(options)
    if device != "cpu" and hasattr(base, "workers"):
        chosen.setdefault("workers", max(1, min(_MOST_WORKERS, (os.cpu_count() or 2) - 1)))
    batch = options.batch or base.batch
    return replace(base, **chosen, batch=batch, device=device)
