"""What the plan forbids, held at every step of the reverse process."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chord_usd.base.scene.palette import category
from chord_usd.line.layout.condition import DOOR_FLOOR_PLANE, PIXEL_PLANES, WINDOW_FLOOR_PLANE
from chord_usd.line.layout.denoiser import Estimate, Plans
from chord_usd.line.layout.draft import CLASS_COUNT, CODE_BITS, codebook, encode
from chord_usd.line.layout.known import bare_outside, held_to_plan
from chord_usd.line.layout.levels import LEVELS

HOUSE = LEVELS["house"]
BED, SHOWER = (1 + category(name).detector_class for name in ("bed", "shower"))


def said(label: int, second: int) -> Estimate:
    """A network that is rather sure of one label everywhere, and else thinks of a second."""
    logits = np.full((1, CLASS_COUNT + 1, 1, 4), -20.0, np.float32)
    logits[:, label], logits[:, second], logits[:, -1] = 3.0, 1.0, 2.0
    labels = np.full((1, 4), label, np.uint8)
    return Estimate(logits, encode(labels, labels > 0)[None])


def plans() -> Plans:
    """Four pixels: free floor, before a door, before a window, and outside before one."""
    pixels = np.zeros((1, PIXEL_PLANES, 1, 4), np.float32)
    pixels[:, DOOR_FLOOR_PLANE, :, 1] = pixels[:, WINDOW_FLOOR_PLANE, :, 2:] = 1.0
    return Plans(pixels, None, np.array([[[[True, True, True, False]]]]))


@pytest.mark.parametrize(
    ("label", "shown"), [(BED, [BED, 0, BED, 0]), (SHOWER, [SHOWER, 0, BED, 0])]
)
def test_labels_stand_where_the_plan_lets_them(label: int, shown: list[int]) -> None:
    held = held_to_plan(said(label, BED if label == SHOWER else SHOWER), plans(), HOUSE)
    assert held.output[0, :-1, 0].argmax(axis=0).tolist() == shown


def test_the_clean_state_follows_the_logits() -> None:
    before = said(SHOWER, BED)
    held = held_to_plan(before, plans(), HOUSE)
    assert held.clean is not None
    assert before.clean is not None
    words = held.clean[0, :CODE_BITS, 0].T
    np.testing.assert_allclose(words[1], codebook()[0])
    np.testing.assert_allclose(words[2], codebook()[BED], atol=1e-3)
    # A bed's pixel shows a front as likely as the logit of 2 says, and floor none.
    np.testing.assert_allclose(held.clean[0, -1, 0, 1:3], [-1.0, np.tanh(1.0)], atol=1e-3)
    np.testing.assert_array_equal(held.clean[..., 0], before.clean[..., 0])


def test_the_estimate_before_is_left_as_it_was() -> None:
    estimate = said(SHOWER, BED)
    before = estimate.output.copy()
    held_to_plan(estimate, plans(), HOUSE)
    np.testing.assert_array_equal(estimate.output, before)


def test_a_level_without_such_planes_forbids_nothing_on_its_ground() -> None:
    estimate = said(BED, SHOWER)
    held = held_to_plan(estimate, plans(), replace(HOUSE, bare_plane=None, low_plane=None))
    assert held.output[0, :-1, 0].argmax(axis=0).tolist() == [BED, BED, BED, 0]


def test_nothing_is_off_the_ground() -> None:
    estimate = said(BED, SHOWER)
    bare = bare_outside(estimate, plans().inside, HOUSE)
    assert bare.output[0, :-1, 0].argmax(axis=0).tolist() == [BED, BED, BED, 0]
    assert bare.clean is not None
    np.testing.assert_allclose(bare.clean[0, :CODE_BITS, 0, 3], codebook()[0])
