"""Networks led by words further than they go by themselves (Ho and Salimans, 2022)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from chord_usd.layout.codes import expected_state
from chord_usd.layout.denoiser import Denoiser, Estimate, Plans


class GuidedDenoiser:
    """A denoiser whose logits are pushed from those without a word towards those with the words.

    Takes two passes of the network a step.
    """

    def __init__(self, denoiser: Denoiser, scale: float, silence: npt.NDArray[np.float32]) -> None:
        """scale: 1 changes nothing, 0 hears nothing. silence: (words, channels) that say nothing,
        as the network has seen it in training."""
        self.description = denoiser.description
        self.device = denoiser.device
        self._denoiser = denoiser
        self._scale = scale
        self._silence = silence

    def estimate(
        self, state: npt.NDArray[np.float32], times: Sequence[int], plans: Plans
    ) -> Estimate:
        """As Denoiser."""
        told = self._denoiser.estimate(state, times, plans).output
        silence = np.repeat(self._silence[None], len(state), axis=0)
        untold = self._denoiser.estimate(state, times, replace(plans, words=silence)).output
        output = untold + self._scale * (told - untold)
        return Estimate(output, expected_state(output))
