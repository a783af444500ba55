"""The labelled picture from above: what is where, at what scale, and that it is whole."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from chord_usd.base.errors import OutputError
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.line.image.preview import PAPER, PICTURE_PX, WALL, Sheet, draw_preview, preview_rgb


@pytest.fixture
def flat() -> SceneGraph:
    corners = [(0, 0), (5, 0), (5, 4), (0, 4)]
    bed = Item("bed", "bed", Box((3.9, 2.9, 0), (1.8, 2.0, 0.5), 0.0), room_id="a")
    return SceneGraph(
        rooms=(Room("a", "bedroom", frozen_array(corners)),),
        openings=(
            Opening("w", "window", Box((2.5, 4.12, 0.9), (1.5, 0.24, 1.2), 0.0)),
            Opening("d", "door", Box((1.0, -0.12, 0), (0.9, 0.24, 2.1), 0.0)),
        ),
        items=(bed,),
    )


def color_at(graph: SceneGraph, x_m: float, y_m: float) -> np.ndarray:
    column, row = Sheet.around(graph).px(np.array([x_m, y_m])).astype(int)
    return preview_rgb(graph)[row, column].astype(int)


def test_longer_side_and_colours(flat):
    picture = preview_rgb(flat)
    assert picture.dtype == np.uint8
    assert abs(max(picture.shape[:2]) - PICTURE_PX) <= 1
    assert tuple(picture[2, 2]) == PAPER
    np.testing.assert_allclose(color_at(flat, -0.12, 2.0), WALL, atol=2)


def test_north_is_up_and_items_lie_where_they_are(flat):
    red = np.array(category("bed").rgb) - color_at(flat, 3.3, 3.5)
    assert red[0] < 40
    assert red[1] < 0
    assert color_at(flat, 1.0, 0.8).min() > 220  # floor
    assert color_at(flat, 1.2, 4.12).max() < 90  # wall
    glass = color_at(flat, 2.5, 4.05)
    assert glass[2] > glass[0] + 10


def test_the_front_is_marked_on_the_side_that_faces_it(flat):
    """At yaw 0 the front is towards -y: the mark is dark near y = 1.9, and not near y = 3.9."""
    front, back = color_at(flat, 3.9, 1.96), color_at(flat, 3.9, 3.84)
    assert front.sum() < back.sum() - 60


def test_a_picture_is_written_whole_and_the_same_each_time(flat, tmp_path):
    draw_preview(flat, tmp_path / "a.png")
    draw_preview(flat, tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.png", "b.png"]
    assert np.array_equal(np.asarray(Image.open(tmp_path / "a.png")), preview_rgb(flat))


def test_a_scene_without_anything_is_an_empty_sheet(tmp_path):
    draw_preview(SceneGraph((), (), ()), tmp_path / "empty.png")
    with pytest.raises(OutputError):
        draw_preview(SceneGraph((), (), ()), tmp_path)
