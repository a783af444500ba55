"""What is held out stays held out."""

import numpy as np

from chord_usd.workshop.data.splits import (
    TEST_SEED,
    is_test_seed,
    part_of,
    split_hash,
    training_seed,
)


def test_the_hash_names_the_set_not_the_order():
    assert split_hash(["a", "b"]) == split_hash(["b", "a"])
    assert split_hash(["a", "b"]) != split_hash(["a", "c"])
    assert split_hash(["ab"]) != split_hash(["a", "b"])


def test_about_a_fifth_of_real_plans_is_held_out():
    held_out = sum(part_of(f"flat/{index}") == "test" for index in range(5000))
    assert 900 < held_out < 1100


def test_procedural_test_houses_are_a_seed_range():
    assert is_test_seed(TEST_SEED)
    assert not is_test_seed(TEST_SEED - 1)


def test_seeds_to_train_on_are_of_few_houses_where_few_are_asked_for():
    rng = np.random.default_rng(0)
    assert {training_seed(rng, 5) for _ in range(100)} == set(range(5))
    assert len({training_seed(rng) for _ in range(100)}) == 100


def test_a_file_named_after_a_plan_belongs_where_the_plan_belongs():
    for index in range(200):
        assert part_of(f"00/02/{index}") == part_of(f"00_02_{index}")
