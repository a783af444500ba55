"""Open balconies have railings; glazed ones, and walls that lead nowhere near air, have none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from chord_usd.base.scene.types import Box, Opening, Plan, Room, SceneGraph
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_rules import broken_rules
from chord_usd.line.stage.shell.railings import KERB_M, RAIL_M
from chord_usd.line.stage.shell.walls import build_walls

LIVING = Room("l", "living", np.array([[0.0, 0.0], [5.0, 0.0], [5.0, 4.0], [0.0, 4.0]]))
BALCONY = Room("b", "balcony", np.array([[1.0, 4.24], [4.0, 4.24], [4.0, 5.7], [1.0, 5.7]]))
DOOR = Opening("d", "door", Box((2.5, 4.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("l", "b"))
WINDOW = Opening("w", "window", Box((2.5, 5.82, 0.9), (1.5, 0.24, 1.2), 0.0), ("b",))


def test_the_three_outer_sides_of_a_balcony_open() -> None:
    railings = build_walls(Plan((LIVING, BALCONY), (DOOR,))).railings
    assert [index for index, _ in railings] == [1, 1, 1]
    for _, tunnel in railings:
        assert tunnel.low_m == pytest.approx(KERB_M)
        assert tunnel.area_m.bounds[1] > 4.3
    widths = sorted(tunnel.opening.box.size_m[0] for _, tunnel in railings)
    assert widths[-1] == pytest.approx(3.0 - 0.4)


def test_a_glazed_balcony_keeps_its_walls() -> None:
    assert build_walls(Plan((LIVING, BALCONY), (DOOR, WINDOW))).railings == ()


def test_a_window_to_the_room_behind_does_not_glaze_a_balcony() -> None:
    inner = Opening("w", "window", Box((3.5, 4.12, 0.9), (0.6, 0.24, 1.2), 0.0), ("l", "b"))
    assert len(build_walls(Plan((LIVING, BALCONY), (DOOR, inner))).railings) == 3


def test_an_outer_door_keeps_its_wall() -> None:
    outer = Opening("o", "door", Box((2.5, 5.82, 0.0), (0.9, 0.24, 2.1), 0.0), ("b",))
    plan = Plan((LIVING, BALCONY), (DOOR, outer))
    for _, tunnel in build_walls(plan).railings:
        assert tunnel.area_m.distance(build_walls(plan).tunnels["o"].area_m) > 0.1


def test_other_rooms_have_no_railings() -> None:
    assert build_walls(Plan((LIVING,), ())).railings == ()


def test_a_stage_with_railings_keeps_every_rule(tmp_path: Path) -> None:
    graph = SceneGraph((LIVING, BALCONY), (DOOR,), ())
    stage = Usd.Stage.Open(str(author_stage(graph, tmp_path / "house.usda").path))
    assert broken_rules(stage) == []
    bars = [prim for prim in stage.Traverse() if prim.GetName().startswith("Bars_")]
    assert len(bars) == 3
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"])
    for prim in bars:
        box = cache.ComputeWorldBound(prim).ComputeAlignedRange()
        assert box.GetMax()[2] == pytest.approx(RAIL_M, abs=1e-4)
        assert box.GetMin()[2] > KERB_M
