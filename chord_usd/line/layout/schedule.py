"""Noise schedules, and how samplers walk down them, as diffusers has them.

DDIM and DDPM in few steps are three weights a step and computed here. DPM-Solver++, and the paper's
noise prediction, are diffusers' own, which is imported, with torch, where it is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.layout.config import LayoutConfig

if TYPE_CHECKING:
    import torch

SAMPLERS = ("ddim", "dpm", "ddpm")
WALKED = ("ddim", "ddpm")
"""Samplers that walk_of knows."""

State = npt.NDArray[np.float32]
"""(B, C, H, W)."""


class Step(NamedTuple):
    """One step down, of a network that predicts the clean state."""

    time: int
    keep: float
    """How much of the noisy state is kept."""
    pull: float
    """How much of the clean state is added."""
    spread: float = 0.0
    """Standard deviation of the noise that is added."""


Walk = tuple[Step, ...]


def training_scheduler(config: LayoutConfig) -> Any:
    """Adds noise in training and, over all its steps, samples as DDPM does (paper)."""
    from diffusers import DDPMScheduler

    return DDPMScheduler(**_common(config))


def sampling_scheduler(config: LayoutConfig, sampler: str = "ddim") -> Any:
    """A diffusers scheduler that walks the same noise levels in few steps.

    sampler: ddim (deterministic), dpm (DPM-Solver++, second order) or ddpm (ancestral, paper).
    """
    from diffusers import DDIMScheduler, DDPMScheduler, DPMSolverMultistepScheduler

    if sampler == "ddpm":
        return DDPMScheduler(**_common(config), timestep_spacing="trailing")
    if sampler == "dpm":
        common = _common(config)
        common.pop("clip_sample")
        return DPMSolverMultistepScheduler(
            **common, timestep_spacing="trailing", algorithm_type="dpmsolver++"
        )
    return DDIMScheduler(**_common(config), timestep_spacing="trailing", set_alpha_to_one=True)


def _common(config: LayoutConfig) -> dict[str, Any]:
    common: dict[str, Any] = {
        "num_train_timesteps": config.training_steps,
        "prediction_type": config.prediction,
        "clip_sample": config.state == "rgb",
    }
    if config.schedule == "linear":
        return {**common, "beta_schedule": "linear"}
    return {**common, "trained_betas": log_snr_betas(config)}


def log_snr_betas(config: LayoutConfig) -> npt.NDArray[np.float32]:
    """(training_steps,) betas whose noise-to-signal ratio grows geometrically.

    sigma/alpha runs from noise_to_signal[0] to noise_to_signal[1], so that every octave of noise
    gets the same number of steps, in training and in sampling.
    """
    low, high = config.noise_to_signal
    ratio = np.geomspace(low, high, config.training_steps)
    alphas_cumprod = 1.0 / (1.0 + ratio**2)
    previous = np.concatenate([[1.0], alphas_cumprod[:-1]])
    return (1.0 - alphas_cumprod / previous).astype(np.float32)


def alphas_cumprod(config: LayoutConfig) -> FloatArray:
    """(training_steps,) share of the signal's variance that is left at each time."""
    if config.schedule == "linear":
        betas = np.linspace(*LINEAR_BETAS, config.training_steps)
    else:
        betas = log_snr_betas(config).astype(np.float64)
    return np.cumprod(1.0 - betas)


LINEAR_BETAS = (1e-4, 0.02)
"""DDPM's (Ho et al., 2020), which diffusers takes where no others are named."""


def noised(clean: State, noise: State, alpha: float) -> State:
    """A clean state at a noise level: the forward process in one step (paper, equation 1)."""
    return (np.sqrt(alpha) * clean + np.sqrt(1.0 - alpha) * noise).astype(np.float32)


def walk_of(config: LayoutConfig, sampler: str, steps: int) -> Walk:
    """ddim or ddpm in so many steps, for a network that predicts the clean state.

    DDIM of Song et al. (2021), equation 12, with sigma = 0, or for ddpm with that of equation 16 at
    eta = 1: the ancestral sampler of DDPM is DDIM that puts all of the noise back.
    """
    alphas = alphas_cumprod(config)
    times = np.round(np.linspace(config.training_steps, 0, steps, endpoint=False)).astype(int) - 1
    walk = []
    # The last state is clean.
    for time, alpha, after in zip(times, alphas[times], [*alphas[times[1:]], 1.0], strict=True):
        variance = (1.0 - after) / (1.0 - alpha) * (1.0 - alpha / after)
        spread = variance**0.5 if sampler == "ddpm" else 0.0
        keep = ((1.0 - after - spread**2) / (1.0 - alpha)) ** 0.5
        pull = after**0.5 - keep * alpha**0.5
        walk.append(Step(int(time), float(keep), float(pull), float(spread)))
    return tuple(walk)


_WALK_NOISE = 1
"""Sets the noise of the steps apart from the noise that a picture of the same seed starts from."""


class Sampler(Protocol):
    """Steps down from noise to a clean state."""

    times: list[int]
    """Of the steps, falling, in [0, training_steps)."""

    def step(self, prediction: State, index: int, state: State) -> State:
        """The state after step index: prediction is the network's, clean state or noise."""


class WrittenSampler:
    """A walk whose weights are known: a checkpoint's own, or walk_of's."""

    def __init__(self, walk: Walk, seeds: Sequence[int]) -> None:
        """seeds: one per picture, from which noise is drawn where the walk adds some."""
        self.times = [step.time for step in walk]
        self._walk = walk
        self._dice = [np.random.default_rng((seed, _WALK_NOISE)) for seed in seeds]

    def step(self, prediction: State, index: int, state: State) -> State:
        """The next state."""
        _, keep, pull, spread = self._walk[index]
        after = np.float32(keep) * state + np.float32(pull) * prediction
        if spread:
            noise = [dice.standard_normal(state.shape[1:], np.float32) for dice in self._dice]
            after += np.float32(spread) * np.stack(noise)
        return after.astype(np.float32)


class DiffusersSampler:
    """Any sampler of diffusers."""

    def __init__(
        self, config: LayoutConfig, sampler: str, steps: int, seeds: Sequence[int]
    ) -> None:
        """seeds: one per picture; samplers that add noise draw it from them, not from a global.

        Raises MissingExtraError without diffusers.
        """
        with needed_for(f"the sampler {sampler}"):
            import torch

            self._scheduler = sampling_scheduler(config, sampler)
        self._scheduler.set_timesteps(steps)
        self.times = [int(time) for time in self._scheduler.timesteps]
        self._more: dict[str, list[torch.Generator]] = {}
        if sampler == "ddpm":
            generators = [torch.Generator().manual_seed(seed + 2**32) for seed in seeds]
            self._more = {"generator": generators}

    def step(self, prediction: State, index: int, state: State) -> State:
        """The next state."""
        import torch

        stepped = self._scheduler.step(
            torch.from_numpy(prediction),
            self._scheduler.timesteps[index],
            torch.from_numpy(state),
            **self._more,
        )
        return np.asarray(stepped.prev_sample.numpy(), np.float32)
