"""Training of the list network."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from chord_usd.base.runtime.progress import Progress
from chord_usd.line.lists.list_sampler import GRAPH_INPUTS, GRAPH_OUTPUTS, NOW, STATES
from chord_usd.line.lists.vocabulary import NOTHING, SEGMENT_FIELDS, Vocabulary
from chord_usd.workshop.training.lists_data import Batch
from chord_usd.workshop.training.lists_network import Drawing, ListNetwork
from chord_usd.workshop.training.loader import Seeded, batches_ahead
from chord_usd.workshop.training.loop import Lesson, RunConfig, train, write_weights
from chord_usd.workshop.training.onnx_file import write_graph


@dataclass(frozen=True, eq=False)
class Task:
    """What lists a network learns to write."""

    vocabulary: Vocabulary
    batches: Callable[[int], Iterator[Batch]]
    """From a seed: endless."""
    held_out: Batch | None = None
    """That no training sees."""


@dataclass(frozen=True)
class ListTraining(RunConfig):
    """How to train."""

    minutes: float = 60.0
    batch: int = 64
    learning_rate: float = 1e-3
    warmup_steps: int = 200
    cooldown_share: float = 0.5
    weight_decay: float = 0.02
    ema_decay: float = 0.999
    workers: int = 0
    """Processes that furnish rooms; on a CPU the training process does, in a tenth of its time."""
    houses: int | None = None
    """How many different procedural ones there are; None for no two alike."""
    furnished: int = 0
    """How many foreign houses there are in place of procedural houses."""


def train_lists(
    config: ListTraining,
    folder: Path,
    task: Task,
    progress: Progress | None = None,
    start: Path | None = None,
) -> dict[str, Any]:
    """Train as loop.train does, and return what the card says of the run."""
    torch.manual_seed(config.seed)

    is_cuda = config.device.startswith("cuda")

    def losses(network: ListNetwork, batch: Batch) -> dict[str, Tensor]:
        return {"nats": batch_loss(network, moved(batch, config.device)).mean()}

    lesson = Lesson(
        lambda seed: batches_ahead(Seeded(task.batches, seed), config.workers, pinned=is_cuda),
        losses,
        score=lambda network: {"held_out_nats": _score(network, task.held_out, config.device)},
        write=lambda to, network, facts: write_checkpoint(to, network, task.vocabulary, facts),
        take_up=take_up,
    )
    return train(lesson, ListNetwork(task.vocabulary), config, folder, progress, start)


def take_up(network: ListNetwork, tensors: dict[str, Tensor]) -> None:
    """Give a network the weights of a checkpoint, which may know fewer kinds of segment.

    Raises RuntimeError where they do not fit.
    """
    weight = network.segment_kind.weight
    known = tensors["segment_kind.weight"]
    if known.shape[1:] == weight.shape[1:] and len(known) < len(weight):
        tensors = {**tensors, "segment_kind.weight": torch.cat([known, weight[len(known) :].data])}
    network.load_state_dict(tensors)


def moved(batch: Batch, device: str) -> Batch:
    """The batch, on a device."""
    segments, facts, flags, roles, left, values = (
        part.to(device, non_blocking=True) for part in batch
    )
    return segments, facts, flags, roles, left, values


def batch_loss(network: ListNetwork, batch: Batch) -> Tensor:
    """(B,) negative log likelihood of each list, in nats."""
    chances: Tensor = network(*batch)
    return -chances.sum(dim=1)


@torch.inference_mode()
def _score(network: ListNetwork, held_out: Batch | None, device: str) -> float | None:
    """Mean nats a held-out list takes."""
    if held_out is None:
        return None
    return round(float(batch_loss(network, moved(held_out, device)).mean()), 3)


def write_checkpoint(
    folder: Path, network: ListNetwork, vocabulary: Vocabulary, facts: dict[str, Any]
) -> None:
    """The weights in half precision, how to draw with them, and where they come from."""
    write_weights(folder, network, {"training": facts})
    write_drawing(folder, network, vocabulary)


def write_drawing(folder: Path, network: ListNetwork, vocabulary: Vocabulary) -> None:
    """How to draw with a checkpoint's weights."""
    slots = len(vocabulary.slots)
    states = [f"{part}_{layer}" for layer in range(network.layers) for part in STATES]
    state = torch.zeros(1, network.heads, 1, network.head_width)
    example = {
        "segments": torch.ones(1, 2, SEGMENT_FIELDS, dtype=torch.long),
        "facts": torch.zeros(1, len(vocabulary.facts), dtype=torch.long),
        "flags": torch.zeros(1, vocabulary.flags),
        "roles": torch.zeros(1, 2, dtype=torch.long),
        "left": torch.zeros(1, 2, dtype=torch.long),
        "values": torch.full((1, 3, slots), NOTHING, dtype=torch.long),
        "noise": torch.zeros(1, slots, vocabulary.size),
        "at": torch.arange(2),
        "new": torch.arange(5),
        "there": torch.ones(1, 1, dtype=torch.bool),
        **dict.fromkeys(states, state),
    }
    outputs = (*GRAPH_OUTPUTS, *(name + NOW for name in states))
    batch, positions = {0: "batch"}, {0: "batch", 1: "positions"}
    known, now = {0: "batch", 2: "known"}, {0: "batch", 2: "known now"}
    write_graph(
        folder,
        Drawing(network.cpu()),
        stored={f"network.{name}": name for name in network.state_dict()},
        inputs={name: example[name] for name in (*GRAPH_INPUTS, *states)},
        outputs=outputs,
        free_axes={
            "segments": {0: "batch", 1: "segments"},
            **dict.fromkeys(("roles", "left"), positions),
            "values": {0: "batch", 1: "positions and one"},
            **dict.fromkeys(("facts", "flags", "noise", *GRAPH_OUTPUTS[:2]), batch),
            "at": {0: "positions"},
            "new": {0: "new"},
            "there": {0: "batch", 1: "known"},
            "there_now": {0: "batch", 1: "known now"},
            **dict.fromkeys(states, known),
            **dict.fromkeys(outputs[3:], now),
        },
    )
