"""The plan as the network sees it: computed from the raster alone."""

import numpy as np
import pytest

from chord_usd.base.scene.palette import CATEGORIES, ROOM_SHADES
from chord_usd.base.scene.types import LEARNED_KINDS
from chord_usd.line.layout.condition import GRID_PLANES, PIXEL_PLANES, plan_condition

FLOOR_PLANE = 3
AREA_PLANE = 1 + len(LEARNED_KINDS)
FREE_LEFT, FREE_RIGHT = AREA_PLANE + 3, AREA_PLANE + 4


def _two_rooms(left: str = "bedroom", right: str = "kitchen") -> np.ndarray:
    """A 64×64 raster: black walls around two rooms side by side, a door between them."""
    rgb = np.full((64, 64, 3), 255, np.uint8)
    rgb[8:56, 4:60] = CATEGORIES["wall"].rgb
    rgb[12:52, 8:32] = ROOM_SHADES[left]
    rgb[12:52, 36:56] = ROOM_SHADES[right]
    rgb[24:32, 32:36] = CATEGORIES["door"].rgb
    return rgb


def test_floor_is_what_walls_enclose_even_where_rooms_are_white():
    shaded = plan_condition(_two_rooms(), 0.1, 4)
    white = plan_condition(_two_rooms("unknown", "unknown"), 0.1, 4)
    assert shaded.pixels.shape == (PIXEL_PLANES, 64, 64)
    assert shaded.grid.shape == (GRID_PLANES, 16, 16)
    assert shaded.pixels[FLOOR_PLANE].sum() == 40 * 24 + 40 * 20
    assert np.array_equal(shaded.pixels, white.pixels)


@pytest.mark.parametrize(("column", "kind"), [(4, "bedroom"), (11, "kitchen")])
def test_kind_follows_the_shade(column, kind):
    grid = plan_condition(_two_rooms(), 0.1, 4).grid
    kinds = grid[1 : 1 + len(LEARNED_KINDS), 8, column]
    assert LEARNED_KINDS[int(kinds.argmax())] == kind
    assert kinds.sum() == 1


def test_measures_are_metric():
    grid = plan_condition(_two_rooms(), 0.1, 4).grid
    area_m2 = np.expm1(grid[AREA_PLANE, 8, 4] * 3.0)
    assert area_m2 == pytest.approx(4.0 * 2.4)
    across_m = np.expm1(grid[FREE_LEFT, 8, 4]) + np.expm1(grid[FREE_RIGHT, 8, 4])
    assert across_m == pytest.approx(2.4)


def test_mirroring_the_plan_mirrors_the_condition():
    rgb = _two_rooms()
    here = plan_condition(rgb, 0.1, 4)
    there = plan_condition(np.ascontiguousarray(rgb[::-1]), 0.1, 4)
    assert np.array_equal(there.pixels, here.pixels[:, ::-1])
    unchanged = list(range(AREA_PLANE + 5))
    assert np.allclose(there.grid[unchanged], here.grid[unchanged, ::-1])


def test_the_floor_before_a_door_is_kept_free_on_both_sides():
    door_plane, window_plane = plan_condition(_two_rooms(), 0.1, 4).pixels[FLOOR_PLANE + 1 :]
    # The door is 0.8 m wide, so it keeps 0.8 m free in either room.
    expected = np.zeros((64, 64), bool)
    expected[24:32, 24:32] = expected[24:32, 36:44] = True
    assert np.array_equal(door_plane > 0, expected)
    assert not window_plane.any()


def test_a_passage_of_a_shaded_plan_is_kept_free_like_a_door():
    rgb = _two_rooms()
    rgb[24:32, 32:36] = 255
    assert plan_condition(rgb, 0.05, 4).pixels[FLOOR_PLANE + 1, 24:32, 24:32].all()


def test_a_window_keeps_half_a_metre_free_inside_only():
    rgb = _two_rooms()
    rgb[20:30, 4:8] = CATEGORIES["window"].rgb
    kept = plan_condition(rgb, 0.1, 4).pixels[FLOOR_PLANE + 2]
    assert np.array_equal(np.argwhere(kept).min(axis=0), [20, 8])
    assert kept.sum() == 10 * 5
