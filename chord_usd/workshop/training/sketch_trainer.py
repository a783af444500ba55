"""Training of the sketching network."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from chord_usd.base.runtime.progress import Progress
from chord_usd.line.planning import sketch_tokens as tokens
from chord_usd.line.planning.sketcher import GRAPH_INPUTS, GRAPH_OUTPUTS
from chord_usd.workshop.training.loop import Lesson, RunConfig, train, write_weights
from chord_usd.workshop.training.onnx_file import write_graph
from chord_usd.workshop.training.sketch_data import Batch, Sketched, batch_of, endless_batches
from chord_usd.workshop.training.sketch_network import SketchNetwork


@dataclass(frozen=True)
class SketchTraining(RunConfig):
    """How to train."""

    minutes: float = 30.0
    batch: int = 64
    learning_rate: float = 1e-3
    warmup_steps: int = 100
    cooldown_share: float = 0.4
    weight_decay: float = 0.05
    ema_decay: float = 0.998
    real_share: float = 0.3


def train_sketches(
    config: SketchTraining,
    folder: Path,
    houses: Sequence[Sketched],
    real: list[Sketched],
    judges: list[Sketched],
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Train as loop.train does. judges: held-out houses. Returns what the card says of the run."""
    torch.manual_seed(config.seed)

    def batches(seed: int) -> Iterator[Batch]:
        return endless_batches(houses, real, config.real_share, config.batch, seed)

    def losses(network: SketchNetwork, batch: Batch) -> dict[str, Tensor]:
        moved = tuple(part.to(config.device) for part in batch)
        return {"nats": batch_loss(network, moved).mean()}

    def score(network: SketchNetwork) -> dict[str, Any]:
        return {
            "houses": len(houses), "real_plans": len(real),
            "held_out_nats": round(_score(network, judges), 3), "held_out": len(judges),
        }  # fmt: skip

    lesson = Lesson(batches, losses, score, _write_checkpoint)
    return train(lesson, SketchNetwork(), config, folder, progress)


def batch_loss(network: SketchNetwork, batch: Batch | tuple[Tensor, ...]) -> Tensor:
    """(B,) negative log likelihood of each house, in nats."""
    shell, roles, left, values = batch
    chances = network(shell, roles, left, values)
    found = chances.gather(-1, values[..., None])[..., 0]
    return -(found * (values != tokens.NOTHING)).sum(dim=(1, 2))


@torch.inference_mode()
def _score(network: SketchNetwork, houses: list[Sketched]) -> float:
    """Mean nats a held-out house takes, its shell seen."""
    if not houses:
        return float("nan")
    device = next(network.parameters()).device
    losses = batch_loss(network, tuple(part.to(device) for part in batch_of(houses)))
    return float(losses.mean())


def _write_checkpoint(folder: Path, network: SketchNetwork, facts: dict[str, Any]) -> None:
    """The weights in half precision, how to compute with them, and where they come from."""
    write_weights(folder, network, {"training": facts})
    example = {
        "shell": torch.from_numpy(tokens.no_shell())[None],
        "roles": torch.zeros(1, tokens.HEADING, dtype=torch.long),
        "left": torch.zeros(1, tokens.HEADING, dtype=torch.long),
        "values": torch.zeros(1, tokens.HEADING, tokens.SLOTS, dtype=torch.long),
    }
    axes = {0: "batch", 1: "positions"}
    write_graph(
        folder,
        network.cpu(),
        stored={name: name for name in network.state_dict()},
        inputs={name: example[name] for name in GRAPH_INPUTS},
        outputs=GRAPH_OUTPUTS,
        free_axes={
            "shell": {0: "batch"},
            **dict.fromkeys((*GRAPH_INPUTS[1:], *GRAPH_OUTPUTS), axes),
        },
    )
