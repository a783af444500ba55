"""The noise-prediction error: exact where the network is, and what it says of single items."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from chord_usd.base.raster import canvas
from chord_usd.line.layout.checkpoint import Checkpoint
from chord_usd.line.layout.config import PRESETS
from chord_usd.line.layout.denoiser import Estimate
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.outlier import Drawing, NoiseError
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.layout.torch_denoiser import TorchDenoiser

TINY = replace(
    PRESETS["default"], channels=(16, 32), attention=(False, True), feature_channels=16
)  # fmt: skip
TINY_PAPER = replace(PRESETS["paper"], patch_px=4, channels=(16, 32), attention=(False, False))


@pytest.fixture
def drawing(furnished_house):
    return Drawing.of(canvas.draw_plan(furnished_house.plan), furnished_house.items)


@pytest.fixture(params=[TINY, TINY_PAPER], ids=["codes", "rgb"])
def model(request):
    torch.manual_seed(0)
    network = LayoutNetwork(request.param).eval().requires_grad_(False)
    return LayoutModel(TorchDenoiser(Checkpoint(network, request.param, "hash", {})))


class Knowing(LayoutModel):
    """A model that sees through all noise to one layout."""

    def tell(self, drawing: Drawing) -> None:
        (window,) = self.windows([drawing.plan_image])
        labels, front = drawing.labels[window], drawing.front[window]
        self.clean = self.encode(labels, front, drawing.plan_image.rgb[window])

    def estimate(self, state, times, plans):
        return Estimate(state, np.broadcast_to(self.clean, state.shape))


@pytest.fixture
def knowing():
    network = LayoutNetwork(TINY).eval().requires_grad_(False)
    return Knowing(TorchDenoiser(Checkpoint(network, TINY, "hash", {})))


def test_maps_are_of_floor_and_the_same_again(model, drawing):
    errors = NoiseError(model)
    first = list(errors.maps([drawing, drawing], [10, 500]))
    again = list(errors.maps([drawing, drawing], [10, 500]))
    assert [one.shape for one in first] == [(2, 256, 256)] * 2
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    inside = model.plans([drawing.plan_image]).inside[0, 0]
    assert all((one[:, ~inside] == 0).all() and (one >= 0).all() for one in first)
    assert all(one[:, inside].mean() > 0 for one in first)


def test_a_model_that_knows_the_layout_is_not_surprised(knowing, drawing, furnished_house):
    knowing.tell(drawing)
    (found,) = NoiseError(knowing).maps([drawing], [300])
    assert found.max() < 1e-6
    scores = NoiseError(knowing).item_scores(drawing.plan_image, furnished_house.items)
    assert set(scores.values()) == {0.0}


def test_a_model_that_expects_bare_floor_is_wrong_by_one(knowing, drawing, furnished_house):
    knowing.tell(Drawing.of(drawing.plan_image, []))
    scores = NoiseError(knowing).item_scores(drawing.plan_image, furnished_house.items)
    assert len(scores) == len(furnished_house.items)
    assert set(scores.values()) == {1.0}


def test_only_the_item_that_was_not_expected_stands_out(knowing, drawing, furnished_house):
    expected = [item for item in furnished_house.items if item.category != "toilet"]
    knowing.tell(Drawing.of(drawing.plan_image, expected))
    scores = NoiseError(knowing).item_scores(drawing.plan_image, furnished_house.items)
    odd = {item.id for item in furnished_house.items if item.category == "toilet"}
    assert odd
    assert {item_id for item_id, score in scores.items() if score > 0.5} == odd


def test_times_are_found_by_their_noise(model):
    errors = NoiseError(model)
    assert errors.time_of(1e-9) == 0
    assert errors.time_of(1e9) == model.config.training_steps - 1
    time = errors.time_of(8.0)
    assert errors.noise_to_signal[time] == pytest.approx(8.0, rel=0.05)
