"""The holes that openings cut into walls."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.base.scene.tunnels import as_cut, dig_tunnels, wall_solid
from chord_usd.base.scene.types import WALL_THICKNESS_M, Box, Opening, Room, frozen_array

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


@pytest.mark.parametrize("apart_m", [0.12, 0.5, 0.8, 1.0])
def test_a_door_goes_through_a_wall_however_thick(apart_m: float) -> None:
    """Walls of old houses are: rooms so far apart have one solid wall between them."""
    first = Room("a", "living", frozen_array([(0, 0), (4, 0), (4, 4), (0, 4)]))
    x0 = 4 + apart_m
    second = Room("b", "bedroom", frozen_array([(x0, 0), (9, 0), (9, 4), (x0, 4)]))
    box = Box((4 + apart_m / 2, 2.0, 0.0), (0.9, apart_m, 2.1), 90.0)
    solid = wall_solid([first, second])
    (tunnel,) = dig_tunnels([Opening("d", "door", box, ("a", "b"))], solid)
    assert tunnel is not None
    assert tunnel.area_m.bounds == pytest.approx((4.0, 1.55, x0, 2.45), abs=1e-3)
    assert tunnel.is_end.count(True) == 2
