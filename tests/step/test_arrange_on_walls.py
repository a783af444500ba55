"""Panels hang on the wall behind them, if it is near."""

from __future__ import annotations

import numpy as np
import pytest

from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.types import Box, Item, Room, SceneGraph
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.off_trim import REACH_M, hang_on_walls

ROOM = Room("r", "bedroom", np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]]))


def hung(box: Box, category: str = "bed_background") -> tuple[Item, Item]:
    """An item before and after."""
    item = Item("one", category, box, "r")
    return item, hang_on_walls(Arrangement.of(SceneGraph((ROOM,), (), (item,)))).items[0]


@pytest.mark.parametrize("gap_m", [-0.045, -0.002, 0.002, 0.02, REACH_M - 1e-3])
def test_a_panel_near_its_wall_is_moved_onto_it(gap_m: float) -> None:
    before, after = hung(Box((2.0, 3.0 - 0.04 - gap_m, 1.1), (1.6, 0.08, 1.0), 0.0))
    assert footprint(after.box)[[0, 3], 1] == pytest.approx([3.0, 3.0])
    assert after.box.size_m == before.box.size_m
    moved = np.subtract(after.box.center_m, before.box.center_m)
    assert np.hypot(*moved[:2]) == pytest.approx(abs(gap_m), abs=1e-6)


def test_one_that_is_there_stays() -> None:
    before, after = hung(Box((2.0, 2.96, 1.1), (1.6, 0.08, 1.0), 0.0))
    assert after is before


@pytest.mark.parametrize(
    "box",
    [
        Box((2.0, 2.8, 1.1), (1.6, 0.08, 1.0), 0.0),  # in the middle of the room
        Box((2.0, 2.93, 1.1), (1.6, 0.08, 1.0), 180.0),  # its back to the room
        Box((2.0, 2.93, 1.1), (1.6, 0.08, 1.0), 2.0),  # askew
    ],
)
def test_what_hangs_nowhere_is_left_out(box: Box) -> None:
    item = Item("one", "bed_background", box, "r")
    assert not hang_on_walls(Arrangement.of(SceneGraph((ROOM,), (), (item,)))).items


def test_what_stands_on_the_floor_stays() -> None:
    before, after = hung(Box((2.0, 2.75, 0.0), (1.0, 0.46, 2.0), 0.0), "cabinet")
    assert after is before


def test_what_is_kept_stays() -> None:
    item = Item("one", "bed_background", Box((2.0, 2.93, 1.1), (1.6, 0.08, 1.0), 0.0), "r")
    graph = SceneGraph((ROOM,), (), (item,))
    assert hang_on_walls(Arrangement.of(graph, movable=())).items == (item,)
