"""The graph by which a layout network runs without torch."""

from __future__ import annotations

from pathlib import Path

import torch
from torch import Tensor, nn

from chord_usd.base.runtime.networks import has_graph
from chord_usd.line.layout.denoiser import GRAPH_INPUTS, GRAPH_OUTPUTS
from chord_usd.line.layout.draft import DRAFT_PLANES, STATE_CHANNELS
from chord_usd.line.layout.levels import traits_of
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.workshop.training.onnx_file import write_graph

_AXES = {0: "batch", 2: "height", 3: "width"}
_GRID_AXES = {0: "batch", 2: "grid_height", 3: "grid_width"}


def write_layout_graph(folder: Path, network: LayoutNetwork) -> None:
    """Write the network.onnx of a checkpoint folder, unless it has one.

    Networks of the paper's kind are not for a CPU: they get none.
    """
    config = network.config
    if has_graph(folder) or config.state != "codes" or config.condition != "planes":
        return
    side, cell, traits = 2 * config.window_multiple_px, config.patch_px, traits_of(config)
    example = [
        torch.zeros(1, STATE_CHANNELS, side, side),
        torch.zeros(1, dtype=torch.long),
        torch.zeros(1, traits.pixel_planes + DRAFT_PLANES * config.draft, side, side),
        torch.zeros(1, traits.grid_planes, side // cell, side // cell),
    ]
    if config.words:
        example.append(torch.zeros(1, config.words, config.word_channels))
    write_graph(
        folder,
        _Estimating(network),
        stored={f"network.{name}": name for name in network.state_dict()},
        inputs=dict(zip(GRAPH_INPUTS, example, strict=False)),
        outputs=GRAPH_OUTPUTS,
        free_axes={
            "state": _AXES,
            "time": {0: "batch"},
            "pixels": _AXES,
            "grid": _GRID_AXES,
            **({"words": {0: "batch"}} if config.words else {}),
            **dict.fromkeys(GRAPH_OUTPUTS, _AXES),
        },
    )


class _Estimating(nn.Module):
    """The network and the clean state that its logits stand for."""

    def __init__(self, network: LayoutNetwork) -> None:
        super().__init__()
        self.network = network

    def forward(self, state: Tensor, time: Tensor, *condition: Tensor) -> tuple[Tensor, Tensor]:
        output = self.network(state, time, *condition)
        return output, self.network.expected_state(output)
