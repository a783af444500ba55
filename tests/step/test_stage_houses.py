"""Houses nobody drew by hand keep every rule: slanted rooms, bays, walls cut by many openings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd

from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_rules import broken_rules
from chord_usd.workshop.data.houses import random_plan


@pytest.mark.parametrize("seed", [1, 5, 8, 12, 21, 26, 38])
def test_a_random_house_breaks_no_rule(seed: int, tmp_path: Path) -> None:
    plan = random_plan(np.random.default_rng(seed))
    bare = SceneGraph(plan.rooms, plan.openings, ())
    path = author_stage(bare, tmp_path / "house.usda").path
    assert broken_rules(Usd.Stage.Open(str(path))) == []
