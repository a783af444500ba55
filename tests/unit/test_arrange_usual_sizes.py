"""Pieces below the usual sizes of their kind grow to them where the room has the space."""

from __future__ import annotations

import numpy as np
import pytest

from chord_usd.arrange.arrangement import Arrangement
from chord_usd.arrange.usual_sizes import grow_to_usual
from chord_usd.metrics.clear_floor import blocked_openings
from chord_usd.metrics.overlap import scene_overlap
from chord_usd.scene.geometry import to_own, to_world
from chord_usd.scene.palette import category
from chord_usd.scene.types import Box, Item, Opening, Room, SceneGraph, frozen_array

ROOM = Room("r", "bathroom", frozen_array([(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0)]))
LEAST_M = (category("toilet").length_m[0], category("toilet").width_m[0])


def toilet(x_m: float = 1.5, size_m: tuple[float, float] = (0.3, 0.4), yaw: float = 0.0) -> Item:
    """With its back at the upper wall."""
    box = Box((x_m, 2.0 - size_m[1] / 2, 0.0), (*size_m, 0.75), yaw)
    return Item("toilet", "toilet", box, "r")


def grown(*items: Item, openings: tuple[Opening, ...] = ()) -> tuple[Item, ...]:
    return grow_to_usual(Arrangement.of(SceneGraph((ROOM,), openings, items))).items


def left_back(box: Box) -> np.ndarray:
    return to_world(box, (-box.size_m[0] / 2, box.size_m[1] / 2))


def test_a_small_piece_gets_the_usual_size_and_keeps_its_back_and_its_middle() -> None:
    (after,) = grown(toilet())
    assert after.box.size_m == (*LEAST_M, 0.75)
    assert after.box.center_m[0] == pytest.approx(1.5)
    assert after.box.center_m[1] + after.box.size_m[1] / 2 == pytest.approx(2.0)


@pytest.mark.parametrize("yaw", [90.0, 30.0, -135.0])
def test_it_grows_in_its_own_frame(yaw: float) -> None:
    box = Box((1.5, 1.0, 0.0), (0.3, 0.4, 0.75), yaw)
    (after,) = grown(Item("toilet", "toilet", box, "r"))
    own = to_own(box, after.box.center_m[:2])
    assert own == pytest.approx((0.0, (0.4 - LEAST_M[1]) / 2))
    assert after.box.yaw_deg == yaw


def test_in_a_corner_it_grows_away_from_the_wall() -> None:
    (after,) = grown(toilet(x_m=0.15))
    assert after.box.size_m[:2] == LEAST_M
    assert left_back(after.box) == pytest.approx((0.0, 2.0))


def test_between_two_pieces_only_its_depth_grows() -> None:
    sides = [
        Item(name, "cabinet", Box((x, 1.7, 0.0), (0.6, 0.6, 2.0), 0.0), "r")
        for name, x in (("a", 1.04), ("b", 1.96))
    ]
    after = grown(toilet(), *sides)
    assert after[0].box.size_m[:2] == (0.3, LEAST_M[1])
    assert after[1:] == tuple(sides)
    assert not scene_overlap(SceneGraph((ROOM,), (), after)).overlapping


def test_a_table_does_not_grow_over_a_chair_and_a_bed_may_below_its_panel() -> None:
    def piece(name: str, x_m: float, y_m: float, size_m: tuple[float, float, float]) -> Item:
        mount_m = category(name).mount_height_m
        return Item(name, name, Box((x_m, y_m, mount_m), size_m, 0.0), "r")

    table = piece("dining_table", 0.5, 1.0, (0.9, 0.6, 0.75))
    chair = piece("chair", 0.5, 0.5, (0.5, 0.5, 0.9))
    assert [one.box for one in grown(table, chair)] == [table.box, chair.box]
    bed = piece("bed", 1.5, 1.0, (0.8, 2.0, 1.0))
    panel = piece("bed_background", 1.5, 1.97, (1.2, 0.06, 1.0))
    assert grown(bed, panel)[0].box.size_m[:2] == (0.9, 2.0)


def test_nothing_grows_before_a_door() -> None:
    door = Opening("d", "door", Box((1.5, -0.12, 0.0), (0.8, 0.24, 2.0), 0.0), ("r",))
    sofa = Item("s", "leisure_sofa", Box((1.5, 1.5, 0.0), (0.4, 0.4, 0.8), 0.0), "r")
    near = Item("s", "leisure_sofa", Box((1.5, 1.1, 0.0), (0.4, 0.4, 0.8), 0.0), "r")
    assert grown(sofa, openings=(door,))[0].box.size_m[:2] == (0.6, 0.6)
    after = grown(near, openings=(door,))
    assert after[0].box.size_m[1] == 0.4
    assert not blocked_openings(SceneGraph((ROOM,), (door,), after))


@pytest.mark.parametrize(
    "item",
    [
        toilet(size_m=(0.5, 0.7)),
        toilet(size_m=(0.15, 0.5)),
        Item("p", "bed_background", Box((1.5, 1.97, 1.1), (0.9, 0.06, 1.0), 0.0), "r"),
        Item("u", "double_door_floor_cabinet", Box((1.5, 1.75, 0.0), (0.5, 0.5, 0.9), 0.0), "r"),
    ],
    ids=["usual", "scrap", "panel", "kitchen unit"],
)
def test_usual_pieces_scraps_panels_and_kitchen_units_stay(item: Item) -> None:
    assert grown(item) == (item,)
