"""Footprint in the room: what reaches into walls is cut back, however little of it does."""

from __future__ import annotations

import shapely
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.oriented_rect import Footprint
from chord_usd.base.scene.types import Box
from chord_usd.line.arrange.off_trim import cut_at_walls

TOUCHING_M = 0.005
PIER = shapely.Polygon([(0, 0), (4, 0), (4, 1.9), (3, 1.9), (3, 2.1), (4, 2.1), (4, 4), (0, 4)])
"""A room with a thin pier that reaches in from the right."""


@given(
    x=st.floats(0.4, 3.6),
    y=st.floats(0.2, 3.8),
    length=st.floats(0.4, 2.0),
    yaw_deg=st.floats(-180.0, 180.0),
)
def test_nothing_is_left_in_a_wall(x: float, y: float, length: float, yaw_deg: float) -> None:
    standing = Footprint.of(Box((x, y, 0.0), (length, 0.35, 0.5), yaw_deg))
    before = footprint_polygon(standing.on(Box((0, 0, 0), (1, 1, 0.5), 0.0)))
    pulled = cut_at_walls(standing, PIER)
    after = footprint_polygon(pulled.on(Box((0, 0, 0), (1, 1, 0.5), 0.0)))
    assert after.difference(before.buffer(1e-6)).is_empty, "only ever cut"
    if before.difference(PIER).area < 0.1 * before.area:
        assert after.difference(PIER).buffer(-TOUCHING_M / 2).is_empty


def test_a_corner_of_a_slanted_piece_comes_out_of_the_wall() -> None:
    room = shapely.box(0, 0, 4, 4)
    standing = Footprint.of(Box((2.0, 0.147, 0.0), (0.57, 0.27, 0.3), 175.7))
    before = footprint_polygon(standing.on(Box((0, 0, 0), (1, 1, 0.3), 0.0)))
    assert 0.0 < before.difference(room).area < 0.02 * before.area
    after = footprint_polygon(cut_at_walls(standing, room).on(Box((0, 0, 0), (1, 1, 0.3), 0.0)))
    assert after.bounds[1] > -TOUCHING_M


def test_what_stands_in_the_room_stays() -> None:
    standing = Footprint.of(Box((2.0, 2.0, 0.0), (1.0, 1.0, 1.0), 30.0))
    assert cut_at_walls(standing, shapely.box(0, 0, 4, 4)) == standing
