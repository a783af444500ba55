"""Draws lists with a trained network (workshop/training/lists_network.py), position by position."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np

from chord_usd.base.runtime.networks import Network, content_hash, load_network
from chord_usd.line.lists.vocabulary import (
    END,
    NOTHING,
    SEGMENT_FIELDS,
    Element,
    Floats,
    Ints,
    Vocabulary,
    roles_of,
)

GRAPH_INPUTS = (
    "segments", "facts", "flags", "roles", "left", "values", "noise", "at", "new", "there",
)  # fmt: skip
GRAPH_OUTPUTS = ("values_drawn", "chances", "there_now")
STATES, NOW = ("keys", "values_of"), "_now"
"""Further inputs, STATES of each layer, as keys_0; outputs are named keys_0_now."""
REMEDY = ("<train=lists>", "<reinstall>")


class Heat(NamedTuple):
    """Temperatures: 1 draws what is as likely as the network says, less what is likelier."""

    categories: float = 0.9
    """As varied as homes are."""
    places: float = 0.3
    """Where a piece stands, which had better be where it fits."""


HEAT = Heat()
_BARRED = -1e4


@dataclass(frozen=True, eq=False)
class Subject:
    """What a list is to be drawn for."""

    segments: Ints
    """(S, SEGMENT_FIELDS)"""
    facts: Ints
    """(F,)"""
    flags: Floats
    """(K,)"""
    wanted: tuple[int, ...] = ()
    """Categories that it must hold, as often as they are named."""
    excluded: frozenset[int] = frozenset()
    kept: tuple[Element, ...] = ()
    """Elements that it holds already, besides what is wanted."""


@dataclass(frozen=True)
class Drawn:
    """One list."""

    elements: tuple[Element, ...]
    likelihood: float
    """Log chance of all that was drawn."""


class Drawer(Protocol):
    """Whatever tells which pieces rooms hold, and where."""

    content_hash: str
    """Of its weights."""

    def draw(
        self, subjects: Sequence[Subject], rng: np.random.Generator, heat: Heat = HEAT
    ) -> list[Drawn]:
        """One list for each subject, all drawn together."""
        raise NotImplementedError


class ListDrawer:
    """The trained network. Make one with load_lists."""

    def __init__(self, network: Network, vocabulary: Vocabulary, content_hash: str) -> None:
        """content_hash: of the weights."""
        self._network, self.vocabulary = network, vocabulary
        self.content_hash = content_hash

    def draw(
        self,
        subjects: Sequence[Subject],
        rng: np.random.Generator | Sequence[np.random.Generator],
        heat: Heat = HEAT,
    ) -> list[Drawn]:
        """One list for each subject, all drawn together.

        rng: one for all, or one for each, whose list then does not depend on the others.
        """
        if not subjects:
            return []
        lines = _Lines(self.vocabulary, subjects, self._network.shapes())
        while len(lines.open):
            self._tell(lines, rng, heat)
        return lines.drawn()

    def _tell(
        self, lines: _Lines, rng: np.random.Generator | Sequence[np.random.Generator], heat: Heat
    ) -> None:
        """One more position of every list that is not at its end."""
        inputs = lines.inputs()
        size = (len(self.vocabulary.slots), self.vocabulary.size)
        if isinstance(rng, np.random.Generator):
            gumbel = rng.gumbel(size=(len(lines.open), *size))
        else:
            gumbel = np.stack([rng[line].gumbel(size=size) for line in lines.open])
        closed = lines.is_closed[lines.open, None, None]
        gumbel *= np.where(closed, heat.places, heat.categories)
        inputs["noise"] = (gumbel + lines.barred()).astype(np.float32)
        values, chances, there, *states = self._network.run(inputs)
        lines.take(np.asarray(values, np.int64), chances, [there, *states])


class _Lines:
    """Lists while they are drawn."""

    def __init__(
        self,
        vocabulary: Vocabulary,
        subjects: Sequence[Subject],
        shapes: Mapping[str, Sequence[int]],
    ) -> None:
        """shapes: of the network's inputs, 0 for axes of any length."""
        self.vocabulary, self.subjects = vocabulary, subjects
        count, slots = len(subjects), len(vocabulary.slots)
        most = max(len(subject.segments) for subject in subjects)
        self.segments = np.zeros((count, most, SEGMENT_FIELDS), np.int64)
        for index, subject in enumerate(subjects):
            self.segments[index, : len(subject.segments)] = subject.segments
        self.facts = np.stack([subject.facts for subject in subjects])
        self.flags = np.stack([subject.flags for subject in subjects]).astype(np.float32)
        self.at = 0
        self.open = np.arange(count)
        self.values = np.zeros((count, 0, slots), np.int64)
        self.categories: list[list[int]] = [[] for _ in subjects]
        self.is_closed = np.zeros(count, np.bool_)
        self.likelihood = np.zeros(count)
        self.roles: list[Ints] = [np.zeros(0, np.int64)] * count
        self.left: list[Ints] = [np.zeros(0, np.int64)] * count
        states = [name for name in shapes if name.startswith(STATES)]
        self.known = {"there": np.zeros((count, 0), np.bool_)}
        self.known |= {name: np.zeros((count, *shapes[name][1:]), np.float32) for name in states}

    def inputs(self) -> dict[str, np.ndarray]:
        """For the network, the position to come of the open lists, and what is known of them; all
        that lies around them before the first."""
        rows = self.open
        roles = np.zeros((len(rows), 1), np.int64)
        left = np.zeros_like(roles)
        values = np.zeros((len(rows), 2, self.values.shape[2]), np.int64)
        if self.at:
            values[:, 0] = self.values[rows, -1]
        for row, line in enumerate(rows):
            if self.is_closed[line]:
                nth = self.at - len(self.categories[line]) - 1
                roles[row, 0], left[row, 0] = self.roles[line][nth], self.left[line][nth]
                values[row, -1] = self._given(line, nth)
        around = self.segments[rows] if not self.at else self.segments[rows, :0]
        new = np.arange(self.at > 0, around.shape[1] + 2)
        return {
            "segments": around, "facts": self.facts[rows], "flags": self.flags[rows],
            "roles": roles, "left": left, "values": values, "at": np.array([self.at]), "new": new,
            **self.known,
        }  # fmt: skip

    def _given(self, line: int, index: int) -> Ints:
        """(slots,) the values of an element that is kept; NOTHING of one to draw."""
        category = self.categories[line][index]
        nth = self.categories[line][:index].count(category)
        kept = [piece for piece in self.subjects[line].kept if piece.category == category]
        if nth >= len(kept):
            return np.full(len(self.vocabulary.slots), NOTHING, np.int64)
        starts = [self.vocabulary.first[name] for name in self.vocabulary.slots]
        return np.array(kept[nth].values, np.int64) + starts

    def barred(self) -> Floats:
        """(open lists, slots, size) _BARRED for categories that cannot come next."""
        vocabulary = self.vocabulary
        barred = np.zeros((len(self.open), len(vocabulary.slots), vocabulary.size), np.float32)
        for row, line in enumerate(self.open):
            if not self.is_closed[line]:
                barred[row, 0, ~self._possible(line)] = _BARRED
        return barred

    def _possible(self, line: int) -> np.ndarray:
        """(size,) which categories may come next: in order, and none that is wanted passed over."""
        subject, drawn = self.subjects[line], self.categories[line]
        possible = np.zeros(self.vocabulary.size, np.bool_)
        needed = [*subject.wanted, *(piece.category for piece in subject.kept)]
        waiting = [c for c in set(needed) if needed.count(c) > drawn.count(c)]
        ranks = self.vocabulary.ranks
        first = ranks[drawn[-1]] if drawn else 0
        last = min(ranks[waiting]) if waiting else len(ranks)
        room_left = self.vocabulary.most - len(drawn)
        if not waiting or room_left <= 0:
            possible[END] = True
        missing = sum(max(0, needed.count(c) - drawn.count(c)) for c in set(needed))
        for category in np.flatnonzero((ranks >= first) & (ranks <= last)):
            is_needed = category in waiting
            if room_left > 0 and (is_needed or (category not in subject.excluded
                                                and room_left > missing)):  # fmt: skip
                possible[END + 1 + category] = True
        if not possible.any():
            possible[END] = True
        return possible

    def take(self, values: Ints, chances: Floats, known: Sequence[np.ndarray]) -> None:
        """What the network drew for the open lists. known: what it knows of them now, in the order
        of self.known: it reads surroundings and positions once."""
        column = np.zeros((len(self.subjects), 1, self.values.shape[2]), np.int64)
        for row, line in enumerate(self.open):
            if self.is_closed[line]:
                column[line, 0] = values[row]
                self.likelihood[line] += float(chances[row].sum())
                continue
            count = int(values[row, 0])
            column[line, 0, 0] = count
            self.likelihood[line] += float(chances[row, 0])
            if count == END:
                self.is_closed[line] = True
                self.roles[line], self.left[line] = roles_of(self.categories[line])
            else:
                self.categories[line].append(count - END - 1)
        self.values = np.concatenate([self.values, column], axis=1)
        self.at += 1
        lengths = np.array([2 * len(listed) + 1 for listed in self.categories])
        rows, self.open = self.open, np.flatnonzero(~self.is_closed | (lengths > self.at))
        stay = np.isin(rows, self.open)
        left = known if stay.all() else [part[stay] for part in known]
        self.known = dict(zip(self.known, left, strict=True))

    def drawn(self) -> list[Drawn]:
        starts = np.array([self.vocabulary.first[name] for name in self.vocabulary.slots])
        lists = []
        for line, categories in enumerate(self.categories):
            first = len(categories) + 1
            values = self.values[line, first : first + len(categories)] - starts
            elements = tuple(
                Element(category, tuple(map(int, numbers)))
                for category, numbers in zip(categories, values, strict=True)
            )
            lists.append(Drawn(elements, float(self.likelihood[line])))
        return lists


def load_lists(folder: Path, vocabulary: Vocabulary) -> ListDrawer:
    """The network of a checkpoint folder. Raises CheckpointError for an unusable one."""
    return ListDrawer(load_network(folder, REMEDY), vocabulary, content_hash(folder))


def without(categories: Collection[str], vocabulary: Vocabulary) -> frozenset[int]:
    """Indices of categories, for Subject.excluded."""
    return frozenset(vocabulary.categories.index(name) for name in categories)
