"""Every change that a rule makes is kept with the piece."""

from __future__ import annotations

from dataclasses import replace

from chord_usd.base.metrics.violations import violations
from chord_usd.base.scene.types import Box, Edit, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.rules import arrange, edits_told, noted

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


def test_what_others_placed_moves_aside_or_goes() -> None:
    wardrobe = Item("r/cabinet_0", "cabinet", Box((3.9, 0.5, 0.0), (1.0, 0.6, 2.0), 90.0), "r")
    in_bed = replace(DESK, box=replace(DESK.box, center_m=(2.2, 1.5, 0.0)))
    house = replace(HOUSE, items=(in_bed, BED, wardrobe))
    after = arrange(Arrangement.of(house), "given")
    assert [item.id for item in after.items] == [in_bed.id, BED.id, wardrobe.id]
    assert not [one for one in violations(after) if one.kind in ("overlap", "out of room")]
    desk, bed, other = after.items
    assert 0.0 < bed.moved_m < desk.moved_m < 0.5
    assert 0.0 < other.moved_m < 0.5
    still = arrange(Arrangement.of(after), "given")
    assert [item.box for item in still.items] == [item.box for item in after.items]
    # What may not move does not, and what may goes farther for it.
    held = arrange(Arrangement.of(house, movable=[BED.id]), "given")
    assert [item.box == own.box for item, own in zip(held.items, house.items, strict=True)] == [
        True, False, True,
    ]  # fmt: skip


def test_rounding_is_no_change_and_what_is_new_has_none() -> None:
    new = replace(DESK, id="r/table_1")
    after = noted("one", HOUSE, replace(HOUSE, items=(moved(BED, 1e-9), DESK, new)))
    assert not edits_told(after)


def test_what_cuts_a_side_of_the_bed_off_goes_where_nothing_needs_it() -> None:
    """A cabinet for a television stands 10 cm from the foot of the bed, all across the way."""
    room = Room("r", "bedroom", frozen_array([(0, 0), (3.72, 0), (3.72, 2.61), (0, 2.61)]))
    door = Opening("d", "door", Box((3.84, 0.92, 0.0), (0.84, 0.24, 2.1), 90.0), ("r",))
    bed = Item("r/bed_0", "bed", Box((1.44, 1.5, 0.0), (1.5, 2.22, 0.85), 0.0), "r")
    low = Item("r/tv_cabinet_0", "tv_cabinet", Box((1.4, 0.14, 0.0), (1.13, 0.28, 0.4), 180.0), "r")
    house = SceneGraph((room,), (door,), (bed, low))
    after = arrange(Arrangement.of(house, faults=lambda graph: 0.0), "drawn")
    assert [item.id for item in after.items] == [bed.id]
    # The bed cuts as much off: a bedroom without one has a fault more.
    needed = arrange(Arrangement.of(house, faults=lambda graph: -len(graph.items)), "drawn")
    assert needed.items == house.items
    shifted = replace(low, box=replace(low.box, center_m=(3.0, 2.4, 0.0)))
    free = replace(house, items=(bed, shifted))
    assert arrange(Arrangement.of(free, faults=lambda graph: 0.0), "drawn").items == free.items
