"""Pieces step out of the way of doors, by a little and into nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.graph.aside import FARTHEST_M, shut_in, step_aside
from chord_usd.metrics.openings import blocked_openings
from chord_usd.metrics.overlap import scene_overlap
from chord_usd.metrics.rooms import out_of_room
from chord_usd.types import MOVED, Box, Item, Opening, Room, SceneGraph, frozen_array

DOOR = Opening("door", "door", Box((0.6, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("r",))
"""In the lower wall; it keeps the floor free that lies in [0.16, 1.04] x [0.01, 0.89]."""
CLEAR_TO_M = 0.89

BED = Item("bed", "bed", Box((1.0, 1.35, 0.0), (1.0, 2.0, 0.9), 90.0), "r")
"""With its head on the left wall; its side is at y = 0.85."""


def house(*items: Item, openings: tuple[Opening, ...] = (DOOR,)) -> SceneGraph:
    corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]
    return SceneGraph((Room("r", "bedroom", frozen_array(corners)),), openings, items)


def shifted(item: Item, x_m: float = 0.0, y_m: float = 0.0) -> Item:
    x, y, z = item.box.center_m
    return replace(item, box=replace(item.box, center_m=(x + x_m, y + y_m, z)))


def cabinet(x_m: float, y_m: float) -> Item:
    return Item("cabinet", "cabinet", Box((x_m, y_m, 0.0), (0.6, 0.4, 2.0), 0.0), "r")


def move_m(before: SceneGraph, after: SceneGraph) -> np.ndarray:
    """(2,) of the first item."""
    return np.subtract(after.items[0].box.center_m, before.items[0].box.center_m)[:2]


def test_a_bed_moves_along_its_wall_by_the_least_that_clears_the_door() -> None:
    before = house(BED)
    assert blocked_openings(before)
    after = step_aside(before)
    assert not blocked_openings(after)
    x_m, y_m = move_m(before, after)
    assert x_m == pytest.approx(0.0), "its head stays on the wall"
    assert CLEAR_TO_M - 0.85 - 1e-3 <= y_m <= CLEAR_TO_M - 0.85 + 0.01
    assert after.items[0].extra[MOVED] == pytest.approx(y_m)
    assert after.items[0].box.size_m == BED.box.size_m


@pytest.mark.parametrize(
    "graph",
    [
        house(shifted(BED, y_m=-0.1)),
        house(BED, cabinet(1.0, 2.06)),
        house(shifted(BED, y_m=0.05)),
        house(replace(BED, room_id="")),
    ],
    ids=["too far in the way", "something beside it", "out of the way", "in no room"],
)
def test_a_piece_that_cannot_or_need_not_stays(graph: SceneGraph) -> None:
    assert [item.box for item in step_aside(graph).items] == [item.box for item in graph.items]


def test_a_piece_in_a_corner_is_not_pushed_into_the_wall() -> None:
    room = Room("r", "bedroom", frozen_array([(0.0, 0.0), (4.0, 0.0), (4.0, 1.86), (0.0, 1.86)]))
    graph = replace(house(BED), rooms=(room,))
    assert not move_m(graph, step_aside(graph)).any()


def test_out_of_one_door_it_does_not_step_before_another() -> None:
    other = Opening("other", "door", Box((1.3, 2.795, 0.0), (0.9, 0.24, 2.1), 0.0), ("r",))
    room = Room("r", "bedroom", frozen_array([(0.0, 0.0), (4.0, 0.0), (4.0, 2.675), (0.0, 2.675)]))
    table = Item("table", "table", Box((0.6, 1.3, 0.0), (0.9, 0.9, 0.75), 0.0), "r")
    graph = replace(house(table, openings=(DOOR, other)), rooms=(room,))
    assert len(blocked_openings(graph)) == 1
    after = step_aside(graph)
    assert not move_m(graph, after).any()


def test_in_the_middle_of_a_room_it_goes_any_way() -> None:
    graph = house(Item("t", "coffee_table", Box((1.3, 1.06, 0.0), (1.2, 0.4, 0.4), 0.0), "r"))
    assert blocked_openings(graph)
    after = step_aside(graph)
    assert not blocked_openings(after)
    assert move_m(graph, after)[1] > 0.0


@given(
    x_m=st.floats(0.0, 3.0),
    y_m=st.floats(0.5, 2.5),
    yaw_deg=st.sampled_from([0.0, 30.0, 90.0, 180.0, 270.0]),
    beside_m=st.floats(0.0, 0.2),
)
def test_no_move_makes_anything_worse(
    x_m: float, y_m: float, yaw_deg: float, beside_m: float
) -> None:
    piece = Item("p", "cabinet", Box((x_m, y_m, 0.0), (0.8, 0.5, 2.0), yaw_deg), "r")
    before = house(piece, cabinet(x_m + 0.9 + beside_m, y_m))
    after = step_aside(before)
    assert np.abs(move_m(before, after)).max() <= FARTHEST_M + 1e-6
    for faults in (blocked_openings, out_of_room):
        assert len(faults(after)) <= len(faults(before))
    shared = [
        sum(pair.area_m2 for pair in scene_overlap(graph).overlapping) for graph in (before, after)
    ]
    assert shared[1] <= shared[0] + 2e-4


def test_only_doors_are_shut_in() -> None:
    in_the_way = shifted(BED, y_m=-0.7)
    window = replace(
        DOOR, id="window", kind="window", box=replace(DOOR.box, center_m=(0.6, -0.12, 0.3))
    )
    assert shut_in(house(BED, in_the_way)) == ("bed",)
    assert shut_in(house(shifted(BED, y_m=0.2))) == ()
    assert blocked_openings(house(in_the_way, openings=(window,)))
    assert shut_in(house(in_the_way, openings=(window,))) == ()
