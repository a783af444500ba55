"""A piece that shuts a room off steps aside, as little as it must."""

from __future__ import annotations

import pytest

from chord_usd.arrange.arrangement import Arrangement
from chord_usd.arrange.ways_opened import open_ways
from chord_usd.metrics.walk import WALKER_RADIUS_M, walk
from chord_usd.scene.types import Box, Item, Opening, Room, SceneGraph, frozen_array


def _room(name: str, kind: str, low_m: float, high_m: float) -> Room:
    corners = frozen_array([[0, low_m], [4, low_m], [4, high_m], [0, high_m]])
    return Room(name, kind, corners)  # type: ignore[arg-type]


def _door(name: str, y_m: float) -> Opening:
    return Opening(name, "door", Box((2.0, y_m, 0.0), (0.8, 0.24, 2.1), 0.0))


def _house(*items: Item) -> SceneGraph:
    """A hall, a bedroom behind it, and a bathroom behind that."""
    rooms = (
        _room("hall", "corridor", 0, 2),
        _room("bedroom", "bedroom", 2.24, 6.24),
        _room("bathroom", "bathroom", 6.48, 8.5),
    )
    doors = (_door("front", -0.12), _door("inner", 2.12), _door("wet", 6.36))
    return SceneGraph(rooms, doors, items)


def _piece(category: str, x_m: float, width_m: float, yaw_deg: float = 0.0) -> Item:
    box = Box((x_m, 4.3, 0.0), (width_m, 0.8, 0.8), yaw_deg)
    return Item(f"bedroom/{category}_0", category, box, "bedroom")


@pytest.mark.parametrize("yaw_deg", [0.0, 180.0])
def test_a_piece_moves_as_far_as_a_walker_needs(yaw_deg: float) -> None:
    house = _house(_piece("bed", 1.9, 3.4, yaw_deg))
    assert walk(house).unreachable == ("bathroom",)
    after = open_ways(Arrangement.of(house))
    assert walk(after).unreachable == ()
    (bed,) = after.items
    assert bed.box.center_m == pytest.approx((1.85, 4.3, 0.0))
    assert 4.0 - bed.box.center_m[0] - 1.7 > 2 * WALKER_RADIUS_M
    assert open_ways(Arrangement.of(after)) is after


def test_what_no_move_helps_or_may_not_move_stays() -> None:
    too_wide, bed = _house(_piece("bed", 2.0, 3.9)), _house(_piece("bed", 1.9, 3.4))
    assert open_ways(Arrangement.of(too_wide)) is too_wide
    assert open_ways(Arrangement.of(bed, movable=())) is bed
