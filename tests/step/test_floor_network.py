"""The network that hears words: attention, and the programme in every block."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch

from chord_usd.base.errors import CheckpointError
from chord_usd.line.layout.config import FLOOR
from chord_usd.line.layout.levels import traits_of
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.transfer import take_up
from chord_usd.line.planning.words import PROGRAMME_CHANNELS, PROGRAMME_ROWS, TEXT_CHANNELS, WORDS

WORD_CHANNELS = TEXT_CHANNELS + PROGRAMME_CHANNELS

TINY = replace(
    FLOOR, channels=(32, 32), attention=(False, True), feature_channels=16, default_steps=2
)
SIDE = 32


def network_of(config=TINY) -> LayoutNetwork:
    torch.manual_seed(0)
    return LayoutNetwork(config).eval().requires_grad_(False)


def heard(network: LayoutNetwork, words: torch.Tensor) -> torch.Tensor:
    traits, cell = traits_of(TINY), TINY.patch_px
    pixels = torch.zeros(1, traits.pixel_planes, SIDE, SIDE)
    grid = torch.zeros(1, traits.grid_planes, SIDE // cell, SIDE // cell)
    state = torch.randn(1, 17, SIDE, SIDE, generator=torch.Generator().manual_seed(1))
    return network(state, torch.tensor([500]), pixels, grid, words)


@pytest.fixture
def words() -> torch.Tensor:
    return torch.randn(1, WORDS, WORD_CHANNELS, generator=torch.Generator().manual_seed(2))


def test_words_are_as_many_as_the_configuration_says() -> None:
    assert (FLOOR.words, FLOOR.word_channels) == (WORDS, WORD_CHANNELS)
    assert FLOOR.programme == PROGRAMME_ROWS


def test_a_programme_says_nothing_before_training(words: torch.Tensor) -> None:
    """So that a network without one goes on where it was."""
    before = network_of(replace(TINY, programme=0))
    after = network_of()
    take_up(after, before)
    assert torch.equal(heard(after, words), heard(before, words))


def test_a_programme_is_heard_beside_attention(words: torch.Tensor) -> None:
    network = network_of()
    torch.nn.init.normal_(network.unet.class_embedding.linear_2.weight)
    silent = heard(network, words)
    for name, parameter in network.named_parameters():
        if ".attn2.to_v" in name:
            torch.nn.init.zeros_(parameter)
    deaf = heard(network, words)
    assert not torch.equal(deaf, silent)
    other = words.clone()
    other[:, PROGRAMME_ROWS:] += 1.0
    assert torch.equal(heard(network, other), deaf), "the text is attended to alone"
    other[:, 0] += 1.0
    assert not torch.equal(heard(network, other), deaf)


def test_a_network_built_otherwise_is_no_start() -> None:
    with pytest.raises(CheckpointError, match="built differently"):
        take_up(network_of(), network_of(replace(TINY, channels=(32, 64))))
