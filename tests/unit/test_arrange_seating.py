"""Chairs without a front mark face their table, and those of one table are of one size."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

from chord_usd.base.metrics.overlap import scene_overlap
from chord_usd.base.scene.geometry import footprint, footprint_polygon, front_direction
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Box, Facts, Item, Room, SceneGraph, frozen_array
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.seating import seat_chairs

TABLE = Item("table", "dining_table", Box((2.0, 2.0, 0.0), (1.8, 0.8, 0.75), 30.0), "r")


ROOM = Room("r", "dining", frozen_array([(-2.0, -2.0), (6.0, -2.0), (6.0, 6.0), (-2.0, 6.0)]))


def seated(*items: Item) -> tuple[Item, ...]:
    return seat_chairs(Arrangement.of(SceneGraph((ROOM,), (), items))).items


def chair(own_x_m: float, own_y_m: float, yaw_deg: float = 75.0, seen: str = "wall") -> Item:
    """At this place of the table's own frame."""
    turn = np.radians(TABLE.box.yaw_deg)
    x_m = 2.0 + own_x_m * np.cos(turn) - own_y_m * np.sin(turn)
    y_m = 2.0 + own_x_m * np.sin(turn) + own_y_m * np.cos(turn)
    box = Box((float(x_m), float(y_m), 0.0), (0.45, 0.55, 0.9), yaw_deg)
    return Item("chair", "chair", box, "r", facts=Facts(front_from=seen))


def test_at_every_side_of_a_table_it_faces_across() -> None:
    for own_x_m, own_y_m, yaw_deg in (
        (0.0, 0.5, 30.0), (0.7, 0.6, 30.0), (0.6, 0.2, 30.0), (-0.8, -0.5, -150.0),
        (1.1, 0.1, -60.0), (-1.0, 0.0, 120.0), (0.0, 0.4, 30.0),
    ):  # fmt: skip
        for before_deg in (30.0, 120.0, -150.0, -60.0):
            before = chair(own_x_m, own_y_m, before_deg)
            after = seated(TABLE, before)[1]
            assert after.box.yaw_deg == pytest.approx(yaw_deg), (own_x_m, own_y_m)
            assert after.facts.front_from == "table"
            same = footprint_polygon(after.box).symmetric_difference(footprint_polygon(before.box))
            assert same.area < 1e-9, "its size is usual, and its footprint stays"


def test_of_two_tables_it_faces_the_nearer() -> None:
    other = Item("other", "table", Box((2.0, 3.4, 0.0), (1.2, 0.6, 0.75), 0.0), "r")
    box = Box((2.0, 2.95, 0.0), (0.4, 0.4, 0.9), 0.0)
    near = Item("c", "chair", box, "r", facts=Facts(front_from="wall"))
    turned = seated(TABLE, other, near)[2]
    assert front_direction(turned.box.yaw_deg) == pytest.approx((0.0, 1.0))


@pytest.mark.parametrize(
    "item",
    [
        chair(0.0, 0.5, 120.0, "mark"),
        chair(0.0, 1.2, 120.0),
        Item("s", "single_sofa", chair(0.0, 0.5, 120.0).box, "r", facts=Facts(front_from="wall")),
        Item("c", "chair", chair(0.0, 0.5, 120.0).box, "next", facts=Facts(front_from="wall")),
    ],
    ids=["its mark was seen", "too far off", "no chair", "in another room"],
)
def test_others_stay_as_they_are(item: Item) -> None:
    assert seated(TABLE, item)[1].box.yaw_deg == item.box.yaw_deg


def sized(own_x_m: float, own_y_m: float, length_m: float, depth_m: float, name: str) -> Item:
    """With its front to the table."""
    at = chair(own_x_m, own_y_m, 30.0 if own_y_m > 0 else -150.0, "mark")
    return replace(at, id=name, box=replace(at.box, size_m=(length_m, depth_m, 0.9)))


def sizes_m(items: Iterable[Item]) -> list[tuple[float, float]]:
    return [item.box.size_m[:2] for item in items if item.category == "chair"]


def test_chairs_of_a_table_take_the_middle_of_their_sizes() -> None:
    chairs = [
        sized(-0.5, 0.6, 0.42, 0.5, "a"),
        sized(0.5, 0.6, 0.48, 0.46, "b"),
        sized(0.0, -0.6, 0.56, 0.58, "c"),
    ]
    after = seated(TABLE, *chairs)
    assert sizes_m(after) == [pytest.approx((0.48, 0.5))] * 3
    for old, new in zip(chairs, after[1:], strict=True):
        fronts = [footprint(one.box)[[1, 2]].mean(axis=0) for one in (old, new)]
        assert fronts[0] == pytest.approx(fronts[1]), "no chair comes nearer to the table"
    assert sizes_m(seated(*chairs)) == sizes_m(chairs), "without a table they are no set"


def test_no_chair_is_a_doll_s_but_undersized_ones_are_left_to_be_told() -> None:
    row = category("chair")
    least = (row.length_m[0], row.width_m[0])
    small = sized(0.0, 0.6, 0.28, 0.36, "small")
    speck = sized(0.6, -0.6, 0.18, 0.2, "speck")
    assert sizes_m(seated(TABLE, small, speck)) == [pytest.approx(least), (0.18, 0.2)]


@pytest.mark.parametrize("gap_m", [0.01, 0.2])
def test_a_chair_does_not_grow_into_its_neighbour(gap_m: float) -> None:
    left = sized(-0.15 - gap_m / 2, 0.6, 0.3, 0.4, "left")
    right = sized(0.15 + gap_m / 2, 0.6, 0.3, 0.4, "right")
    after = seated(TABLE, left, right)
    graph = SceneGraph((ROOM,), (), after)
    assert not [pair for pair in scene_overlap(graph).overlapping if not pair.natural]
    grown = [size[0] > 0.35 for size in sizes_m(after)]
    assert all(grown) if gap_m > 0.1 else not all(grown)
