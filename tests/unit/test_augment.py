"""Posing a house moves it and nothing else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.data.augment import Pose, posed, random_pose
from chord_usd.geometry import footprint, front_direction, room_polygon
from chord_usd.types import Box, Item, Opening, Room, SceneGraph

poses = st.builds(
    Pose, st.booleans(), st.floats(0.5, 2.0), st.floats(-180.0, 180.0, allow_nan=False)
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


def test_tabletop_items_are_not_mirrored_in_silence():
    house = _house()
    cup = Item("cup", "coffee_cup", Box((0.1, 0.0, 0.5), (0.1, 0.1, 0.1), 0.0))
    table = Item("t", "table", house.items[0].box, "r", children=(cup,))
    scene = SceneGraph(house.rooms, house.openings, (table,))
    with pytest.raises(ValueError, match="not mirrored"):
        posed(scene, Pose(mirrored=True))
    assert posed(scene, Pose(yaw_deg=90.0)).items[0].children == (cup,)
