"""Doors that are added to planned floors."""

import pytest

from chord_usd.base.scene.types import Box, Opening
from chord_usd.line.planning.ways import DOOR_M, FRONT_DOOR_M, Border, missing_doors

BOX = Box((0.0, 0.0, 0.0), (0.8, 0.24, 2.1), 0.0)
KINDS = {"corridor1": "corridor", "bedroom1": "bedroom", "bathroom1": "bathroom"}


def door(*rooms: str) -> Opening:
    return Opening("door", "door", BOX, rooms)


def border(index: int, *rooms: str, length_m: float = 3.0, taken_m=()) -> Border:
    return Border(rooms, index, length_m, tuple(taken_m))


def test_a_house_that_is_open_gets_no_door() -> None:
    openings = [door("corridor1"), door("corridor1", "bedroom1"), door("bathroom1", "bedroom1")]
    assert missing_doors(KINDS, openings, [border(0, "corridor1")]) == []


def test_a_shut_house_is_entered_by_the_corridor() -> None:
    borders = [border(0, "bedroom1", length_m=6.0), border(1, "corridor1", length_m=1.2)]
    found = missing_doors({"corridor1": "corridor"} | KINDS, [], borders)
    assert [(one.border.index, one.width_m) for one in found] == [(1, FRONT_DOOR_M)]


def test_rooms_are_entered_from_the_corridor_rather_than_from_the_bathroom() -> None:
    openings = [door("corridor1"), door("corridor1", "bathroom1")]
    borders = [border(0, "bathroom1", "bedroom1"), border(1, "corridor1", "bedroom1", length_m=1)]
    (found,) = missing_doors(KINDS, openings, borders)
    assert found.border.index == 1
    assert found.width_m == DOOR_M


def test_a_room_behind_a_room_is_reached_too() -> None:
    borders = [border(0, "corridor1", "bedroom1"), border(1, "bedroom1", "bathroom1")]
    found = missing_doors(KINDS, [door("corridor1")], borders)
    assert [one.border.index for one in found] == [0, 1]


def test_doors_keep_clear_of_openings_and_of_short_walls() -> None:
    window = border(0, "corridor1", length_m=2.0, taken_m=[(0.0, 1.3)])
    short = border(1, "corridor1", length_m=0.5)
    (found,) = missing_doors({"corridor1": "corridor"}, [], [window, short])
    assert found.border.index == 0
    assert found.middle_m - found.width_m / 2 >= 1.3 - 1e-9
    assert found.width_m == pytest.approx(0.7)
    assert missing_doors({"corridor1": "corridor"}, [], [short]) == []
