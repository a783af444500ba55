"""Houses nobody drew by hand keep every rule: slanted rooms, bays, walls cut by many openings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd

from chord_usd.data.houses import random_plan
from chord_usd.scene.types import SceneGraph
from chord_usd.stage.author import author_stage
from chord_usd.stage.check_rules import broken_rules


@pytest.mark.parametrize("seed", [1, 5, 8, 12, 21, 26, 38])
def test_a_random_house_breaks_no_rule(seed: int, tmp_path: Path) -> None:
    plan = random_plan(np.random.default_rng(seed))
    bare = SceneGraph(plan.rooms, plan.openings, ())
    path = author_stage(bare, tmp_path / "house.usda").path
    assert broken_rules(Usd.Stage.Open(str(path))) == []
