"""Tabletops to learn lists from: an endless stream, none seen twice."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from chord_usd.base.scene.types import LEARNED_KINDS
from chord_usd.line.lists import things
from chord_usd.line.lists.vocabulary import sequence_of
from chord_usd.workshop.data.splits import TEST_SEED, is_test_seed
from chord_usd.workshop.data.tabletops import Tabletop, random_tabletop
from chord_usd.workshop.training.lists_data import Batch, ListSample, stacked

UNNAMED_SHARE = 0.1
"""Share of pieces without a room, as on plans without names."""
_BUCKETS = 4
"""Batches that are drawn together and sorted by length, so that little is padding."""


def held_out(count: int) -> list[Tabletop]:
    """The first test tabletops."""
    return [random_tabletop(np.random.default_rng(TEST_SEED + index)) for index in range(count)]


def endless_batches(batch: int, seed: int) -> Iterator[Batch]:
    """Batches of tabletops that may be trained on."""
    rng = np.random.default_rng(seed)
    while True:
        drawn: list[Tabletop] = []
        while len(drawn) < batch * _BUCKETS:
            drawn_seed = int(rng.integers(2**40))
            if not is_test_seed(drawn_seed):
                drawn.append(random_tabletop(np.random.default_rng(drawn_seed)))
        drawn.sort(key=lambda tabletop: len(tabletop.items))
        for start in rng.permutation(_BUCKETS) * batch:
            yield batch_of(drawn[start : start + batch], rng)


def batch_of(tabletops: Sequence[Tabletop], rng: np.random.Generator | None = None) -> Batch:
    """Tabletops side by side; with rng, some do not know their room."""
    samples = [_sample(tabletop) for tabletop in tabletops]
    if rng is not None:
        for sample in samples:
            if rng.random() < UNNAMED_SHARE:
                sample.facts[1] = LEARNED_KINDS.index("unknown")
    return stacked(samples)


def _sample(tabletop: Tabletop) -> ListSample:
    top = tabletop.top
    sequence = sequence_of(things.THINGS, things.things_of(tabletop.items, top))
    return ListSample(things.segments_of(top), things.facts_of(top), things.flags_of(top), sequence)
