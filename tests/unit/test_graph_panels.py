"""Panels hang on their wall with all of their back."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon

from chord_usd.geometry import footprint, to_world
from chord_usd.graph.panels import end_with_wall
from chord_usd.types import Box

JOG_M = 3.0
"""The lower wall lies at y = 0 up to here, and 0.12 m farther out beyond."""
CORNERS = np.array([(0.0, 0.0), (JOG_M, 0.0), (JOG_M, -0.12), (5.0, -0.12), (5.0, 4.0), (0.0, 4.0)])


def panel(start_m: float, stop_m: float, back_m: float = 0.0) -> Box:
    """On the lower wall, its front to the room."""
    center_m = ((start_m + stop_m) / 2, back_m + 0.05, 1.1)
    return Box(center_m, (stop_m - start_m, 0.1, 1.2), 180.0)


@given(start_m=st.floats(0.5, 1.5), over_m=st.floats(0.05, 1.0), turn_deg=st.floats(-180.0, 180.0))
def test_it_ends_at_the_corner_that_it_was_painted_past(
    start_m: float, over_m: float, turn_deg: float
) -> None:
    whole = panel(start_m, JOG_M + over_m)
    house = Box((0.7, -0.3, 0.0), (1.0, 1.0, 1.0), turn_deg)
    x_m, y_m = to_world(house, whole.center_m[:2])
    turned = Box((float(x_m), float(y_m), 1.1), whole.size_m, 180.0 + turn_deg)
    cut = end_with_wall(turned, Polygon(to_world(house, CORNERS)))
    assert cut.size_m == pytest.approx((JOG_M - start_m, 0.1, 1.2), abs=2e-3)
    along = (to_world(house, np.array([start_m, 0.0])) + to_world(house, (JOG_M, 0.0))) / 2
    back_middle = footprint(cut)[[0, 3]].mean(axis=0)
    assert back_middle == pytest.approx(along, abs=2e-3), "its back stays on the wall"


@pytest.mark.parametrize(
    "box",
    [
        panel(0.5, 2.5), panel(0.0, JOG_M), panel(2.5, 4.5), panel(0.5, 3.2, back_m=1.0),
        panel(0.5, 3.2, back_m=-0.13),
    ],
    ids=["on its wall", "from corner to corner", "mostly past it", "on no wall", "in the wall"],
)  # fmt: skip
def test_others_stay_as_they_are(box: Box) -> None:
    assert end_with_wall(box, Polygon(CORNERS)) == box
