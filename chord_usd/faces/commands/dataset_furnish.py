"""How dataset synth and import furnish plans: by rules, or as the networks of generate do."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from chord_usd.faces.commands.common import UsageError, whole_number

if TYPE_CHECKING:
    import numpy as np

    from chord_usd.base.scene.types import Plan, SceneGraph

    Furnish = Callable[[Plan, np.random.Generator], SceneGraph]


def add_furnisher(parser: argparse.ArgumentParser) -> None:
    """Options of furnisher_of."""
    parser.add_argument(
        "--statistics", choices=("homes", "paper"), default="homes",
        help="furnish as people live, or as sparsely as the paper's houses (homes)",
    )  # fmt: skip
    parser.add_argument(
        "--drafts", type=whole_number(1, 1000), default=1, metavar="N",
        help="furnish N times, and keep what breaks the fewest planning rules (1)",
    )  # fmt: skip
    parser.add_argument(
        "--furnisher", choices=("rules", "networks"), default="rules",
        help="furnish by rules, or as generate does: homes to train lists on (rules)",
    )  # fmt: skip


def furnisher_of(options: argparse.Namespace) -> Furnish:
    """How a plan is furnished, as the options say."""
    if options.furnisher == "networks":
        if options.statistics != "homes":
            raise UsageError(
                "networks furnish homes", where="--statistics",
                expected="homes, or --furnisher rules",
            )  # fmt: skip
        return by_networks(options.drafts)
    from chord_usd.workshop.data.searched import furnish_best

    return partial(furnish_best, drafts=options.drafts, statistics=options.statistics)


def by_networks(drafts: int) -> Furnish:
    """Furnishes plans as generate does, up to the scene graph, and keeps the best of some drafts.

    The same plan and state of the generator give the same home. It raises ChordError for a plan
    that generate refuses.
    """
    from chord_usd.base.scene.chord_json import write_scene
    from chord_usd.line.pipeline import Settings, furnished, load_models
    from chord_usd.workshop.data.searched import price_of

    settings = Settings(tabletop=False, dressing=False)
    models = load_models(settings)

    def furnish(plan: Plan, rng: np.random.Generator) -> SceneGraph:
        seeds = rng.integers(2**31, size=drafts).tolist()
        with TemporaryDirectory() as folder:
            file = Path(folder) / "plan.json"
            write_scene(plan.scene(), file)
            homes = [furnished(file, replace(settings, seed=seed), models) for seed in seeds]
        return replace(min(homes, key=price_of), extra=plan.extra)

    return furnish
