"""Posing a house moves it and nothing else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.base.scene.geometry import footprint, front_direction, room_polygon
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.types import Box, Item, Opening, Plan, Room, SceneGraph
from chord_usd.base.scene.units import rotation_2d
from chord_usd.workshop.data.augment import random_pose

poses = st.builds(
    Pose,
    st.booleans(),
    st.floats(0.5, 2.0),
    st.floats(-180.0, 180.0, allow_nan=False),
    st.tuples(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0)),
)


def _house() -> SceneGraph:
    polygon = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [1.0, 3.5]])
    bed = Box((1.4, 1.2, 0.0), (1.8, 2.1, 1.0), 30.0)
    door = Box((2.0, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0)
    return SceneGraph(
        (Room("r", "bedroom", polygon),),
        (Opening("d", "door", door),),
        (Item("bed_0", "bed", bed, "r"),),
    )


@given(poses)
def test_corners_and_front_move_as_points_do(pose):
    before, after = _house(), posed(_house(), pose)
    old, new = before.items[0].box, after.items[0].box
    corners = pose.points(footprint(old))
    # A mirror swaps left and right, never front and back.
    order = [3, 2, 1, 0] if pose.mirrored else [0, 1, 2, 3]
    assert np.allclose(footprint(new), corners[order])
    ahead = pose.points(np.array([old.center_m[:2]]) + front_direction(old.yaw_deg))
    here = pose.points(np.array([old.center_m[:2]]))
    assert np.allclose((ahead - here)[0] / pose.scale, front_direction(new.yaw_deg))


@given(poses)
def test_rooms_stay_counter_clockwise_and_scale_in_area(pose):
    room = posed(_house(), pose).rooms[0]
    polygon = room_polygon(room)
    assert polygon.exterior.is_ccw
    assert polygon.area == pytest.approx(room_polygon(_house().rooms[0]).area * pose.scale**2)


@given(st.integers(0, 2**32 - 1))
def test_random_poses_are_the_same_for_the_same_seed(seed):
    one = random_pose(_house(), np.random.default_rng(seed))
    other = random_pose(_house(), np.random.default_rng(seed))
    assert one.items[0].box == other.items[0].box


@given(poses)
def test_children_end_up_where_their_points_go(pose):
    house = _house()
    cup = Item("cup", "coffee_cup", Box((0.3, -0.2, 0.5), (0.1, 0.2, 0.1), 40.0))
    table = Item("t", "table", house.items[0].box, "r", children=(cup,))
    after = posed(SceneGraph(house.rooms, house.openings, (table,)), pose).items[0]
    order = [3, 2, 1, 0] if pose.mirrored else [0, 1, 2, 3]
    assert np.allclose(_child_corners(after), pose.points(_child_corners(table))[order])


def _child_corners(parent: Item) -> np.ndarray:
    turned = footprint(parent.children[0].box) @ rotation_2d(parent.box.yaw_deg).T
    return turned + np.array(parent.box.center_m[:2])


def test_mirroring_twice_and_four_quarters_give_the_same_house():
    house = _house()
    there_and_back = posed(posed(house, Pose(mirrored=True)), Pose(mirrored=True))
    turned = house
    for _ in range(4):
        turned = posed(turned, Pose(yaw_deg=90.0))
    for other in (there_and_back, turned):
        assert other.items[0].box == house.items[0].box
        assert np.array_equal(other.rooms[0].polygon_m, house.rooms[0].polygon_m)


def test_fixtures_of_a_real_flat_move_with_it():
    house = _house()
    toilet = {"category": "toilet", "x": 1.0, "y": 2.0, "w": 0.4, "h": 0.7}
    plan = Plan(house.rooms, house.openings, {"fixtures": [toilet]})
    after = posed(plan, Pose(mirrored=True, yaw_deg=90.0, offset_m=(1.0, 0.0)))
    moved = after.extra["fixtures"][0]
    assert (moved["x"], moved["y"], moved["yaw"]) == (-1.0, -1.0, 90.0)
