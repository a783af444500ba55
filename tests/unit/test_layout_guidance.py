"""Guidance by words, and the clean state behind logits."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from chord_usd.layout.codes import CLASS_COUNT, encode, expected_state
from chord_usd.layout.denoiser import Estimate, Plans
from chord_usd.layout.guidance import GuidedDenoiser

SIDE = 4


class Listener:
    """A network whose logits are what it is told."""

    description = None
    device = "cpu"

    def estimate(self, state: np.ndarray, times: Sequence[int], plans: Plans) -> Estimate:
        assert plans.words is not None
        output = np.zeros((len(state), CLASS_COUNT + 1, SIDE, SIDE), np.float32)
        output[:, 1] = plans.words.mean(axis=(1, 2))[:, None, None]
        return Estimate(output, None)


def plans_of(*values: float) -> Plans:
    blank = np.zeros((len(values), 1, SIDE, SIDE), np.float32)
    words = np.stack([np.full((2, 3), value, np.float32) for value in values])
    return Plans(blank, None, blank > 0, words)


@pytest.mark.parametrize("scale", [0.0, 1.0, 2.5])
def test_logits_go_from_silence_towards_the_words_and_beyond(scale: float) -> None:
    guided = GuidedDenoiser(Listener(), scale, np.full((2, 3), 1.0, np.float32))
    estimate = guided.estimate(np.zeros((2, 17, SIDE, SIDE), np.float32), [5, 5], plans_of(3, 1))
    assert estimate.output[0, 1] == pytest.approx(np.full((SIDE, SIDE), 1 + scale * 2))
    assert estimate.output[1, 1] == pytest.approx(np.ones((SIDE, SIDE)))
    assert estimate.clean is not None
    assert estimate.clean.shape == (2, 17, SIDE, SIDE)


def test_what_logits_are_sure_of_is_the_clean_state() -> None:
    rng = np.random.default_rng(0)
    labels = rng.integers(0, CLASS_COUNT, (SIDE, SIDE)).astype(np.uint8)
    front = (rng.random((SIDE, SIDE)) < 0.5) & (labels > 0)
    logits = np.full((1, CLASS_COUNT + 1, SIDE, SIDE), -40.0, np.float32)
    np.put_along_axis(logits[0], labels[None].astype(int), 40.0, axis=0)
    logits[0, -1] = np.where(front, 40.0, -40.0)
    assert expected_state(logits)[0] == pytest.approx(encode(labels, front), abs=1e-5)


def test_logits_that_are_undecided_lie_between() -> None:
    state = expected_state(np.zeros((1, CLASS_COUNT + 1, SIDE, SIDE), np.float32))
    assert np.abs(state).max() < 1.0
    assert not state[:, -1].any()
