"""The YOLOv8 networks: loading, errors, what the shipped weights see, how training goes on."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from chord_usd.data.splits import TEST_SEED
from chord_usd.errors import CheckpointError
from chord_usd.graph.detect import (
    CLASSES,
    CONFIG_FILE,
    WEIGHTS_FILE,
    Kind,
    build_model,
    load_item_detector,
    load_room_segmenter,
    save_model,
)
from chord_usd.graph.extract import extract_graph
from chord_usd.locations import checkpoint_folder
from chord_usd.raster import draw_plan, layout_image
from chord_usd.training.detector import DetectorTraining, train_detector
from chord_usd.training.detector_data import CLEAN, draw_sample, held_out, house
from chord_usd.training.detector_scores import average_precision, score_checkpoint

KINDS: tuple[Kind, ...] = ("items", "rooms")


@pytest.fixture(scope="module")
def untrained(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("untrained")
    save_model("items", build_model("items"), folder, {})
    return folder


def test_a_missing_checkpoint_says_how_to_get_one(tmp_path: Path) -> None:
    for load in (load_item_detector, load_room_segmenter):
        with pytest.raises(CheckpointError, match="train detector --kind"):
            load(tmp_path / "nowhere")


def test_damaged_weights_are_an_error(untrained: Path, tmp_path: Path) -> None:
    shutil.copytree(untrained, tmp_path / "d")
    weights = tmp_path / "d" / WEIGHTS_FILE
    whole = weights.read_bytes()
    for damaged in (whole[: len(whole) // 2], b"", b"\x00" * 64):
        weights.write_bytes(damaged)
        with pytest.raises(CheckpointError, match=WEIGHTS_FILE):
            load_item_detector(tmp_path / "d")


def test_weights_of_another_network_are_an_error(untrained: Path, tmp_path: Path) -> None:
    save_model("rooms", build_model("rooms"), tmp_path / "d", {})
    shutil.copy(untrained / CONFIG_FILE, tmp_path / "d" / CONFIG_FILE)
    with pytest.raises(CheckpointError, match="do not fit"):
        load_item_detector(tmp_path / "d")


def test_another_list_of_classes_is_an_error(untrained: Path, tmp_path: Path) -> None:
    shutil.copytree(untrained, tmp_path / "d")
    config = json.loads((tmp_path / "d" / CONFIG_FILE).read_text())
    config["classes"][0] = "throne"
    (tmp_path / "d" / CONFIG_FILE).write_text(json.dumps(config))
    with pytest.raises(CheckpointError, match="classes"):
        load_item_detector(tmp_path / "d")


def test_weights_survive_being_saved(untrained: Path, tmp_path: Path) -> None:
    rgb = np.random.default_rng(0).integers(0, 255, (1, 256, 256, 3), dtype=np.uint8)
    first = load_item_detector(untrained).raw(rgb, 0.001)[0]
    shutil.copytree(untrained, tmp_path / "copy")
    np.testing.assert_array_equal(first, load_item_detector(tmp_path / "copy").raw(rgb, 0.001)[0])


def test_ultralytics_is_silent_and_leaves_the_home_folder_alone(tmp_path: Path) -> None:
    code = "from chord_usd.graph.detect import build_model; build_model('items')"
    environment = {"HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout == ""
    assert done.stderr == ""
    assert not list(tmp_path.rglob("*ltralytics*"))


def test_labels_outline_what_is_painted() -> None:
    """Every box of a clean sample covers pixels of one colour that is not the floor's."""
    for sample in held_out(5, CLEAN):
        for label, x, y, *_ in sample.boxes:
            assert 0 <= label < len(CLASSES["items"])
            red, green, blue = sample.rgb[int(y), int(x)].astype(int)
            assert (red, green) != (green, blue)
        for index, label in enumerate(sample.room_classes):
            assert 0 <= label < len(CLASSES["rooms"])
            rows, columns = np.nonzero(sample.room_map == index + 1)
            x, y, width, height = sample.room_boxes[index]
            if len(rows):
                assert np.abs((columns * 4 + 2) - x).max() <= width / 2 + 4
                assert np.abs((rows * 4 + 2) - y).max() <= height / 2 + 4


def test_spoilt_samples_are_reproducible() -> None:
    from chord_usd.training.detector_data import Spoiling

    graph = house(5)
    spoiling = Spoiling(1.0, 1.0, 1.0, 1.0, 1.0, 0.0)
    first, second = (draw_sample(graph, spoiling, np.random.default_rng(1)) for _ in range(2))
    np.testing.assert_array_equal(first.rgb, second.rgb)
    np.testing.assert_array_equal(first.boxes, second.boxes)


def test_average_precision_on_known_rankings() -> None:
    from chord_usd.training.detector_scores import _Found

    right, wrong = True, False

    def score(*order: bool, truths: int) -> float:
        return average_precision([_Found(1 - i / 9, r) for i, r in enumerate(order)], truths)

    assert score(right, right, truths=2) == 1.0
    assert score(right, wrong, truths=2) == 0.5
    assert score(wrong, right, truths=1) == 0.5
    assert score(truths=3) == 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_training_leaves_a_checkpoint_and_goes_on_from_it(kind: Kind, tmp_path: Path) -> None:
    config = DetectorTraining(minutes=0.01, batch=2, score_houses=1, warmup_steps=1)
    train_detector(kind, tmp_path, config)
    before = json.loads((tmp_path / CONFIG_FILE).read_text())
    train_detector(kind, tmp_path, config, resume=True)
    after = json.loads((tmp_path / CONFIG_FILE).read_text())
    assert after["images"] > before["images"] >= 2
    assert after["scores"]["houses"] == 1
    assert "mAP50" in (tmp_path / "README.md").read_text()
    assert score_checkpoint(kind, tmp_path, 1).map50 == after["scores"]["map50"]


def test_resuming_from_nothing_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(CheckpointError, match="resume"):
        train_detector("items", tmp_path, DetectorTraining(minutes=0.01), resume=True)


def test_the_shipped_detector_finds_most_furniture() -> None:
    folder = checkpoint_folder("detector_items")
    scores = score_checkpoint("items", folder, 6)
    assert scores.by_class["bed"] > 0.8
    assert scores.map50 > 0.5


def test_the_shipped_detector_and_the_pixels_agree() -> None:
    graph = house(TEST_SEED + 3)
    layout = layout_image(draw_plan(graph.plan), graph.items)
    found = extract_graph(layout, graph.plan, detector=load_item_detector())
    assert len(found.items) == len(graph.items)
    assert np.mean([item.extra["detected"] for item in found.items]) > 0.6
