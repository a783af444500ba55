"""The list network: learned, resumed, exported, and drawn from without torch."""

from __future__ import annotations

import json
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
import torch
from torch.nn import functional

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.networks import load_network
from chord_usd.base.scene.types import Box
from chord_usd.cli import main
from chord_usd.line.lists import pieces
from chord_usd.line.lists.list_sampler import Subject, load_lists
from chord_usd.line.lists.pieces import PIECES
from chord_usd.line.lists.things import load_lister
from chord_usd.line.lists.vocabulary import NOTHING
from chord_usd.workshop.data.tabletops import random_tabletop
from chord_usd.workshop.training.lists_data import (
    batch_of,
    endless_batches,
    endless_houses,
    held_out,
)
from chord_usd.workshop.training.lists_network import Drawing, ListNetwork
from chord_usd.workshop.training.lists_trainer import (
    ListTraining,
    Task,
    batch_loss,
    train_lists,
    write_checkpoint,
)

EXAMPLES = held_out(4)


@pytest.fixture(scope="module")
def network() -> ListNetwork:
    torch.manual_seed(0)
    return ListNetwork(PIECES, channels=32, layers=1, heads=2).eval()


@pytest.fixture(scope="module")
def folder(network: ListNetwork, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("lists")
    write_checkpoint(path, network, PIECES, {})
    return path


def test_positions_do_not_see_what_comes_after_them(network: ListNetwork) -> None:
    segments, facts, flags, roles, left, values = batch_of(EXAMPLES[:6])
    whole = network(segments, facts, flags, roles, left, values)
    for cut in (1, 3, values.shape[1] - 1):
        part = network(segments, facts, flags, roles[:, :cut], left[:, :cut], values[:, :cut])
        assert torch.allclose(whole[:, :cut], part, atol=1e-4)


def test_padding_changes_nothing(network: ListNetwork) -> None:
    together = network(*batch_of(EXAMPLES[:8])).sum(dim=1)
    alone = [float(network(*batch_of([example])).detach().sum()) for example in EXAMPLES[:8]]
    assert together.tolist() == pytest.approx(alone, abs=1e-3)


def test_the_order_of_what_lies_around_does_not_matter(network: ListNetwork) -> None:
    segments, *others = batch_of(EXAMPLES[:4])
    shuffled = segments[:, torch.randperm(segments.shape[1])]
    assert torch.allclose(network(segments, *others), network(shuffled, *others), atol=1e-4)


def test_drawing_knows_the_chances_that_training_sees(network: ListNetwork) -> None:
    """What is given is kept, and all chances add up to those of the whole list."""
    batch = batch_of(EXAMPLES[:5])
    segments, facts, flags, roles, left, values = batch
    noise = torch.zeros(5, len(PIECES.slots), PIECES.size)
    drawing, total = Drawing(network), torch.zeros(5)
    there, known = torch.ones(5, 0, dtype=torch.bool), [torch.zeros(5, 2, 0, 16)] * 2
    padded = functional.pad(values, (0, 0, 1, 0))
    for at in range(values.shape[1]):
        around = segments if not at else segments[:, :0]
        new = torch.arange(int(at > 0), around.shape[1] + 2)
        place = torch.tensor([at])
        kept, chances, there, *known = drawing(
            around, facts, flags, roles[:, at, None], left[:, at, None], padded[:, at : at + 2],
            noise, place, new, there, *known,
        )  # fmt: skip
        held = values[:, at] != NOTHING
        assert torch.equal(kept[held], values[:, at][held])
        total += (chances * held).sum(dim=1)
    assert torch.allclose(total, network(*batch).sum(dim=1), atol=1e-3)


def test_without_torch_the_same_is_drawn(network: ListNetwork, folder: Path) -> None:
    segments, facts, flags, roles, left, values = batch_of(EXAMPLES[:3])
    values[:, -1] = NOTHING
    noise = torch.randn(3, len(PIECES.slots), PIECES.size, generator=torch.manual_seed(1))
    halves = {name: t.half().float() for name, t in network.state_dict().items()}
    rounded = ListNetwork(PIECES, channels=32, layers=1, heads=2).eval()
    rounded.load_state_dict(halves)
    count, length = values.shape[:2]
    padded = functional.pad(values, (0, 0, 1, 0))
    new = torch.arange(1 + segments.shape[1] + length)
    known = (torch.zeros(count, 2, 0, 16), torch.zeros(count, 2, 0, 16))
    arrays = (segments, facts, flags, roles, left, padded, noise, torch.arange(length), new,
              torch.ones(count, 0, dtype=torch.bool), *known)  # fmt: skip
    runner = load_network(folder, "")
    drawn, chances, *_ = runner.run(
        {name: a.numpy() for name, a in zip(runner.shapes(), arrays, strict=True)}
    )
    expected = Drawing(rounded)(*arrays)
    assert np.array_equal(drawn, expected[0].numpy())
    assert np.allclose(chances, expected[1].detach().numpy(), atol=1e-3)


def test_a_checkpoint_furnishes_rooms(folder: Path) -> None:
    arounds = [example.around for example in EXAMPLES[:5]]
    subjects = [Subject(pieces.segments_of(one), one.facts, one.flags) for one in arounds]
    drawer = load_lists(folder, PIECES)
    first, again = (drawer.draw(subjects, np.random.default_rng(3)) for _ in range(2))
    assert first == again
    for around, drawn in zip(arounds, first, strict=True):
        assert drawn.likelihood < 0.0
        for item in pieces.items_from(drawn.elements, around, "r"):
            assert min(item.box.size_m) > 0.0


def test_a_damaged_checkpoint_says_so(folder: Path, tmp_path: Path) -> None:
    for file in folder.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes()[:100])
    with pytest.raises(CheckpointError):
        load_lists(tmp_path, PIECES)


