"""Plans to be evaluated on: procedural houses, real flats, or a folder of CHOrD JSON."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from chord_usd.base.errors import ChordError, SceneError
from chord_usd.base.runtime.counting import counted
from chord_usd.base.scene.chord_json import read_scene
from chord_usd.base.scene.types import Plan, SceneGraph
from chord_usd.workshop.data.flats import read_flats
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED, part_of, split_hash

Split = Literal["test", "train", "all"]
SPLITS: tuple[Split, ...] = get_args(Split)

_MOST_SHOWN = 5


@dataclass(frozen=True, eq=False)
class Case:
    """A plan under its name, and its furniture where someone has furnished it."""

    id: str
    plan: Plan
    furnished: SceneGraph | None = None

    def truth(self, seed: int = 0) -> SceneGraph:
        """The furniture it came with, else what the training data's own furnisher puts in.

        That depends on seed and the case's id alone.
        """
        if self.furnished is not None:
            return self.furnished
        digest = int(split_hash([self.id]), 16)
        return furnish(self.plan, np.random.default_rng((seed, digest)))


@dataclass(frozen=True, eq=False)
class Cases:
    """A set of plans, and what of it could not be read."""

    cases: tuple[Case, ...]
    skipped: tuple[str, ...] = field(default=())
    """One sentence per file that could not be read."""

    @property
    def split(self) -> str:
        """12 hex digits that name this set; printed beside its scores."""
        return split_hash([case.id for case in self.cases])

    @property
    def warnings(self) -> list[str]:
        """What a user should know of the files skipped: how many, and the first of them."""
        if not self.skipped:
            return []
        shown = list(self.skipped[:_MOST_SHOWN])
        more = len(self.skipped) - len(shown)
        rest = [f"and {more} more"] if more else []
        return [f"{counted(len(self.skipped), 'file')} skipped:", *shown, *rest]


def procedural_cases(split: Split, count: int, start: int = 0) -> Cases:
    """Procedural houses; houses of the split "test" are never trained on (data.splits).

    start: how many of the split to leave out first.
    """
    first = (TEST_SEED if split == "test" else 0) + start
    seeds = range(first, first + count)
    return Cases(
        tuple(Case(f"procedural/{s}", random_plan(np.random.default_rng(s))) for s in seeds)
    )


def flat_cases(path: Path, split: Split, count: int) -> Cases:
    """Real flats of a file that data.flats reads. Raises PlanError."""
    flats = read_flats(path, part=None if split == "all" else split)
    return Cases(tuple(Case(str(flat.extra["source"]), flat) for flat in flats[:count]))


def folder_cases(folder: Path, split: Split, count: int | None = None) -> Cases:
    """Furnished houses or plans in a folder of CHOrD JSON; a file's name decides its part.

    Files that cannot be read are skipped and listed. Raises SceneError where none is left.
    """
    files = sorted(folder.glob("*.json"))
    chosen = [path for path in files if split == "all" or part_of(path.stem) == split]
    cases: list[Case] = []
    skipped: list[str] = []
    for path in islice(chosen, count):
        try:
            scene = read_scene(path)
            cases.append(Case(path.stem, scene.plan, scene if scene.items else None))
        except ChordError as error:
            skipped.append(str(error))
    if not cases:
        share = f"{len(chosen)} of {len(files)} files are of split {split!r}"
        raise SceneError(
            "holds no house that can be read",
            where=str(folder),
            expected=f"CHOrD JSON; {share}, {len(skipped)} of them broken",
            try_=skipped[0] if skipped else "--split all",
        )
    return Cases(tuple(cases), tuple(skipped))
