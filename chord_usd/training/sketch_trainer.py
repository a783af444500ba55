"""Training of the sketching network: resumable, on a time budget, on CPU or CUDA."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import save
from torch import Tensor

from chord_usd.layout.description import CONFIG_FILE, FORMAT
from chord_usd.planning import sketch_tokens as tokens
from chord_usd.planning.sketcher import GRAPH_INPUTS, GRAPH_OUTPUTS
from chord_usd.runtime.checksums import checkpoint_files
from chord_usd.runtime.files import begin_run, write_atomic
from chord_usd.runtime.networks import WEIGHTS_FILE
from chord_usd.runtime.progress import Progress
from chord_usd.training.budget import Budget
from chord_usd.training.onnx_file import write_graph
from chord_usd.training.sketch_data import Batch, Sketched, batch_of, endless_batches
from chord_usd.training.sketch_network import SketchNetwork
from chord_usd.training.weights import Weights, warm_and_cool

STATE_FOLDER = "state"
_SAVE_MINUTES = 2.0
_END_RATE = 0.02
"""Share of the learning rate at which a run ends."""


@dataclass(frozen=True)
class SketchTraining:
    """How to train."""

    minutes: float = 30.0
    batch: int = 64
    learning_rate: float = 1e-3
    warmup_steps: int = 100
    cooldown_share: float = 0.4
    """Last share of the budget in which the learning rate falls to a fiftieth."""
    weight_decay: float = 0.05
    ema_decay: float = 0.998
    gradient_clip: float = 1.0
    real_share: float = 0.3
    seed: int = 0
    device: str = "cpu"


def train_sketches(
    config: SketchTraining,
    folder: Path,
    houses: list[Sketched],
    real: list[Sketched],
    judges: list[Sketched],
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Run until the minutes are spent, going on where a run in the folder stopped.

    judges: held-out houses. Returns what the card says of the run; the checkpoint comes to lie in
    folder/checkpoint.
    """
    begin_run(folder)
    torch.manual_seed(config.seed)
    network = SketchNetwork().to(config.device)
    weights = Weights(network, config.learning_rate, config.weight_decay, config.ema_decay)
    before = weights.load(folder / STATE_FOLDER, config.device) or {"step": 0, "minutes": 0.0}
    step = first_step = int(before["step"])
    budget = Budget(config.minutes)
    for batch in endless_batches(houses, real, config.real_share, config.batch, config.seed + step):
        steps, cooldown = step - first_step, config.cooldown_share
        rate = warm_and_cool(steps, config.warmup_steps, budget.share, cooldown, _END_RATE)
        loss = batch_loss(network, tuple(part.to(config.device) for part in batch)).mean()
        weights.step(loss, config.learning_rate * rate, config.gradient_clip, step)
        step += 1
        if progress and step % 25 == 0:
            progress(round(budget.spent * 60), round(config.minutes * 60))
        ended = budget.is_over
        if ended or budget.is_due("save", _SAVE_MINUTES):
            counters = {"step": step, "minutes": before["minutes"] + budget.spent}
            weights.save(folder / STATE_FOLDER, counters)
        if ended:
            break
    facts = {
        "steps": step,
        "batch": config.batch,
        "minutes": round(before["minutes"] + budget.spent, 1),
        "houses": len(houses),
        "real_plans": len(real),
        "held_out_nats": round(_score(weights.average, judges), 3),
        "held_out": len(judges),
    }
    _write_checkpoint(folder / "checkpoint", weights.average, facts)
    return facts


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
    folder.mkdir(parents=True, exist_ok=True)
    with checkpoint_files(folder):
        halves = {name: t.cpu().to(torch.float16) for name, t in network.state_dict().items()}
        write_atomic(folder / WEIGHTS_FILE, save(halves))
        description = json.dumps({"format": FORMAT, "training": facts}, indent=2)
        write_atomic(folder / CONFIG_FILE, (description + "\n").encode())
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
