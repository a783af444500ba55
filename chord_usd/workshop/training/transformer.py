"""The layer that the networks which write lists are made of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn import functional


class Block(nn.Module):
    """A transformer's layer, normalised before."""

    def __init__(self, channels: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.norm_1, self.norm_2 = nn.LayerNorm(channels), nn.LayerNorm(channels)
        self.attend, self.merge = nn.Linear(channels, 3 * channels), nn.Linear(channels, channels)
        self.widen = nn.Linear(channels, 4 * channels)
        self.narrow = nn.Linear(4 * channels, channels)

    def forward(self, state: Tensor, mask: Tensor) -> Tensor:
        """state: (B, L, channels); mask: what is added to attention, (L, L) or (B, 1, L, L)."""
        return self.continued(state, mask, ())[0]

    def continued(
        self, state: Tensor, mask: Tensor, known: Sequence[Tensor]
    ) -> tuple[Tensor, Tensor, Tensor]:
        """The same after positions that are known already, with keys and values of all.

        known: their keys and values, (B, heads, P, channels / heads); mask: (B, 1, L, P + L).
        """
        query, key, value = (
            part.unflatten(-1, (self.heads, -1)).transpose(1, 2)
            for part in self.attend(self.norm_1(state)).chunk(3, dim=-1)
        )
        if known:
            key, value = (
                torch.cat(parts, dim=2) for parts in zip(known, (key, value), strict=True)
            )
        scores = query @ key.transpose(-1, -2) / query.shape[-1] ** 0.5 + mask
        seen = (scores.softmax(dim=-1) @ value).transpose(1, 2).flatten(2)
        state = state + self.merge(seen)
        inner: Any = self.narrow(functional.gelu(self.widen(self.norm_2(state))))
        return state + inner, key, value
