"""Our houses beside the paper's tables."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.workshop.data import paper_tables as paper
from chord_usd.workshop.data.floorplans.programme import spread_room_count
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.statistics import as_text, count_houses, total_variation

HISTOGRAMS = st.dictionaries(st.sampled_from("abcdef"), st.integers(1, 1000), min_size=1)

FAR = 0.05
"""Total variation distance to the paper's histograms that is asked for."""


@given(HISTOGRAMS, HISTOGRAMS, st.integers(2, 9))
def test_total_variation_is_a_distance_of_shares(a: dict, b: dict, times: int) -> None:
    apart = total_variation(a, b)
    assert 0.0 <= apart <= 1.0 + 1e-12
    assert apart == pytest.approx(total_variation(b, a))
    assert total_variation({key: times * count for key, count in a.items()}, a) < 1e-12
    if not a.keys() & b.keys():
        assert apart == pytest.approx(1.0)


def test_seeds_in_a_row_have_the_rooms_of_the_papers_houses() -> None:
    for first in (0, 777, 10**9):
        counts = Counter(spread_room_count(seed) for seed in range(first, first + 500))
        assert total_variation(counts, paper.ROOM_COUNTS) < FAR


def test_houses_hold_what_the_papers_hold() -> None:
    items: Counter[str] = Counter()
    for seed in range(200):
        rng = np.random.default_rng(seed)
        house = furnish(random_plan(rng, spread_room_count(seed)), rng, "paper")
        items.update(item.category for item in house.items)
    assert total_variation({name: items[name] for name in paper.ITEMS}, paper.ITEMS) < FAR


def test_tables_name_every_category_and_count_what_is_there() -> None:
    rng = np.random.default_rng(3)
    houses = [furnish(random_plan(rng, 6), rng) for _ in range(4)]
    statistics = count_houses(houses)
    assert statistics.items.total() == sum(len(house.items) for house in houses)
    assert statistics.rooms_per_house == {6: 4}
    assert statistics.as_json()["scores"]["por"]["value"] == 0.0
    text = as_text(statistics)
    assert all(name in text for name in paper.ITEMS)


def test_no_house_is_as_far_as_can_be() -> None:
    statistics = count_houses([])
    assert statistics.category_distance == 1.0
    assert statistics.empty_room_rate == 0.0
    assert "0 houses" in as_text(statistics)
