"""Lists of things as sequences of small numbers: what a list network reads and writes.

A list is told in two parts: the categories of its elements, by the ranks of the vocabulary, closed
by END, and then every element's own values, slot by slot. Each position of the sequence holds up to
as many values as an element has slots; what they mean follows from the position's role. What lies
around (walls and openings, the rim of a table) is told before it, as segments.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.types import BoolArray

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float32]

NOTHING, END = 0, 1
"""The value of an empty slot; of the category that closes a list."""

CATEGORY_ROLE = 0
"""Of positions that tell a category; those of an element have the role 1 + its category."""

NO_SEGMENT = 0
"""Kind of a segment that pads."""

SEGMENT_FIELDS = 5
"""Kind, and x and y of both ends."""


class Element(NamedTuple):
    """One thing of a list."""

    category: int
    """Index into the vocabulary's."""
    values: tuple[int, ...]
    """What stands in each slot, from 0."""


@dataclass(frozen=True)
class Vocabulary:
    """What a kind of list can say."""

    categories: tuple[str, ...]
    """In the order in which lists tell them, but for those of the run."""
    ranges: tuple[tuple[str, int], ...]
    """Names of kinds of value, and how many each has; "x" and "y" are places, as in segments."""
    slots: tuple[str, ...]
    """Of an element: names of ranges."""
    segments: int
    """Kinds of segment, NO_SEGMENT among them."""
    facts: tuple[int, ...]
    """How many values each fact about the whole has."""
    flags: int
    """Numbers that are told beside the facts."""
    most: int
    """Elements of a list."""
    run: tuple[str, ...] = ()
    """Neighbours among the categories that are told as they stand, end to end, whichever comes
    first: each then begins where the one before it ends."""

    @cached_property
    def ranks(self) -> Ints:
        """(categories,) which comes before which: a list tells none of a lower rank after one of a
        higher. Those of the run have one."""
        ranks = np.arange(len(self.categories))
        in_run = np.isin(self.categories, self.run)
        ranks[in_run] = ranks[in_run].min(initial=len(ranks))
        return ranks

    @cached_property
    def first(self) -> dict[str, int]:
        """The first value of each range."""
        starts, at = {}, END + 1 + len(self.categories)
        for name, count in self.ranges:
            starts[name] = at
            at += count
        return starts

    @cached_property
    def size(self) -> int:
        """How many values there are."""
        return END + 1 + len(self.categories) + sum(count for _, count in self.ranges)

    @property
    def roles(self) -> int:
        """How many roles a position can have."""
        return 1 + len(self.categories)

    def allowed(self) -> BoolArray:
        """(roles, slots, size) which values can stand where."""
        allowed = np.zeros((self.roles, len(self.slots), self.size), np.bool_)
        counts = dict(self.ranges)
        allowed[CATEGORY_ROLE, 0, END : END + 1 + len(self.categories)] = True
        allowed[CATEGORY_ROLE, 1:, NOTHING] = True
        for slot, name in enumerate(self.slots):
            allowed[1:, slot, self.first[name] : self.first[name] + counts[name]] = True
        return allowed

    def span(self, slot: int) -> tuple[int, int]:
        """The first value that can stand in a slot, and the one after the last."""
        where = np.flatnonzero(self.allowed()[:, slot].any(axis=0))
        held = where[where != NOTHING]
        return int(held[0]), int(held[-1]) + 1

    def places(self, name: str) -> tuple[int, int]:
        """First value of a range, and how many."""
        return self.first[name], dict(self.ranges)[name]


@dataclass(frozen=True, eq=False)
class Sequences:
    """Several lists of one length L, or one; unused positions at the end have no values."""

    roles: Ints
    """(..., L)"""
    left: Ints
    """(..., L) elements of this category still to come, this one counted; 0 for categories."""
    values: Ints
    """(..., L, slots)"""


def sequence_of(vocabulary: Vocabulary, elements: Sequence[Element]) -> Sequences:
    """One list. elements: by the ranks of the vocabulary; those beyond the most are left out."""
    told = list(elements)[: vocabulary.most]
    categories = [element.category for element in told]
    count = len(told)
    values = np.full((2 * count + 1, len(vocabulary.slots)), NOTHING, np.int64)
    values[:count, 0] = np.array(categories, np.int64) + END + 1
    values[count, 0] = END
    starts = [vocabulary.first[name] for name in vocabulary.slots]
    for index, element in enumerate(told):
        values[count + 1 + index] = np.array(element.values) + starts
    roles, left = roles_of(categories)
    heading = np.zeros(count + 1, np.int64)
    return Sequences(np.concatenate([heading, roles]), np.concatenate([heading, left]), values)


def roles_of(categories: Sequence[int]) -> tuple[Ints, Ints]:
    """(N,) roles, and elements of the category left, of the elements of a list."""
    seen: dict[int, int] = {}
    left = []
    for category in reversed(categories):
        seen[category] = seen.get(category, 0) + 1
        left.append(seen[category])
    return np.array(categories, np.int64) + 1, np.array(left[::-1], np.int64)
