"""A house of storeys in Blender, with the panel."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.base.scene.stacking import stack
from chord_usd.line.stage.author.author_stage import author_levels
from chord_usd.line.stage.author.stage_levels import levels_of
from chord_usd.workshop.data.storey_houses import random_storeys

RunInBlender = Callable[..., dict[str, Any]]


def test_a_house_is_shown_up_to_a_storey(run_in_blender: RunInBlender, tmp_path: Path) -> None:
    made = stack(random_storeys(np.random.default_rng(1), 2))
    graphs = [storey.plan.scene() for storey in made.storeys]
    author_levels(levels_of(made, graphs), tmp_path / "house.usda", roof="hip")
    told = run_in_blender("storeys.py", tmp_path / "house.usda")
    assert told["opened"] == ""
    assert {"Storey_0", "Storey_1"} <= told["tree"].keys()
    assert "Bedroom_1" in told["tree"]["Storey_1"]
    assert {"Bedroom_0", "Bedroom_1"} <= set(told["rooms"])
    assert told["drawn"]
    assert [told[f"hidden_{storey}"] for storey in (0, 1, 2)] == [[], ["Storey_1"], []]
    assert told["roof_drawn"]
    assert "Roof" in told["tree"]
    assert told["roof"] == [False, True, False, True, False]
    assert told["path"] == "/House/Rooms/Storey_1/Corridor_1"
    assert told["left"] == []
