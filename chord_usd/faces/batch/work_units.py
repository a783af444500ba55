"""What a batch makes: one house for each plan and seed.

A unit knows its recipe, everything that decides its bytes; a house on disk that was made by the
same recipe need not be made again.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd import __version__
from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.files import hash_file
from chord_usd.base.runtime.locations import absolute, checkpoint_folder
from chord_usd.base.runtime.networks import WEIGHTS_FILE

if TYPE_CHECKING:
    from chord_usd.line.image.options import RenderOptions
    from chord_usd.line.pipeline import Settings

PLAN_SUFFIXES = (
    ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp", ".gif", ".pdf", ".json", ".svg",
    ".dxf", ".ifc", ".sh3d",
)  # fmt: skip
"""Of the files taken out of a folder of plans; a plan that is named itself may have any."""


@dataclass(frozen=True)
class Order:
    """What holds for every house of a batch."""

    folder: Path
    """Where the houses go. Absolute, and the same path on every machine that works on them."""
    settings: Settings
    """Its seed is not used; each unit has its own."""
    renders: RenderOptions | None = None
    """How to take pictures; None for houses only."""
    timeout_s: float | None = None
    """What a house with its pictures may take; None for no limit."""


@dataclass(frozen=True)
class Unit:
    """One house to make."""

    name: str
    """Of its folder; no two units of a batch share it."""
    seed: int
    plan: Path | int
    """The plan's file, absolute; or the number of a procedural plan."""
    recipe: Mapping[str, Any] = field(default_factory=dict, compare=False)
    """What decides the bytes of the house, as JSON values."""

    @property
    def source(self) -> str:
        """The plan, in words."""
        return f"procedural plan {self.plan}" if isinstance(self.plan, int) else str(self.plan)


def list_units(
    plans: Sequence[Path], procedural: int, seeds: Sequence[int], settings: Settings
) -> tuple[Unit, ...]:
    """The units of plan files, folders of them and procedural plans 0 to procedural - 1.

    Their order is that of the plans, the seeds of one after the other. Raises PlanError for a plan
    that is not there and a folder without one, CheckpointError for a missing checkpoint.
    """
    common = _common_recipe(settings)
    files = list(dict.fromkeys(_plan_files(plans)))
    named: list[tuple[str, Path | int, dict[str, Any]]] = [
        (name, file, {"plan_sha256": hash_file(file)})
        for name, file in zip(_names(files), files, strict=True)
    ]
    named += [
        (f"procedural_{number:06d}", number, {"procedural_plan": number})
        for number in range(procedural)
    ]
    _refuse_same_names([name for name, _, _ in named])
    return tuple(
        Unit(f"{name}-{seed}", seed, plan, {**common, **source, "seed": seed})
        for name, plan, source in named
        for seed in seeds
    )


def numbered_units(numbers: Iterable[int], settings: Settings) -> tuple[Unit, ...]:
    """House N of the procedural plan N with the seed N. Raises CheckpointError."""
    common = _common_recipe(settings)
    return tuple(
        Unit(f"house_{n:06d}", n, n, {**common, "procedural_plan": n, "seed": n}) for n in numbers
    )


def _plan_files(plans: Sequence[Path]) -> Iterator[Path]:
    for plan in plans:
        if plan.is_dir():
            files = sorted(f for f in plan.iterdir() if f.suffix.lower() in PLAN_SUFFIXES)
            if not files:
                raise PlanError(
                    "holds no plan", where=str(plan), expected="pictures of floor plans"
                )
            yield from (absolute(file) for file in files)
        elif plan.is_file():
            yield absolute(plan)
        else:
            raise PlanError("no such file", where=str(plan), try_="check the path")


def _names(files: Sequence[Path]) -> list[str]:
    """File names without their suffix; those that are taken twice get their folder's before."""
    stems = Counter(_word(file.stem) for file in files)
    return [
        _word(file.stem)
        if stems[_word(file.stem)] == 1
        else f"{_word(file.parent.name)}-{_word(file.stem)}"
        for file in files
    ]


def _word(name: str) -> str:
    """A name without the dots that end a key in a WebDataset, and without blanks."""
    return re.sub(r"[^\w-]+", "_", name).strip("_") or "plan"


def _refuse_same_names(names: Sequence[str]) -> None:
    for name, count in Counter(names).most_common(1):
        if count > 1:
            raise PlanError(
                f"{count} plans have this name, and the same name of their folder",
                where=name,
                expected="plans that can be told apart",
                try_="other names, or a batch for each folder",
            )


def _common_recipe(settings: Settings) -> dict[str, Any]:
    """All that decides the bytes of a house but its plan and seed.

    Where the networks run is left out: it is no reason to make a house again.
    """
    from chord_usd.line.pipeline import checkpoints

    chosen = asdict(settings)
    for other in ("seed", "device", "asset_folders"):
        del chosen[other]
    folders = {name: checkpoint_folder(name) for name in checkpoints(settings)}
    return {
        "version": __version__,
        "checkpoints": {name: hash_file(folders[name] / WEIGHTS_FILE) for name in folders},
        "asset_indexes": [hash_file(folder / "index.json") for folder in settings.asset_folders],
        **chosen,
    }
