"""Outlines of drawn shapes come back within half a pixel, slanted ones included."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
import shapely
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon

from chord_usd.base.raster.vectorize import largest_region, polygon_from_mask, rotated_box_from_mask

SIZE = 128


def drawn(corners: np.ndarray) -> np.ndarray:
    """The pixels whose centres lie inside, by shapely."""
    rows, columns = np.mgrid[0:SIZE, 0:SIZE] + 0.5
    return shapely.contains_xy(Polygon(corners), columns, rows)


def strayed(found: np.ndarray, corners: np.ndarray) -> float:
    return Polygon(found).exterior.hausdorff_distance(Polygon(corners).exterior)


def assert_well_formed(polygon: np.ndarray) -> None:
    shape = Polygon(polygon)
    assert shape.is_valid
    # Counter-clockwise in the world is clockwise in numbers: image y is down.
    assert not shape.exterior.is_ccw


places = st.floats(8, 120)


@settings(deadline=None, max_examples=30)
@given(places, places, places, places)
@example(8.6, 10.7, 8.6, 10.7)  # two pixels by two
def test_a_rectangle_comes_back_to_half_a_pixel(a: float, b: float, c: float, d: float) -> None:
    left, right, top, bottom = min(a, b), max(a, b), min(c, d), max(c, d)
    assume(right - left > 2 and bottom - top > 2)
    # Whether a centre on the very edge counts is up to the library that draws here.
    assume(all(abs(place % 1.0 - 0.5) > 1e-6 for place in (a, b, c, d)))
    corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
    found = polygon_from_mask(drawn(corners))
    assert len(found) == 4
    assert np.abs(found[:, None] - corners).max(axis=2).min(axis=1).max() <= 0.5 + 1e-9
    assert_well_formed(found)


@settings(deadline=None, max_examples=30)
@given(st.floats(56, 72), st.floats(56, 72), st.floats(20, 45), st.floats(12, 45), st.floats(0, 90))
def test_a_turned_rectangle_comes_back(
    x: float, y: float, length: float, width: float, angle_deg: float
) -> None:
    corners = cv2.boxPoints(((x, y), (length, width), angle_deg)).astype(float)
    found = polygon_from_mask(drawn(corners))
    assert_well_formed(found)
    # Sides within half a pixel; a corner's tip may lie between pixel centres.
    assert strayed(found, corners) <= 1.5


@settings(deadline=None, max_examples=20)
@given(
    st.tuples(st.floats(10, 14), st.floats(10, 14)),
    st.floats(45, 60), st.floats(90, 110), st.floats(30, 50), st.floats(70, 95), st.floats(4, 30),
)  # fmt: skip
def test_an_l_shape_with_a_slanted_corner_comes_back(
    corner: tuple[float, float], x1: float, x2: float, y1: float, y2: float, cut: float
) -> None:
    x0, y0 = corner
    corners = np.array(
        [[x0, y0], [x2, y0], [x2, y1], [x1, y1], [x1, y2], [x0 + cut, y2], [x0, y2 - cut]]
    )
    found = polygon_from_mask(drawn(corners))
    assert len(found) == 7
    assert strayed(found, corners) <= 1.0
    assert_well_formed(found)


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 2**32 - 1), st.floats(0.35, 0.7), st.floats(0, 2))
def test_any_mask_gives_a_simple_polygon(seed: int, density: float, noise_px: float) -> None:
    mask = np.random.default_rng(seed).random((24, 24)) < density
    assume(mask.any())
    found = polygon_from_mask(mask, noise_px)
    assert_well_formed(found)
    assert len(found) >= 3


def test_notches_of_a_pixel_vanish_where_noise_is_allowed() -> None:
    mask = np.zeros((SIZE, SIZE), bool)
    mask[20:90, 30:100] = True
    mask[20, 40:60] = False
    mask[50:70, 100] = True
    found = polygon_from_mask(mask, noise_px=0.6)
    assert len(found) == 4
    assert strayed(found, np.array([[30, 20], [100, 20], [100, 90], [30, 90]])) <= 1.5


def test_holes_and_smaller_regions_are_passed_over() -> None:
    mask = np.zeros((SIZE, SIZE), np.uint8)
    mask[10:60, 10:60] = 255
    mask[30:40, 30:40] = 0
    mask[60:70, 60:70] = 255  # touches at a corner only
    assert largest_region(mask > 0).sum() == 50 * 50 - 100
    found = polygon_from_mask(mask)
    assert np.array_equal(np.sort(np.unique(found)), [10, 60])


@settings(deadline=None, max_examples=30)
@given(
    st.floats(50, 78), st.floats(50, 78), st.floats(16, 60), st.floats(3, 8), st.floats(0, 179.99)
)
def test_a_bar_comes_back_as_its_box(
    x: float, y: float, length: float, width: float, angle_deg: float
) -> None:
    corners = cv2.boxPoints(((x, y), (length, width), angle_deg)).astype(float)
    found = rotated_box_from_mask(drawn(corners))
    assert np.hypot(found.center_px[0] - x, found.center_px[1] - y) < 0.8
    assert found.length_px == pytest.approx(length, abs=1.2)
    assert found.width_px == pytest.approx(width, abs=1.2)
    turn = (found.angle_deg - angle_deg + 90) % 180 - 90
    assert abs(np.radians(turn)) * length / 2 < 1.0


def test_an_empty_mask_is_refused() -> None:
    empty = np.zeros((8, 8), bool)
    for function in (polygon_from_mask, rotated_box_from_mask, largest_region):
        with pytest.raises(ValueError, match="empty"):
            function(empty)
