"""Trim around openings: what is written is what furniture keeps clear of, and the check sees it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from chord_usd.base.metrics.walk import is_shut
from chord_usd.base.scene.trim import boards, casings
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph
from chord_usd.library.database import load_database
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.off_trim import clear_trim
from chord_usd.line.graph.match import match_assets
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_stage import check_stage

ROOM = Room("r", "bedroom", np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]))
DOOR = Opening("d", "door", Box((1.0, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("r",))
WINDOW = Opening("w", "window", Box((2.0, 4.12, 0.9), (1.2, 0.24, 1.2), 0.0), ("r",))


def cabinet(x_m: float, y_m: float = 0.225) -> Item:
    return Item("c", "cabinet", Box((x_m, y_m, 0.0), (1.0, 0.45, 0.9), 180.0), "r")


def house(*items: Item) -> SceneGraph:
    return match_assets(SceneGraph((ROOM,), (DOOR, WINDOW), items), load_database())


STEPPED = replace(
    ROOM,
    polygon_m=np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.94], [2.2, 3.94], [2.2, 4.0], [0.0, 4.0]]),
)
"""The wall of the window is 6 cm thicker before a third of it."""


@pytest.mark.parametrize("room", [ROOM, STEPPED], ids=["even", "stepped"])
def test_trim_is_where_it_is_written(room: Room, tmp_path: Path) -> None:
    graph = SceneGraph((room,), (DOOR, WINDOW), ())
    stage = Usd.Stage.Open(str(author_stage(graph, tmp_path / "h.usda").path))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default", "render"])
    frame, board = (
        next(
            cache.ComputeWorldBound(prim).ComputeAlignedRange()
            for prim in stage.TraverseAll()
            if prim.GetName().startswith(name) and f"/{opening}/" in str(prim.GetPath())
        )
        for opening, name in (("Door_0", "Frame"), ("Window_0", "Board"))
    )
    left, right = casings(DOOR, room)
    assert frame.GetMin()[0] == pytest.approx(left.center_m[0] - left.size_m[0] / 2, abs=1e-3)
    assert frame.GetMax()[0] == pytest.approx(right.center_m[0] + right.size_m[0] / 2, abs=1e-3)
    assert frame.GetMax()[1] == pytest.approx(right.center_m[1] + right.size_m[1] / 2, abs=1e-3)
    (told,) = boards(WINDOW, room)
    assert board.GetMin()[1] == pytest.approx(told.center_m[1] - told.size_m[1] / 2, abs=1e-3)
    assert board.GetMax()[0] == pytest.approx(told.center_m[0] + told.size_m[0] / 2, abs=1e-3)
    assert board.GetMax()[2] == pytest.approx(told.top_m, abs=5e-3)


def test_furniture_off_one_casing_is_not_in_another() -> None:
    next_door = replace(DOOR, id="e", box=replace(DOOR.box, center_m=(3.015, -0.12, 0.0)))
    graph = SceneGraph((ROOM,), (DOOR, next_door), (cabinet(2.0),))
    moved = clear_trim(Arrangement.of(graph)).items[0].box
    middle_m, half_m = np.array(moved.center_m[:2]), np.array(moved.size_m[:2]) / 2
    for leg in (*casings(DOOR, ROOM), *casings(next_door, ROOM)):
        apart_m = np.abs(middle_m - leg.center_m[:2]) - half_m - np.array(leg.size_m[:2]) / 2
        assert apart_m.max() > 0.0


@pytest.mark.parametrize("x_m", [1.96, 2.0])
def test_furniture_flush_beside_a_door_comes_off_its_casing(tmp_path: Path, x_m: float) -> None:
    before = house(cabinet(x_m))
    after = clear_trim(Arrangement.of(before))
    bad, good = (
        check_stage(author_stage(graph, tmp_path / f"{name}.usda").path)
        for name, graph in (("bad", before), ("good", after))
    )
    assert [one.b.split("/")[-1] for one in bad.collisions] == ["Door_0"]
    assert good.collisions == ()
    assert (
        0.0
        < np.hypot(*np.subtract(after.items[0].box.center_m, before.items[0].box.center_m)[:2])
        < 0.06
    )


def test_what_is_clear_or_kept_stays() -> None:
    clear, caught = house(cabinet(2.02)), house(cabinet(1.96))
    assert clear_trim(Arrangement.of(clear)).items == clear.items
    assert clear_trim(Arrangement.of(caught, movable=())).items == caught.items


def test_the_check_sees_what_reaches_through_a_window_board(tmp_path: Path) -> None:
    tall = replace(cabinet(2.0, 3.775), box=Box((2.0, 3.775, 0.0), (1.0, 0.45, 1.1), 0.0))
    found = check_stage(author_stage(house(tall), tmp_path / "h.usda").path)
    assert "Window_0" in [one.b.split("/")[-1] for one in found.collisions]


def test_what_is_as_high_as_a_sill_comes_off_it(tmp_path: Path) -> None:
    tall = replace(cabinet(2.0, 3.775), box=Box((2.0, 3.775, 0.0), (1.0, 0.45, 0.915), 0.0))
    before = house(tall)
    after = clear_trim(Arrangement.of(before))
    assert before.items[0].box.center_m[1] - after.items[0].box.center_m[1] < 0.04
    found = check_stage(author_stage(after, tmp_path / "h.usda").path)
    assert found.collisions == ()


def test_a_basin_that_comes_off_a_casing_shuts_no_bathroom() -> None:
    """Straight into the room, it would leave less than a walker needs beside the shower."""
    corners = np.array([[0.0, 0.0], [1.59, 0.0], [1.59, 1.77], [0.0, 1.77]])
    room = Room("r", "bathroom", corners)
    door = Opening("d", "door", Box((1.71, 0.55, 0.0), (0.7, 0.24, 2.1), 90.0), ("r",))
    boxes = {
        "shower": Box((0.4, 0.4, 0.0), (0.8, 0.8, 2.15), 180.0),
        "toilet": Box((0.2925, 1.254, 0.0), (0.379, 0.585, 0.82), 90.0),
        "washbasin": Box((1.39, 1.19, 0.0), (0.525, 0.4, 0.85), -90.0),
    }
    items = tuple(Item(name, name, box, "r") for name, box in boxes.items())
    graph = SceneGraph((room,), (door,), items)
    assert not is_shut(graph, room)
    after = clear_trim(Arrangement.of(graph))
    assert after.items[2].box != items[2].box
    assert not is_shut(after, room)
