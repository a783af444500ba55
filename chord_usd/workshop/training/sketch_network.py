"""The sketching network: a small transformer that tells a house room by room.

What shall be in a house is decided before it is drawn, by bubbles (bubbles.py): a network that
draws pixels cannot count, one that writes a list can.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional

from chord_usd.line.planning import sketch_tokens as tokens
from chord_usd.line.planning.words import MOST_COUNTED
from chord_usd.workshop.training.transformer import Block

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
        told = self.embed_role(roles) + self.embed_left(left)
        for slot, table in enumerate(self.embed_before):
            told = told + table(before[..., slot])
        around = self.embed_shell(shell) + self.shell_place
        state = torch.cat([around, told], dim=1)
        mask = _seen(state, around.shape[1])
        for block in self.blocks:
            state = block(state, mask)
        state = self.norm(state[:, around.shape[1] :])
        logits = []
        for slot in range(tokens.SLOTS):
            if slot:
                state = state + self.embed_own[slot - 1](values[..., slot - 1])
            logits.append(self.head(functional.silu(self.hidden[slot](state))))
        found = torch.stack(logits, dim=2)
        return torch.where(self.allowed[roles], found, -1e4).log_softmax(dim=-1)


def _seen(state: Tensor, around: int) -> Tensor:
    """(L, L) what is added to attention: positions see the shell and what was told before."""
    place = torch.arange(state.shape[1])
    seen = (place[None] <= place[:, None]) | (place[None] < around)
    return torch.where(seen, 0.0, -1e4).to(state.dtype)
