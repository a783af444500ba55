"""A network of one level as the start of another level's.

Levels share the U-Net, the noise and the code words: label k is the same word at every level. What
a network has learned of rectangles, edges and front marks therefore holds at once; only what the
condition means and which item belongs where has to be learned again.
"""

from __future__ import annotations

from dataclasses import replace

import torch
from torch import Tensor

from chord_usd.base.errors import CheckpointError
from chord_usd.line.layout.config import LayoutConfig
from chord_usd.line.layout.levels import traits_of
from chord_usd.line.layout.network import LayoutNetwork


@torch.no_grad()
def adopt(network: LayoutNetwork, other: LayoutNetwork) -> None:
    """Fill network with what fits of a network of another level and the same architecture.

    Raises CheckpointError where anything but the level differs.
    """
    if replace(_built(other), level=network.config.level) != _built(network):
        raise CheckpointError(
            "the network to start from is built differently",
            expected="the same channels, attention, state and condition",
            try_="a checkpoint of <train=plan2layout>, of its default preset",
        )
    weights = other.state_dict()
    for name in ("weight", "bias"):
        parameter = network.head.get_parameter(name)
        weights[f"head.{name}"] = _same_labels(weights[f"head.{name}"], parameter, network)
    weights["embed_plan.weight"] = _same_ground(network, other)
    weights["embed_state.weight"] = _same_front(network, other)
    network.load_state_dict(weights)


def _built(network: LayoutNetwork) -> LayoutConfig:
    """How a network is built, however it is sampled and however large its front marks are."""
    return replace(network.config, default_steps=1, default_sampler="ddim", front_amplitude=1.0)


def _same_front(network: LayoutNetwork, other: LayoutNetwork) -> Tensor:
    """What the embedding of the state says of front marks, whatever their amplitude."""
    fold = network.config.patch_px**2
    weight = other.embed_state.weight.clone()
    weight[:, -fold:] *= other.config.front_amplitude / network.config.front_amplitude
    return weight


def _same_labels(head: Tensor, parameter: Tensor, network: LayoutNetwork) -> Tensor:
    """The rows of a head that stand for the labels of the network, and for the front mark."""
    fold = network.config.patch_px**2
    by_label = head.unflatten(0, (-1, fold))
    wanted = parameter.unflatten(0, (-1, fold)).clone()
    shared = min(len(by_label), len(wanted)) - 1
    wanted[:shared], wanted[-1] = by_label[:shared], by_label[-1]
    return wanted.flatten(0, 1)


def _same_ground(network: LayoutNetwork, other: LayoutNetwork) -> Tensor:
    """What the embedding of the condition says of the ground; nothing yet of all else."""
    fold = network.config.patch_px**2
    before, weight = other.embed_plan.weight, torch.zeros_like(network.embed_plan.weight)
    to, from_ = (traits_of(net.config).ground_plane * fold for net in (network, other))
    weight[:, to : to + fold] = before[:, from_ : from_ + fold]
    return weight


def take_up(network: LayoutNetwork, other: LayoutNetwork) -> None:
    """Fill network with another of its level, which may hear no programme and see no draft:
    they say nothing then.

    Raises CheckpointError where they are built differently otherwise.
    """
    config = network.config
    if replace(_built(other), programme=config.programme, draft=config.draft) != _built(network):
        raise CheckpointError(
            "the network to start from is built differently",
            expected="the configuration of what is trained",
            try_="a checkpoint of the same command",
        )
    weights = {**network.state_dict(), **other.state_dict()}
    weights["embed_state.weight"] = _same_front(network, other)
    if config.draft and not other.config.draft:
        weights["embed_plan.weight"] = _without_draft(network, other)
    network.load_state_dict(weights)


def _without_draft(network: LayoutNetwork, other: LayoutNetwork) -> Tensor:
    """What the embedding of the condition says of a plan; nothing yet of a draft."""
    before, weight = other.embed_plan.weight, torch.zeros_like(network.embed_plan.weight)
    pixels = traits_of(other.config).pixel_planes * other.config.patch_px**2
    weight[:, :pixels] = before[:, :pixels]
    weight[:, weight.shape[1] - (before.shape[1] - pixels) :] = before[:, pixels:]
    return weight
