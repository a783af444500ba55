"""What doors and windows tell of the items before them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from chord_usd.base.metrics.clear_floor import ClearFloors, blocked_openings, clearances
from chord_usd.base.raster.canvas import draw_items
from chord_usd.base.scene.types import (
    Box,
    Item,
    Opening,
    PixelFrame,
    Room,
    SceneGraph,
    frozen_array,
)
from chord_usd.line.arrange.arrangement import Painted, kept_off
from chord_usd.line.graph.colours import NO_ITEM

ROOM = Room("room1", "bedroom", frozen_array([(0, 0), (4, 0), (4, 4), (0, 4)]))
DOOR = Opening("door1", "door", Box((2.0, -0.05, 0.0), (0.8, 0.1, 2.0), 0.0))
WINDOW = Opening("window1", "window", Box((2.0, 4.05, 0.9), (1.6, 0.1, 1.2), 0.0))
REACH_M = 0.03


def cabinet(x: float, y: float, height: float = 1.6, yaw_deg: float = 0.0) -> Item:
    box = Box((x, y, 0.0), (1.0, 0.6, height), yaw_deg)
    return Item("room1/cabinet_0", "cabinet", box, "room1")


def kept(item: Item) -> Item:
    clear = ClearFloors(list(clearances([ROOM], [DOOR, WINDOW])))
    return clear.below_sill(replace(item, box=kept_off(clear, item, REACH_M)))


def kept_as_painted(item: Item, painted: Box, openings: Sequence[Opening] = (DOOR, WINDOW)) -> Item:
    """item as it is read where the raster shows painted alone."""
    frame = PixelFrame(0.03, (-0.5, -0.5), 256)
    shown = replace(item, box=painted)
    drawn, _ = draw_items([shown], frame)
    labels = np.where(drawn > 0, drawn - 1, NO_ITEM).astype(np.uint8)
    clear = ClearFloors(list(clearances([ROOM], openings)))
    return replace(item, box=kept_off(clear, item, REACH_M, Painted(labels, frame)))


def blocked(item: Item) -> list[str]:
    return [one.opening for one in blocked_openings(SceneGraph((ROOM,), (DOOR, WINDOW), (item,)))]


def assert_alike(after: Item, before: Item) -> None:
    assert after.box.center_m == pytest.approx(before.box.center_m)
    assert after.box.size_m == pytest.approx(before.box.size_m)
    assert after.extra == before.extra


@pytest.mark.parametrize("yaw_deg", [0.0, 90.0, 180.0, -90.0])
def test_half_a_pixel_before_a_door_was_drawn_beside_it(yaw_deg: float) -> None:
    half = 0.5 if yaw_deg in (0.0, 180.0) else 0.3
    item = cabinet(1.6 - half + 0.025, 0.5, yaw_deg=yaw_deg)
    assert blocked(item) == ["door1"]
    after = kept(item)
    assert not blocked(after)
    moved = np.array(item.box.size_m) - np.array(after.box.size_m)
    assert 0.0 < moved.max() < REACH_M, "one edge, by no more than it was in the way"
    assert np.count_nonzero(moved > 1e-9) == 1


def test_what_stands_before_a_door_stays_there() -> None:
    item = cabinet(1.6, 0.5)
    assert_alike(kept(item), item)
    assert blocked(kept(item)) == ["door1"]


def test_a_box_gives_up_floor_that_shows_nothing_of_its_piece() -> None:
    item = cabinet(1.3, 0.5)  # 0.2 m before the door
    assert blocked(item) == ["door1"]
    after = kept_as_painted(item, replace(item.box, center_m=(1.1, 0.5, 0.0)))
    assert not blocked(after)
    assert after.box.size_m == pytest.approx((0.79, 0.6, 1.6), abs=0.02)


def test_a_box_keeps_floor_that_shows_its_piece() -> None:
    item = cabinet(1.3, 0.5)
    assert_alike(kept_as_painted(item, item.box), item)


def test_a_box_gives_up_no_more_than_a_corner() -> None:
    item = cabinet(1.6, 0.5)  # half of it before the door
    assert_alike(kept_as_painted(item, replace(item.box, center_m=(0.6, 0.5, 0.0))), item)


def test_a_box_that_gave_way_to_one_door_need_not_to_the_next() -> None:
    beside = replace(DOOR, id="door2", box=replace(DOOR.box, center_m=(2.02, -0.05, 0.0)))
    item = cabinet(1.2, 0.5)  # 0.1 m before one door, 0.08 m before the other
    bare = replace(item.box, center_m=(1.0, 0.5, 0.0))
    after = kept_as_painted(item, bare, [DOOR, beside])
    assert after.box == kept_as_painted(item, bare, [DOOR]).box
    assert not blocked(after)


def test_before_a_window_stands_a_low_piece() -> None:
    item = cabinet(2.0, 3.7)
    assert blocked(item) == ["window1"]
    after = kept(item)
    assert after.box.size_m == pytest.approx((1.0, 0.6, 0.9))
    assert after.facts.below_sill_m == 0.9
    assert not blocked(after)


def test_a_refrigerator_blocks_the_window_it_stands_before() -> None:
    box = Box((2.0, 3.7, 0.0), (0.7, 0.6, 1.8), 180.0)
    item = replace(cabinet(2.0, 3.7), category="refrigerator", box=box)
    assert_alike(kept(item), item)
    assert blocked(kept(item)) == ["window1"]


def test_an_edge_before_a_window_counts_only_for_what_is_always_high() -> None:
    box = Box((0.9, 3.7, 0.0), (0.65, 0.6, 1.8), 180.0)
    item = replace(cabinet(0.0, 0.0), category="refrigerator", box=box)
    assert blocked(item) == ["window1"]
    assert not blocked(kept(item))


def test_houses_without_openings_are_as_before() -> None:
    item = cabinet(2.0, 2.0)
    clear = ClearFloors([])
    assert clear.below_sill(item) == item
    assert_alike(replace(item, box=kept_off(clear, item, REACH_M)), item)
