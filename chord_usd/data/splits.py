"""What is held out from training, decided by identity, never by chance at run time."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

TEST_SEED = 10**9
"""Procedural houses with seeds from here on are test houses, TEST_HOUSES of them."""

TEST_HOUSES = 10**6

TEST_SHARE = 0.2
"""Share of real plans that is held out (paper: 80 % training, 20 % test)."""


def is_test_seed(seed: int) -> bool:
    """Whether a procedural house of this seed is held out."""
    return TEST_SEED <= seed < TEST_SEED + TEST_HOUSES


def is_test_plan(plan_id: str) -> bool:
    """Whether a real plan of this name is held out: by the hash of its name, for ever."""
    digest = hashlib.sha256(plan_id.encode()).digest()
    return int.from_bytes(digest[:4], "big") < TEST_SHARE * 2**32


def split_hash(ids: Iterable[str]) -> str:
    """12 hex digits that name a set of houses, whatever their order; printed beside its scores."""
    joined = "\n".join(sorted(ids)).encode()
    return hashlib.sha256(joined).hexdigest()[:12]
