"""Lists of things as sequences of small numbers: what a list network reads and writes.

A list is told in two parts: the categories of its elements, by the ranks of the vocabulary, closed
by END, and then every element's own values, slot by slot. Each position of the sequence holds up to
as many values as an element has slots; what they mean follows from the position's role. What lies
around (walls and openings, the rim of a table) is told before it, as segments.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import WET_KINDS, BoolArray, RoomKind

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
    kept = list(elements)[: vocabulary.most]
    categories = [element.category for element in kept]
    count = len(kept)
    values = np.full((2 * count + 1, len(vocabulary.slots)), NOTHING, np.int64)
    values[:count, 0] = np.array(categories, np.int64) + END + 1
    values[count, 0] = END
    starts = [vocabulary.first[name] for name in vocabulary.slots]
    for index, element in enumerate(kept):
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


# What people call pieces of furniture, in the languages of room_names. Blanks are "_" ------------

ANY_M = (0.0, math.inf)

_SIZED = (
    ("bed", (0.0, 1.3), "single_bed twin_bed einzelbett lit_simple cama_individual"
     " cama_de_solteiro enkelsang 单人床 單人床 シングルベッド"),
    ("bed", (1.3, math.inf), "double_bed doppelbett lit_double cama_doble cama_de_matrimonio"
     " cama_de_casal dubbelsang parisanky 双人床 雙人床 ダブルベッド"),
    ("bed", (1.45, 1.75), "queen_bed queen_size_bed queen_sized_bed"),
    ("bed", (1.75, math.inf), "king_bed king_size_bed king_sized_bed"),
    ("sofa", (0.0, 1.9), "loveseat love_seat two_seater two_seater_sofa 2_seater 2_seater_sofa"
     " zweisitzer canape_deux_places"),
    ("sofa", (1.9, math.inf), "three_seater three_seater_sofa 3_seater 3_seater_sofa dreisitzer"
     " canape_trois_places"),
)  # fmt: skip
"""Words that say how long a piece is: metres, along its back."""

_LOUNGE = dict.fromkeys(("armchair", "arm chair", "easy chair"), "leisure_sofa")

HERE: dict[RoomKind, dict[str, str]] = {
    "bedroom": _LOUNGE,
    "study": _LOUNGE,
    "balcony": _LOUNGE,
    **{kind: {"sink": "washbasin"} for kind in WET_KINDS},
    "kitchen": {"table": "dining_table", "basin": "sink_cabinet"},
    "dining": {"table": "dining_table"},
}
"""Words that mean another category in some rooms."""


class Named(NamedTuple):
    """What a word stands for."""

    word: str
    """As the tables have it, with blanks."""
    category: str
    length_m: tuple[float, float] = ANY_M


WORDS: dict[str, Named] = {
    word.replace("_", ""): Named(word.replace("_", " "), category, length_m)
    for category, length_m, words in (
        *((row.name, ANY_M, row.words) for row in CATEGORIES.values()),
        *_SIZED,
    )
    for word in (words.split() if isinstance(words, str) else words)
}
"""By the word without blanks."""

_PLURALS = ("s", "es", "x", "n", "en", "e", "er", "ar", "r", "a", "ta")


def named(words: list[str]) -> Named | None:
    """What these words together name, singular or plural; None for what is not known."""
    joined = "".join(words)
    stems = [joined, *(joined.removesuffix(end) for end in _PLURALS if joined.endswith(end))]
    stems += [joined[:-3] + "f"] if joined.endswith("ves") else []
    # "Chests of drawers", "tables de chevet": several, said in the first word.
    stems += ["".join([words[0].removesuffix("s"), *words[1:]])] if len(words) > 1 else []
    stems += [stem.removesuffix("s") for stem in stems[-1:]]
    return next((WORDS[stem] for stem in stems if stem in WORDS), None)
