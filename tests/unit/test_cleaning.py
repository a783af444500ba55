"""Cleaning takes out what is wrong and nothing else."""

from __future__ import annotations

import numpy as np

from chord_usd.base.metrics import score_scene
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.workshop.data.cleaning import clean
from chord_usd.workshop.data.distributions import compare, measure
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan


def _bedroom(*items: Item) -> SceneGraph:
    corners = frozen_array([(0, 0), (5, 0), (5, 4), (0, 4)])
    door = Opening("door1", "door", Box((4.0, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("r",))
    return SceneGraph((Room("r", "bedroom", corners),), (door,), items)


def _item(name: str, category: str, x: float, y: float, length: float, depth: float) -> Item:
    return Item(name, category, Box((x, y, 0.0), (length, depth, 0.9), 0.0), "r")


BED = _item("bed", "bed", 1.5, 2.9, 1.8, 2.1)


def test_each_fault_is_taken_out_and_named() -> None:
    house = _bedroom(
        BED,
        _item("inside the bed", "bedside_table", 1.5, 2.9, 0.5, 0.4),
        _item("half outside", "cabinet", 5.0, 2.0, 1.2, 0.6),
        _item("as large as the room", "table", 2.5, 2.0, 4.9, 3.9),
        _item("before the door", "leisure_sofa", 4.0, 0.4, 0.8, 0.8),
        _item("fine", "cabinet", 0.6, 0.3, 1.2, 0.6),
    )
    cleaned = clean(house)
    assert cleaned.removed == {
        "inside the bed": "colliding",
        "half outside": "out of room",
        "as large as the room": "size",
        "before the door": "blocking",
    }
    assert [item.id for item in cleaned.house.items] == ["bed", "fine"]
    assert cleaned.is_kept
    scores = score_scene(cleaned.house)
    assert not scores.out_of_room
    assert not scores.blocked_openings
    assert scores.overlap.por == 0.0


def test_what_sticks_out_a_little_is_moved_in() -> None:
    cleaned = clean(_bedroom(BED, _item("cabinet", "cabinet", 4.44, 2.0, 1.2, 0.6)))
    assert cleaned.removed == {}
    assert np.allclose(cleaned.house.items[1].box.center_m, (4.39, 2.0, 0.0))
    assert cleaned.house.items[0].box == BED.box


def test_chairs_may_stand_under_their_table() -> None:
    house = _bedroom(
        BED,
        _item("table", "table", 4.0, 3.5, 1.2, 0.6),
        _item("chair", "chair", 4.0, 3.2, 0.5, 0.5),
    )
    assert clean(house).removed == {}


def test_empty_houses_are_dropped() -> None:
    assert not clean(_bedroom()).is_kept
    assert not clean(_bedroom(_item("toilet", "toilet", 1.0, 1.0, 0.4, 0.7))).is_kept
    assert clean(_bedroom(BED)).is_kept


def test_our_own_houses_are_clean_and_like_themselves() -> None:
    rng = np.random.default_rng(8)
    houses = [furnish(random_plan(rng), rng) for _ in range(15)]
    for house in houses:
        cleaned = clean(house)
        assert cleaned.house == house or cleaned.removed == {}
        assert cleaned.is_kept
    samples = measure(houses)
    rows = compare(samples, samples)
    assert {"length m", "wall m", "turn deg", "gap m"} <= {row.measure for row in rows}
    assert all(row.distance == 0.0 for row in rows)


def test_measures_tell_what_stands_askew_and_away() -> None:
    straight = _bedroom(BED, _item("t", "bedside_table", 2.75, 3.8, 0.5, 0.4))
    samples = measure([straight])
    assert np.isclose(samples["wall m", "bed"][0], 0.05)
    assert np.isclose(samples["turn deg", "bed"][0], 0.0)
    assert np.isclose(samples["gap m", "bedside_table - bed"][0], 0.1)
