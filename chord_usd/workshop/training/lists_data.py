"""Rooms to learn lists from: an endless stream of furnished rooms, in all eight poses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from chord_usd.base.scene.types import LEARNED_KINDS, FloatArray, Item, Plan, SceneGraph
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.lists import pieces
from chord_usd.line.lists.vocabulary import SEGMENT_FIELDS, Floats, Ints, Sequences, sequence_of
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED, training_seed

Batch = tuple[Tensor, Tensor, Tensor, Tensor, Tensor, Tensor]
"""Segments, facts, flags, roles, left and values: what the network takes."""

HOMES_SHARE = 0.8
"""Houses furnished as homes; the others as sparsely as the paper's."""
FLAT_SHARE = 0.35
"""Houses that are real flats, where there are any."""
UNKNOWN_SHARE = 0.4
"""Houses whose rooms know nothing of what the others hold."""
UNNAMED_SHARE = 0.05
"""Share of rooms without a kind, as on plans without names."""
POOL = 12_000
"""Rooms that are kept and seen again in other poses."""
NEW_HOUSES = 3
"""Furnished for each batch."""
_BUCKETS = 4
"""Batches that are drawn together and sorted by length, so that little is padding."""


@dataclass(frozen=True, eq=False)
class Example:
    """One room."""

    around: pieces.Around
    items: tuple[Item, ...]


def examples_of(
    house: SceneGraph, teacher: pieces.Teacher, rng: np.random.Generator
) -> list[Example]:
    """Rooms of a house: each knows of those furnished before it, in random order, or of none."""
    is_known = rng.random() >= UNKNOWN_SHARE
    order = rng.permutation(len(house.rooms))
    finished = (
        [house.rooms[i].id for i in order[: rng.integers(len(order) + 1)]] if is_known else None
    )
    arounds = pieces.rooms_around(house, teacher, finished)
    known = frozenset(finished or ())
    examples = []
    for room, around in zip(house.rooms, arounds, strict=True):
        if room.id not in known:
            examples.append(Example(around, tuple(house.items_of(room.id))))
    return examples


def endless_houses(
    flats: Sequence[Plan],
    rng: np.random.Generator,
    procedural: int | None = None,
    furnished: Sequence[SceneGraph] = (),
    sparse_share: float = 0.0,
) -> Iterator[tuple[SceneGraph, pieces.Teacher]]:
    """Furnished houses that may be trained on, and whose they imitate.

    procedural: how many different ones; None for no two alike. furnished: in place of all others,
    but for a share of the paper's sparse houses, in [0, 1].
    """
    while True:
        if furnished and rng.random() >= sparse_share:
            yield furnished[int(rng.integers(len(furnished)))], "homes"
            continue
        if flats and rng.random() < FLAT_SHARE:
            plan, flat_rng = flats[int(rng.integers(len(flats)))], rng
        else:
            flat_rng = np.random.default_rng(training_seed(rng, procedural))
            plan = random_plan(flat_rng)
        is_home = flat_rng.random() < HOMES_SHARE and not furnished
        teacher: pieces.Teacher = "homes" if is_home else "paper"
        yield furnish(plan, flat_rng, teacher), teacher


def held_out(count: int) -> list[Example]:
    """The rooms of the first test houses, as homes."""
    owns = [np.random.default_rng(TEST_SEED + index) for index in range(count)]
    return examples_in([furnish(random_plan(generator), generator) for generator in owns])


def examples_in(houses: Iterable[SceneGraph]) -> list[Example]:
    """The rooms of these houses, as homes; always the same."""
    rng = np.random.default_rng(0)
    return [example for house in houses for example in examples_of(house, "homes", rng)]


