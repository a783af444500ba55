"""What a layout network makes of a noisy state, by torch: on CUDA, in training, and to compare."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext

import numpy as np
import numpy.typing as npt
import torch

from chord_usd.line.layout.checkpoint import Checkpoint
from chord_usd.line.layout.denoiser import Estimate, Plans
from chord_usd.line.layout.device import half_precision


class TorchDenoiser:
    """A network on a device of torch."""

    def __init__(self, checkpoint: Checkpoint, device: str = "cpu", *, full: bool = False) -> None:
        """full: float32 throughout, also where bfloat16 would be faster."""
        self.description = checkpoint.description
        self.device = device
        self._network = checkpoint.network
        self._network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        self._full = full

    @torch.inference_mode()
    def estimate(
        self, state: npt.NDArray[np.float32], times: Sequence[int], plans: Plans
    ) -> Estimate:
        """As Denoiser."""
        with nullcontext() if self._full else half_precision(self.device):
            output = self._network(
                self._tensor(state),
                torch.tensor(times, device=self.device),
                self._tensor(plans.pixels),
                None if plans.grid is None else self._tensor(plans.grid),
                None if plans.words is None else self._tensor(plans.words),
            ).float()
        if self.description.config.state == "rgb":
            return Estimate(output.cpu().numpy(), None)
        clean = self._network.expected_state(output)
        return Estimate(output.cpu().numpy(), clean.cpu().numpy())

    def _tensor(self, values: npt.NDArray[np.float32]) -> torch.Tensor:
        return torch.from_numpy(values).to(self.device)
