"""Wall frames and taken space: the same places for all that asks where a box may be."""

from __future__ import annotations

import numpy as np
import pytest

from chord_usd.base.places.taken_space import TakenSpace
from chord_usd.base.places.tries import around, beside, over_floor
from chord_usd.base.places.wall_frames import WallFrame, wall_frames
from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    front_direction,
    room_polygon,
)
from chord_usd.base.scene.types import Box, Room, frozen_array

SIZE = (1.2, 0.5, 0.8)


def room(turn_deg: float) -> Room:
    """An L of 4 x 3 m, turned."""
    corners = np.array([(0, 0), (4, 0), (4, 2), (2, 2), (2, 3), (0, 3)], float)
    angle = np.radians(turn_deg)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return Room("a", "living", frozen_array(corners @ turn.T))


@pytest.mark.parametrize("turn_deg", [0.0, 30.0, 90.0])
def test_boxes_along_a_wall_have_their_backs_on_it_and_look_into_the_room(turn_deg: float):
    outline = room(turn_deg)
    for wall in wall_frames(outline):
        boxes = list(wall.boxes(SIZE, 0.3))
        assert bool(boxes) == (wall.length_m >= SIZE[0])
        for box in boxes:
            low_u, high_u, low_v, high_v = wall.extent(footprint(box))
            assert -1e-9 <= low_u < high_u <= wall.length_m + 1e-9
            assert (low_v, high_v) == pytest.approx((0.0, SIZE[1]), abs=1e-6)
            assert front_direction(box.yaw_deg) @ wall.inward == pytest.approx(1.0)


def test_points_survive_a_wall_frame_and_back():
    wall = WallFrame.between(np.array([1.0, 2.0]), np.array([4.0, 6.0]))
    points = np.array([[0.3, 0.2], [2.0, -1.0]])
    assert wall.local(np.array([wall.at(*point) for point in points])) == pytest.approx(points)


def test_places_beside_a_piece_touch_its_gap_and_never_the_piece():
    anchor = Box((1.0, 1.0, 0.0), (1.6, 0.9, 0.7), 40.0)
    for looks in (False, True):
        boxes = list(beside(Box((0, 0, 0), (0.5, 0.4, 0.9), 0.0), anchor, 0.03, 0.1,
                            looks_at_it=looks))  # fmt: skip
        gaps = [footprint_polygon(box).distance(footprint_polygon(anchor)) for box in boxes]
        assert min(gaps) == pytest.approx(0.03, abs=1e-3)
        assert max(gaps) < 0.04
        if looks:
            ahead = [np.subtract(anchor.center_m, box.center_m)[:2] for box in boxes]
            assert all(front_direction(box.yaw_deg) @ way > 0
                       for box, way in zip(boxes, ahead, strict=True))  # fmt: skip


def test_places_around_come_from_near_to_far_and_over_the_floor_cover_it():
    box = Box((0.0, 0.0, 0.0), SIZE, 0.0)
    away = [float(np.hypot(*place.center_m[:2])) for place in around(box, 0.1, 0.5)]
    assert away == sorted(away)
    assert max(away) <= 0.5 + 1e-9
    outline = room(0.0)
    places = {place.center_m[:2] for place in over_floor(box, outline, 0.3)}
    inside = [at for at in places if room_polygon(outline).buffer(-0.3).contains_properly(
        footprint_polygon(Box((*at, 0.0), (0.01, 0.01, 0.1), 0.0)))]  # fmt: skip
    assert len(inside) > 30


def test_taken_space_names_the_reason_and_the_owner_of_what_is_hit():
    taken = TakenSpace()
    taken.add(Box((0.0, 0.0, 0.0), (1.0, 1.0, 0.4), 0.0), "piece", "chest")
    taken.add(Box((0.0, 0.0, 1.0), (1.0, 1.0, 0.5), 20.0), "swing", "cupboard")
    low, high = Box((0.2, 0.2, 0.0), (0.2, 0.2, 0.2), 0.0), Box((0.2, 0.2, 1.1), (0.2, 0.2, 0.2), 5)
    assert taken.hit(low) == ("piece", "chest")
    assert taken.hit(high) == ("swing", "cupboard")
    assert taken.hit(high, ("swing",)) is None
    assert taken.hit(low, but=("chest",)) is None
    assert taken.hit(Box((0.0, 0.0, 0.4), (1.0, 1.0, 0.6), 0.0)) is None
