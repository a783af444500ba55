"""Several training processes as one: each learns from data of its own, gradients are averaged.

torchrun starts them: `torchrun --nproc-per-node 2 -m -- chord_usd train plan2layout …`. Two
processes of one thread each learn faster on two cores than one process of two threads, which wait
for one another at every layer.
"""

from __future__ import annotations

import os
from collections.abc import Iterable

import torch
from torch import Tensor, distributed, nn

_SEEDS_APART = 500_009
"""Between processes; workers of a process are further apart (workshop/training/loader.py)."""


class Processes:
    """The processes of this run, of which this is one; alone without torchrun."""

    def __init__(self, device: str) -> None:
        self.count = int(os.environ.get("WORLD_SIZE", "1"))
        self.rank = int(os.environ.get("RANK", "0"))
        if self.count > 1 and not distributed.is_initialized():
            distributed.init_process_group("nccl" if device.startswith("cuda") else "gloo")

    @property
    def is_first(self) -> bool:
        """Whether this process writes what the run keeps."""
        return self.rank == 0

    def seed(self, seed: int) -> int:
        """A seed of this process's own, equal to the given one in the first."""
        return seed + _SEEDS_APART * self.rank

    @torch.no_grad()
    def average_gradients(self, parameters: Iterable[nn.Parameter]) -> None:
        """Replace gradients by their means over all processes."""
        if self.count == 1:
            return
        gradients = [p.grad for p in parameters if p.grad is not None]
        flat = torch.cat([gradient.reshape(-1) for gradient in gradients])
        distributed.all_reduce(flat)
        flat /= self.count
        pieces = flat.split([gradient.numel() for gradient in gradients])
        for gradient, piece in zip(gradients, pieces, strict=True):
            gradient.copy_(piece.view_as(gradient))

    def agree(self, flag: bool, device: torch.device) -> bool:
        """What the first process says: clocks differ."""
        if self.count == 1:
            return flag
        said: Tensor = torch.tensor([flag], dtype=torch.uint8, device=device)
        distributed.broadcast(said, src=0)
        return bool(said.item())
