"""Learning from a guided teacher, and front marks of any amplitude."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from chord_usd.line.layout.checkpoint import save_checkpoint
from chord_usd.line.layout.config import FRONT_AMPLITUDE, PRESETS
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.transfer import take_up
from chord_usd.workshop.training.guided import GuidedTrainer
from chord_usd.workshop.training.stream import LayoutStream, StreamConfig
from chord_usd.workshop.training.trainer import TrainingConfig

TINY = replace(
    PRESETS["default"], channels=(16, 32), attention=(False, False), feature_channels=16,
    default_steps=2,
)  # fmt: skip
FAINT = replace(TINY, front_amplitude=1.0)
QUICK = TrainingConfig(
    minutes=30.0, batch=2, workers=0, warmup_steps=5, learning_rate=3e-3, mixed_precision=False
)


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Checkpoint folders of two untrained networks that code fronts faintly."""
    made = []
    for seed in (0, 1):
        torch.manual_seed(seed)
        folder = tmp_path_factory.mktemp("checkpoint")
        network = LayoutNetwork(FAINT)
        network.head.weight.data *= 8.0  # else they say next to nothing
        save_checkpoint(folder, network, {})
        made.append(folder)
    return made


@pytest.fixture(scope="module")
def batch():
    return next(iter(LayoutStream(StreamConfig(seed=1), [], TINY, 2)))


def wanted(folders, batch, folder, guidance, network=FAINT):
    """Chances that a trainer asks for, and the log chances of its two networks."""
    trainer = GuidedTrainer(network, QUICK, folder, *folders, guidance)
    clean = trainer._clean_state(batch)
    times = torch.tensor([300, 700])
    noisy = trainer.scheduler.add_noise(clean, torch.ones_like(clean), times)
    plan = trainer._plan_pixels(batch), trainer._plan_grid(batch), None
    said = [
        trainer._said(each, batch, noisy, times, plan)
        for each in (trainer._teacher, trainer._guide)
    ]
    return trainer._wanted(batch, noisy, times, plan), *said


class TestGuidance:
    def test_of_one_is_the_teacher_alone(self, folders, batch, tmp_path):
        chances, teacher, guide = wanted(folders, batch, tmp_path, 1.0)
        assert torch.allclose(chances, teacher.exp(), atol=1e-6)
        assert not torch.allclose(chances, guide.exp(), atol=1e-3)

    def test_of_more_leads_away_from_the_guide(self, folders, batch, tmp_path):
        chances, teacher, guide = wanted(folders, batch, tmp_path, 2.0)
        assert torch.allclose(chances.sum(dim=1), torch.ones(()), atol=1e-5)
        believed = teacher > np.log(0.01)
        lead = torch.where(believed, teacher - guide, (teacher - guide).clamp(max=0.0))
        # The same up to what norms the chances, which is one number per pixel.
        rest = chances.log() - teacher - lead
        assert float((rest - rest.mean(dim=1, keepdim=True)).abs().max()) < 1e-4
        assert bool(believed.any())
        assert not bool(believed.all())

    def test_networks_see_fronts_as_they_code_them(self, folders, batch, tmp_path):
        faint = wanted(folders, batch, tmp_path, 2.0)
        strong = wanted(folders, batch, tmp_path, 2.0, network=TINY)
        assert bool(batch["front"].any())
        assert torch.allclose(faint[1], strong[1], atol=1e-5)

    @pytest.mark.acceptance
    def test_the_teacher_is_learned(self, folders, batch, tmp_path):
        trainer = GuidedTrainer(TINY, QUICK, tmp_path, *folders, 2.0)
        losses = [float(trainer._step(batch)["category"]) for _ in range(80)]
        assert np.mean(losses[-5:]) < 0.9 * np.mean(losses[:5])


def test_a_network_is_taken_up_with_larger_front_marks():
    torch.manual_seed(0)
    faint, strong = LayoutNetwork(FAINT).eval(), LayoutNetwork(TINY).eval()
    take_up(strong, faint)
    labels = torch.randint(0, 5, (1, 32, 32))
    front = labels == 3
    states = [network.encode(labels, front) for network in (faint, strong)]
    assert torch.equal(states[0][:, :-1], states[1][:, :-1])
    assert torch.allclose(states[0][:, -1] * FRONT_AMPLITUDE, states[1][:, -1])
    with torch.no_grad():
        embedded = [
            network.embed_state(torch.nn.functional.pixel_unshuffle(state, FAINT.patch_px))
            for network, state in zip((faint, strong), states, strict=True)
        ]
    assert torch.allclose(*embedded, atol=1e-5)


def test_the_expected_front_is_that_of_items_and_bare_floor():
    torch.manual_seed(0)
    network = LayoutNetwork(TINY)
    said = torch.zeros(1, network.class_count + 1, 1, 3)
    said[0, 3, 0, :2] = 40.0
    said[0, 0, 0, 2] = 40.0
    said[0, -1, 0] = torch.tensor([40.0, -40.0, 40.0])
    front = network.expected_state(said)[0, -1, 0]
    assert torch.allclose(front, FRONT_AMPLITUDE * torch.tensor([1.0, -1.0, -1.0]))


def test_the_expected_front_is_as_likely_as_the_item_is():
    torch.manual_seed(0)
    network = LayoutNetwork(TINY)
    even = torch.full((1, network.class_count + 1, 1, 1), -40.0)
    even[0, [0, 3, -1]] = torch.tensor([0.0, 0.0, 40.0])[:, None, None]
    assert network.expected_state(even)[0, -1].abs().max() < 1e-5
