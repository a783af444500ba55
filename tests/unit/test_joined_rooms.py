"""Rooms that share their light."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import box

from chord_usd.line.image.joined import lit_with, touching

ROOMS = st.sampled_from("ABCDEF")
PAIRS = st.lists(st.tuples(ROOMS, ROOMS))


def test_light_goes_on_from_hole_to_hole_and_stops_at_walls() -> None:
    joined = [("A", "B"), ("C", "B"), ("D", "E")]
    assert lit_with("A", joined) == {"A", "B", "C"}
    assert lit_with("E", joined) == {"D", "E"}
    assert lit_with("F", joined) == {"F"}


@given(ROOMS, ROOMS, PAIRS)
def test_sharing_light_is_mutual(one: str, other: str, joined: list[tuple[str, str]]) -> None:
    assert (other in lit_with(one, joined)) == (one in lit_with(other, joined))


@given(ROOMS, PAIRS, st.tuples(ROOMS, ROOMS))
def test_another_hole_takes_no_light_away(
    room: str, joined: list[tuple[str, str]], hole: tuple[str, str]
) -> None:
    assert lit_with(room, joined) <= lit_with(room, [*joined, hole])


def test_rooms_without_a_wall_between_share_their_light() -> None:
    floors = {
        "Living": box(0.0, 0.0, 4.0, 3.0),
        "Dining": box(4.0, 1.0, 7.0, 3.0),
        "Behind a wall": box(1.0, 3.1, 4.0, 6.0),
        "At a corner": box(-2.0, 3.0, 0.0, 5.0),
    }
    assert list(touching(floors)) == [("Dining", "Living")]
