"""A denoiser of the boxes of a room, unordered, as DiffuScene's: a baseline, never shipped.

A small transformer sees the noisy slots of a room (boxes_data.py) beside the surroundings, coded as
for lists (vocabulary.py), and predicts the content of each slot. Slots have no order: noise
alone distinguishes them.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional

from chord_usd.line.lists.pieces import PIECES, PLACES, STEP_M
from chord_usd.line.lists.vocabulary import NO_SEGMENT
from chord_usd.workshop.training.boxes_data import BOX, CATEGORIES, EXTENT_M, MIDDLE_M, WIDTH
from chord_usd.workshop.training.transformer import Block

CHANNELS = 128
LAYERS = 4
HEADS = 4
NOISE_STEPS = 1000

_WAVES = 12
_LONGEST_M, _SHORTEST_M = 17.0, 0.2
_HIDDEN = -1e4


class Surroundings(NamedTuple):
    """What lies around rooms, as batches of lists have it."""

    segments: Tensor
    """(B, S, SEGMENT_FIELDS)"""
    facts: Tensor
    """(B, F)"""
    flags: Tensor
    """(B, K)"""


def noise_scheduler() -> Any:
    """How noise is added and taken away: diffusers' DDPM on a cosine schedule."""
    from diffusers import DDPMScheduler

    return DDPMScheduler(
        num_train_timesteps=NOISE_STEPS,
        beta_schedule="squaredcos_cap_v2",
        prediction_type="sample",
        clip_sample=False,
        timestep_spacing="trailing",
    )


class BoxNetwork(nn.Module):
    """Says what noisy slots hold."""

    kept: Tensor

    def __init__(self, channels: int = CHANNELS, layers: int = LAYERS, heads: int = HEADS) -> None:
        super().__init__()
        self.segment_kind = nn.Embedding(PIECES.segments, channels)
        self.segment_place = nn.Linear(4 * 2 * _WAVES, channels)
        self.facts = nn.ModuleList(nn.Embedding(count, channels) for count in PIECES.facts)
        self.flags = nn.Linear(PIECES.flags, channels)
        self.slot = nn.Linear(WIDTH, channels)
        self.slot_place = nn.Linear(4 * 2 * _WAVES, channels)
        self.time = nn.Sequential(
            nn.Linear(2 * _WAVES, channels), nn.SiLU(), nn.Linear(channels, channels)
        )
        self.blocks = nn.ModuleList(Block(channels, heads) for _ in range(layers))
        self.norm = nn.LayerNorm(channels)
        self.head = nn.Linear(channels, WIDTH)
        self.scheduler = noise_scheduler()
        self.register_buffer("kept", self.scheduler.alphas_cumprod, persistent=False)

    def forward(self, noisy: Tensor, times: Tensor, around: Surroundings) -> tuple[Tensor, Tensor]:
        """(B, N, CATEGORIES + 1) logits, and (B, N, BOX) clean boxes.

        noisy: (B, N, WIDTH); times: (B,) in [0, NOISE_STEPS).
        """
        now = self.time(_waves(times / NOISE_STEPS, 2.0, 0.01))[:, None]
        middle, extent = noisy[..., -BOX : 2 - BOX], noisy[..., 2 - BOX : 4 - BOX]
        half = (extent + EXTENT_M) / 2 / MIDDLE_M
        place = torch.cat([middle - half, middle + half], dim=-1) * MIDDLE_M
        slots = self.slot(noisy) + self.slot_place(_places(place)) + now
        lies, there = self._around(around)
        state = torch.cat([lies + now, slots], dim=1)
        there = functional.pad(there, (0, slots.shape[1]), value=True)
        mask = torch.where(there, 0.0, _HIDDEN).to(state.dtype)[:, None, None]
        for block in self.blocks:
            state = block(state, mask)
        out = self.head(self.norm(state[:, lies.shape[1] :]))
        # As velocity, a box is kept where there is little noise and predicted where there is much.
        kept = self.kept[times][:, None, None]
        box = kept.sqrt() * noisy[..., -BOX:] - (1.0 - kept).sqrt() * out[..., -BOX:]
        return out[..., : CATEGORIES + 1], box

    def _around(self, around: Surroundings) -> tuple[Tensor, Tensor]:
        """(B, 1 + S, channels) what lies around, and (B, 1 + S) which of it is there."""
        state: Tensor = self.flags(around.flags)
        for index, table in enumerate(self.facts):
            state = state + table(around.facts[:, index])
        place_m = (around.segments[..., 1:] - PLACES // 2) * STEP_M
        lines = self.segment_kind(around.segments[..., 0]) + self.segment_place(_places(place_m))
        there = functional.pad(around.segments[..., 0] != NO_SEGMENT, (1, 0), value=True)
        return torch.cat([state[:, None], lines], dim=1), there


def _places(place_m: Tensor) -> Tensor:
    """(..., 4 * 2 * _WAVES) four coordinates as waves, from as long as the largest room down."""
    return _waves(place_m, _LONGEST_M, _SHORTEST_M).flatten(-2)


def _waves(value: Tensor, longest: float, shortest: float) -> Tensor:
    """(..., 2 * _WAVES) sines and cosines."""
    steps = torch.linspace(math.log(longest), math.log(shortest), _WAVES, device=value.device)
    turns = value[..., None] * (2.0 * math.pi / steps.exp())
    return torch.cat([turns.sin(), turns.cos()], dim=-1)
