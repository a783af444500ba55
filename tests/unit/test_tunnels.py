"""The holes that openings cut into walls."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.scene.tunnels import as_cut
from chord_usd.scene.types import WALL_THICKNESS_M, Box, Opening, Room, frozen_array

ROOM = Room("room", "bedroom", frozen_array([[0, 0], [4, 0], [4, 3], [0, 3]], float))


@given(
    depth_m=st.floats(0.12, 0.5),
    off_m=st.floats(-0.1, 0.05),
    at_m=st.floats(0.6, 3.4),
    turned=st.sampled_from((0.0, 180.0)),
)
def test_openings_are_as_deep_as_their_wall(
    depth_m: float, off_m: float, at_m: float, turned: float
) -> None:
    """A window read too deep, or off the middle of its wall, is dressed as it is built."""
    middle = (at_m, -WALL_THICKNESS_M / 2 + off_m, 0.9)
    window = Opening("window", "window", Box(middle, (1.0, depth_m, 1.2), turned), ("room",))
    (cut,) = as_cut([ROOM], [window])
    assert cut.box.center_m == pytest.approx((at_m, -WALL_THICKNESS_M / 2, 0.9), abs=0.01)
    assert cut.box.size_m == pytest.approx((1.0, WALL_THICKNESS_M, 1.2), abs=0.01)


def test_a_window_told_on_the_outer_face_of_a_thick_wall_is_dressed_as_it_is_built() -> None:
    window = Opening("w", "window", Box((2.0, -0.3, 0.95), (2.0, 0.6, 1.2), 0.0), ("room",))
    (cut,) = as_cut([ROOM], [window])
    assert cut.box.center_m == pytest.approx((2.0, -WALL_THICKNESS_M / 2, 0.95), abs=0.01)
    assert cut.box.size_m == pytest.approx((2.0, WALL_THICKNESS_M, 1.2), abs=0.01)
