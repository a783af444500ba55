"""Tops -> what stands on them, by lists alone: all tops together, the best of several drafts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from chord_usd.base.metrics.overlap import items_overlap
from chord_usd.base.raster.relief import Relief
from chord_usd.base.raster.table_top import TableTop
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.types import Item
from chord_usd.line.lists.list_sampler import Heat, ListDrawer, Subject, load_lists, without
from chord_usd.line.lists.things import THINGS, facts_of, flags_of, items_from, segments_of

DRAFTS, KEPT = 10, 6
"""Of each top, at most; of one list."""
OFF = 0.05
"""A smaller share of a thing's footprint beside the piece is rounding of cells."""

TABLE_HEAT = Heat(categories=1.0)
"""As full as tables are: sharper lists are shorter."""

_ALL = without(THINGS.categories, THINGS)


class TopLister:
    """Writes down what stands on tops."""

    def __init__(self, drawer: ListDrawer, drafts: int = DRAFTS, heat: Heat = TABLE_HEAT) -> None:
        """drafts: of each top, at most; the first without faults is taken, or the best."""
        self._drawer, self.drafts, self._heat = drawer, drafts, heat

    @property
    def content_hash(self) -> str:
        """Of the weights."""
        return self._drawer.content_hash

    def things(
        self, tops: Sequence[TableTop], seeds: Sequence[int], progress: Progress | None = None
    ) -> list[list[Item]]:
        """Things on each top, in its frame; a top's seed alone varies its own.

        Of tops with faults further drafts tell the same things at other places: short lists gain
        nothing by it. Only what does not fit after KEPT drafts is told anew.
        """
        subjects = [Subject(segments_of(top), facts_of(top), flags_of(top)) for top in tops]
        rngs = [np.random.default_rng(seed) for seed in seeds]
        best: list[list[Item]] = [[] for _ in tops]
        faults = np.full(len(tops), np.inf)
        asked = list(subjects)
        for draft in range(self.drafts):
            waiting = [int(index) for index in np.flatnonzero(faults > 0.0)]
            if not waiting:
                break
            if draft == KEPT:
                asked = subjects
            drawn = self._drawer.draw(
                [asked[index] for index in waiting], [rngs[index] for index in waiting], self._heat
            )
            for index, one in zip(waiting, drawn, strict=True):
                items = items_from(one.elements, tops[index])
                found = top_faults(items, tops[index])
                if found < faults[index]:
                    best[index], faults[index] = items, found
                if draft == 0 and items:
                    told = tuple(element.category for element in one.elements)
                    asked[index] = replace(subjects[index], wanted=told, excluded=_ALL)
            if progress:
                progress(draft + 1, self.drafts)
        return best


def top_faults(things: Sequence[Item], top: TableTop) -> float:
    """What is wrong per thing, in square metres: things in each other or beside the top. A top
    without anything is worst."""
    if not things:
        return 1.0
    relief = Relief(top.free.astype(np.float64), (*top.size_m, 1.0))
    total = sum(pair.area_m2 for pair in items_overlap(things).overlapping if not pair.natural)
    total += sum(_beside_m2(thing, relief) for thing in things)
    return total / len(things)


def _beside_m2(thing: Item, relief: Relief) -> float:
    """How much of a thing's footprint lies beside the top, or on what rises from it, if only a
    cell."""
    mask, window = relief.under(thing.box)
    length, depth, _ = thing.box.size_m
    off = length * depth - float(mask.sum()) * relief.cell_m2
    risen = float((mask & ~relief.free[window]).sum()) * relief.cell_m2
    return risen + (off if off > OFF * length * depth else 0.0)


def load_lister(folder: Path, drafts: int = DRAFTS) -> TopLister:
    """The network of a checkpoint folder. Raises CheckpointError for an unusable one."""
    return TopLister(load_lists(folder, THINGS), drafts)
