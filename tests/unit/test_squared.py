"""Outlines squared: torn rims lie along an axis, walls that are askew stay so."""

import cv2
import numpy as np
import pytest
from shapely.geometry import Polygon

from chord_usd.line.plan.squared import is_askew, squared

THICKNESS_PX = 12.0


def mask_of(*corners):
    mask = np.zeros((300, 300), np.uint8)
    cv2.fillPoly(mask, [np.array(corners, np.int32)], (1,))
    return mask > 0


def off_axis_deg(polygon):
    run = np.roll(polygon, -1, axis=0) - polygon
    angles = np.degrees(np.arctan2(run[:, 1], run[:, 0])) % 90.0
    return np.minimum(angles, 90.0 - angles)


def likeness(polygon, other):
    one, two = Polygon(polygon), Polygon(other)
    return one.intersection(two).area / one.union(two).area


@pytest.mark.parametrize("jump", [4, 6])
def test_a_torn_rim_lies_along_an_axis(jump):
    corners = [(40, 40), (140, 40), (140, 40 + jump), (240, 40 + jump), (240, 200), (40, 200)]
    askew = np.array([(40, 40), (241, 40 + jump), (241, 201), (40, 201)], float)
    found = squared(askew, mask_of(*corners), THICKNESS_PX)
    assert len(found) == 4
    assert off_axis_deg(found).max() < 1e-9
    assert likeness(found, askew) > 0.96


def test_a_step_that_is_meant_stays_one():
    corners = [(40, 40), (140, 40), (140, 62), (240, 62), (240, 200), (40, 200)]
    askew = np.array([(40, 40), (241, 62), (241, 201), (40, 201)], float)
    found = squared(askew, mask_of(*corners), THICKNESS_PX)
    assert len(found) == 6
    assert off_axis_deg(found).max() < 1e-9
    assert likeness(found, [(x + 0.5, y + 0.5) for x, y in corners]) > 0.97


@pytest.mark.parametrize("askew_deg", [6.0, 12.0, 30.0, 45.0])
def test_a_wall_that_is_askew_stays_so(askew_deg):
    drop = 160 * np.tan(np.radians(askew_deg))
    polygon = np.array([(40, 40), (200, 40 + drop), (200, 260), (40, 260)], float)
    found = squared(polygon, mask_of(*polygon.round()), THICKNESS_PX)
    assert len(found) == 4
    assert likeness(found, polygon) > 0.999


def test_a_corner_cut_off_by_little_is_a_corner():
    polygon = np.array([(40, 52), (52, 40), (240, 40), (240, 200), (40, 200)], float)
    found = squared(polygon, mask_of(*polygon), THICKNESS_PX)
    assert sorted(map(tuple, found)) == [(40, 40), (40, 200), (240, 40), (240, 200)]
    wide = np.array([(40, 90), (90, 40), (240, 40), (240, 200), (40, 200)], float)
    assert likeness(squared(wide, mask_of(*wide), THICKNESS_PX), wide) > 0.999


@pytest.mark.parametrize(("askew_deg", "is_photo"), [(0.0, False), (1.5, False), (5.0, True)])
def test_a_picture_taken_at_a_slant_is_told(askew_deg, is_photo):
    angle = np.radians(askew_deg)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    floor = np.array([(0, 0), (90, 0), (90, 60), (0, 60)])
    rooms = [floor + np.array([100 * k, 0]) for k in range(3)]
    one_askew = np.array([(0, 100), (200, 115), (200, 200), (0, 200)])
    assert is_askew([*(room @ turn for room in rooms), one_askew]) == is_photo