def endless_batches(
    flats: Sequence[Plan],
    batch: int,
    seed: int,
    pool: int = POOL,
    procedural: int | None = None,
    furnished: Sequence[SceneGraph] = (),
    sparse_share: float = 0.0,
) -> Iterator[Batch]:
    """Batches of rooms. A pool of rooms is filled first, and renewed a little with each batch.

    procedural, furnished, sparse_share: as of endless_houses.
    """
    rng = np.random.default_rng(seed)
    houses = endless_houses(flats, rng, procedural, furnished, sparse_share)
    rooms: list[Example] = []
    while len(rooms) < min(pool, 20 * batch):
        rooms += examples_of(*next(houses), rng)
    while True:
        for _ in range(NEW_HOUSES * _BUCKETS):
            for example in examples_of(*next(houses), rng):
                if len(rooms) < pool:
                    rooms.append(example)
                else:
                    rooms[int(rng.integers(pool))] = example
        chosen = [rooms[i] for i in rng.integers(len(rooms), size=batch * _BUCKETS)]
        chosen.sort(key=lambda example: len(example.items))
        for start in rng.permutation(_BUCKETS) * batch:
            yield batch_of(chosen[start : start + batch], rng)


@dataclass(frozen=True, eq=False)
class ListSample:
    """One list and what it is for, as numbers."""

    segments: Ints
    """(S, SEGMENT_FIELDS)"""
    facts: Ints
    flags: Floats
    sequence: Sequences


def stacked(samples: Sequence[ListSample]) -> Batch:
    """Lists of one vocabulary side by side, padded to the longest."""
    longest = max(len(sample.sequence.roles) for sample in samples)
    most = max(len(sample.segments) for sample in samples)
    count, slots = len(samples), samples[0].sequence.values.shape[1]
    segments = np.zeros((count, most, SEGMENT_FIELDS), np.int64)
    roles = np.zeros((count, longest), np.int64)
    left = np.zeros_like(roles)
    values = np.zeros((count, longest, slots), np.int64)
    for index, sample in enumerate(samples):
        length = len(sample.sequence.roles)
        segments[index, : len(sample.segments)] = sample.segments
        roles[index, :length], left[index, :length] = sample.sequence.roles, sample.sequence.left
        values[index, :length] = sample.sequence.values
    facts = np.stack([sample.facts for sample in samples])
    flags = np.stack([sample.flags for sample in samples])
    arrays = (segments, facts, flags, roles, left, values)
    tensors = [torch.from_numpy(array) for array in arrays]
    return tensors[0], tensors[1], tensors[2], tensors[3], tensors[4], tensors[5]


def batch_of(examples: Sequence[Example], rng: np.random.Generator | None = None) -> Batch:
    """Rooms side by side, each in a pose of its own where rng is given."""
    samples = [_sample(example, rng) for example in examples]
    if rng is not None:
        for index in np.flatnonzero(rng.random(len(samples)) < UNNAMED_SHARE):
            samples[index].facts[0] = LEARNED_KINDS.index("unknown")
    return stacked(samples)


def _sample(example: Example, rng: np.random.Generator | None) -> ListSample:
    """A room and its list, in a random pose."""
    turns, mirrored = (int(rng.integers(4)), bool(rng.integers(2))) if rng else (0, False)
    around = example.around
    lines = _posed(around.lines_m, turns, mirrored)
    elements = pieces.pieces_of(example.items, around.frame, turns, mirrored)
    segments = pieces.segments_of(around, lines)
    if rng is not None:
        segments = rng.permutation(segments)
    sequence = sequence_of(pieces.PIECES, elements)
    return ListSample(segments, around.facts.copy(), around.flags, sequence)


def _posed(lines_m: FloatArray, quarter_turns: int, mirrored: bool) -> FloatArray:
    """(S, 4) segments mirrored in x, then turned; the room stays on their left."""
    points = lines_m.reshape(-1, 2, 2)
    if mirrored:
        points = points[:, ::-1] * (-1.0, 1.0)
    turned: FloatArray = (points @ rotation_2d(90.0 * quarter_turns).T).reshape(-1, 4)
    return turned
