"""Rectangles fitted to pixels; footprints moved flush with walls and with each other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.scene.geometry import footprint, footprint_polygon
from chord_usd.base.scene.oriented_rect import Footprint, OrientedRect
from chord_usd.base.scene.types import Box, PixelFrame, Room, frozen_array
from chord_usd.base.scene.units import fold_deg, px_from_m
from chord_usd.line.graph.directions import plan_directions
from chord_usd.line.graph.flush import align, flush_with_walls, parted
from chord_usd.line.graph.rectangles import (
    FRONT_EDGES,
    Evidence,
    canvas_corners,
    fit_at_angle,
    fit_free,
    front_mark,
)

GRID = np.stack(np.meshgrid(np.arange(64) + 0.5, -np.arange(64) - 0.5), axis=-1).reshape(-1, 2)
SQUARE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])


def evidence_of(rectangle: OrientedRect) -> Evidence:
    inside = rectangle.covers(GRID)
    return Evidence(GRID[inside], GRID[~inside], np.ones(int((~inside).sum())))


def centred(angle_deg: float, x: float, y: float, length: float, width: float) -> OrientedRect:
    return OrientedRect.around((x, y), angle_deg, length, width)


PLACES = {
    "x": st.floats(28, 36),
    "y": st.floats(-36, -28),
    "length": st.floats(6, 34),
    "width": st.floats(5, 20),
}


@settings(max_examples=60, deadline=None)
@given(angle_deg=st.floats(-45, 44.9), **PLACES)
def test_an_edge_of_known_direction_is_found_within_half_a_pixel(
    angle_deg: float, x: float, y: float, length: float, width: float
) -> None:
    drawn = centred(angle_deg, x, y, length, width)
    found = fit_at_angle(evidence_of(drawn), angle_deg)
    for edge in ("u0", "u1", "v0", "v1"):
        assert getattr(found, edge) == pytest.approx(getattr(drawn, edge), abs=0.75)
    assert evidence_of(drawn).cost(found) <= 2.0


@settings(max_examples=40, deadline=None)
@given(
    angle_deg=st.floats(-45, 44.9),
    x=st.floats(30, 34),
    y=st.floats(-34, -30),
    length=st.floats(20, 36),
    width=st.floats(8, 14),
)
def test_an_unknown_direction_is_found_to_a_pixel_at_the_ends(
    angle_deg: float, x: float, y: float, length: float, width: float
) -> None:
    drawn = centred(angle_deg, x, y, length, width)
    found = fit_free(evidence_of(drawn))
    off_deg = abs(fold_deg(found.angle_deg - drawn.angle_deg))
    assert np.radians(off_deg) * length / 2 < 1.0


def test_specks_do_not_stretch_a_rectangle() -> None:
    drawn = centred(0.0, 32, -32, 20, 10)
    inside = drawn.covers(GRID)
    inside |= (GRID == (50.5, -32.5)).all(axis=1) | (GRID == (32.5, -45.5)).all(axis=1)
    found = fit_at_angle(Evidence(GRID[inside], GRID[~inside], np.ones((~inside).sum())), 0.0)
    assert (found.u0, found.u1, found.v0, found.v1) == pytest.approx((22, 42, -37, -27), abs=0.01)


@pytest.mark.parametrize("quarter_turns", range(4))
def test_the_mark_lies_at_the_front_edge(quarter_turns: int) -> None:
    body = OrientedRect(20.0, 0.0, 20.0, 0.0, 10.0)
    mark = front_mark(body, quarter_turns)
    name = FRONT_EDGES[quarter_turns]
    assert getattr(mark, name) == getattr(body, name)
    corners = canvas_corners(body, quarter_turns)
    front_middle = (corners[1] + corners[2]) / 2
    mark_middle = mark.center * (1.0, -1.0)
    assert np.hypot(*(front_middle - mark_middle)) < np.hypot(*(corners.mean(axis=0) - mark_middle))


@given(
    yaw_deg=st.floats(-180, 180),
    length=st.floats(0.3, 3),
    width=st.floats(0.1, 2),
)
def test_a_footprint_gives_its_box_back(yaw_deg: float, length: float, width: float) -> None:
    box = Box((1.0, -2.0, 0.3), (length, width, 0.8), yaw_deg)
    np.testing.assert_allclose(footprint(Footprint.of(box).on(box)), footprint(box), atol=1e-9)


@given(off_m=st.floats(-0.04, 0.04), yaw_deg=st.sampled_from([0.0, 90.0, 180.0, -90.0]))
def test_a_back_within_reach_of_the_wall_is_put_on_it(off_m: float, yaw_deg: float) -> None:
    box = Box((2.0, 3.0 - 0.3 + off_m, 0.0), (1.0, 0.6, 0.8), yaw_deg)
    before = Footprint.of(box)
    upper = before.rect.v1
    moved = flush_with_walls(before, SQUARE, 0.05 + abs(upper - 3.0))
    assert moved.rect.v1 == pytest.approx(3.0, abs=1e-12)
    assert moved.rect.v0 == before.rect.v0


def test_an_item_out_of_reach_of_walls_stays() -> None:
    before = Footprint.of(Box((2.0, 1.5, 0.0), (1.0, 0.6, 0.8), 0.0))
    assert flush_with_walls(before, SQUARE, 0.05) == before


@given(turn=st.floats(-3.9, 3.9))
def test_nearly_aligned_items_are_aligned_about_their_centre(turn: float) -> None:
    before = Footprint.of(Box((2.0, 2.6, 0.0), (1.0, 0.6, 0.8), 90.0 + turn))
    moved = align(before, SQUARE)
    assert moved.rect.angle_deg == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(moved.rect.center, (2.0, 2.6), atol=1e-9)


def test_clearly_turned_items_keep_their_yaw() -> None:
    before = Footprint.of(Box((2.0, 2.6, 0.0), (1.0, 0.6, 0.8), 12.0))
    assert align(before, SQUARE) == before


@given(gap=st.floats(-0.049, 0.2))
def test_neighbours_never_overlap_and_are_not_pulled_together(gap: float) -> None:
    boxes = [
        Box((1.0, 1.0, 0.0), (1.0, 0.6, 0.8), 0.0),
        Box((2.0 + gap, 1.1, 0.0), (1.0, 0.6, 0.8), 180.0),
    ]
    moved = [
        one.on(box)
        for one, box in zip(parted([Footprint.of(box) for box in boxes]), boxes, strict=True)
    ]
    first, second = (footprint_polygon(box) for box in moved)
    assert first.intersection(second).area < 1e-9
    if gap >= 0.0:
        assert moved == [Footprint.of(box).on(box) for box in boxes]


def test_directions_of_a_house_are_its_walls() -> None:
    slanted = np.array([[0.0, 0.0], [5.0, 0.0], [5.0, 3.0], [2.0, 4.0], [0.0, 4.0]])
    room = Room("r", "living", frozen_array(slanted))
    directions = plan_directions([room], PixelFrame(0.05, (0.0, 0.0)))
    assert directions.angles_deg[0] == 0.0
    assert sorted(directions.angles_deg) == pytest.approx([np.degrees(np.arctan2(-1, 3)), 0.0])
    beside_slant = np.array([3.6 / 0.05, -(256 - 3.4 / 0.05)])
    assert directions.near(beside_slant)[0] == pytest.approx(np.degrees(np.arctan2(-1, 3)))


def test_walls_of_other_rooms_and_short_ones_far_off_give_no_direction() -> None:
    bevelled = [(0.0, 0.0), (6.0, 0.0), (6.0, 5.7), (5.7, 6.0), (0.0, 6.0)]
    wing = [(6.3, 0.0), (10.0, 2.0), (9.0, 4.0), (6.3, 2.5)]
    rooms = [
        Room(f"r{i}", "living", np.array(corners)) for i, corners in enumerate((bevelled, wing))
    ]
    directions = plan_directions(rooms, PixelFrame(0.05, (0.0, 0.0)))

    def upright(x_m: float, y_m: float) -> np.ndarray:
        return px_from_m(np.array([x_m, y_m]), PixelFrame(0.05, (0.0, 0.0))) * (1.0, -1.0)

    assert directions.near(upright(3.0, 3.0)) == [0.0]
    assert -45.0 in directions.near(upright(5.75, 5.75))
    assert directions.near(upright(7.5, 1.8))[0] == pytest.approx(28.67, abs=0.1)
