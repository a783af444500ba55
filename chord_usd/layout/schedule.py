"""Noise schedules, as diffusers schedulers."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from diffusers import DDIMScheduler, DDPMScheduler, DPMSolverMultistepScheduler

from chord_usd.layout.config import LayoutConfig

SAMPLERS = ("ddim", "dpm", "ddpm")


def training_scheduler(config: LayoutConfig) -> Any:
    """Adds noise in training and, over all its steps, samples as DDPM does (paper)."""
    return DDPMScheduler(**_common(config))


def sampling_scheduler(config: LayoutConfig, sampler: str = "ddim") -> Any:
    """A diffusers scheduler that walks the same noise levels in few steps.

    sampler: ddim (deterministic), dpm (DPM-Solver++, second order) or ddpm (ancestral, paper).
    """
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
