"""The procedural teacher, searched under the planning table."""

from __future__ import annotations

import numpy as np
import pytest

from chord_usd.base.metrics.design.price import house_price
from chord_usd.base.metrics.violations import room_faults
from chord_usd.base.scene.types import SceneGraph
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.searched import furnish_best
from chord_usd.workshop.training.lists_data import endless_houses

SEEDS = range(300, 304)


def _house(seed: int, drafts: int) -> SceneGraph:
    rng = np.random.default_rng(seed)
    return furnish_best(random_plan(rng, 5), rng, drafts)


def _price(house: SceneGraph) -> float:
    faults = room_faults(house, house.rooms, unpainted=True)
    return house_price(
        house, {room.id: fault for room, fault in zip(house.rooms, faults, strict=True)}
    )


def test_more_drafts_break_fewer_rules() -> None:
    first = sum(_price(_house(seed, 1)) for seed in SEEDS)
    best = sum(_price(_house(seed, 4)) for seed in SEEDS)
    assert best < 0.8 * first


def test_the_same_seed_gives_the_same_house() -> None:
    first, again = ([(item.id, item.box) for item in _house(300, 3).items] for _ in range(2))
    assert first == again


def test_no_draft_at_all_is_refused() -> None:
    with pytest.raises(ValueError, match="1 or more"):
        _house(300, 0)


def test_sparse_houses_are_learned_beside_a_kept_set() -> None:
    home = _house(300, 1)
    houses = endless_houses([], np.random.default_rng(0), furnished=[home], sparse_share=0.5)
    drawn = [next(houses) for _ in range(12)]
    assert {teacher for _, teacher in drawn} == {"homes", "paper"}
    assert all(house is home for house, teacher in drawn if teacher == "homes")
