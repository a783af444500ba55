"""How far doors and drawers open: against shapes whose angles and ways are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from chord_usd.base.places.swept import WALL, Boxes, Leaf, swept_box, way_of
from chord_usd.base.scene.types import Box

WIDTH_M, THICK_M = 0.6, 0.02
ROOM = shapely.box(-5.0, -5.0, 5.0, 5.0)
NOTHING = Boxes.of(np.zeros((0, 2, 3)))


def door(opens_deg: float = -90.0) -> Leaf:
    """Hung at the left of a front in the plane y = 0."""
    bounds = np.array([[[-WIDTH_M / 2, 0.0, 0.1], [WIDTH_M / 2, THICK_M, 2.0]]])
    return Leaf("Door_1", True, 2, np.array([-WIDTH_M / 2, 0.0, 0.1]), opens_deg, bounds)


def drawer(opens_m: float = -0.4) -> Leaf:
    bounds = np.array([[[-0.2, 0.0, 0.5], [0.2, 0.4, 0.7]]])
    return Leaf("Drawer_1", False, 1, np.array([0.0, 0.0, 0.5]), opens_m, bounds)


def piece(yaw_deg: float = 0.0) -> Box:
    return Box((0.0, 0.0, 0.0), (WIDTH_M, 0.6, 2.0), yaw_deg)


@pytest.mark.parametrize("yaw_deg", [0.0, 37.0, -90.0])
@pytest.mark.parametrize("away_m", [0.2, 0.35, 0.5])
def test_a_door_stops_at_the_angle_at_which_its_edge_meets_a_board(away_m: float, yaw_deg: float):
    box = piece(yaw_deg)
    board = Boxes.of(np.array([[-2.0, -away_m - 0.1, 0.0], [2.0, -away_m, 1.0]])).placed(box)
    way = way_of(door(), box, board, ROOM)
    meets_deg = math.degrees(math.asin(away_m / WIDTH_M))
    step_deg = 90.0 / len(door().shares)
    assert way.stopped_by == 0
    assert meets_deg - 2 * step_deg <= 90.0 * way.share <= meets_deg
    assert not way.is_free


def test_a_drawer_stops_at_a_casing_of_a_finger_s_breadth():
    casing = Boxes.of(np.array([[0.19, -0.3, 0.0], [0.25, -0.2, 2.1]]))
    way = way_of(drawer(), piece(), casing, ROOM)
    assert way.share * 0.4 == pytest.approx(0.2, abs=0.021)
    beside = Boxes.of(np.array([[0.201, -0.3, 0.0], [0.25, -0.2, 2.1]]))
    assert way_of(drawer(), piece(), beside, ROOM).is_free


def test_walls_stop_leaves_and_what_is_above_or_below_does_not():
    narrow = shapely.box(-5.0, -0.3, 5.0, 5.0)
    assert way_of(door(), piece(), NOTHING, narrow).stopped_by == WALL
    above = Boxes.of(np.array([[-1.0, -1.0, 2.05], [1.0, 0.0, 2.4]]))
    below = Boxes.of(np.array([[-1.0, -1.0, 0.0], [1.0, 0.0, 0.02]]))
    for free in (above, below):
        assert way_of(door(), piece(), free, ROOM).share == 1.0


@pytest.mark.parametrize("leaf", [door(), drawer()], ids=["door", "drawer"])
def test_nothing_outside_the_swept_box_stops_a_leaf(leaf: Leaf):
    rng = np.random.default_rng(3)
    for _ in range(60):
        box = Box((*rng.uniform(-1, 1, 2), 0.0), (0.6, 0.6, 2.0), float(rng.uniform(-180, 180)))
        swept = swept_box(leaf, box)
        low = rng.uniform(-2.0, 2.0, 3)
        other = np.array([low, low + rng.uniform(0.05, 0.6, 3)])
        way = way_of(leaf, box, Boxes.of(other), ROOM)
        (length, depth, height), base = swept.size_m, swept.center_m[2]
        corners = Boxes.of(other).corners[0]
        turn = math.radians(swept.yaw_deg)
        ahead = corners[:, :2] - swept.center_m[:2]
        u = ahead @ (math.cos(turn), math.sin(turn))
        v = ahead @ (-math.sin(turn), math.cos(turn))
        apart = (
            u.min() > length / 2 or u.max() < -length / 2 or v.min() > depth / 2
            or v.max() < -depth / 2 or low[2] > base + height or other[1, 2] < base
        )  # fmt: skip
        assert not (apart and way.stopped_by == 0)
