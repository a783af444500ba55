"""What the pixels of layout rasters show, in exact and in spoilt colours."""

from __future__ import annotations

import numpy as np
import pytest

from chord_usd.base.errors import SceneError
from chord_usd.base.raster import canvas
from chord_usd.base.scene.palette import HOUSE_CATEGORIES, ROOM_SHADES
from chord_usd.base.scene.types import Box, Item, Plan, Room, RoomKind, frozen_array
from chord_usd.line.graph.colours import NO_ITEM, SHADE_KINDS, read_pixels

ROOM = np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 6.0], [0.0, 6.0]])


def plan_of(kind: RoomKind) -> Plan:
    return Plan((Room("r", kind, frozen_array(ROOM)),), ())


def all_categories() -> tuple[Item, ...]:
    """One piece of every category, 0.8 m square, in rows."""
    return tuple(
        Item(
            row.name, row.name, Box((0.8 + i % 8 * 1.05, 0.8 + i // 8 * 1.4, 0), (0.8,) * 3, 0), "r"
        )
        for i, row in enumerate(HOUSE_CATEGORIES)
    )


@pytest.mark.parametrize("kind", list(ROOM_SHADES))
def test_every_category_and_mark_is_read_on_every_shade(kind: RoomKind) -> None:
    plan_image = canvas.draw_plan(plan_of(kind))
    labels, front = canvas.draw_items(all_categories(), plan_image.frame)
    pixels = read_pixels(canvas.paint_layout(plan_image, labels, front))
    np.testing.assert_array_equal(pixels.item, labels.astype(int) - 1)
    np.testing.assert_array_equal(pixels.front, front)
    assert (pixels.shade[pixels.item != NO_ITEM] == SHADE_KINDS.index(kind)).all()


@pytest.mark.parametrize("kind", ["unknown", "kitchen"])
@pytest.mark.parametrize("reach", [6, 8])
def test_noise_changes_few_pixels(kind: RoomKind, reach: int) -> None:
    plan_image = canvas.draw_plan(plan_of(kind))
    labels, front = canvas.draw_items(all_categories(), plan_image.frame)
    rgb = canvas.paint_layout(plan_image, labels, front).astype(int)
    rgb += np.random.default_rng(reach).integers(-reach, reach + 1, rgb.shape)
    pixels = read_pixels(np.clip(rgb, 0, 255).astype(np.uint8))
    painted = labels > 0
    assert (pixels.item != labels.astype(int) - 1)[painted].mean() < 0.01
    assert (pixels.item[~painted] != NO_ITEM).mean() < 0.001


@pytest.mark.parametrize("kind", ["unknown", "kitchen", "store"])
@pytest.mark.parametrize("offset", [(6, -6, 0), (-5, 3, 6), (0, 0, 0)])
def test_colours_that_are_all_shifted_alike_are_read_as_their_own(
    kind: RoomKind, offset: tuple[int, int, int]
) -> None:
    plan_image = canvas.draw_plan(plan_of(kind))
    labels, front = canvas.draw_items(all_categories(), plan_image.frame)
    rgb = canvas.paint_layout(plan_image, labels, front) * (0.94, 0.97, 1.0) + offset
    pixels = read_pixels(np.clip(rgb, 0, 255).astype(np.uint8))
    assert pixels.clean
    np.testing.assert_array_equal(pixels.item, labels.astype(int) - 1)
    np.testing.assert_array_equal(pixels.front, front)
    assert (pixels.shade[pixels.item != NO_ITEM] == SHADE_KINDS.index(kind)).all()


def test_two_shades_without_a_wall_between_are_told_apart() -> None:
    halves = [ROOM * (0.5, 1.0), ROOM * (0.5, 1.0) + (4.5, 0.0)]
    rooms = tuple(
        Room(kind, kind, frozen_array(half))
        for kind, half in zip(("living", "dining"), halves, strict=True)
    )
    plan_image = canvas.draw_plan(Plan(rooms, ()))
    table = Item("t", "table", Box((4.5, 3.0, 0), (2.0, 1.0, 0.8), 0), "living")
    labels, front = canvas.draw_items([table], plan_image.frame)
    pixels = read_pixels(canvas.paint_layout(plan_image, labels, front))
    shades = pixels.shade[labels > 0]
    assert set(shades) == {SHADE_KINDS.index("living"), SHADE_KINDS.index("dining")}
    assert (pixels.item[labels > 0] == labels[labels > 0].astype(int) - 1).all()


def test_a_picture_of_another_type_is_refused() -> None:
    with pytest.raises(SceneError, match="uint8"):
        read_pixels(np.zeros((4, 4), dtype=np.uint8))
