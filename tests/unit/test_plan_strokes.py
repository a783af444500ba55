"""Walls as they are drawn: hollow, hatched, coloured, as lines, on black, in a frame, askew."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from chord_usd.plan.sheet import measure_skew, turned
from chord_usd.plan.strokes import find_strokes
from chord_usd.types import BoolArray, ByteArray

SIDE = 800


def area(mask: BoolArray) -> int:
    return int(mask.sum())


def true_wall() -> BoolArray:
    """A square house with a partition and a gap in it."""
    wall = np.zeros((SIDE, SIDE), bool)
    wall[60:741, 60:741] = True
    wall[74:727, 74:727] = False
    wall[74:350, 393:407] = True
    wall[410:727, 393:407] = True
    return wall


def outlined(wall: BoolArray) -> ByteArray:
    inner = cv2.erode(wall.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    return np.where((wall & ~inner)[:, :, None], 0, np.full((SIDE, SIDE, 3), 255)).astype(np.uint8)


def painted(wall: BoolArray, rgb: tuple[int, int, int], paper: int = 255) -> ByteArray:
    canvas = np.full((SIDE, SIDE, 3), paper, np.uint8)
    canvas[wall] = rgb
    return canvas


def hatched(wall: BoolArray) -> ByteArray:
    rows, columns = np.indices(wall.shape)
    drawing = outlined(wall)
    drawing[wall & ((rows + columns) % 6 == 0)] = 0
    return drawing


def framed(drawing: ByteArray) -> ByteArray:
    return cv2.rectangle(drawing.copy(), (8, 8), (SIDE - 9, SIDE - 9), (0, 0, 0), 2)


DRAWINGS = {
    "solid": painted(true_wall(), (0, 0, 0)),
    "hollow": outlined(true_wall()),
    "hatched": hatched(true_wall()),
    "yellow": painted(true_wall(), (250, 215, 40)),
    "on black": painted(true_wall(), (255, 255, 255), paper=0),
    "framed": framed(painted(true_wall(), (0, 0, 0))),
}


@pytest.mark.parametrize("name", DRAWINGS)
def test_walls_are_found_however_they_are_drawn(name: str) -> None:
    wall = true_wall()
    shares = [
        area(strokes.wall & wall) / area(strokes.wall | wall)
        for strokes in find_strokes(DRAWINGS[name])
    ]
    assert max(shares) > 0.85


def test_coloured_walls_are_found_among_many_coloured_floors() -> None:
    """Eight floors cover more paper than the walls between them."""
    wall = true_wall()
    drawing = np.full((SIDE, SIDE, 3), 255, np.uint8)
    for index in range(8):
        top = 74 + 80 * index
        drawing[top : top + 80, 74:727] = (200, 235 - 12 * index, 180 + 9 * index)
    drawing[wall] = (255, 215, 45)
    inner = cv2.erode(wall.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    drawing[wall & ~inner] = 60
    shares = [area(s.wall & wall) / area(s.wall | wall) for s in find_strokes(drawing)]
    assert max(shares) > 0.9


def test_a_coloured_floor_is_no_line_but_what_is_drawn_on_it_is() -> None:
    drawing = painted(true_wall(), (0, 0, 0))
    drawing[74:727, 74:393] = (102, 194, 165)
    cv2.circle(drawing, (74, 727), 90, (40, 40, 40), 1)
    thin = next(find_strokes(drawing)).thin
    assert not thin[300:500, 100:300].any()
    assert thin[727 - 90 - 1 : 727 - 90 + 2, 78].any()


def test_panes_are_left_open_in_hatched_walls() -> None:
    wall = true_wall()
    drawing = hatched(wall)
    drawing[60:74, 200:300] = 255
    cv2.rectangle(drawing, (200, 60), (300, 73), (0, 0, 0), 1)
    cv2.line(drawing, (200, 66), (300, 66), (0, 0, 0), 1)
    # Crumbs there would be wall without a gap.
    found = [s.wall for s in find_strokes(drawing) if area(s.wall & wall) > 0.8 * area(wall)]
    assert found
    assert not any(mask[66, 220:280].all() for mask in found)


def test_lines_become_walls_that_are_no_longer_than_the_lines() -> None:
    drawing = np.full((SIDE, SIDE, 3), 255, np.uint8)
    cv2.rectangle(drawing, (60, 60), (740, 740), (0, 0, 0), 2)
    cv2.line(drawing, (200, 60), (200, 150), (0, 0, 0), 2)
    strokes = next(find_strokes(drawing))
    assert strokes.are_lines
    assert strokes.thickness_px > 4
    assert np.flatnonzero(strokes.wall[100:300, 200]).max() + 100 == pytest.approx(150, abs=2)


def test_letters_are_no_walls() -> None:
    drawing = DRAWINGS["solid"].copy()
    cv2.putText(drawing, "HALL", (220, 280), cv2.FONT_HERSHEY_SIMPLEX, 1.0, (0, 0, 0), 8)
    box = np.array([[210.0, 240.0], [325.0, 240.0], [325.0, 295.0], [210.0, 295.0]])
    strokes = next(find_strokes(drawing, [box]))
    assert not strokes.wall[245:290, 215:320].any()


@pytest.mark.parametrize("skew_deg", [-3.0, -0.6, 0.5, 2.0])
def test_a_turn_is_measured(skew_deg: float) -> None:
    askew = turned(DRAWINGS["solid"], -skew_deg)
    assert measure_skew(askew) == pytest.approx(skew_deg, abs=0.15)


def test_an_upright_drawing_is_not_turned() -> None:
    assert measure_skew(DRAWINGS["solid"]) == 0.0
