"""Tops -> what stands on them, by lists alone: all tops together, the best of several drafts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from chord_usd.lists.draw import HEAT, Heat, ListDrawer, Subject, load_lists
from chord_usd.lists.things import THINGS, facts_of, flags_of, items_from, segments_of
from chord_usd.metrics.overlap import items_overlap
from chord_usd.progress import Progress
from chord_usd.relief import Relief
from chord_usd.table_top import TableTop
from chord_usd.types import Item

DRAFTS = 3
"""Of each top."""
OVER_EDGE = 0.01
"""A smaller share of a thing's footprint beside the top is rounding."""


class TopLister:
    """Writes down what stands on tops."""

    def __init__(self, drawer: ListDrawer, drafts: int = 1, heat: Heat = HEAT) -> None:
        """drafts: of each top; the first one without faults is taken, else that with fewest."""
        self._drawer, self.drafts, self._heat = drawer, drafts, heat

    @property
    def content_hash(self) -> str:
        """Of the weights."""
        return self._drawer.content_hash

    def things(
        self, tops: Sequence[TableTop], seeds: Sequence[int], progress: Progress | None = None
    ) -> list[list[Item]]:
        """Things on each top, in its frame; of a top's seed alone depends what is on it."""
        subjects = [Subject(segments_of(top), facts_of(top), flags_of(top)) for top in tops]
        rngs = [
            np.random.default_rng((draft, seed)) for draft in range(self.drafts) for seed in seeds
        ]
        drawn = self._drawer.draw(subjects * self.drafts, rngs, self._heat)
        best = []
        for index, top in enumerate(tops):
            drafts = [items_from(one.elements, top) for one in drawn[index :: len(tops)]]
            faults = [top_faults(items, top) for items in drafts]
            best.append(drafts[faults.index(min(faults))])
        if progress:
            progress(len(tops), len(tops))
        return best


def top_faults(things: Sequence[Item], top: TableTop) -> float:
    """What is wrong per thing, in square metres: things in each other or beside the top. A top
    without anything is worst."""
    if not things:
        return 1.0
    relief = Relief(top.free.astype(np.float64), (*top.size_m, 1.0))
    total = sum(pair.area_m2 for pair in items_overlap(things).overlapping if not pair.natural)
    for thing in things:
        beside = 1.0 - relief.free_share(thing.box)
        length, depth, _ = thing.box.size_m
        total += beside * length * depth if beside > OVER_EDGE else 0.0
    return total / len(things)


def load_lister(folder: Path, drafts: int = DRAFTS) -> TopLister:
    """The network of a checkpoint folder. Raises CheckpointError for an unusable one."""
    return TopLister(load_lists(folder, THINGS), drafts)
