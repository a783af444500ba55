"""Rooms that share their light."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from chord_usd.image.joined import lit_with

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
