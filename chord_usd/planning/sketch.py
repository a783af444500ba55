"""A wish, and outer walls where there are any -> bubble diagrams of houses.

Runs the sketching network (training/sketch_network.py) value by value. What a wish leaves open is
drawn from what houses are like that have what it asks for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from chord_usd.bubbles import Bubble
from chord_usd.networks import Network, load_network
from chord_usd.planning import sketch_tokens as tokens
from chord_usd.types import RoomKind
from chord_usd.wish import WISHED_KINDS, Wish

GRAPH_INPUTS = ("shell", "roles", "left", "values")
GRAPH_OUTPUTS = ("chances",)
REMEDY = "chord-usd train bubbles, or reinstall chord-usd"

_PROGRAMMES = 32
"""So many are drawn, and weighed by how well they go with what is asked for."""


@dataclass(frozen=True)
class Sketch:
    """A house before it is drawn."""

    bubbles: tuple[Bubble, ...]
    """Metres from the middle of the sheet."""
    counts: Mapping[RoomKind, int]
    """Rooms of every kind."""
    area_m2: float
    """Sum of the rooms' floors."""


class Sketcher:
    """The trained network. Make one with load_sketcher."""

    def __init__(self, network: Network) -> None:
        self._network = network

    def sketch(self, wish: Wish, shell: tokens.Floats, count: int, seed: int) -> list[Sketch]:
        """So many diagrams, each from a programme of its own; same seed, same diagrams.

        shell: sketch_tokens.shell_patches, or no_shell().
        """
        rng = np.random.default_rng(seed)
        headings = self._headings(wish, shell, count, rng)
        counts = [tokens.counts_of(heading) for heading in headings]
        rooms = [tokens.rooms_of(one) for one in counts]
        length = tokens.HEADING + max(len(roles) for roles, _ in rooms)
        lines = _blank(count, length)
        lines.values[:, : tokens.HEADING] = headings
        for line, (roles, left) in enumerate(rooms):
            told = slice(tokens.HEADING, tokens.HEADING + len(roles))
            lines.roles[line, told], lines.left[line, told] = roles, left
        for place in range(tokens.HEADING, length):
            for slot in range(tokens.SLOTS):
                chances = self._chances(shell, lines, place, slot)
                lines.values[:, place, slot] = _drawn(chances, rng)
        return [
            Sketch(
                tokens.bubbles_from(roles, values[tokens.HEADING :][: len(roles)]),
                found,
                tokens.area_of(values[tokens.AREA_ROLE, 0]),
            )
            for (roles, _), values, found in zip(rooms, lines.values, counts, strict=True)
        ]

    def _headings(
        self, wish: Wish, shell: tokens.Floats, count: int, rng: np.random.Generator
    ) -> tokens.Ints:
        """(count, HEADING, SLOTS) areas and numbers of rooms, those asked for among them.

        What is drawn before knows nothing of what is asked for after it: programmes are weighed by
        the chance of that (likelihood weighting), and drawn again by weight.
        """
        lines = _blank(_PROGRAMMES, tokens.HEADING)
        weights = np.zeros(_PROGRAMMES)
        asked = _asked(wish)
        for place in range(tokens.HEADING):
            chances = self._chances(shell, lines, place, 0)
            value = asked[place]
            if value is None:
                lines.values[:, place, 0] = _drawn(chances, rng)
            else:
                lines.values[:, place, 0] = value
                weights += chances[:, value]
        share = np.exp(weights - weights.max())
        chosen = rng.choice(_PROGRAMMES, count, p=share / share.sum())
        return np.asarray(lines.values[chosen])

    def _chances(
        self, shell: tokens.Floats, lines: tokens.Sequences, place: int, slot: int
    ) -> npt.NDArray[np.float64]:
        """(B, VOCABULARY) log chances of what stands next."""
        told = slice(place + 1)
        shells = np.broadcast_to(shell, (len(lines.roles), *shell.shape))
        inputs = (shells, lines.roles[:, told], lines.left[:, told], lines.values[:, told])
        arrays = [np.ascontiguousarray(array) for array in inputs]
        (found,) = self._network.run(dict(zip(GRAPH_INPUTS, arrays, strict=True)))
        return found[:, place, slot].astype(np.float64)


def load_sketcher(folder: Path) -> Sketcher:
    """The network of a checkpoint folder. Raises CheckpointError for an unusable one."""
    return Sketcher(load_network(folder, REMEDY))


def _asked(wish: Wish) -> list[int | None]:
    """The value of each position of a heading; None where it is left open."""
    area = None if wish.area_m2 is None else tokens.area_value(wish.area_m2)
    counts = [
        tokens.count_value(wish.counts[kind]) if kind in wish.counts else None
        for kind in WISHED_KINDS
    ]
    return [area, *counts]


def _blank(count: int, length: int) -> tokens.Sequences:
    roles = np.zeros((count, length), np.int64)
    roles[:, : tokens.HEADING] = np.arange(tokens.HEADING)
    values = np.full((count, length, tokens.SLOTS), tokens.NOTHING, np.int64)
    return tokens.Sequences(roles, np.zeros_like(roles), values)


def _drawn(chances: npt.NDArray[np.float64], rng: np.random.Generator) -> tokens.Ints:
    """(B,) values by chance (Gumbel's trick)."""
    return np.asarray((chances + rng.gumbel(size=chances.shape)).argmax(axis=1))
