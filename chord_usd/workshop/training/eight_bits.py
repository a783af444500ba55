"""Tensors in 8 bits, block by block, for the parts of a training state that may be coarse.

Values are stored as roots, so that the small values of a block keep their relative size: Adam
divides by the second moment, and a second moment rounded to zero would make a step explode.
"""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn import functional

BLOCK = 256
"""Values that share a scale."""
_LEVELS = 127


def pack(values: Tensor, root: int) -> tuple[Tensor, Tensor]:
    """Codes (N,) int8 and scales (ceil(N / BLOCK),) float32 of a tensor of N values.

    root: 1 stores values evenly spaced; larger roots resolve small values better. A value other
    than zero never becomes zero where root is above 1.
    """
    flat = values.detach().float().reshape(-1)
    blocks = functional.pad(flat, (0, -len(flat) % BLOCK)).reshape(-1, BLOCK)
    scales = blocks.abs().amax(dim=1)
    relative = blocks / scales.clamp(min=torch.finfo(torch.float32).tiny)[:, None]
    levels = (relative.abs() ** (1.0 / root) * _LEVELS).round()
    if root > 1:
        levels = torch.where(relative != 0.0, levels.clamp(min=1.0), levels)
    codes = (levels * relative.sign()).to(torch.int8).reshape(-1)[: len(flat)]
    return codes.contiguous(), scales


def unpack(codes: Tensor, scales: Tensor, root: int) -> Tensor:
    """(N,) float32: the inverse of pack."""
    relative = codes.float() / _LEVELS
    each = scales.repeat_interleave(BLOCK)[: len(codes)]
    return relative.sign() * relative.abs() ** root * each
