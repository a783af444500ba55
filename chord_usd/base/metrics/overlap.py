"""POR and PIoU: how many pairs of items overlap, and by how much (CHOrD, section 5).

A pair overlaps when its oriented footprints share more than MIN_OVERLAP_M2. Items of the house
make pairs with each other, tabletop items only with those on the same table. Both scores come in
two variants with one denominator, all pairs of the scene: `por_all` and `piou_all` count every
overlap; `por` and `piou` leave out overlaps that are natural (a chair pushed under its table).
Hence 0 <= piou <= por <= por_all <= 1, always.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
import shapely

from chord_usd.base.metrics.footprints import (
    GRID_M,
    Footprints,
    footprints_of,
    is_underfoot,
    sibling_groups,
)
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Item, SceneGraph

MIN_OVERLAP_M2 = 1e-4
"""Footprints that share no more than 1 cm² do not count as overlapping."""

STACKED_TOLERANCE_M = 0.01
"""An item whose underside is at most this far below another's upper side stands on it."""

NATURAL_PAIRS = frozenset(
    frozenset((row.name, other)) for row in CATEGORIES.values() for other in row.overlaps
)
"""Categories that overlap by nature: a panel behind what leans on it, a chair under a table."""


def natural_partners(name: str) -> frozenset[str]:
    """Categories that overlap one by nature: of a chair, the tables it is pushed under."""
    return frozenset(other for pair in NATURAL_PAIRS if name in pair for other in pair - {name})


@dataclass(frozen=True)
class PairOverlap:
    """Two items whose footprints overlap."""

    a: str
    b: str
    area_m2: float
    iou: float
    """Intersection over union of the two footprints, in (0, 1]."""
    natural: bool
    """Left out of `por` and `piou`."""


@dataclass(frozen=True)
class Overlap:
    """The overlapping pairs of a scene, and how many pairs there are in all."""

    pairs: int
    overlapping: tuple[PairOverlap, ...]

    @property
    def por(self) -> float:
        """Share of pairs that overlap and should not, in [0, 1]; 0.0 where there is no pair."""
        return self._over_pairs(sum(1.0 for pair in self.overlapping if not pair.natural))

    @property
    def por_all(self) -> float:
        """Share of pairs that overlap, natural ones included."""
        return self._over_pairs(float(len(self.overlapping)))

    @property
    def piou(self) -> float:
        """Mean intersection over union of all pairs, natural overlaps counted as none."""
        return self._over_pairs(sum(pair.iou for pair in self.overlapping if not pair.natural))

    @property
    def piou_all(self) -> float:
        """Mean intersection over union of all pairs."""
        return self._over_pairs(sum(pair.iou for pair in self.overlapping))

    def _over_pairs(self, total: float) -> float:
        return total / self.pairs if self.pairs else 0.0


def overlaps_by_nature(a: Item, b: Item) -> bool:
    """Whether these two may share floor: a natural pair, one lies underfoot, or one on the other.

    The relation is symmetric.
    """
    if frozenset((a.category, b.category)) in NATURAL_PAIRS or is_underfoot(a) or is_underfoot(b):
        return True
    lower, upper = sorted((a.box, b.box), key=lambda box: box.center_m[2])
    return upper.center_m[2] >= lower.top_m - STACKED_TOLERANCE_M


def overlapping_pairs(prints: Footprints) -> list[PairOverlap]:
    """Every pair of these footprints that shares more than MIN_OVERLAP_M2, each once."""
    tree = shapely.STRtree(prints.polygons)
    first, second = tree.query(prints.polygons, predicate="intersects")
    once = first < second
    first, second = first[once], second[once]
    shared = shapely.intersection(prints.polygons[first], prints.polygons[second], grid_size=GRID_M)
    shared_m2 = shapely.area(shared)
    iou = shared_m2 / (prints.areas_m2[first] + prints.areas_m2[second] - shared_m2)
    return [
        PairOverlap(
            a=prints.items[first[k]].id,
            b=prints.items[second[k]].id,
            area_m2=float(shared_m2[k]),
            iou=min(1.0, float(iou[k])),
            natural=overlaps_by_nature(prints.items[first[k]], prints.items[second[k]]),
        )
        for k in np.flatnonzero(shared_m2 > MIN_OVERLAP_M2)
    ]


def items_overlap(items: Sequence[Item]) -> Overlap:
    """The overlap of items that share a frame. Fewer than two make no pair."""
    count = len(items)
    if count < 2:
        return Overlap(pairs=0, overlapping=())
    return Overlap(count * (count - 1) // 2, tuple(overlapping_pairs(footprints_of(items))))


def scene_overlap(graph: SceneGraph) -> Overlap:
    """The overlap of a whole scene: pairs of the house plus pairs on each table."""
    groups = [items_overlap(group) for group in sibling_groups(graph)]
    return Overlap(
        pairs=sum(group.pairs for group in groups),
        overlapping=tuple(chain.from_iterable(group.overlapping for group in groups)),
    )
