"""Training of the box diffusion, on the rooms that lists learn from."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import torch
from torch import Tensor
from torch.nn import functional

from chord_usd.base.runtime.progress import Progress
from chord_usd.workshop.training.boxes_data import BOX, CATEGORIES, EMPTY, slots_of
from chord_usd.workshop.training.boxes_network import NOISE_STEPS, BoxNetwork, Surroundings
from chord_usd.workshop.training.lists_data import Batch
from chord_usd.workshop.training.lists_trainer import ListTraining, moved
from chord_usd.workshop.training.loader import Seeded, batches_ahead
from chord_usd.workshop.training.loop import Lesson, train, write_weights

_EMPTY_WEIGHT = 0.1
"""Of the box of a slot that holds nothing, which is only to go to zero."""


def train_boxes(
    config: ListTraining,
    folder: Path,
    batches: Callable[[int], Iterator[Batch]],
    held_out: Batch | None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Train as loop.train does, and return what the card says of the run.

    batches: from a seed, endless; held_out: that no training sees.
    """
    torch.manual_seed(config.seed)

    def losses(network: BoxNetwork, batch: Batch) -> dict[str, Tensor]:
        return denoising_losses(network, moved(batch, config.device))

    def score(network: BoxNetwork) -> dict[str, Any]:
        if held_out is None:
            return {}
        generator = torch.Generator(config.device).manual_seed(0)
        with torch.inference_mode():
            losses = denoising_losses(network, moved(held_out, config.device), generator)
        return {f"held_out_{name}": round(float(loss), 4) for name, loss in losses.items()}

    def write(to: Path, network: BoxNetwork, facts: dict[str, Any]) -> None:
        write_weights(to, network, {"training": facts})

    lesson = Lesson(
        lambda seed: batches_ahead(Seeded(batches, seed), config.workers), losses, score, write
    )
    return train(lesson, BoxNetwork(), config, folder, progress)


def denoising_losses(
    network: BoxNetwork, batch: Batch, generator: torch.Generator | None = None
) -> dict[str, Tensor]:
    """Cross-entropy of categories and squared error of boxes, at a random noise of each room."""
    device = batch[0].device
    clean = slots_of(batch).to(device)
    times = torch.randint(NOISE_STEPS, (len(clean),), generator=generator, device=device)
    noise = torch.randn(clean.shape, generator=generator, device=device)
    noisy = network.scheduler.add_noise(clean, noise, times)
    logits, boxes = network(noisy, times, Surroundings(*batch[:3]))
    wanted = clean[..., : CATEGORIES + 1].argmax(dim=-1)
    category = functional.cross_entropy(logits.flatten(0, 1), wanted.flatten())
    # Squared error of the velocity that the network predicts.
    noise_share = 1.0 - network.kept[times][:, None]
    error = ((boxes - clean[..., -BOX:]) ** 2).mean(dim=-1) / noise_share
    weight = torch.where(wanted == EMPTY, _EMPTY_WEIGHT, 1.0)
    return {"category": category, "box": (error * weight).sum() / weight.sum()}
