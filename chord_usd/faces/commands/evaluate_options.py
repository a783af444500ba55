"""What the verbs of evaluate share: which plans, which model, where the report goes."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.scene.settings import OPTIONS, SAMPLERS
from chord_usd.faces.commands.common import Outcome, Parser, UsageError, existing_file, whole_number
from chord_usd.faces.commands.house_options import add_options
from chord_usd.faces.commands.paths import output_file

if TYPE_CHECKING:
    from chord_usd.line.layout.sample import LayoutModel
    from chord_usd.line.lists.list_sampler import Drawer, ListDrawer
    from chord_usd.workshop.evaluation.cases import Cases
    from chord_usd.workshop.evaluation.encoders import Encoder
    from chord_usd.workshop.evaluation.layouts import Sampling

SPLITS = ("test", "train", "all")


def add_plans(parser: Parser, count: int) -> None:
    """Options that say which plans."""
    parser.add_argument(
        "--split", default="test", metavar="NAME", help=f"{', '.join(SPLITS)} (test: held out)"
    )
    parser.add_argument(
        "--n", "--plans", dest="plans", type=whole_number(1, 1_000_000), default=count, metavar="N",
        help=f"plans ({count})",
    )  # fmt: skip
    parser.add_argument("--flats", type=Path, metavar="JSONL", help="real floor plans")
    parser.add_argument("--houses", type=Path, metavar="DIR", help="a folder of CHOrD JSON")
    parser.add_argument(
        "--unshaded", action="store_true", help="plans that do not show the kind of a room"
    )


def add_checkpoint(parser: Parser, name: str = "plan2layout") -> None:
    """Options that say which model. name: of the one that ships."""
    parser.add_argument(
        "--checkpoint", type=Path, metavar="DIR", help=f"instead of the shipped {name}"
    )
    add_options(parser, "seed")
    add_options(parser, "device")


def add_sampling(parser: Parser) -> None:
    """Options that say how the model is sampled."""
    add_options(parser, "steps")
    parser.add_argument("--sampler", choices=SAMPLERS, help="(the checkpoint's own)")


def add_drawer(parser: Parser) -> None:
    """Options that say what the model starts from."""
    parser.add_argument(
        "--lists", type=Path, metavar="DIR",
        help="start from the lists of this checkpoint of train lists (the shipped one)",
    )  # fmt: skip
    parser.add_argument("--no-list", action="store_true", help=OPTIONS["lists"].help)


def load_drawer(options: argparse.Namespace) -> ListDrawer:
    """The lists that the options ask for. Raises CheckpointError."""
    from chord_usd.base.runtime.locations import checkpoint_folder
    from chord_usd.line.lists.list_sampler import load_lists
    from chord_usd.line.lists.pieces import PIECES
    from chord_usd.line.pipeline import LISTS_CHECKPOINT

    return load_lists(options.lists or checkpoint_folder(LISTS_CHECKPOINT), PIECES)


def load_boxes_or_lists(options: argparse.Namespace) -> Drawer:
    """What lists rooms, nothing painted. Raises CheckpointError."""
    if not options.boxes:
        return load_drawer(options)
    from chord_usd.workshop.training.boxes_sampler import load_boxes

    return load_boxes(options.boxes)


def load_lists_of(options: argparse.Namespace, model: LayoutModel) -> ListDrawer | None:
    """The same; None where the options, or how the model was trained, leave it to the model."""
    return load_drawer(options) if model.config.draft and not options.no_list else None


def add_fid(parser: Parser) -> None:
    """Option --fid."""
    parser.add_argument(
        "--fid", action=argparse.BooleanOptionalAction,
        help="FID-EffLite0 and KID (where the extra 'evaluate' is installed)",
    )  # fmt: skip


def add_inception(parser: Parser) -> None:
    """Option --inception, beside --fid."""
    parser.add_argument(
        "--inception", type=Path, metavar="FILE",
        help="FID and KID by Inception v3 instead: a state dict of torchvision's inception_v3",
    )  # fmt: skip


def load_encoder(options: argparse.Namespace, warnings: list[str]) -> Encoder | None:
    """The encoder behind FID and KID. Without its weights these are left out, with a warning; where
    they were asked for, that is an error."""
    from chord_usd.base.errors import MissingExtraError
    from chord_usd.workshop.evaluation.encoders import InceptionEncoder, LiteEncoder

    weights: Path | None = getattr(options, "inception", None)
    if weights:
        if options.fid is False:
            raise UsageError("is for FID", where="--inception", expected="no --no-fid")
        return InceptionEncoder(existing_file(weights))
    if options.fid is False:
        return None
    try:
        return LiteEncoder()
    except MissingExtraError as error:
        if options.fid:
            raise
        warnings.append(f"no FID and KID: {error}")
        return None


def add_records(parser: Parser) -> None:
    """The option --records, of long measurements."""
    parser.add_argument(
        "--records", type=output_file, metavar="FILE",
        help="keep every score here (JSON lines), and go on from those that are there",
    )  # fmt: skip


def add_report(parser: Parser) -> None:
    """Option -o."""
    parser.add_argument(
        "-o", "--output", type=output_file, metavar="MD",
        help="also write the report; a .json and .png appear beside it",
    )  # fmt: skip


def load_cases(options: argparse.Namespace) -> Cases:
    """The plans that the options ask for. Raises UsageError for a split that does not exist."""
    from chord_usd.workshop.evaluation import cases

    split: Any = options.split
    if split not in SPLITS:
        raise UsageError(
            f"there is no split {split!r}",
            where="--split",
            expected=f"one of {', '.join(SPLITS)}",
            try_="chord-usd dataset split says which house belongs where",
        )
    if options.houses:
        if not options.houses.is_dir():
            raise UsageError("no such folder", where=str(options.houses), try_="check the path")
        return cases.folder_cases(options.houses, split, options.plans)
    if options.flats:
        return cases.flat_cases(existing_file(options.flats), split, options.plans)
    if split == "all":
        raise UsageError(
            "procedural houses have no end", where="--split all", expected="test or train"
        )
    return cases.procedural_cases(split, options.plans)


def load_layout_model(options: argparse.Namespace, name: str = "plan2layout") -> LayoutModel:
    """The model that the options ask for. Raises CheckpointError, ChordError."""
    from chord_usd.base.runtime.locations import checkpoint_folder
    from chord_usd.line.layout.sample import LayoutModel

    folder = options.checkpoint or checkpoint_folder(name)
    return LayoutModel.load(folder, options.device)


def sampling_of(options: argparse.Namespace) -> Sampling:
    """How to sample, as the options say."""
    from chord_usd.workshop.evaluation.layouts import Sampling

    return Sampling(
        options.seed,
        options.steps,
        options.sampler,
        not options.unshaded,
    )


def reported(
    options: argparse.Namespace,
    markdown: str,
    data: Mapping[str, Any],
    pictures: Mapping[str, bytes],
    warnings: list[str],
) -> Outcome:
    """The outcome of an evaluation; its report is written where -o asks for one."""
    from chord_usd.workshop.evaluation.report import write_report

    if options.output:
        write_report(options.output, markdown, data, pictures)
    return Outcome(markdown.rstrip(), {**data, "warnings": warnings}, warnings=warnings)
