"""The box diffusion: boxes as numbers and back, learned, resumed, drawn and scored as lists are."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import torch

from chord_usd.base.errors import CheckpointError
from chord_usd.cli import main
from chord_usd.line.lists import pieces
from chord_usd.line.lists.list_sampler import Subject
from chord_usd.line.lists.pieces import PIECES
from chord_usd.workshop.training.boxes_data import elements_of, slots_of
from chord_usd.workshop.training.boxes_network import NOISE_STEPS, BoxNetwork, Surroundings
from chord_usd.workshop.training.boxes_sampler import load_boxes
from chord_usd.workshop.training.boxes_trainer import denoising_losses, train_boxes
from chord_usd.workshop.training.lists_data import batch_of, endless_batches, held_out
from chord_usd.workshop.training.lists_trainer import ListTraining

EXAMPLES = held_out(4)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of a few steps, gone on with once."""
    folder = tmp_path_factory.mktemp("boxes") / "run"
    config = ListTraining(minutes=0.05, batch=8, warmup_steps=1)
    batches, held = partial(endless_batches, [], 8, pool=50), batch_of(EXAMPLES[:8])
    first, again = (train_boxes(config, folder, batches, held) for _ in range(2))
    assert again["steps"] > first["steps"]
    torch.manual_seed(0)
    with torch.inference_mode():
        fresh = denoising_losses(BoxNetwork(), held, torch.Generator().manual_seed(0))
    assert again["held_out_category"] < float(fresh["category"])
    return folder


def test_rooms_come_back_from_slots() -> None:
    slots = slots_of(batch_of(EXAMPLES)).numpy()
    for example, own in zip(EXAMPLES, slots, strict=True):
        told = pieces.pieces_of(example.items, example.around.frame)
        assert sorted(elements_of(own)) == sorted(told[: PIECES.most])


def test_slots_have_no_order() -> None:
    network = BoxNetwork(channels=32, layers=1, heads=2).eval()
    batch = batch_of(EXAMPLES[:4])
    noisy, times = torch.randn_like(slots_of(batch)), torch.tensor([1, 300, 700, NOISE_STEPS - 1])
    order = torch.randperm(noisy.shape[1])
    with torch.inference_mode():
        plain = network(noisy, times, Surroundings(*batch[:3]))
        shuffled = network(noisy[:, order], times, Surroundings(*batch[:3]))
    for one, other in zip(plain, shuffled, strict=True):
        assert torch.allclose(one[:, order], other, atol=1e-4)


def test_a_checkpoint_furnishes_rooms_with_what_is_wanted(run: Path) -> None:
    arounds = [example.around for example in EXAMPLES[:5]]
    wanted, every = (3, 3, 7), frozenset(range(len(PIECES.categories)))
    subjects = [
        Subject(pieces.segments_of(one), one.facts, one.flags, wanted, every) for one in arounds
    ]
    drawer = load_boxes(run / "checkpoint")
    first, again = (drawer.draw(subjects, np.random.default_rng(3)) for _ in range(2))
    assert first == again
    for around, drawn in zip(arounds, first, strict=True):
        assert [one.category for one in drawn.elements] == list(wanted)
        for item in pieces.items_from(drawn.elements, around, "r"):
            assert min(item.box.size_m) > 0.0


def test_boxes_are_scored_as_lists_are(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["evaluate", "layouts", "--boxes", str(run / "checkpoint"), "--n", "2", "--no-fid"]
    assert main(command) == 2, "nothing paints over boxes"
    capsys.readouterr()
    assert main([*command, "--unpainted", "2", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["made_by"] == load_boxes(run / "checkpoint").content_hash
    assert found["rows"]["house"]["complete_houses"]["count"] == 2


def test_weights_of_another_network_say_so(run: Path, tmp_path: Path) -> None:
    from chord_usd.workshop.training.loop import write_weights

    write_weights(tmp_path, BoxNetwork(channels=32), {})
    with pytest.raises(CheckpointError):
        load_boxes(tmp_path)


def test_a_run_counts_the_processor_time_of_its_process(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["train", "boxes", "-o", str(tmp_path / "run"), "--minutes", "0.01", "--batch", "2"]
    assert main([*command, "--processor-time", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["steps"] >= 1
    assert found["processor_time"] is True
