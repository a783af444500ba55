"""The network that reads pages: learned, resumed, exported, and run without torch."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from chord_usd.base.errors import CheckpointError
from chord_usd.base.raster.page_labels import BUILT_NAMES, KIND_NAMES, READER_INPUT
from chord_usd.base.runtime.networks import load_network
from chord_usd.cli import main
from chord_usd.line.plan.segment import load_reader
from chord_usd.workshop.training.reader_data import (
    CROP_PX,
    PageStream,
    batch_of,
    crop_of,
    heat_of,
    held_out,
    posed,
)
from chord_usd.workshop.training.reader_network import OUTPUTS, ReaderNetwork, Reading
from chord_usd.workshop.training.reader_trainer import (
    ReaderTraining,
    batch_losses,
    score,
    train_reader,
    write_checkpoint,
)

SMALL = (8, 8, 16, 16, 16)
CROPS = held_out(2)


@pytest.fixture(scope="module")
def network() -> ReaderNetwork:
    torch.manual_seed(0)
    network = ReaderNetwork(SMALL)
    network.train()
    with torch.no_grad():  # so that normalisation has something to undo
        for _ in range(3):
            network(torch.randn(2, 3, 64, 64) * 0.5 + 0.3)
    return network.eval()


@pytest.fixture(scope="module")
def folder(network: ReaderNetwork, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("reader")
    write_checkpoint(path, network, {})
    return path


def test_fusing_changes_nothing(network: ReaderNetwork) -> None:
    rgb = torch.rand(1, 3, 96, 64) * 2 - 1
    with torch.inference_mode():
        built = network(rgb)[0].split(OUTPUTS, dim=1)[0].softmax(dim=1)
        assert torch.allclose(built, Reading(network).eval()(rgb)[0], atol=1e-4)


def test_without_torch_the_same_is_seen(network: ReaderNetwork, folder: Path) -> None:
    rgb = torch.rand(1, 3, 160, 96) * 2 - 1
    with torch.inference_mode():
        expected = Reading(network).eval()(rgb)
    seen = load_network(folder, "").run({READER_INPUT: rgb.numpy()})
    for one, other in zip(seen, expected, strict=True):
        assert np.allclose(one, other.numpy(), atol=5e-3)


def test_pictures_of_any_shape_are_read(folder: Path) -> None:
    reader = load_reader(folder)
    rng = np.random.default_rng(0)
    for shape in ((300, 200), (40, 900), (5, 3), (1500, 2)):
        seen = reader.read(rng.integers(0, 256, (*shape, 3), dtype=np.uint8))
        assert seen.most_likely.shape == shape
        assert seen.kinds.shape == (len(KIND_NAMES), *shape)
        assert np.allclose(seen.built.sum(axis=0), 1.0, atol=1e-3)
        assert seen.barrier.min() > -1e-3


def test_tiles_join_without_seams(folder: Path) -> None:
    """A picture wider than a tile, of one colour: the same everywhere but at its edges."""
    seen = load_reader(folder)._at(np.full((600, 1400, 3), 200, np.uint8))
    inner = seen[: len(BUILT_NAMES), 200:400:7, 200:1200:7]
    assert np.ptp(inner, axis=(1, 2)).max() < 0.05


def test_a_damaged_checkpoint_says_so(folder: Path, tmp_path: Path) -> None:
    for file in folder.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes()[:100])
    with pytest.raises(CheckpointError):
        load_reader(tmp_path)


def test_poses_move_points_with_their_pixels() -> None:
    """Heat drawn before and after a pose is the same heat in that pose."""
    crop = CROPS[0]
    found = set()
    for seed in range(12):
        moved = posed(crop, np.random.default_rng(seed))
        for name, change in (
            ("same", lambda heat: heat),
            ("flipped", lambda heat: heat[:, :, ::-1]),
            ("turned", lambda heat: heat.transpose(0, 2, 1)),
            ("both", lambda heat: heat[:, :, ::-1].transpose(0, 2, 1)),
        ):
            labels = change(crop.labels[None])[0]
            if np.array_equal(labels, moved.labels):
                difference = change(heat_of(crop.points)).astype(int) - heat_of(moved.points)
                assert np.mean(np.abs(difference) > 90) < 2e-3
                found.add(name)
    assert len(found) == 4


def test_batches_depend_on_the_seed_alone() -> None:
    def some(seed: int) -> list[torch.Tensor]:
        stream = iter(PageStream(2, seed, pool=3))
        return [part for _ in range(2) for part in next(stream)]

    assert all(map(torch.equal, some(1), some(1)))
    assert not all(map(torch.equal, some(1), some(2)))


def test_losses_are_finite_and_a_perfect_score_is_one(network: ReaderNetwork) -> None:
    batch = batch_of(CROPS)
    losses = batch_losses(network, batch)
    assert losses.shape == (5,)
    assert bool(torch.isfinite(losses).all())
    found = score(network, CROPS, "cpu")
    assert found["crops"] == 2
    assert all(0.0 <= found[name] <= 1.0 for name in found if name != "crops")
    assert batch[0].shape == (2, 3, CROP_PX, CROP_PX)


def test_a_few_steps_learn_and_a_run_goes_on(tmp_path: Path) -> None:
    config = ReaderTraining(minutes=0.05, batch=1, workers=0, warmup_steps=1)
    first, again = (train_reader(config, tmp_path, CROPS[:1], channels=SMALL) for _ in range(2))
    assert again["steps"] > first["steps"]
    described = json.loads((tmp_path / "checkpoint" / "config.json").read_text())
    assert described["training"]["steps"] == again["steps"]
    assert described["labels"]["built"] == list(BUILT_NAMES)
    assert load_reader(tmp_path / "checkpoint").content_hash


def test_small_pages_are_cropped_too() -> None:
    from chord_usd.workshop.data.drawn.crowded import draw_page

    rng = np.random.default_rng(0)
    for side in (100.0, 700.0):
        crop = crop_of(draw_page(5), side, rng)
        assert crop.rgb.shape == (CROP_PX, CROP_PX, 3)
        assert crop.labels.any()


@pytest.mark.acceptance
def test_a_run_is_started_from_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["train", "reader", "-o", str(tmp_path / "run"), "--minutes", "0.01"]
    assert main([*command, "--batch", "1", "--workers", "0", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["steps"] >= 1
    assert load_reader(Path(found["checkpoint"])).content_hash
