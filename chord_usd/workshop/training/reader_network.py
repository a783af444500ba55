"""The network that reads pages: a U-Net from colours to what is built, what is drawn over it,
points, and what rooms are for."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from itertools import pairwise

import torch
from torch import Tensor, nn
from torch.nn import functional
from torch.nn.utils.fusion import fuse_conv_bn_eval

from chord_usd.base.raster.page_labels import (
    BUILT_NAMES,
    KIND_NAMES,
    KIND_STEP_PX,
    LAID_NAMES,
    POINT_NAMES,
)

CHANNELS = (32, 64, 128, 224, 320)
"""From a half to a thirty-second of the page's resolution."""

OUTPUTS = (len(BUILT_NAMES), len(LAID_NAMES), len(POINT_NAMES))

_KIND_LEVEL = KIND_STEP_PX // 2 - 1
"""Of the way up, where features are as coarse as kinds."""

_HEADS = ("out.0", "kinds", "zones.out")

_ZONE_WIDTH, _ZONE_DILATIONS = 96, (1, 2, 4, 8)
"""Channels of what looks around for kinds, and how far its layers look, in steps of an eighth of
the page's resolution."""

_RARE_POINT = -4.0
"""Logit of a point before anything is learned: there are few."""


class _Layer(nn.Sequential):
    """A convolution, normalised over the batch until it is fused."""

    def __init__(self, inner: int, outer: int, size: int = 3, dilation: int = 1) -> None:
        convolution = nn.Conv2d(
            inner, outer, size, padding=dilation * (size // 2), dilation=dilation, bias=False
        )
        super().__init__(convolution, nn.BatchNorm2d(outer), nn.ReLU(inplace=True))


def _pair(inner: int, outer: int) -> nn.Sequential:
    return nn.Sequential(_Layer(inner, outer), _Layer(outer, outer))


class _Zones(nn.Module):
    """Adds the evidence of a wide view to the logits of kinds: the pieces about a spot show what an
    open floor is for. Adds nothing before anything is learned."""

    def __init__(self, fine: int, coarse: int) -> None:
        super().__init__()
        self.into = _Layer(fine + coarse, _ZONE_WIDTH, size=1)
        self.around = nn.ModuleList(
            _Layer(_ZONE_WIDTH, _ZONE_WIDTH, dilation=step) for step in _ZONE_DILATIONS
        )
        self.out = nn.Conv2d(_ZONE_WIDTH, len(KIND_NAMES), 1)
        nn.init.zeros_(self.out.weight)
        assert self.out.bias is not None
        nn.init.zeros_(self.out.bias)

    def forward(self, fine: Tensor, coarse: Tensor) -> Tensor:
        """Of features as fine as kinds, and of those half as fine."""
        now = self.into(torch.cat([functional.max_pool2d(fine, 2), coarse], dim=1))
        for layer in self.around:
            now = now + layer(now)
        return functional.interpolate(self.out(now), scale_factor=2.0)


class ReaderNetwork(nn.Module):
    """(B, 3, H, W) in [-1, 1], sides multiples of 32, to logits: (B, sum(OUTPUTS), H, W), and of
    kinds, (B, len(KIND_NAMES), H / KIND_STEP_PX, W / KIND_STEP_PX)."""

    def __init__(self, channels: tuple[int, ...] = CHANNELS) -> None:
        super().__init__()
        self.stem = nn.Sequential(nn.PixelUnshuffle(2), _Layer(12, channels[0]))
        inner = (channels[0], *channels[:-1])
        self.down = nn.ModuleList(
            _pair(a, b) if level else _Layer(a, b)
            for level, (a, b) in enumerate(zip(inner, channels, strict=True))
        )
        self.middle = nn.Sequential(
            *(_Layer(channels[-1], channels[-1], dilation=step) for step in (2, 4))
        )
        self.narrow = nn.ModuleList(_Layer(b, a, size=1) for a, b in pairwise(channels))
        self.up = nn.ModuleList(
            _pair(2 * a, a) if level else _Layer(2 * a, a) for level, a in enumerate(channels[:-1])
        )
        self.out = nn.Sequential(nn.Conv2d(channels[0], 4 * sum(OUTPUTS), 1), nn.PixelShuffle(2))
        self.kinds = nn.Conv2d(channels[_KIND_LEVEL], len(KIND_NAMES), 1)
        self.zones = _Zones(channels[_KIND_LEVEL], channels[_KIND_LEVEL + 1])
        with torch.no_grad():
            bias = self.out[0].bias
            assert isinstance(bias, Tensor)
            bias.zero_()[-4 * OUTPUTS[-1] :] = _RARE_POINT

    def forward(self, rgb: Tensor) -> tuple[Tensor, Tensor]:
        """Logits of all fine heads, one after the other, and of kinds."""
        kinds, now, seen = self._kinds(rgb)
        for level in reversed(range(_KIND_LEVEL)):
            now = self._finer(level, now, seen)
        return self.out(now), kinds

    def kinds_of(self, rgb: Tensor) -> Tensor:
        """Logits of kinds alone."""
        return self._kinds(rgb)[0]

    def _kinds(self, rgb: Tensor) -> tuple[Tensor, Tensor, list[Tensor]]:
        """Logits of kinds, their features, and the features of each level on the way down."""
        now = self.stem(rgb)
        seen = []
        for level, down in enumerate(self.down):
            now = down(functional.max_pool2d(now, 2) if level else now)
            seen.append(now)
        now = coarser = now + self.middle(now)
        for level in reversed(range(_KIND_LEVEL, len(self.up))):
            coarser, now = now, self._finer(level, now, seen)
        return self.kinds(now) + self.zones(now, coarser), now, seen

    def _finer(self, level: int, now: Tensor, seen: list[Tensor]) -> Tensor:
        above = functional.interpolate(self.narrow[level](now), scale_factor=2.0)
        finer: Tensor = self.up[level](torch.cat([above, seen[level]], dim=1))
        return finer

    def keep_all_but_kinds(self) -> None:
        """Fuse and freeze all but the head for kinds."""
        for name, module in self.named_children():
            if name not in ("kinds", "zones"):
                _fuse(module.eval())
                module.requires_grad_(False)


class Reading(nn.Module):
    """The network as it is shipped: fused, and saying chances."""

    def __init__(self, network: ReaderNetwork) -> None:
        super().__init__()
        self.network = fused(network)

    def forward(self, rgb: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Chances of what is built, of what is drawn over it, of points, and of kinds."""
        fine, kinds = self.network(rgb)
        built, laid, points = fine.split(OUTPUTS, dim=1)
        return built.softmax(dim=1), laid.softmax(dim=1), points.sigmoid(), kinds.softmax(dim=1)


@torch.no_grad()
def take_up_fused(network: ReaderNetwork, weights: Mapping[str, Tensor], rgb: Tensor) -> None:
    """Take up the weights of a fused network: what fused() made of another one.

    Each normalisation is given the scale and offset that undo what it does to rgb, (B, 3, H, W) in
    [-1, 1], so that the network says of such pictures what the fused one does. Raises KeyError or
    RuntimeError where the weights belong to a network of other channels.
    """
    plain = dict(network.named_parameters())
    offsets: dict[nn.Module, Tensor] = {}
    for name, layer in network.named_modules():
        if isinstance(layer, _Layer):
            plain[f"{name}.0.weight"].copy_(weights[f"{name}.0.weight"])
            if isinstance(layer[1], nn.BatchNorm2d):
                offsets[layer[1]] = weights[f"{name}.0.bias"]
            else:
                plain[f"{name}.0.bias"].copy_(weights[f"{name}.0.bias"])
    for name in (f"{head}.{part}" for head in _HEADS for part in ("weight", "bias")):
        plain[name].copy_(weights[name])

    def undo(norm: nn.Module, inputs: tuple[Tensor]) -> None:
        assert isinstance(norm, nn.BatchNorm2d)
        variance, mean = torch.var_mean(inputs[0], dim=(0, 2, 3), correction=0)
        norm.weight.copy_((variance + norm.eps).sqrt())
        norm.bias.copy_(mean + offsets[norm])

    hooks = [norm.register_forward_pre_hook(undo) for norm in offsets]
    network.train()
    network(rgb)
    for hook in hooks:
        hook.remove()


def fused(network: ReaderNetwork) -> ReaderNetwork:
    """A copy whose convolutions do what normalisation did after them."""
    copied = copy.deepcopy(network).eval()
    _fuse(copied)
    return copied


def _fuse(module: nn.Module) -> None:
    for layer in module.modules():
        if isinstance(layer, _Layer) and isinstance(layer[1], nn.BatchNorm2d):
            convolution = layer[0]
            assert isinstance(convolution, nn.Conv2d)
            layer[0] = fuse_conv_bn_eval(convolution, layer[1])
            layer[1] = nn.Identity()
