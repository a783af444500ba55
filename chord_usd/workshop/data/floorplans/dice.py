"""Fast scalar draws from a numpy generator."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

T = TypeVar("T")

_BLOCK = 128
"""Values drawn at once; one call of the generator costs as much as a hundred values."""


class Dice:
    """Draws scalars in blocks; what it yields depends on the state of rng alone."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._values: list[float] = []

    def unit(self) -> float:
        """A value in [0, 1)."""
        if not self._values:
            self._values = self._rng.random(_BLOCK).tolist()
        return self._values.pop()

    def chance(self, probability: float) -> bool:
        """True with this probability."""
        return self.unit() < probability

    def steps(self, low: float, high: float) -> int:
        """A whole number, even over [low, high]; low where the span is empty."""
        return int(low + self.unit() * max(high - low + 1, 1))

    def about(self, low: float, high: float) -> float:
        """A value in [low, high], the middle twice as likely as the average (triangular)."""
        return low + (high - low) * (self.unit() + self.unit()) / 2

    def pick(self, choices: Sequence[T]) -> T:
        """One of the choices, all equally likely."""
        return choices[int(self.unit() * len(choices))]

    def weighted(self, choices: Sequence[tuple[T, float]]) -> T:
        """One of (choice, weight); weights need not add up to one."""
        left = self.unit() * sum(weight for _, weight in choices)
        for choice, weight in choices:
            left -= weight
            if left < 0.0:
                return choice
        return choices[-1][0]

    def shuffled(self, items: Sequence[T]) -> list[T]:
        """The items in random order."""
        keyed = sorted((self.unit(), index) for index in range(len(items)))
        return [items[index] for _, index in keyed]
