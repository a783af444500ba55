"""A picture is turned upright before it is read, and what is drawn is told from paper."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from chord_usd.base.scene.types import ByteArray
from chord_usd.line.plan.sheet import ink_of, measure_skew, on_white, turned

SIDE = 800


def house(paper: int = 255, ink: int = 0) -> ByteArray:
    """A square house with a partition and a gap in it."""
    page = np.full((SIDE, SIDE, 3), paper, np.uint8)
    cv2.rectangle(page, (67, 67), (733, 733), (ink,) * 3, 14)
    cv2.line(page, (400, 74), (400, 350), (ink,) * 3, 14)
    cv2.line(page, (400, 410), (400, 727), (ink,) * 3, 14)
    return page


@pytest.mark.parametrize("skew_deg", [-3.0, -0.6, 0.5, 2.0])
def test_a_turn_is_measured(skew_deg: float) -> None:
    askew = turned(house(), -skew_deg)
    assert measure_skew(askew) == pytest.approx(skew_deg, abs=0.15)


def test_an_upright_drawing_is_not_turned() -> None:
    assert measure_skew(house()) == 0.0


def test_ink_is_told_from_paper_in_a_shadow_and_on_black() -> None:
    drawn = house()[..., 0] == 0
    light = np.linspace(1.0, 0.4, SIDE)[None, :, None]
    for page in (house(), (house(230, 30) * light).astype(np.uint8), house(0, 255)):
        assert (ink_of(on_white(page)) == drawn).mean() > 0.98
