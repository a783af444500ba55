"""Training of the sketching network."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn import functional

from chord_usd.base.runtime.progress import Progress
from chord_usd.line.planning import sketch_tokens as tokens
from chord_usd.line.planning.sketcher import GRAPH_INPUTS, GRAPH_OUTPUTS
from chord_usd.line.planning.words import MOST_COUNTED
from chord_usd.workshop.training.loop import Lesson, RunConfig, train, write_weights
from chord_usd.workshop.training.onnx_file import write_graph
from chord_usd.workshop.training.sketch_data import Batch, Sketched, batch_of, endless_batches
from chord_usd.workshop.training.transformer import Block


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
    likely = chances.gather(-1, values[..., None])[..., 0]
    return -(likely * (values != tokens.NOTHING)).sum(dim=(1, 2))


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


# The sketching network: a small transformer that writes a house room by room ---------------------

# Bubbles (bubbles.py) decide the rooms of a house before it is drawn: a network that draws pixels
# cannot count, but a network that writes a list can.

CHANNELS = 160
LAYERS = 4
HEADS = 5
MOST_POSITIONS = 64


class SketchNetwork(nn.Module):
    """Autoregressive over the positions of a sequence, and over the slots of each position."""

    allowed: Tensor

    def __init__(self, channels: int = CHANNELS, layers: int = LAYERS, heads: int = HEADS) -> None:
        super().__init__()
        self.heads = heads
        self.embed_shell = nn.Linear(tokens.SHELL_CHANNELS, channels)
        self.shell_place = nn.Parameter(torch.randn(tokens.SHELL_PATCHES, channels) * 0.02)
        self.embed_before = nn.ModuleList(
            nn.Embedding(tokens.VOCABULARY, channels) for _ in range(tokens.SLOTS)
        )
        self.embed_own = nn.ModuleList(
            nn.Embedding(tokens.VOCABULARY, channels) for _ in range(tokens.SLOTS - 1)
        )
        self.embed_role = nn.Embedding(tokens.ROLES, channels)
        self.embed_left = nn.Embedding(MOST_COUNTED + 1, channels)
        self.blocks = nn.ModuleList(Block(channels, heads) for _ in range(layers))
        self.hidden = nn.ModuleList(nn.Linear(channels, channels) for _ in range(tokens.SLOTS))
        self.norm = nn.LayerNorm(channels)
        self.head = nn.Linear(channels, tokens.VOCABULARY)
        self.register_buffer("allowed", torch.from_numpy(tokens.allowed_values()), persistent=False)
        for module in self.modules():
            if isinstance(module, nn.Embedding):
                nn.init.normal_(module.weight, std=0.1)

    def forward(self, shell: Tensor, roles: Tensor, left: Tensor, values: Tensor) -> Tensor:
        """What may stand in each slot, given all before it.

        shell: (B, SHELL_PATCHES, SHELL_CHANNELS); roles, left: (B, L); values: (B, L, SLOTS), of
        which a slot's logits see those before it only. Returns (B, L, SLOTS, VOCABULARY) log
        probabilities; what cannot stand in a slot has about -1e4.
        """
        before = functional.pad(values[:, :-1], (0, 0, 1, 0))
        inputs = self.embed_role(roles) + self.embed_left(left)
        for slot, table in enumerate(self.embed_before):
            inputs = inputs + table(before[..., slot])
        around = self.embed_shell(shell) + self.shell_place
        state = torch.cat([around, inputs], dim=1)
        mask = _seen(state, around.shape[1])
        for block in self.blocks:
            state = block(state, mask)
        state = self.norm(state[:, around.shape[1] :])
        logits = []
        for slot in range(tokens.SLOTS):
            if slot:
                state = state + self.embed_own[slot - 1](values[..., slot - 1])
            logits.append(self.head(functional.silu(self.hidden[slot](state))))
        stacked = torch.stack(logits, dim=2)
        return torch.where(self.allowed[roles], stacked, -1e4).log_softmax(dim=-1)


def _seen(state: Tensor, around: int) -> Tensor:
    """(L, L) what is added to attention: positions see the shell and earlier positions."""
    place = torch.arange(state.shape[1])
    seen = (place[None] <= place[:, None]) | (place[None] < around)
    return torch.where(seen, 0.0, -1e4).to(state.dtype)
