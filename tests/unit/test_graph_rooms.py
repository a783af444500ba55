"""Outlines, faces and walls of rooms in rasters, against drawings whose truth is known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon

from chord_usd.base.raster import canvas
from chord_usd.base.raster.vectorize import polygon_from_mask
from chord_usd.base.scene.types import FloatArray, LayoutImage, Plan, Room, frozen_array
from chord_usd.line.graph.colours import CLEAR, read_pixels
from chord_usd.line.graph.layout_plan import Walls, outline_of, read_plan, settle_faces
from chord_usd.workshop.data.houses import random_plan

SPANS = st.tuples(st.integers(0, 8), st.integers(9, 24))
"""Start and length; all blocks share a pixel, so that they are one region."""


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(SPANS, SPANS), min_size=1, max_size=4))
def test_upright_outlines_are_those_of_the_line_fitter(blocks) -> None:
    mask = np.zeros((40, 40), dtype=bool)
    for (x, width), (y, height) in blocks:
        mask[y : y + height, x : x + width] = True
    mine, fitted = Polygon(outline_of(mask)), Polygon(polygon_from_mask(mask))
    assert mine.is_valid
    assert mine.symmetric_difference(fitted).area < 1e-6


def test_an_outline_passes_over_holes_and_runs_counter_clockwise_in_the_world() -> None:
    mask = np.ones((20, 30), dtype=bool)
    mask[5:10, 10:20] = False
    outline = outline_of(mask)
    x, y = outline.T
    assert len(outline) == 4
    assert x @ np.roll(y, -1) - y @ np.roll(x, -1) == pytest.approx(-2 * 20 * 30)


def edge_errors_px(found: Plan, truth: Plan, m_per_px: float) -> FloatArray:
    """Distance of every upright or level side from the true side of its direction nearest to it."""
    errors = []
    truths = np.concatenate([_sides(room) for room in truth.rooms])
    for side in np.concatenate([_sides(room) for room in found.rooms]):
        axis, sign, place, low, high = side
        same = truths[(truths[:, 0] == axis) & (truths[:, 1] == sign)]
        common = np.minimum(same[:, 4], high) - np.maximum(same[:, 3], low)
        near = same[common > 0.5 * (high - low)]
        if len(near):
            errors.append(np.abs(near[:, 2] - place).min() / m_per_px)
    return np.array(errors)


def _sides(room: Room) -> FloatArray:
    """(N, 5) axis, direction, place, from, to of the sides along an axis."""
    rows = []
    for start, stop in zip(room.polygon_m, np.roll(room.polygon_m, -1, axis=0), strict=True):
        for axis in (0, 1):
            if abs(start[axis] - stop[axis]) < 1e-6:
                low, high = sorted((start[1 - axis], stop[1 - axis]))
                rows.append([axis, np.sign(stop - start)[1 - axis], start[axis], low, high])
    return np.array(rows).reshape(-1, 5)


def test_faces_are_found_to_a_fraction_of_a_pixel() -> None:
    errors = []
    for seed in range(12):
        plan = random_plan(np.random.default_rng(seed))
        image = canvas.draw_plan(plan)
        layout = LayoutImage(image.rgb, image.frame)
        found = read_plan(read_pixels(layout.rgb), layout.frame)
        errors += edge_errors_px(found, plan, layout.frame.m_per_px).tolist()
    assert np.max(errors) < 0.6
    # Rounding alone leaves 0.25 on average.
    assert np.mean(errors) < 0.2


def test_a_side_with_floor_behind_stays() -> None:
    """Rooms that touch keep touching: a gap between them would be a wall."""
    structure = np.full((50, 60), CLEAR, dtype=np.int16)
    structure[6:40, 6:50] = 0
    structure[10:36, 10:46] = CLEAR
    outline = np.array([[10.0, 10.0], [10.0, 36.0], [30.0, 36.0], [30.0, 10.0]])
    settled = settle_faces(outline, structure, 3.4)
    # Walls of 3.4 pixels came out 4 thick: their faces were rounded into the room, by 0.3.
    np.testing.assert_allclose(settled, [[9.7, 9.7], [9.7, 36.3], [30.0, 36.3], [30.0, 9.7]])


def test_a_bar_goes_to_the_middle_of_its_wall_and_joins_both_rooms() -> None:
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])
    rooms = [
        Room("a", "living", frozen_array(square)),
        Room("b", "bedroom", frozen_array(square + np.array([4.24, 0.0]))),
    ]
    center, along, joined = Walls(rooms).place(np.array([4.05, 1.5]), 88.0)
    assert center == pytest.approx((4.12, 1.5))
    assert along == pytest.approx(90.0)
    assert sorted(joined) == ["a", "b"]
    assert Walls(rooms).place(np.array([2.0, 1.5]), 90.0)[2] == ()
