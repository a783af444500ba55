"""The network that finds drawn furniture and fixtures: the first half of the one that reads pages,
and heads for centres and shapes (Objects as Points, Zhou et al. 2019)."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor, nn
from torch.nn import functional

from chord_usd.base.raster.page_labels import PIECE_NAMES

CHANNELS = (32, 64, 128, 224)
"""From a half to a sixteenth of the page's resolution, as in the network that reads pages."""

_HEAD_WIDTH = 96
_RARE = -4.0
"""Logit of a centre before anything is learned: there are few."""
_USUAL_SIDE = 3.0
"""Logarithm of a side in pixels."""
_FINEST = 1
"""Level of the cells: a quarter of the resolution."""


class _Layer(nn.Sequential):
    def __init__(self, inner: int, outer: int, size: int = 3) -> None:
        super().__init__(nn.Conv2d(inner, outer, size, padding=size // 2), nn.ReLU(inplace=True))


def _pair(inner: int, outer: int) -> nn.Sequential:
    return nn.Sequential(_Layer(inner, outer), _Layer(outer, outer))


class SymbolsNetwork(nn.Module):
    """(B, 3, H, W) in [-1, 1], sides multiples of 16, to logits of centres (B, K, H/4, W/4) and
    shapes (B, 6, H/4, W/4)."""

    def __init__(self) -> None:
        super().__init__()
        self.stem = nn.Sequential(nn.PixelUnshuffle(2), _Layer(12, CHANNELS[0]))
        inner = (CHANNELS[0], *CHANNELS[:-1])
        self.down = nn.ModuleList(
            _pair(a, b) if level else _Layer(a, b)
            for level, (a, b) in enumerate(zip(inner, CHANNELS, strict=True))
        )
        self.narrow = nn.ModuleDict()
        self.up = nn.ModuleDict()
        for level in range(_FINEST, len(CHANNELS) - 1):
            self.narrow[str(level)] = _Layer(CHANNELS[level + 1], CHANNELS[level], size=1)
            self.up[str(level)] = _pair(2 * CHANNELS[level], CHANNELS[level])
        self.centres = _head(CHANNELS[_FINEST], len(PIECE_NAMES))
        self.shapes = _head(CHANNELS[_FINEST], 6)
        with torch.no_grad():
            for head, part, value in (
                (self.centres, slice(None), _RARE), (self.shapes, slice(2, 4), _USUAL_SIDE),
            ):  # fmt: skip
                bias = head[-1].bias
                assert isinstance(bias, Tensor)
                bias[part] = value

    def forward(self, rgb: Tensor) -> tuple[Tensor, Tensor]:
        """Logits of centres, and shapes."""
        now = self.stem(rgb)
        seen = []
        for level, down in enumerate(self.down):
            now = down(functional.max_pool2d(now, 2) if level else now)
            seen.append(now)
        for level in reversed(range(_FINEST, len(CHANNELS) - 1)):
            above = functional.interpolate(self.narrow[str(level)](now), scale_factor=2.0)
            now = self.up[str(level)](torch.cat([above, seen[level]], dim=1))
        return self.centres(now), self.shapes(now)


def _head(inner: int, outer: int) -> nn.Sequential:
    return nn.Sequential(_Layer(inner, _HEAD_WIDTH), nn.Conv2d(_HEAD_WIDTH, outer, 1))


class Finding(nn.Module):
    """The network as it is shipped: saying chances."""

    def __init__(self, network: SymbolsNetwork) -> None:
        super().__init__()
        self.network = network

    def forward(self, rgb: Tensor) -> tuple[Tensor, Tensor]:
        """Chances of centres, and shapes."""
        centres, shapes = self.network(rgb)
        return centres.sigmoid(), shapes


@torch.no_grad()
def take_up(network: SymbolsNetwork, weights: Mapping[str, Tensor]) -> None:
    """Take up the weights of this network, or what the one that reads pages has learned.

    Raises KeyError or RuntimeError where they are of neither.
    """
    state = network.state_dict()
    is_reader = "centres.1.weight" not in weights
    for name, tensor in state.items():
        if not (is_reader and name.split(".")[0] in ("centres", "shapes")):
            tensor.copy_(weights[name])
