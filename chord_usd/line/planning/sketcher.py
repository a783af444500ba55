"""A wish, and outer walls where there are any -> bubble diagrams of houses.

Runs the sketching network (sketch_network.py) value by value. What a wish leaves open is
drawn from what houses are like that have what it asks for.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from chord_usd.base.raster.bubbles import LEAST_RADIUS_M, Bubble
from chord_usd.base.runtime.networks import Network, content_hash, load_network
from chord_usd.base.scene.types import BoolArray, RoomKind
from chord_usd.base.scene.wish import WISHED_KINDS, Wish
from chord_usd.line.planning import sketch_tokens as tokens

GRAPH_INPUTS = ("shell", "roles", "left", "values")
GRAPH_OUTPUTS = ("chances",)
REMEDY = ("<train=bubbles>", "<reinstall>")

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
    likelihood: float
    """Mean log chance of what its bubbles are: how much it is like a house."""


@dataclass(frozen=True, eq=False)
class Ground:
    """Where a house is to be sketched."""

    shell: tokens.Floats
    """sketch_tokens.shell_patches, or no_shell()."""
    places: BoolArray
    """(PLACES, PLACES) by x and y: where a room's middle can be."""


def open_ground() -> Ground:
    """A sheet with nothing on it."""
    return Ground(tokens.no_shell(), everywhere())


class Sketcher:
    """The trained network. Make one with load_sketcher."""

    def __init__(self, network: Network, content_hash: str) -> None:
        """content_hash: of the weights."""
        self._network, self.content_hash = network, content_hash

    def sketch(self, wish: Wish, ground: Ground, count: int, seed: int) -> list[Sketch]:
        """So many diagrams, each from a programme of its own; same seed, same diagrams."""
        rng = np.random.default_rng(seed)
        lines = _begun(self._headings(wish, ground.shell, count, rng))
        likelihood = self._sample_rooms(lines, ground, rng)
        return [
            _sketch(roles, values, float(total))
            for roles, values, total in zip(lines.roles, lines.values, likelihood, strict=True)
        ]

    def programme(self, wish: Wish, ground: Ground, seed: int) -> dict[RoomKind, int]:
        """How many rooms of every kind one such house has."""
        # With one seed for all, a thousand open plans would all come out with many rooms, or few.
        shell_seed = zlib.crc32(np.ascontiguousarray(ground.shell).tobytes())
        rng = np.random.default_rng([seed, shell_seed])
        heading = self._headings(wish, ground.shell, 1, rng)[0]
        return dict(tokens.counts_of(heading))

    def _sample_rooms(
        self, lines: tokens.Sequences, ground: Ground, rng: np.random.Generator
    ) -> npt.NDArray[np.float64]:
        """Fill in the bubbles of all lines; (B,) the log chance of each line's."""
        count, length = lines.roles.shape
        free = [FreePlaces(ground.places) for _ in range(count)]
        likelihood = np.zeros(count)
        for place in range(tokens.HEADING, length):
            rooms = np.flatnonzero(lines.roles[:, place] >= tokens.FIRST_ROOM_ROLE)
            for slot in range(tokens.SLOTS):
                chances = self._chances(ground.shell, lines, place, slot)[rooms]
                values = _drawn(_possible(chances, lines, free, rooms, place, slot), rng)
                lines.values[rooms, place, slot] = values
                likelihood[rooms] += chances[np.arange(len(rooms)), values]
            for line in rooms:
                free[line].take(lines.values[line, place])
        return likelihood

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
        known = slice(place + 1)
        shells = np.broadcast_to(shell, (len(lines.roles), *shell.shape))
        inputs = (shells, lines.roles[:, known], lines.left[:, known], lines.values[:, known])
        arrays = [np.ascontiguousarray(array) for array in inputs]
        (chances,) = self._network.run(dict(zip(GRAPH_INPUTS, arrays, strict=True)))
        return chances[:, place, slot].astype(np.float64)


def load_sketcher(folder: Path) -> Sketcher:
    """The network of a checkpoint folder. Raises CheckpointError for an unusable one."""
    network = load_network(folder, REMEDY)
    return Sketcher(network, content_hash(folder))


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


