"""The network that finds drawn furniture: learned, resumed, exported, and run without torch."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from chord_usd.base.errors import CheckpointError
from chord_usd.base.raster.page_labels import PIECE_NAMES, PIECE_STEP_PX, READER_INPUT
from chord_usd.base.runtime.networks import load_network
from chord_usd.base.scene.geometry import front_direction
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import PixelFrame
from chord_usd.line.plan.seen_pieces import SeenPiece, as_items, load_finder
from chord_usd.workshop.data.drawn.furniture_symbols import DRAWN
from chord_usd.workshop.training.symbols_data import (
    CROP_PX,
    Crop,
    SymbolStream,
    held_out,
    posed,
    targets_of,
)
from chord_usd.workshop.training.symbols_network import Finding, SymbolsNetwork, take_up
from chord_usd.workshop.training.symbols_trainer import (
    SymbolsTraining,
    score,
    train_symbols,
    write_checkpoint,
)

CROPS = held_out(2)


@pytest.fixture(scope="module")
def network() -> SymbolsNetwork:
    torch.manual_seed(0)
    return SymbolsNetwork().eval()


@pytest.fixture(scope="module")
def folder(network: SymbolsNetwork, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("symbols")
    write_checkpoint(path, network, {})
    return path


def test_without_torch_the_same_is_seen(network: SymbolsNetwork, folder: Path) -> None:
    rgb = torch.rand(1, 3, 160, 96) * 2 - 1
    with torch.inference_mode():
        expected = Finding(network).eval()(rgb)
    seen = load_network(folder, "").run({READER_INPUT: rgb.numpy()})
    for one, other in zip(seen, expected, strict=True):
        assert np.allclose(one, other.numpy(), atol=5e-3)


def test_it_begins_with_what_the_reader_has_learned() -> None:
    from chord_usd.base.runtime.locations import checkpoint_folder
    from chord_usd.base.runtime.networks import read_weights

    stored = read_weights(checkpoint_folder("reader") / "weights.safetensors", "")
    weights = {name: torch.from_numpy(value).float() for name, value in stored.items()}
    network = SymbolsNetwork()
    take_up(network, weights)
    assert torch.equal(network.down[2][0][0].weight, weights["down.2.0.0.weight"])
    with pytest.raises(KeyError):
        take_up(network, {"elsewhere": torch.zeros(1)})


def test_pictures_of_any_shape_are_searched(folder: Path) -> None:
    finder = load_finder(folder)
    rng = np.random.default_rng(0)
    for shape in ((300, 200), (40, 900), (5, 3), (1500, 20)):
        rgb = rng.integers(0, 256, (*shape, 3), dtype=np.uint8)
        for piece in finder.find(rgb, 0.02, 0.0)[:50]:
            assert piece.category in PIECE_NAMES
            assert np.hypot(*piece.front) == pytest.approx(1.0, abs=1e-6)


def test_a_damaged_checkpoint_says_so(folder: Path, tmp_path: Path) -> None:
    for file in folder.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes()[:100])
    with pytest.raises(CheckpointError):
        load_finder(tmp_path)


def test_poses_move_pieces_with_their_pixels() -> None:
    """A white square with a black front, in all poses: the front is where the truth says."""
    rgb = np.full((CROP_PX, CROP_PX, 3), 255, np.uint8)
    rgb[100:104, 60:80] = 0
    crop = Crop(rgb, np.array([[6.0, 70.0, 92.0, 20.0, 24.0, 0.0, 1.0]]))
    for seed in range(16):
        moved = posed(crop, np.random.default_rng(seed))
        _, x, y, _, depth, front_x, front_y = moved.pieces[0]
        front = np.array([x, y]) + np.array([front_x, front_y]) * (depth / 2 - 2)
        column, row = np.floor(front).astype(int)
        assert moved.rgb[row, column].max() < 30


def test_the_truth_of_a_crop_says_where_its_pieces_are() -> None:
    assert all(len(crop.pieces) for crop in CROPS)
    for crop in CROPS:
        hills, _shapes, said = targets_of(crop.pieces)
        for kind, x, y, length, _, front_x, front_y in crop.pieces:
            row, column = int(y / PIECE_STEP_PX), int(x / PIECE_STEP_PX)
            assert hills[int(kind), row, column] == 255
            assert said[row, column]
            assert np.hypot(front_x, front_y) == pytest.approx(1.0, abs=0.02)
            assert length > 3


def test_seen_fronts_become_yaws() -> None:
    frame = PixelFrame(0.02, (0.0, 0.0), 500)
    for front in ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-0.6, 0.8)):
        seen = SeenPiece("toilet", 0.9, (100.0, 400.0), 20.0, 32.0, front)
        (item,) = as_items([seen], frame)
        assert np.allclose(front_direction(item.box.yaw_deg), (front[0], -front[1]))
        assert item.box.center_m[:2] == pytest.approx((2.0, 2.0))
        assert item.box.size_m[:2] == pytest.approx((0.4, 0.64))


def test_symbols_lie_where_their_boxes_are() -> None:
    """But for doors of showers, chaises of sofas and spouts; and they differ between hands."""
    for name, draw in DRAWN.items():
        length, depth = (
            sum(side) / 2 for side in (category(name).length_m, category(name).width_m)
        )
        looks = set()
        for seed in range(20):
            shapes = draw(length, depth, np.random.default_rng(seed))
            x0, y0, x1, y1 = shapes[0].bounds
            assert max(-x0, x1) <= length / 2 + 0.01, name
            assert max(-y0 - 0.8, y1) <= depth / 2 + 0.01, name
            looks.add(tuple(shape.wkt for shape in shapes))
        assert len(looks) >= 4 or name == "electrical_floor_cabinet", name


def test_batches_depend_on_the_seed_alone() -> None:
    def some(seed: int) -> list[torch.Tensor]:
        stream = iter(SymbolStream(2, seed, pool=2))
        return [part for _ in range(2) for part in next(stream)]

    assert all(map(torch.equal, some(1), some(1)))
    assert not all(map(torch.equal, some(1), some(2)))


def test_a_few_steps_learn_and_a_run_goes_on(tmp_path: Path, network: SymbolsNetwork) -> None:
    config = SymbolsTraining(minutes=0.02, batch=1, workers=0, warmup_steps=1)
    first, again = (train_symbols(config, tmp_path, CROPS[:1]) for _ in range(2))
    assert again["steps"] > first["steps"]
    described = json.loads((tmp_path / "checkpoint" / "config.json").read_text())
    assert described["labels"] == list(PIECE_NAMES)
    assert load_finder(tmp_path / "checkpoint")
    found = score(network, CROPS, "cpu")
    assert all(0.0 <= value <= 1.0 for value in found.values())
