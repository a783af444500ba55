"""Draws the pieces of rooms with a trained box diffusion, in the place of lists."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.networks import WEIGHTS_FILE, content_hash, read_weights
from chord_usd.line.lists.list_sampler import HEAT, Drawn, Heat, Subject
from chord_usd.line.lists.vocabulary import NO_SEGMENT
from chord_usd.workshop.training.boxes_data import (
    CATEGORIES,
    SLOTS,
    WIDTH,
    codes_of,
    elements_of,
)
from chord_usd.workshop.training.boxes_network import BoxNetwork, Surroundings, noise_scheduler

STEPS = 50
"""Of DDPM's 1000."""
BATCH = 128
"""Rooms at once."""
_BARRED = -1e4


class BoxDrawer:
    """The trained network, drawing as list_sampler.ListDrawer does. Make one with load_boxes."""

    def __init__(self, network: BoxNetwork, content_hash: str, steps: int = STEPS) -> None:
        """content_hash: of the weights."""
        self._network, self._steps = network.eval(), steps
        self.content_hash = content_hash

    def draw(
        self, subjects: Sequence[Subject], rng: np.random.Generator, heat: Heat = HEAT
    ) -> list[Drawn]:
        """The pieces of each room, at least what is wanted, nothing that is excluded.

        What is kept is not known, and heat changes nothing: noise is as strong as it was learned.
        """
        del heat
        generator = torch.Generator().manual_seed(int(rng.integers(2**62)))
        drawn: list[Drawn] = []
        for first in range(0, len(subjects), BATCH):
            slots = self._denoised(subjects[first : first + BATCH], generator)
            drawn += [Drawn(elements_of(rows), 0.0) for rows in slots.numpy()]
        return drawn

    @torch.inference_mode()
    def _denoised(self, subjects: Sequence[Subject], generator: torch.Generator) -> Tensor:
        around, barred = _around(subjects), _barred(subjects)
        scheduler = noise_scheduler()
        scheduler.set_timesteps(self._steps)
        state = torch.randn(len(subjects), SLOTS, WIDTH, generator=generator)
        for time in scheduler.timesteps:
            logits, boxes = self._network(state, time.expand(len(subjects)), around)
            codes = (logits + barred).softmax(dim=-1) * 2.0 - 1.0
            clean = torch.cat([codes, boxes], dim=-1)
            state = scheduler.step(clean, time, state, generator=generator).prev_sample
        likeliest = codes_of((logits + barred).argmax(dim=-1))
        return torch.cat([likeliest, boxes], dim=-1)


def _around(subjects: Sequence[Subject]) -> Surroundings:
    most = max(len(subject.segments) for subject in subjects)
    segments = np.stack(
        [
            np.pad(
                subject.segments,
                ((0, most - len(subject.segments)), (0, 0)),
                constant_values=NO_SEGMENT,
            )
            for subject in subjects
        ]
    )
    facts = np.stack([subject.facts for subject in subjects])
    flags = np.stack([subject.flags for subject in subjects]).astype(np.float32)
    return Surroundings(*map(torch.from_numpy, (segments, facts, flags)))


def _barred(subjects: Sequence[Subject]) -> Tensor:
    """(B, SLOTS, CATEGORIES + 1) what is added to logits: the first slots hold what is wanted."""
    barred = torch.zeros(len(subjects), SLOTS, CATEGORIES + 1)
    for row, subject in enumerate(subjects):
        wanted = torch.tensor(subject.wanted[:SLOTS], dtype=torch.long)
        barred[row, :, list(subject.excluded)] = _BARRED
        barred[row, : len(wanted)] = _BARRED
        barred[row, torch.arange(len(wanted)), wanted] = 0.0
    return barred


def load_boxes(folder: Path) -> BoxDrawer:
    """The network of a checkpoint of train boxes. Raises CheckpointError for an unusable one."""
    stored = read_weights(folder / WEIGHTS_FILE, "chord-usd train boxes")
    network = BoxNetwork()
    try:
        network.load_state_dict({n: torch.from_numpy(t).float() for n, t in stored.items()})
    except RuntimeError as error:
        raise CheckpointError(
            f"weights of another network ({str(error).splitlines()[0]})",
            where=str(folder / WEIGHTS_FILE),
            expected="a checkpoint of train boxes",
        ) from error
    return BoxDrawer(network, content_hash(folder))
