"""The training loop: it learns, it can be interrupted, it comes back where it was."""

import errno
import os
from dataclasses import replace

import numpy as np
import pytest
import torch

from chord_usd.base.errors import CheckpointError
from chord_usd.base.raster import canvas
from chord_usd.line.layout.checkpoint import load_checkpoint
from chord_usd.line.layout.config import PRESETS, LayoutConfig
from chord_usd.line.layout.draft import CLASS_COUNT
from chord_usd.workshop.training import weights as training_state
from chord_usd.workshop.training.sheets import draw_sheet
from chord_usd.workshop.training.stream import (
    LayoutStream,
    StreamConfig,
    batch_loader,
)
from chord_usd.workshop.training.trainer import PAPER_TRAINING, LayoutTrainer, TrainingConfig

pytestmark = pytest.mark.long

TINY = replace(
    PRESETS["default"], channels=(16, 32), attention=(False, False), feature_channels=16,
    default_steps=2,
)  # fmt: skip
TINY_PAPER = replace(
    PRESETS["paper"], patch_px=8, channels=(16, 32), attention=(False, False), blocks_per_level=1
)
QUICK = TrainingConfig(minutes=0.02, batch=2, workers=0, warmup_steps=5, learning_rate=3e-3)


def _houses(config: LayoutConfig = TINY, seed: int = 0) -> LayoutStream:
    return LayoutStream(StreamConfig(seed=seed), [], config, QUICK.batch)


@pytest.fixture(autouse=True)
def _no_sheets(monkeypatch):
    """A sheet costs seconds of sampling; it has a test of its own."""
    monkeypatch.setattr(LayoutTrainer, "_draw_sheet", lambda _self, _stream: None)


@pytest.mark.parametrize(
    ("config", "left"), [(TINY, 0.5), (TINY_PAPER, 0.99)], ids=["codes", "paper"]
)
def test_one_batch_is_learned(tmp_path, config: LayoutConfig, left: float):
    """left: how much of the first loss remains; noise prediction starts at 1 and falls slowly."""
    trainer = LayoutTrainer(config, replace(QUICK, minutes=30.0), tmp_path)
    batch = next(iter(batch_loader(_houses(config, seed=1), workers=0)))
    losses = [float(trainer._step(batch)["loss"].detach()) for _ in range(50)]
    assert np.mean(losses[-10:]) < left * np.mean(losses[:5])


def test_an_interrupted_run_is_taken_up_where_it_was(tmp_path):
    first = LayoutTrainer(TINY, QUICK, tmp_path)
    first.train(_houses(), lambda row: None)
    second = LayoutTrainer(TINY, QUICK, tmp_path)
    assert second.resume()
    assert second.step == first.step
    assert second.minutes_before == pytest.approx(first.minutes, abs=0.1)
    for name, tensor in first.network.state_dict().items():
        assert torch.equal(tensor, second.network.state_dict()[name])
    for name, tensor in first.average.state_dict().items():
        assert torch.allclose(tensor, second.average.state_dict()[name], rtol=2e-3, atol=1e-6)
    moments = [
        trainer.weights.optimiser.state[next(trainer.network.parameters())]
        for trainer in (first, second)
    ]
    assert float(moments[0]["step"]) == float(moments[1]["step"])
    for key in ("exp_avg", "exp_avg_sq"):
        # Eight bits a value: within 2 % of the largest of each block.
        assert torch.allclose(
            moments[0][key],
            moments[1][key],
            rtol=0.0,
            atol=0.02 * float(moments[0][key].abs().max()),
        )
    second.train(_houses(), lambda row: None)
    assert second.step > first.step
    assert not LayoutTrainer(TINY, QUICK, tmp_path / "empty").resume()


def test_shards_are_small_and_come_back_whole(tmp_path, monkeypatch):
    monkeypatch.setattr(training_state, "MAX_SHARD_BYTES", 2**18 + 4000)
    tensors = {"big": torch.randn(50, 60), "small": torch.arange(7), "none": torch.zeros(0, 3)}
    training_state.save_state(tmp_path / "state", tensors, {"step": 3})
    files = list((tmp_path / "state").glob("*.safetensors"))
    assert len(files) > 2
    assert max(file.stat().st_size for file in files) < training_state.MAX_SHARD_BYTES
    found, counters = training_state.load_state(tmp_path / "state", "cpu")
    assert counters == {"step": 3}
    for name, tensor in tensors.items():
        assert torch.equal(found[name], tensor)


def test_a_save_that_was_cut_short_leaves_the_one_before(tmp_path):
    training_state.save_state(tmp_path / "state", {"w": torch.ones(2)}, {"step": 1})
    (tmp_path / "state").rename(tmp_path / "state.old")
    (tmp_path / "state.part").mkdir()
    found = training_state.load_state(tmp_path / "state", "cpu")
    assert found is not None
    assert found[1] == {"step": 1}


