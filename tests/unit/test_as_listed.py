"""Pieces that were painted where lists have them stand as listed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from chord_usd.base.metrics.design import design_of
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.line.lists.as_listed import REACH_M, RULE, read_as_listed

ROOM = Room("room", "bathroom", frozen_array([(0, 0), (2.4, 0), (2.4, 2), (0, 2)]))
DOOR = Opening("door", "door", Box((1.2, -0.12, 0.0), (0.8, 0.24, 2.0), 0.0), ("room",))


def house(**boxes: Box) -> SceneGraph:
    items = (Item(f"room/{name}_0", name, box, "room") for name, box in boxes.items())
    return SceneGraph((ROOM,), (DOOR,), tuple(items))


SHOWER = Box((0.4, 1.6, 0.0), (0.8, 0.8, 2.0), 0.0)
BASIN = Box((2.2, 1.2, 0.0), (0.5, 0.4, 0.85), -90.0)
LISTED = house(shower=SHOWER, washbasin=BASIN)


def test_what_was_painted_a_pixel_too_small_is_as_listed() -> None:
    shower = replace(SHOWER, center_m=(0.38, 1.62, 0.0), size_m=(0.76, 0.76, 1.9))
    basin = replace(BASIN, center_m=(2.2, 1.22, 0.0), size_m=(0.46, 0.4, 0.8))
    painted = house(shower=shower, washbasin=basin)
    after = read_as_listed(painted, LISTED, ["room"])
    for was, listed, now in zip(painted.items, LISTED.items, after.items, strict=True):
        assert now.id == was.id
        assert now.box.center_m == listed.box.center_m
        assert now.box.size_m == (*listed.box.size_m[:2], was.box.size_m[2])
        assert [edit.rule for edit in now.facts.edits] == [RULE]
    broken = [{one.rule for room in design_of([one]).rooms for one in room.findings}
              for one in (painted, after)]  # fmt: skip
    assert broken[0] - broken[1] >= {"sides of the shower", "width of the basin"}
    assert read_as_listed(after, LISTED, ["room"]).items == after.items
    assert read_as_listed(painted, LISTED, []).items == painted.items
    assert read_as_listed(painted, LISTED, ["room"], {"room/shower_0"}).items[0].box == shower


@pytest.mark.parametrize(
    "moved",
    [
        replace(SHOWER, center_m=(0.4 + REACH_M + 0.01, 1.6, 0.0)),
        replace(SHOWER, yaw_deg=90.0),
    ],
)
def test_what_was_painted_elsewhere_stays_there(moved: Box) -> None:
    painted = house(shower=moved)
    assert read_as_listed(painted, LISTED, ["room"]).items == painted.items


def test_a_room_that_would_cost_more_stays_as_read() -> None:
    """The basin was painted off the shower; as listed it would stand in it."""
    close = replace(BASIN, center_m=(0.98, 1.75, 0.0), yaw_deg=0.0)
    small = replace(SHOWER, center_m=(0.36, 1.64, 0.0), size_m=(0.72, 0.72, 2.0))
    painted = house(shower=small, washbasin=close)
    listed = house(shower=SHOWER, washbasin=replace(close, center_m=(0.9, 1.75, 0.0)))
    after = read_as_listed(painted, listed, ["room"])
    assert after.items == painted.items
