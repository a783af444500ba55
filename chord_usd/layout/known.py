"""What the plan forbids, held at every step of the reverse process.

Before doors there is nothing, and before windows nothing that reaches above their sill: no drawing
that the network learned from shows otherwise. What is known of a picture is not left to the network
to find out again, as in masked diffusion (Lugmayr et al., RePaint, 2022); the next step sees it and
lays out the rest accordingly.
"""

from __future__ import annotations

import numpy as np

from chord_usd.layout.codes import CODE_BITS, codebook, encode
from chord_usd.layout.denoiser import Estimate, Plans
from chord_usd.layout.levels import LevelTraits
from chord_usd.layout.schedule import State
from chord_usd.types import BoolArray

_SURE = 50.0
"""Logit of what is certain."""


def bare_pixel(traits: LevelTraits) -> tuple[State, State]:
    """Output and clean state of one pixel where nothing is, (1, classes + 1 or C, 1, 1)."""
    nothing = np.zeros((1, 1), np.uint8)
    logits = np.full((1, traits.class_count + 1, 1, 1), -_SURE, np.float32)
    logits[:, 0] = _SURE
    clean = encode(nothing, nothing > 0, traits.class_count, traits.front_amplitude)
    return logits, clean[None]


def bare_outside(estimate: Estimate, ground: BoolArray, traits: LevelTraits) -> Estimate:
    """The estimate with nothing off the ground (B, 1, H, W); one of RGB is left alone."""
    if estimate.clean is None:
        return estimate
    output, clean = bare_pixel(traits)
    return Estimate(
        np.where(ground, estimate.output, output), np.where(ground, estimate.clean, clean)
    )


def held_to_plan(estimate: Estimate, plans: Plans, traits: LevelTraits) -> Estimate:
    """The estimate without what the plan forbids on its floor; one of RGB is left alone."""
    output, clean = estimate.output, estimate.clean
    if clean is None:
        return estimate
    if traits.low_plane is not None:
        before_window = plans.inside & _plane(plans, traits.low_plane)
        output, clean = _without_tall(output, clean, before_window[:, 0], traits)
    held = Estimate(output, clean)
    if traits.bare_plane is not None:
        held = bare_outside(held, ~_plane(plans, traits.bare_plane), traits)
    return held


def _plane(plans: Plans, index: int) -> BoolArray:
    return np.asarray(plans.pixels[:, index : index + 1] > 0)


def _without_tall(
    output: State, clean: State, where: BoolArray, traits: LevelTraits
) -> tuple[State, State]:
    """Both with no chance for tall labels where (B, H, W) says so."""
    output, clean = output.copy(), clean.copy()
    logits = output.transpose(0, 2, 3, 1)[where]
    logits[:, traits.tall_labels] = -_SURE
    chances = np.exp(logits[:, :-1] - logits[:, :-1].max(axis=1, keepdims=True))
    chances /= chances.sum(axis=1, keepdims=True)
    output.transpose(0, 2, 3, 1)[where] = logits
    clean.transpose(0, 2, 3, 1)[where, :CODE_BITS] = chances @ codebook(traits.class_count)
    return output, clean