def _begun(headings: tokens.Ints) -> tokens.Sequences:
    """Lines with these headings (B, HEADING, SLOTS), and room for the rooms that they announce."""
    rooms = [tokens.rooms_of(tokens.counts_of(heading)) for heading in headings]
    lines = _blank(len(rooms), tokens.HEADING + max(len(roles) for roles, _ in rooms))
    lines.values[:, : tokens.HEADING] = headings
    for line, (roles, left) in enumerate(rooms):
        known = slice(tokens.HEADING, tokens.HEADING + len(roles))
        lines.roles[line, known], lines.left[line, known] = roles, left
    return lines


def _sketch(roles: tokens.Ints, values: tokens.Ints, likelihood: float) -> Sketch:
    """What one line (L,), (L, SLOTS) says."""
    rooms = roles >= tokens.FIRST_ROOM_ROLE
    bubbles = tokens.bubbles_from(roles[rooms], values[rooms])
    counts = tokens.counts_of(values[: tokens.HEADING])
    area_m2 = tokens.area_of(int(values[tokens.AREA_ROLE, 0]))
    return Sketch(bubbles, counts, area_m2, likelihood / max(len(bubbles) * tokens.SLOTS, 1))


def _possible(
    chances: npt.NDArray[np.float64],
    lines: tokens.Sequences,
    free: Sequence[FreePlaces],
    rooms: tokens.Ints,
    place: int,
    slot: int,
) -> npt.NDArray[np.float64]:
    """(len(rooms), VOCABULARY) log chances without what is not free any more, on these lines."""
    kept = chances.copy()
    for row, line in zip(kept, rooms, strict=True):
        possible = free[line].possible(lines.values[line, place], slot)
        first, last = tokens.value_range(int(lines.roles[line, place]), slot)
        row[first:last][~possible] = -np.inf
    return kept


def _drawn(chances: npt.NDArray[np.float64], rng: np.random.Generator) -> tokens.Ints:
    """(B,) values by chance (Gumbel's trick)."""
    return np.asarray((chances + rng.gumbel(size=chances.shape)).argmax(axis=1))


# Where bubbles of a diagram can still go, so that none touches another or lies outside -----------

# The sketching network has learned what is likely; this is what is possible. A value that is not is
# never drawn.

_PLACES_M = tokens.place_m(np.arange(tokens.PLACES))


def everywhere() -> BoolArray:
    """(PLACES, PLACES) by x and y: a sheet with nothing on it."""
    return np.ones((tokens.PLACES, tokens.PLACES), np.bool_)


class FreePlaces:
    """The ground of one diagram, while bubbles are put on it."""

    def __init__(self, ground: BoolArray) -> None:
        """ground: (PLACES, PLACES) by x and y, where a room's middle can be."""
        self._free = ground.copy()
        self._taken: list[tuple[float, float, float]] = []

    def possible(self, values: tokens.Ints, slot: int) -> BoolArray:
        """(places or radii,) what can stand in a slot, given those before it; all, where nothing
        can: a diagram that slips is better than none.

        values: (SLOTS,) of the bubble that is being sampled.
        """
        if slot == 0:
            is_free = self._free.any(axis=1)
        elif slot == 1:
            is_free = self._free[tokens.place_index(values)[0]]
        else:
            x_m, y_m = (_PLACES_M[index] for index in tokens.place_index(values))
            clear_m = min(
                (np.hypot(x_m - x, y_m - y) - radius for x, y, radius in self._taken),
                default=np.inf,
            )
            is_free = tokens.radius_m(np.arange(tokens.RADII)) < clear_m
        return is_free if is_free.any() else np.ones_like(is_free)

    def take(self, values: tokens.Ints) -> None:
        """Put a bubble down: (SLOTS,) values."""
        x_m, y_m = (_PLACES_M[index] for index in tokens.place_index(values))
        radius = float(tokens.radius_m(tokens.radius_index(values)))
        self._taken.append((x_m, y_m, radius))
        away_m = np.hypot(_PLACES_M[:, None] - x_m, _PLACES_M[None] - y_m)
        self._free &= away_m > radius + LEAST_RADIUS_M
