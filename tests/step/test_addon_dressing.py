"""The extension in Blender with a dressed house: what rests on a piece goes with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Sdf, Usd

from chord_usd.base.scene.chord_json import read_scene, write_scene
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Box, Facts, Item
from chord_usd.cli import main

SCENE = Path(__file__).parents[1] / "fixtures" / "furnished_house.json"
ROOM = "/House/Rooms/Bedroom_0"
TABLE, BOWL, PICTURE = (
    f"{ROOM}/{name}"
    for name in ("Furniture/BedsideTable_0", "Dressing/Bowl_0", "Dressing/Picture_0")
)

pytestmark = pytest.mark.acceptance

Told = dict[str, Any]


@pytest.fixture(scope="module")
def dressed(run_in_blender: Callable[..., Told], tmp_path_factory: pytest.TempPathFactory) -> Told:
    """What happened to a house with a bowl on a bedside table and a picture on a wall."""
    folder = tmp_path_factory.mktemp("dressed")
    graph = read_scene(SCENE)
    table = next(item for item in graph.items if item.category == "bedside_table")
    x, y, _ = table.box.center_m
    low = graph.plan.room(table.room_id).polygon_m.min(axis=0)
    bowl = Box((x, y, table.box.size_m[2]), (0.2, 0.2, 0.08), 0.0)
    picture = Box((low[0] + 0.02, low[1] + 1.0, 1.4), (0.5, 0.03, 0.7), 90.0)
    dressing = (
        Item("bowl", "bowl", bowl, table.room_id, facts=Facts(rests_on=table.id)),
        Item("picture", "picture", picture, table.room_id),
    )
    write_scene(replace(graph, dressing=dressing), folder / "scene.json")
    stage = folder / "house.usda"
    # The picture hangs in the panel behind the bed: what Blender does with it is looked at here.
    assert main(["stage", str(folder / "scene.json"), "-o", str(stage), "--no-check"]) == 0
    return {**run_in_blender("dressing.py", stage), "stage": str(stage)}


def edits_of(told: Told) -> Sdf.Layer:
    """The layer of changes after a swap."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    assert layer.ImportFromString(told["edits"])
    return layer


def test_nothing_of_the_house_has_a_number_for_a_name(dressed: Told) -> None:
    assert not [name for name in dressed["names"] if "." in name]
    assert "Wall_0_Bedroom_0" in dressed["names"]


def test_the_sun_is_as_strong_as_the_house_says(dressed: Told) -> None:
    house = Usd.Stage.Open(dressed["stage"])
    said = house.GetPrimAtPath("/House/Lighting/Sun").GetAttribute("inputs:intensity").Get()
    assert dressed["suns"] == pytest.approx([said])


def test_what_moves_brings_what_a_swap_needs_to_weigh_it(dressed: Told) -> None:
    assert dressed["densities"] == [CATEGORIES["bowl"].kg_per_m3, None]


def test_changes_as_root_keep_the_render_settings(dressed: Told) -> None:
    layers = Sdf.Layer.FindOrOpen(dressed["stage"]), edits_of(dressed)
    first, second = (one.pseudoRoot.GetInfo("renderSettingsPrimPath") for one in layers)
    assert first == second != ""


def test_dressing_is_listed_and_goes_with_what_it_rests_on(dressed: Told) -> None:
    assert dressed["open"] == dressed["reopened"] == ""
    assert "Bedroom_0 Dressing" in dressed["tree"]["House"]["Bedroom_0"]
    assert ["operator", "chord.select_piece"] in [line[:2] for line in dressed["drawn"]]
    assert dressed["untouched"] == []
    x_before, x_after = dressed["before"][0][3], dressed["after"][0][3]
    assert x_after - x_before == pytest.approx(0.25, abs=1e-5)
    assert dressed["still"]
    assert dressed["moved"] == [BOWL, TABLE]
    assert np.allclose(dressed["again"], dressed["after"], atol=1e-5)


def test_dressing_is_locked_swapped_and_deleted(dressed: Told) -> None:
    assert dressed["locked"] == [BOWL, TABLE], "what it rests on stays, too"
    assert dressed["unlocked"] == []
    assert dressed["found"] == dressed["swapped"] == ""
    assert dressed["offered"] > 1
    assert dressed["swaps"] == [PICTURE]
    assert dressed["gone"] == [BOWL, TABLE], "what rests on a piece goes with it"
