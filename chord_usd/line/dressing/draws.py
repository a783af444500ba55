"""Random numbers by what they are for, so that one choice does not change the next."""

from __future__ import annotations

import hashlib

import numpy as np


class Draws:
    """Generators of one room, or of what agrees through a house."""

    def __init__(self, seed: int, place: str = "") -> None:
        """place: id of the room; empty for the house."""
        self._key = f"{seed}/{place}"

    def rng(self, topic: str) -> np.random.Generator:
        """A generator that starts at the same place each time it is asked for."""
        return np.random.default_rng(_number(f"{self._key}/{topic}"))

    def chance(self, topic: str, share: float) -> bool:
        """True for about this share of topics."""
        return self.share(topic) < share

    def share(self, topic: str) -> float:
        """A number in [0, 1)."""
        return _number(f"{self._key}/{topic}") / 2.0**64


def _number(text: str) -> int:
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "little")
