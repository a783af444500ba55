"""The conditional U-Net: diffusers' UNet2DModel between a fold of pixels and a 1×1 head."""

from __future__ import annotations

from typing import Any

import torch
from diffusers import UNet2DConditionModel, UNet2DModel
from torch import Tensor, nn
from torch.nn import functional

from chord_usd.line.layout.config import LayoutConfig
from chord_usd.line.layout.draft import STATE_CHANNELS, codebook
from chord_usd.line.layout.levels import traits_of

RGB_CHANNELS = 3


class LayoutNetwork(nn.Module):
    """epsilon_theta(x_t; y, t) of the paper's equation 1.

    Pixels are folded patch_px × patch_px into channels first (space to depth), which makes a
    256×256 layout affordable on a CPU; with patch_px = 1 it is the paper's network.
    """

    codes: Tensor

    def __init__(self, config: LayoutConfig) -> None:
        super().__init__()
        self.config = config
        self.class_count = traits_of(config).class_count
        fold = config.patch_px**2
        width = config.channels[0]
        self.embed_state = nn.Conv2d(_state_channels(config) * fold, width, 1)
        self.embed_plan = nn.Conv2d(_plan_channels(config), width, 1)
        self.unet = _unet(config)
        self.head = nn.Conv2d(config.feature_channels, _output_channels(config) * fold, 1)
        self.register_buffer(
            "codes", torch.from_numpy(codebook(self.class_count)), persistent=False
        )

    def forward(
        self,
        state: Tensor,
        time: Tensor,
        pixels: Tensor,
        grid: Tensor | None,
        words: Tensor | None = None,
    ) -> Tensor:
        """What the network says of a noisy batch.

        state: (B, C, H, W) noisy state; time: (B,) training steps in [0, training_steps);
        pixels: (B, pixel planes or 3, H, W), a draft's planes last where the network sees drafts,
        and grid: (B, grid planes, H/patch, W/patch), or None
        for the RGB condition: the plan or table, as its level describes it; words: (B, words,
        word_channels) where the network attends to words, all 0 for one that is missing. Returns
        (B, class_count + 1, H, W): category logits, then the front mark's logit; for the RGB state
        the predicted noise, (B, 3, H, W).
        """
        patch = self.config.patch_px
        plan = functional.pixel_unshuffle(pixels, patch)
        if grid is not None:
            plan = torch.cat([plan, grid], dim=1)
        folded = functional.pixel_unshuffle(state, patch)
        inputs = torch.cat([self.embed_state(folded), self.embed_plan(plan)], dim=1)
        features = functional.silu(self.unet(inputs, time, **self._said(words)).sample)
        return functional.pixel_shuffle(self.head(features), patch)

    def _said(self, words: Tensor | None) -> dict[str, Tensor]:
        """Conditions of the U-Net beside the picture."""
        if words is None:
            return {}
        said = {"encoder_hidden_states": words}
        if self.config.programme:
            said["class_labels"] = words[:, : self.config.programme].flatten(1)
        return said

    def encode(self, labels: Tensor, front: Tensor) -> Tensor:
        """Labels (B, H, W) and front marks (B, H, W) bool to the clean state (B, 17, H, W)."""
        words = functional.embedding(labels.long(), self.codes).permute(0, 3, 1, 2)
        marks = front[:, None].to(words.dtype) * 2.0 - 1.0
        return torch.cat([words, marks * self.config.front_amplitude], dim=1)

    def expected_state(self, output: Tensor) -> Tensor:
        """The mean clean state (B, 17, H, W) under forward's logits: what the scheduler steps to.

        A softmax over code words keeps the estimate inside their hull at every noise level
        (score interpolation, Dieleman et al., 2022), where a regressed sample would leave it.
        """
        chances = _chances(output[:, : self.class_count].float())
        # A 1×1 convolution: what ONNX Runtime is made for, unlike the same as an einsum.
        words = functional.conv2d(chances, self.codes.T[:, :, None, None])
        # What the front's logit says holds on items, which alone it learns from; floor has none.
        marked = output[:, self.class_count :].float().sigmoid() * (1.0 - chances[:, :1])
        front = 2.0 * marked - 1.0
        return torch.cat([words, front * self.config.front_amplitude], dim=1)


def _chances(logits: Tensor) -> Tensor:
    """Softmax of (B, classes, H, W) over the classes.

    Written out: ONNX Runtime's own, along any axis but the last, takes as long as the U-Net.
    """
    weights = (logits - logits.amax(dim=1, keepdim=True)).exp()
    return weights / weights.sum(dim=1, keepdim=True)


def _unet(config: LayoutConfig) -> Any:
    """diffusers' U-Net; where there are words, attending levels attend to them, too."""
    common: dict[str, Any] = {
        "in_channels": 2 * config.channels[0],
        "out_channels": config.feature_channels,
        "block_out_channels": config.channels,
        "layers_per_block": config.blocks_per_level,
        "norm_num_groups": 16,
    }
    attending = "CrossAttn{}Block2D" if config.words else "Attn{}Block2D"
    blocks = [attending if attend else "{}Block2D" for attend in config.attention]
    common["down_block_types"] = tuple(block.format("Down") for block in blocks)
    common["up_block_types"] = tuple(block.format("Up") for block in reversed(blocks))
    if not config.words:
        return UNet2DModel(**common, attention_head_dim=32)
    # What this class calls so is the number of heads.
    heads = tuple(width // 32 for width in config.channels)
    projection: dict[str, Any] = {}
    if config.programme:
        projection["class_embed_type"] = "projection"
        projection["projection_class_embeddings_input_dim"] = (
            config.programme * config.word_channels
        )
    unet: Any = UNet2DConditionModel(
        **common, **projection, cross_attention_dim=config.word_channels, attention_head_dim=heads
    )
    if config.programme:
        # Says nothing at first, so that a network without it can be the start.
        nn.init.zeros_(unet.class_embedding.linear_2.weight)
        nn.init.zeros_(unet.class_embedding.linear_2.bias)
    return unet


def _state_channels(config: LayoutConfig) -> int:
    return RGB_CHANNELS if config.state == "rgb" else STATE_CHANNELS


def _plan_channels(config: LayoutConfig) -> int:
    fold = config.patch_px**2
    if config.condition == "rgb":
        return RGB_CHANNELS * fold
    traits = traits_of(config)
    draft_planes = STATE_CHANNELS if config.draft else 0
    return (traits.pixel_planes + draft_planes) * fold + traits.grid_planes


def _output_channels(config: LayoutConfig) -> int:
    return RGB_CHANNELS if config.state == "rgb" else traits_of(config).class_count + 1
