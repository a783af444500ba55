"""The example of a robot runs, and what the page about robots shows is true."""

from __future__ import annotations

import ast
import importlib.util
import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from chord_usd.base.scene.types import Box, Item, Opening, Plan, Room, frozen_array
from chord_usd.library.database import load_database
from chord_usd.line.stage.author.author_stage import author_stage

ROOT = Path(__file__).parents[2]


def room(room_id: str, kind: Any, west: float, east: float) -> Room:
    return Room(room_id, kind, frozen_array([(west, 0.0), (east, 0.0), (east, 4.0), (west, 4.0)]))


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A front door, a living room with a table in the way, a door, a kitchen."""
    doors = (
        Opening("in", "door", Box((1.0, -0.12, 0.0), (1.0, 0.24, 2.0), 0.0)),
        Opening("on", "door", Box((4.62, 3.0, 0.0), (0.9, 0.24, 2.0), 90.0)),
    )
    plan = Plan((room("a", "living", 0.0, 4.5), room("b", "kitchen", 4.74, 8.5)), doors)
    database = load_database()
    things = [
        ("refrigerator", (8.0, 0.4, 0.0), (0.7, 0.65, 1.8), 180.0, "b"),
        ("dining_table", (2.4, 1.9, 0.0), (1.4, 0.8, 0.75), 90.0, "a"),
        ("chair", (3.9, 0.7, 0.0), (0.45, 0.5, 0.9), 0.0, "a"),
    ]
    items = []
    for category, at, size, yaw, where in things:
        asset = database.nearest(category, size)
        box = Box(at, asset.size_m, yaw)
        items.append(Item(category, category, box, where, asset=asset))
    graph = replace(plan.scene(), items=tuple(items))
    path = tmp_path_factory.mktemp("home") / "house.usda"
    return author_stage(graph, path, articulation="jointed").path


@pytest.mark.acceptance
def test_a_robot_drives_to_the_kitchen_and_the_refrigerator_opens(
    home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spec = importlib.util.spec_from_file_location("errand", ROOT / "examples/robot/errand.py")
    assert spec
    assert spec.loader
    errand = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "errand", errand)
    spec.loader.exec_module(errand)
    went = errand.run(home, tmp_path)
    assert went.way_m > 5.0
    assert went.off_m < 0.15
    assert abs(went.opened_deg) > 80.0
    monkeypatch.setattr(errand, "PULL_N", 0.0)
    house = errand.House(tmp_path / "model")
    assert abs(house.pull(house.fridge_door())) < 5.0  # no force, no opening


def test_what_the_page_shows_runs(home: Path) -> None:
    page = (ROOT / "docs/robots.md").read_text(encoding="utf-8")
    usd, isaac = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    known: dict[str, Any] = {}
    exec(usd.replace('"house.usda"', repr(str(home))), known)
    assert {path.rsplit("/", 1)[-1] for path in known["found"]} == {"Refrigerator_0", "Chair_0"}
    assert len(np.unique(known["found"])) == 2
    ast.parse(isaac)
