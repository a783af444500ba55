"""What is held out from training, decided by identity, never by chance at run time."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from typing import Literal

import numpy as np

Part = Literal["train", "test"]

TEST_SEED = 10**9
"""Procedural houses with seeds from here on are test houses, TEST_HOUSES of them."""

TEST_HOUSES = 10**6

TEST_SHARE = 0.2
"""Share of real plans that is held out (paper: 80 % training, 20 % test)."""


def is_test_seed(seed: int) -> bool:
    """Whether a procedural house of this seed is held out."""
    return TEST_SEED <= seed < TEST_SEED + TEST_HOUSES


def training_seed(rng: np.random.Generator, houses: int | None = None) -> int:
    """Seed of a procedural house that may be trained on.

    houses: of the first so many alone; None for more than any run sees.
    """
    while True:
        seed = int(rng.integers(houses or 2**40))
        if not is_test_seed(seed):
            return seed


def part_of(plan_id: str) -> Part:
    """The part a real plan of this name belongs to: by the hash of its name, for ever.

    Underscores count as slashes: a file named after a plan belongs where the plan belongs.
    """
    digest = hashlib.sha256(plan_id.replace("_", "/").encode()).digest()
    return "test" if int.from_bytes(digest[:4], "big") < TEST_SHARE * 2**32 else "train"


def split_hash(ids: Iterable[str]) -> str:
    """12 hex digits that name a set of houses, whatever their order; printed beside its scores."""
    joined = "\n".join(sorted(ids)).encode()
    return hashlib.sha256(joined).hexdigest()[:12]
