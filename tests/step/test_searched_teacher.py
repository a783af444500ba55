"""The procedural teacher, searched under the planning table."""

from __future__ import annotations

import numpy as np
import pytest

from chord_usd.base.scene.types import SceneGraph
from chord_usd.faces.commands.dataset_furnish import by_networks
from chord_usd.line.pipeline import arrange_given
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.kept_set import KeptHouse, best_of
from chord_usd.workshop.data.searched import furnish_best, price_of, repaired
from chord_usd.workshop.training.lists_data import endless_houses

SEEDS = range(300, 304)


def _house(seed: int, drafts: int) -> SceneGraph:
    rng = np.random.default_rng(seed)
    return furnish_best(random_plan(rng, 5), rng, drafts)


def test_more_drafts_break_fewer_rules() -> None:
    first = sum(price_of(_house(seed, 1)) for seed in SEEDS)
    best = sum(price_of(_house(seed, 4)) for seed in SEEDS)
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


def test_the_best_share_of_a_folder_is_kept() -> None:
    houses = [
        KeptHouse(f"{seed}_{drafts}", _house(seed, drafts)) for seed in SEEDS for drafts in (1, 4)
    ]
    best = best_of(houses, 0.5)
    price = {kept.name: price_of(kept.house) / len(kept.house.rooms) for kept in houses}
    left = [price[kept.name] for kept in houses if kept.name not in {one.name for one in best}]
    assert len(best) == len(left) == len(SEEDS)
    assert max(kept.scores["price"] for kept in best) <= min(left) + 1e-4


def test_networks_furnish_homes_that_break_fewer_rules_than_the_teacher() -> None:
    rng = np.random.default_rng(300)
    plan = random_plan(rng, 4)
    furnish = by_networks(1)
    home, again = (furnish(plan, np.random.default_rng(1)) for _ in range(2))
    assert [(item.id, item.box) for item in home.items] == [(i.id, i.box) for i in again.items]
    assert price_of(home) < price_of(furnish_best(plan, rng, 1))


def test_what_a_home_lacks_is_repaired() -> None:
    houses = [_house(seed, 1) for seed in SEEDS]
    better = [repaired(house, arrange_given) for house in houses]
    assert sum(map(price_of, better)) < 0.8 * sum(map(price_of, houses))