def _no_room(_tensors: object) -> bytes:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_a_state_that_finds_no_room_leaves_the_one_before(tmp_path, monkeypatch):
    training_state.save_state(tmp_path / "state", {"w": torch.ones(2)}, {"step": 1})
    monkeypatch.setattr(training_state, "save", _no_room)
    with pytest.raises(OSError, match="No space left"):
        training_state.save_state(tmp_path / "state", {"w": torch.zeros(2)}, {"step": 2})
    _, counters = training_state.load_state(tmp_path / "state", "cpu")
    assert counters == {"step": 1}
    assert [one.name for one in tmp_path.iterdir()] == ["state"]


def test_a_damaged_shard_is_named(tmp_path):
    training_state.save_state(tmp_path / "state", {"w": torch.ones(2)}, {})
    (tmp_path / "state" / "00.safetensors").write_bytes(b"broken")
    with pytest.raises(CheckpointError, match="damaged"):
        training_state.load_state(tmp_path / "state", "cpu")


def test_the_checkpoint_is_the_moving_average_and_says_how_it_was_trained(tmp_path):
    trainer = LayoutTrainer(TINY, QUICK, tmp_path)
    trainer.train(_houses(), lambda row: None)
    loaded = load_checkpoint(tmp_path / "checkpoint")
    assert loaded.training["steps"] == trainer.step
    for name, tensor in trainer.average.state_dict().items():
        assert torch.allclose(loaded.network.state_dict()[name], tensor, atol=1e-2, rtol=1e-2)
    warm = LayoutTrainer(TINY, QUICK, tmp_path / "warm")
    warm.warm_start(tmp_path / "checkpoint")
    assert warm.step == trainer.step


def test_samples_hold_what_the_network_needs():
    sample = next(iter(batch_loader(LayoutStream(StreamConfig(seed=5), [], TINY, 3), workers=0)))
    height, width = sample["labels"].shape[1:]
    assert sample["labels"].shape[0] == 3
    assert height % TINY.window_multiple_px == width % TINY.window_multiple_px == 0
    assert sample["grid"].shape[2:] == (height // TINY.patch_px, width // TINY.patch_px)
    assert int(sample["labels"].max()) < CLASS_COUNT
    assert bool((sample["labels"][sample["front"]] > 0).all()), "marks lie on items"
    inside = sample["pixels"][:, 3] > 0
    assert bool((inside | (sample["labels"] == 0)).all()), "items stand on floor"


def test_the_stream_is_seeded_and_workers_differ():
    def first_labels(seed: int) -> np.ndarray:
        stream = LayoutStream(StreamConfig(seed=seed), [], TINY, 1)
        return next(iter(batch_loader(stream, workers=0)))["labels"].numpy()

    assert np.array_equal(first_labels(1), first_labels(1))
    assert not np.array_equal(first_labels(1), first_labels(2))


def test_few_houses_come_again_and_again():
    stream = LayoutStream(StreamConfig(seed=0, procedural=2), [], TINY, 1)
    rng = np.random.default_rng(0)
    houses = [stream._furnished_house(rng) for _ in range(8)]
    assert len({tuple(item.box.center_m for item in house.items) for house in houses}) == 2


def test_a_furnished_house_is_drawn_as_often_as_is_asked(monkeypatch):
    """And seldom twice in one batch."""
    made = iter(range(10**6))
    monkeypatch.setattr(LayoutStream, "_furnished_house", lambda self, rng: next(made))
    stream = LayoutStream(StreamConfig(uses=4), [], TINY, 1)
    rng = np.random.default_rng(0)
    drawn = [stream._house(rng) for _ in range(8000)]
    assert len(drawn) / len(set(drawn)) == pytest.approx(4, rel=0.1)
    batches = np.array(drawn).reshape(-1, 8)
    assert np.mean([len(set(batch)) for batch in batches]) > 7


def test_learning_rate_warms_up_and_cools_down(tmp_path):
    trainer = LayoutTrainer(TINY, replace(QUICK, minutes=10.0, warmup_steps=10), tmp_path)
    trainer.weights.taken = 4
    assert trainer._learning_rate() == pytest.approx(0.5 * QUICK.learning_rate)
    trainer.weights.taken = 100
    assert trainer._learning_rate() == pytest.approx(QUICK.learning_rate, rel=1e-3)
    trainer.budget.started -= 10 * 60
    assert trainer._learning_rate() == pytest.approx(0.05 * QUICK.learning_rate, rel=1e-3)


def test_paper_training_divides_the_rate_by_ten_every_hundred_epochs(tmp_path):
    trainer = LayoutTrainer(TINY_PAPER, PAPER_TRAINING, tmp_path)
    assert PAPER_TRAINING.batch == 4
    assert trainer._learning_rate() == pytest.approx(1e-4)
    trainer.step = PAPER_TRAINING.decay_every_steps
    assert trainer._learning_rate() == pytest.approx(1e-5)


def test_a_sheet_shows_truth_and_two_samples_of_each_plan(tmp_path):
    trainer = LayoutTrainer(TINY, QUICK, tmp_path)
    draw_sheet(trainer.average, tmp_path / "sheet.png", torch.device("cpu"), _houses().held_out(1))
    import cv2

    rows, columns, _ = cv2.imread(str(tmp_path / "sheet.png")).shape
    assert rows == 3 * columns
    assert columns > 2 * canvas.CANVAS_PX
