"""Bubble diagrams to learn from: of procedural and of real floor plans."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from chord_usd.base.raster import plan_labels
from chord_usd.base.raster.bubbles import Bubble, bubbles_of, jittered
from chord_usd.base.scene.types import Plan
from chord_usd.base.scene.wish import floor_area_m2
from chord_usd.line.planning import sketch_tokens as tokens
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED, is_test_seed

Batch = tuple[Tensor, Tensor, Tensor, Tensor]
"""Shell patches, roles, rooms left and values: what the network takes."""

SHELL_CHANCE = 0.5
"""Chance that the house's outline is seen."""
_HALF_TURNS = (1.0, -1.0)


@dataclass(frozen=True, eq=False)
class Sketched:
    """A house as far as sketches go; metres from the middle of its sheet."""

    bubbles: tuple[Bubble, ...]
    area_m2: float
    cells: tokens.Floats
    """sketch_tokens.shell_cells."""


def sketched(plan: Plan) -> Sketched | None:
    """What a plan teaches; None where it does not fit on a sheet, or a room's kind is unknown."""
    scale = plan_labels.fitting_scale(plan)
    if scale is None or any(room.kind == "unknown" for room in plan.rooms):
        return None
    frame = plan_labels.label_frame(plan, scale)
    shell = plan_labels.open_plan(plan_labels.label_plan(plan, frame), scale)
    half_m = plan_labels.CANVAS_PX * scale / 2
    x_m, y_m = frame.origin_m[0] + half_m, frame.origin_m[1] + half_m
    bubbles = tuple(
        Bubble(bubble.kind, bubble.x_m - x_m, bubble.y_m - y_m, bubble.radius_m)
        for bubble in bubbles_of(plan)
    )
    return Sketched(bubbles, floor_area_m2(plan), tokens.shell_cells(shell, scale))


class Procedural(Sequence[Sketched]):
    """So many houses that may be trained on; each is drawn when it is first needed, so that a run
    pays only for those that it learns from."""

    def __init__(self, count: int, seed: int) -> None:
        """count: at least 1."""
        self._count, self._seed = count, seed
        self._drawn: dict[int, Sketched] = {}

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, index: int) -> Sketched:  # type: ignore[override]  # no slices
        if not 0 <= index < self._count:
            raise IndexError(index)
        if index not in self._drawn:
            self._drawn[index] = _procedural(np.random.default_rng((self._seed, index)))
        return self._drawn[index]


def _procedural(rng: np.random.Generator) -> Sketched:
    while True:
        plan_seed = int(rng.integers(2**40))
        if not is_test_seed(plan_seed):
            house = sketched(random_plan(np.random.default_rng(plan_seed)))
            if house:
                return house


def held_out(count: int) -> list[Sketched]:
    """The first test houses."""
    plans = (random_plan(np.random.default_rng(TEST_SEED + index)) for index in range(2 * count))
    return [house for plan in plans if (house := sketched(plan))][:count]


def endless_batches(
    houses: Sequence[Sketched], real: Sequence[Sketched], share: float, batch: int, seed: int
) -> Iterator[Batch]:
    """Batches of houses in all eight poses, in a new random pose each time.

    share: of real ones, in [0, 1], where there are any.
    """
    rng = np.random.default_rng(seed)
    while True:
        chosen = [
            real[int(rng.integers(len(real)))]
            if real and rng.random() < share
            else houses[int(rng.integers(len(houses)))]
            for _ in range(batch)
        ]
        yield batch_of([_posed_at_random(house, rng) for house in chosen])


def batch_of(houses: Sequence[Sketched]) -> Batch:
    """Houses side by side; shorter ones end in empty slots."""
    sequences = [tokens.sequence_of(house.bubbles, house.area_m2) for house in houses]
    longest = max(len(sequence.roles) for sequence in sequences)
    roles = np.zeros((len(sequences), longest), np.int64)
    left = np.zeros_like(roles)
    values = np.full((*roles.shape, tokens.SLOTS), tokens.NOTHING, np.int64)
    for index, sequence in enumerate(sequences):
        length = len(sequence.roles)
        roles[index, :length], left[index, :length] = sequence.roles, sequence.left
        values[index, :length] = sequence.values
    shells = np.stack([tokens.shell_patches(house.cells) for house in houses])
    return (
        torch.from_numpy(shells),
        torch.from_numpy(roles),
        torch.from_numpy(left),
        torch.from_numpy(values),
    )


def _posed_at_random(house: Sketched, rng: np.random.Generator) -> Sketched:
    """The house turned, mirrored, sketched by another hand, and its shape left open by chance."""
    bubbles, cells = jittered(house.bubbles, rng), house.cells
    across, along = (float(rng.choice(_HALF_TURNS)) for _ in range(2))
    if across < 0:
        cells = cells[:, :, ::-1]
    if along < 0:
        cells = cells[:, ::-1]
    moved = [(bubble, across * bubble.x_m, along * bubble.y_m) for bubble in bubbles]
    if rng.random() < 0.5:
        # Rows become columns; rows run against y.
        cells = cells.transpose(0, 2, 1)
        moved = [(bubble, -y_m, -x_m) for bubble, x_m, y_m in moved]
    turned = tuple(Bubble(bubble.kind, x_m, y_m, bubble.radius_m) for bubble, x_m, y_m in moved)
    seen = rng.random() < SHELL_CHANCE
    return Sketched(turned, house.area_m2, cells if seen else np.zeros_like(cells))
