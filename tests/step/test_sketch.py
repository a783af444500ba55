"""The sketching network: learned, exported, and asked for what a wish says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.scene.palette import ROOM_RGB
from chord_usd.base.scene.wish import Wish
from chord_usd.line.pipeline.planner import SKETCH_CHECKPOINT
from chord_usd.line.planning import sketch_tokens as tokens
from chord_usd.line.planning.floor_sheet import on_sheet, sheet_for_area, shell_sheet, slips
from chord_usd.line.planning.outline import open_shell
from chord_usd.line.planning.sketcher import GRAPH_INPUTS, Sketcher, load_sketcher, open_ground
from chord_usd.workshop.evaluation.floors import held_out_cases
from chord_usd.workshop.evaluation.sketch_sheet import draw_sketches
from chord_usd.workshop.training.sketch_data import Procedural, batch_of, endless_batches, held_out
from chord_usd.workshop.training.sketch_trainer import (
    SketchNetwork,
    SketchTraining,
    batch_loss,
    train_sketches,
)

HOUSES = Procedural(40, 0)


@pytest.fixture(scope="module")
def sketcher() -> Sketcher:
    return load_sketcher(checkpoint_folder(SKETCH_CHECKPOINT))


def test_a_slot_sees_only_what_was_told_before() -> None:
    torch.manual_seed(0)
    network = SketchNetwork().eval()
    shell, roles, left, values = batch_of([HOUSES[0], HOUSES[1]])
    with torch.inference_mode():
        before = network(shell, roles, left, values)
        place = tokens.HEADING + 1
        changed = values.clone()
        changed[:, place, 1] = tokens.value_range(int(roles[0, place]), 1)[0] + 3
        after = network(shell, roles, left, changed)
    assert torch.allclose(before[:, :place], after[:, :place], atol=1e-5)
    assert torch.allclose(before[:, place, :2], after[:, place, :2], atol=1e-5)
    assert not torch.allclose(before[:, place, 2], after[:, place, 2], atol=1e-5)
    assert not torch.allclose(before[:, place + 1], after[:, place + 1], atol=1e-5)


def test_it_learns_and_goes_on_where_it_stopped(tmp_path: Path) -> None:
    torch.manual_seed(0)
    first = batch_loss(SketchNetwork(), batch_of(HOUSES)).mean().item()
    config = SketchTraining(minutes=0.1, batch=16, warmup_steps=3)
    facts = train_sketches(config, tmp_path, HOUSES, [], held_out(10))
    assert facts["held_out_nats"] < first
    again = train_sketches(SketchTraining(minutes=0.001, batch=4), tmp_path, HOUSES, [], [])
    assert again["steps"] > facts["steps"]
    found = load_sketcher(tmp_path / "checkpoint").sketch(Wish(), open_ground(), 2, 0)
    assert len(found) == 2


def test_the_graph_computes_what_the_network_computes(tmp_path: Path) -> None:
    config = SketchTraining(minutes=0.001, batch=2)
    train_sketches(config, tmp_path, HOUSES, [], [])
    from safetensors.torch import load_file

    network = SketchNetwork().eval()
    weights = load_file(tmp_path / "checkpoint" / "weights.safetensors")
    network.load_state_dict({name: tensor.float() for name, tensor in weights.items()})
    batch = batch_of([HOUSES[at] for at in range(3)])
    with torch.inference_mode():
        expected = network(*batch).numpy()
    inputs = {name: part.numpy() for name, part in zip(GRAPH_INPUTS, batch, strict=True)}
    (found,) = load_sketcher(tmp_path / "checkpoint")._network.run(inputs)
    assert np.abs(found - expected).max() < 1e-3


def test_only_houses_that_are_learned_from_are_drawn() -> None:
    """A run of a step takes no longer for the number of its houses."""
    first = [next(endless_batches(Procedural(10**7, 0), [], 0.0, 4, 3)) for _ in range(2)]
    assert all(torch.equal(one, other) for one, other in zip(*first, strict=True))


def test_a_sheet_shows_what_is_sketched(sketcher: Sketcher, tmp_path: Path) -> None:
    draw_sketches(sketcher, held_out_cases(1, aligned=True), tmp_path / "sheet.png")
    sheet = np.asarray(Image.open(tmp_path / "sheet.png").convert("RGB"))
    assert (sheet == ROOM_RGB["bedroom"]).all(axis=2).any()


def test_houses_are_turned_with_their_shells() -> None:
    """Bubbles stay inside the cells of the house, in every pose."""
    for shell, roles, _, values in (next(endless_batches(HOUSES, [], 0.0, 64, 3)),):
        for line in range(len(roles)):
            if not shell[line].any():
                continue
            along = tokens.SHELL_CELLS // 8
            grid = shell[line].reshape(along, along, tokens.SHELL_MARKS, 8, 8)
            house = grid.permute(2, 0, 3, 1, 4).reshape(tokens.SHELL_MARKS, 32, 32)[0]
            told = values[line, :, 0] != tokens.NOTHING
            told[: tokens.HEADING] = False
            for one in tokens.bubbles_from(roles[line][told].numpy(), values[line][told].numpy()):
                column, row = (int(16 + v / tokens.CELL_M) for v in (one.x_m, -one.y_m))
                assert house[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2].any()


def test_what_is_asked_for_is_what_is_sketched(sketcher: Sketcher) -> None:
    wish = Wish({"bedroom": 3, "kitchen": 1, "study": 0}, 90.0)
    for sketch in sketcher.sketch(wish, open_ground(), 8, 1):
        assert {kind: sketch.counts[kind] for kind in wish.counts} == wish.counts
        assert sum(one.kind == "bedroom" for one in sketch.bubbles) == 3
        assert sketch.area_m2 == pytest.approx(90.0, rel=0.05)
        assert len(sketch.bubbles) == sum(sketch.counts.values())


def test_most_sketches_could_be_houses(sketcher: Sketcher) -> None:
    sketches = sketcher.sketch(Wish({"bedroom": 2}, 70.0), open_ground(), 16, 0)
    sheet = sheet_for_area(70.0)
    clean = sum(not slips(sheet, one.bubbles) for one in sketches)
    assert clean >= 15
    from chord_usd.workshop.data.houses import random_plan

    shell, patches = shell_sheet(open_shell(random_plan(np.random.default_rng(1))))
    within = [
        slips(shell, on_sheet(shell, one.bubbles))
        for one in sketcher.sketch(Wish(), patches, 16, 0)
    ]
    assert sum(not count for count in within) >= 14


def test_same_seed_same_sketches(sketcher: Sketcher) -> None:
    one, two, other = (sketcher.sketch(Wish(), open_ground(), 2, seed) for seed in (5, 5, 6))
    assert one == two != other


def test_a_folder_without_weights_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(CheckpointError):
        load_sketcher(tmp_path)
