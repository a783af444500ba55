"""What a layout network makes of a noisy state, on a CPU without torch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import numpy.typing as npt

from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.runtime.networks import GRAPH_FILE, Network, has_graph, load_network
from chord_usd.line.layout.description import REMEDY, Description, read_description
from chord_usd.line.layout.device import choose_device

GRAPH_INPUTS = ("state", "time", "pixels", "grid", "words")
"""The last only where the network attends to words."""
GRAPH_OUTPUTS = ("output", "clean")


@dataclass(frozen=True, eq=False)
class Plans:
    """A batch of plans, or of whatever layouts are drawn over."""

    pixels: npt.NDArray[np.float32]
    """(B, planes, H, W)."""
    grid: npt.NDArray[np.float32] | None
    """(B, planes, H / patch, W / patch), or None for the RGB condition."""
    inside: npt.NDArray[np.bool_]
    """(B, 1, H, W) floor; items exist nowhere else."""
    words: npt.NDArray[np.float32] | None = None
    """(B, words, channels) for networks that attend to words."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """What a network says of a noisy state."""

    output: npt.NDArray[np.float32]
    """(B, classes + 1, H, W) category logits and the front mark's; RGB: (B, 3, H, W) noise."""
    clean: npt.NDArray[np.float32] | None
    """(B, C, H, W) clean state that the logits stand for; None for RGB."""


class Denoiser(Protocol):
    """A trained network on some device."""

    description: Description
    device: str

    def estimate(
        self, state: npt.NDArray[np.float32], times: Sequence[int], plans: Plans
    ) -> Estimate:
        """state: (B, C, H, W) noisy; times: (B,) in [0, training_steps)."""


class OnnxDenoiser:
    """A network on the CPU, by ONNX Runtime."""

    device = "cpu"

    def __init__(self, network: Network, description: Description) -> None:
        self._network = network
        self.description = description

    def estimate(
        self, state: npt.NDArray[np.float32], times: Sequence[int], plans: Plans
    ) -> Estimate:
        """As Denoiser. Raises MemoryError where there is not enough."""
        assert plans.grid is not None, "networks of the paper's kind have no graph"
        words = () if plans.words is None else (plans.words,)
        inputs = (state, np.array(times, np.int64), plans.pixels, plans.grid, *words)
        output, clean = self._network.run(dict(zip(GRAPH_INPUTS, inputs, strict=False)))
        return Estimate(output, clean)


def load_denoiser(folder: Path, device: str) -> Denoiser:
    """The network of a checkpoint folder, without torch where that can be.

    device: auto, cpu or cuda. Raises CheckpointError for an unusable folder, ChordError where CUDA
    is asked for and absent, MissingExtraError where this takes torch and there is none.
    """
    chosen = choose_device(device)
    description = read_description(folder)
    if chosen == "cpu" and has_graph(folder):
        return OnnxDenoiser(load_network(folder, REMEDY), description)

    with needed_for(f"a checkpoint without {GRAPH_FILE}"):
        from chord_usd.line.layout.checkpoint import load_checkpoint
        from chord_usd.line.layout.torch_denoiser import TorchDenoiser

    return TorchDenoiser(load_checkpoint(folder, chosen), chosen)