def test_a_few_steps_learn_and_a_run_goes_on(tmp_path: Path) -> None:
    config = ListTraining(minutes=0.05, batch=8, warmup_steps=1)
    held = batch_of(EXAMPLES[:4])
    task = Task(PIECES, partial(endless_batches, [], 8, pool=50), held)
    first, again = (train_lists(config, tmp_path, task) for _ in range(2))
    assert again["steps"] > first["steps"]
    described = json.loads((tmp_path / "checkpoint" / "config.json").read_text())
    assert described["training"]["steps"] == again["steps"]
    torch.manual_seed(0)
    fresh = ListNetwork(PIECES)
    with torch.inference_mode():
        assert again["held_out_nats"] < float(batch_loss(fresh, held).mean())


def test_batches_depend_on_the_seed_alone() -> None:
    def some(seed: int) -> list[torch.Tensor]:
        batches = endless_batches([], 4, seed, pool=30)
        return [part for _ in range(3) for part in next(batches)]

    assert all(map(torch.equal, some(1), some(1)))
    pairs = zip(some(1), some(2), strict=True)
    assert not all(a.shape == b.shape and torch.equal(a, b) for a, b in pairs)


def test_few_houses_come_again_and_again() -> None:
    rng = np.random.default_rng(0)
    houses = [house for house, _ in islice(endless_houses([], rng, 3), 12)]
    assert len({tuple(item.box.center_m for item in house.items) for house in houses}) == 3


def test_things_have_no_number_of_houses(capsys: pytest.CaptureFixture[str]) -> None:
    command = ["train", "lists", "--of", "things", "-o", "never/", "--houses", "3"]
    assert main(command) == 2
    assert capsys.readouterr().err.startswith("error: --houses, --furnished")
    assert not Path("never").exists()


def test_lists_alone_are_scored(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["evaluate", "layouts", "--lists", str(folder), "--unpainted", "2", "--n", "2"]
    assert main([*command, "--no-fid", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["steps"] == 0
    house = found["rows"]["house"]
    assert house["complete"]["over"] == "rooms judged"
    assert house["complete_houses"]["count"] == 2


@pytest.mark.acceptance
def test_a_run_is_started_from_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["train", "lists", "-o", str(tmp_path / "run"), "--minutes", "0.01"]
    assert main([*command, "--batch", "2", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["steps"] >= 1
    assert load_lists(Path(found["checkpoint"]), PIECES).content_hash


def test_things_on_tops_are_learned_and_drawn_by_the_same_network(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["train", "lists", "--of", "things", "-o", str(tmp_path / "run"), "--minutes", "0.01"]
    assert main([*command, "--batch", "2", "--json"]) == 0
    lister = load_lister(Path(json.loads(capsys.readouterr().out)["checkpoint"]))
    tops = [random_tabletop(np.random.default_rng(seed)).top for seed in range(4)]

    def boxes(count: int, seeds: list[int]) -> list[list[tuple[str, Box]]]:
        found = lister.things(tops[:count], seeds)
        return [[(item.category, item.box) for item in items] for items in found]

    together = boxes(4, [1, 2, 3, 4])
    assert together == boxes(4, [1, 2, 3, 4])
    assert together != boxes(4, [5, 6, 7, 8])
    assert boxes(2, [1, 2]) == together[:2], "a top's seed alone varies its own"
