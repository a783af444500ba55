"""What the plan forbids, held at every step of the reverse process.

Before doors there is nothing, and before windows nothing that reaches above their sill: no drawing
that the network learned from shows otherwise. What is known of a picture is not left to the network
to find out again, as in masked diffusion (Lugmayr et al., RePaint, 2022); the next step sees it and
lays out the rest accordingly.
"""

from __future__ import annotations

import numpy as np

from chord_usd.base.scene.types import BoolArray
from chord_usd.line.layout.denoiser import Estimate, Plans
from chord_usd.line.layout.draft import codebook, encode
from chord_usd.line.layout.levels import LevelTraits
from chord_usd.line.layout.schedule import State

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
    """The estimate with nothing off the floor of its plan, nor what the plan forbids there.

    One of RGB is left alone.
    """
    if estimate.clean is None:
        return estimate
    ground = plans.inside
    if traits.bare_plane is not None:
        ground = ground & ~_plane(plans, traits.bare_plane)
    held = bare_outside(estimate, ground, traits)
    if traits.low_plane is not None:
        before_window = ground & _plane(plans, traits.low_plane)
        _leave_out_tall(held, before_window[:, 0], traits)
    return held


def _plane(plans: Plans, index: int) -> BoolArray:
    return np.asarray(plans.pixels[:, index : index + 1] > 0)


def _leave_out_tall(estimate: Estimate, where: BoolArray, traits: LevelTraits) -> None:
    """Leave tall labels no chance where (B, H, W) says so."""
    assert estimate.clean is not None
    logits = estimate.output.transpose(0, 2, 3, 1)[where]
    logits[:, traits.tall_labels] = -_SURE
    chances = np.exp(logits[:, :-1] - logits[:, :-1].max(axis=1, keepdims=True))
    chances /= chances.sum(axis=1, keepdims=True)
    estimate.output.transpose(0, 2, 3, 1)[where] = logits
    # As LayoutNetwork.expected_state: what is left of the chance of a front goes with the labels.
    marked = (1.0 - chances[:, 0]) * (1.0 + np.tanh(logits[:, -1] / 2.0)) / 2.0
    front = (2.0 * marked - 1.0) * traits.front_amplitude
    words = chances @ codebook(traits.class_count)
    estimate.clean.transpose(0, 2, 3, 1)[where] = np.hstack([words, front[:, None]])
