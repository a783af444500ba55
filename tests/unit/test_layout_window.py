"""The window around a house."""

import numpy as np
import pytest

from chord_usd.base.raster import canvas
from chord_usd.line.layout.mosaic import BORDER_PX, window_of, window_size
from chord_usd.workshop.data.houses import random_plan


@pytest.mark.parametrize("seed", range(20))
def test_the_window_holds_the_whole_house_with_white_around_it(seed: int) -> None:
    plan = random_plan(np.random.default_rng(seed))
    rgb = canvas.draw_plan(plan, canvas.fit_frame(plan, margin_px=4)).rgb
    size = window_size(rgb, 32)
    inside = rgb[window_of(rgb, size)]
    assert inside.shape[:2] == size
    assert size[0] % 32 == size[1] % 32 == 0
    assert (inside < 255).sum() == (rgb < 255).sum()
    edges = (inside[0], inside[-1], inside[:, 0], inside[:, -1])
    assert all((edge == 255).all() for edge in edges)


def test_the_window_is_as_small_as_it_can_be() -> None:
    rgb = np.full((256, 256, 3), 255, np.uint8)
    rgb[100 : 160 - 2 * BORDER_PX, 20:220] = 0
    assert window_size(rgb, 32) == (64, 224)
    assert window_of(rgb, (64, 224))[0].start <= 100 - BORDER_PX


def test_an_empty_canvas_is_its_own_window() -> None:
    rgb = np.full((64, 96, 3), 255, np.uint8)
    assert window_size(rgb, 32) == (64, 96)
    assert window_of(rgb, (64, 96)) == (slice(0, 64), slice(0, 96))
