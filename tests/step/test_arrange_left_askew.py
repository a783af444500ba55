"""Chairs and armchairs a little askew: never at the cost of what the certificate asks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.metrics.clear_floor import WAY_M, shut_borders
from chord_usd.base.scene.types import Box, Item, Room, SceneGraph
from chord_usd.base.scene.units import wrap_deg
from chord_usd.library.database import load_database
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.rules import arrange
from chord_usd.line.arrange.seating import RULE, leave_askew
from chord_usd.line.graph.match import match_assets
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_stage import check_stage

ROOM = Room("r", "dining", np.array([[0.0, 0.0], [5.0, 0.0], [5.0, 4.0], [0.0, 4.0]]))


def house(armchair_y_m: float = 0.6, armchair_x_m: float = 4.2) -> SceneGraph:
    """A table with a row of two chairs at each side, and an armchair before a cabinet."""
    seats = [
        Item(f"chair_{n}", "chair", Box((x, y, 0.0), (0.45, 0.5, 0.9), yaw), "r")
        for n, (x, y, yaw) in enumerate(
            [(1.7, 2.95, 0.0), (2.3, 2.95, 0.0), (1.7, 1.65, 180.0), (2.3, 1.65, 180.0)]
        )
    ]
    table = Item("table", "dining_table", Box((2.0, 2.3, 0.0), (1.4, 0.85, 0.75), 0.0), "r")
    chair = Item(
        "armchair", "single_sofa", Box((armchair_x_m, armchair_y_m, 0.0), (0.8, 0.8, 0.8), 180), "r"
    )
    cabinet = Item("cabinet", "cabinet", Box((4.2, 1.65, 0.0), (0.8, 0.4, 1.0), 0.0), "r")
    return match_assets(SceneGraph((ROOM,), (), (table, *seats, chair, cabinet)), load_database())


def test_they_are_turned_a_little_and_nothing_collides(tmp_path: Path) -> None:
    before = house()
    after = arrange(Arrangement.of(before), "meshed")
    turned = 0
    for old, new in zip(before.items, after.items, strict=True):
        turn = abs(wrap_deg(new.box.yaw_deg - old.box.yaw_deg))
        turned += turn > 0.0
        assert turn == 0.0 or (new.category == "chair" and 2.0 <= turn <= 6.0)
        assert new.box.size_m == old.box.size_m
        assert np.hypot(*np.subtract(new.box.center_m, old.box.center_m)[:2]) <= 0.0501
        assert (turn > 0.0) == (RULE in [edit.rule for edit in new.facts.edits])
    assert turned >= 3
    assert check_stage(author_stage(after, tmp_path / "house.usda").path).collisions == ()
    assert arrange(Arrangement.of(after), "meshed").items == after.items, "once is enough"


def test_an_armchair_narrows_no_passage_and_what_is_locked_stays() -> None:
    """0.45 m are left before the cabinet: enough for one who walks, and nothing to spare."""
    graph = house()
    free = house(armchair_y_m=0.45)
    found = {item.id: item for item in leave_askew(Arrangement.of(graph)).items}
    assert found["armchair"].box == graph.items[5].box
    assert leave_askew(Arrangement.of(free)).items[5].box.yaw_deg != free.items[5].box.yaw_deg
    assert leave_askew(Arrangement.of(graph, movable=())).items == graph.items


def test_a_passage_at_a_wall_stays_beside_a_nearer_wall() -> None:
    """0.1 m from the wall at its side, an armchair leaves 0.42 m before it."""
    for before_m, turns in ((0.42, False), (0.55, True)):
        graph = house(0.4 + before_m, 5.0 - 0.4 - 0.1)
        free = tuple(item for item in graph.items if item.id != "cabinet")
        (armchair,) = (item for item in free if item.id == "armchair")
        after = leave_askew(Arrangement.of(replace(graph, items=free)))
        (left,) = (item for item in after.items if item.id == "armchair")
        assert (left.box != armchair.box) == turns


@pytest.mark.parametrize("name", ["a", "b", "c", "d"])
def test_a_chair_turns_into_no_open_border(name: str) -> None:
    """A border with a way across, half a centimetre wider than one needs."""
    beside = Room("s", "kitchen", np.array([[5.0, 0.0], [8.0, 0.0], [8.0, 4.0], [5.0, 4.0]]))
    chair = Item(name, "chair", Box((4.7, 3.0, 0.0), (0.45, 0.5, 0.9), 90.0), "r")
    (seat,) = match_assets(SceneGraph((ROOM,), (), (chair,)), load_database()).items
    low = seat.box.center_m[1] - seat.box.size_m[0] / 2 - WAY_M - 0.005
    block = Item("f", "cabinet", Box((5.2, low / 2, 0.0), (low, 0.4, 1.0), 90.0), "s")
    other = Item("g", "cabinet", Box((5.2, 3.7, 0.0), (0.6, 0.4, 1.0), 90.0), "s")
    graph = SceneGraph((ROOM, beside), (), (seat, block, other))
    assert not list(shut_borders(graph))
    assert not list(shut_borders(leave_askew(Arrangement.of(graph))))
