"""A sheet that was photographed at a slant is found and seen from above; nothing else is taken."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from chord_usd.base.scene.types import ByteArray, FloatArray
from chord_usd.line.plan.perspective import find_sheet, rectifying, sheet_size

SHEET = (600, 420)
"""Width and height of the true sheet."""


def house(paper: int = 255) -> ByteArray:
    """A drawing that keeps clear of its sheet's edges."""
    page = np.full((SHEET[1], SHEET[0], 3), paper, np.uint8)
    cv2.rectangle(page, (90, 80), (510, 340), (0, 0, 0), 10)
    cv2.line(page, (300, 80), (300, 340), (0, 0, 0), 10)
    return page


def photo(tip_x: float, tip_y: float) -> tuple[ByteArray, FloatArray]:
    """The house on a table through a camera that is tipped (radians), and its sheet's corners."""
    width, height = SHEET
    corners = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float64)
    turn, _ = cv2.Rodrigues(np.array([tip_x, tip_y, 0.0]))
    placed = np.column_stack([corners - np.array(SHEET) / 2, np.zeros(4)]) @ turn.T
    seen = 700.0 * placed[:, :2] / (placed[:, 2:] + 700.0) + np.array([400.0, 320.0])
    matrix = cv2.getPerspectiveTransform(corners.astype(np.float32), seen.astype(np.float32))
    return cv2.warpPerspective(house(), matrix, (800, 640), borderValue=(90, 70, 50)), seen


@pytest.mark.parametrize(("tip_x", "tip_y"), [(0.25, 0.15), (-0.3, 0.1), (0.1, -0.35)])
def test_a_slanted_sheet_is_found_with_its_proportions(tip_x: float, tip_y: float) -> None:
    picture, true_corners = photo(tip_x, tip_y)
    corners = find_sheet(picture)
    assert corners is not None
    np.testing.assert_allclose(corners, true_corners, atol=4.0)
    width, height = sheet_size(corners, picture.shape)
    assert width / height == pytest.approx(SHEET[0] / SHEET[1], rel=0.03)


def test_its_corners_become_those_of_the_sheet() -> None:
    _, corners = photo(0.25, 0.15)
    matrix = rectifying(corners, SHEET)
    seen = np.column_stack([corners, np.ones(4)]) @ matrix.T
    wanted = [[0, 0], [SHEET[0], 0], [SHEET[0], SHEET[1]], [0, SHEET[1]]]
    np.testing.assert_allclose(seen[:, :2] / seen[:, 2:], wanted, atol=1e-2)


def test_a_drawing_without_a_table_is_left_alone() -> None:
    assert find_sheet(house()) is None


def test_a_sheet_seen_from_straight_above_is_left_alone() -> None:
    assert find_sheet(photo(0.0, 0.0)[0]) is None


def test_a_light_house_on_a_dark_ground_is_no_sheet() -> None:
    """Its walls run along what would be the paper's edges."""
    page = np.full((500, 700, 3), 60, np.uint8)
    outline = np.array([[100, 80], [600, 100], [620, 420], [90, 400]])
    cv2.fillPoly(page, [outline], (255, 255, 255))
    for inset in (14, 24):
        middle = outline.mean(axis=0)
        inner = outline + np.sign(middle - outline) * inset
        cv2.polylines(page, [inner.astype(np.int32)], True, (0, 0, 0), 8)
    assert find_sheet(page) is None
