"""Every change that a rule makes is kept with the piece."""

from __future__ import annotations

from dataclasses import replace

from chord_usd.arrange.rules import edits_told, noted
from chord_usd.scene.types import Box, Edit, Item, Room, SceneGraph, frozen_array

ROOM = Room("r", "bedroom", frozen_array([[0, 0], [4, 0], [4, 3], [0, 3]]))
BED = Item("r/bed_0", "bed", Box((1.0, 1.5, 0.0), (1.6, 2.0, 0.5), 0.0), "r")
DESK = Item("r/table_0", "table", Box((3.0, 2.6, 0.0), (1.2, 0.6, 0.75), 0.0), "r")
HOUSE = SceneGraph((ROOM,), (), (BED, DESK))


def moved(item: Item, by_m: float) -> Item:
    x, y, z = item.box.center_m
    return replace(item, box=replace(item.box, center_m=(x + by_m, y, z)))


def test_a_change_is_kept_with_the_rule_and_the_box_before() -> None:
    after = noted("one", HOUSE, replace(HOUSE, items=(moved(BED, 0.3), DESK)))
    again = noted("other", after, replace(after, items=(moved(after.items[0], -0.1), DESK)))
    bed, desk = again.items
    assert [edit.rule for edit in bed.facts.edits] == ["one", "other"]
    assert bed.facts.edits[0] == Edit("one", BED.box)
    assert bed.moved_m == 0.2
    assert not desk.facts.edits
    assert edits_told(again) == [
        {"item": "r/bed_0", "rule": "one", "moved_m": 0.2},
        {"item": "r/bed_0", "rule": "other", "moved_m": 0.2},
    ]


def test_rounding_is_no_change_and_what_is_new_has_none() -> None:
    new = replace(DESK, id="r/table_1")
    after = noted("one", HOUSE, replace(HOUSE, items=(moved(BED, 1e-9), DESK, new)))
    assert not edits_told(after)
