"""The YOLOv8 networks: loading, errors, what the shipped weights see, how training goes on."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import cv2
import numpy as np
import pytest
import torch

from chord_usd.base.errors import CheckpointError
from chord_usd.base.raster.canvas import draw_plan, layout_image
from chord_usd.base.raster.raster_files import write_raster
from chord_usd.base.runtime.checksums import SUMS_FILE
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.runtime.networks import WEIGHTS_FILE, load_network
from chord_usd.base.scene.chord_json import read_scene
from chord_usd.base.scene.types import CANVAS_PX
from chord_usd.cli import main
from chord_usd.line.graph.detect import (
    CLASSES,
    CONFIG_FILE,
    IMAGE_PX,
    LEAST_SCORE,
    Kind,
    load_item_detector,
    load_room_segmenter,
    scaled,
)
from chord_usd.line.graph.extract import extract_graph
from chord_usd.workshop.data.splits import TEST_SEED
from chord_usd.workshop.evaluation.detector_cases import clean_cases
from chord_usd.workshop.evaluation.detector_networks import score_checkpoint
from chord_usd.workshop.evaluation.detector_scores import ROWS, as_markdown, score_detector
from chord_usd.workshop.evaluation.detector_sheet import COLUMNS, ENLARGE, draw_sheet
from chord_usd.workshop.training.detector import LOG_FILE, DetectorTraining, train_detector
from chord_usd.workshop.training.detector_card import write_card
from chord_usd.workshop.training.detector_data import (
    CLEAN,
    MASK_SIDE,
    Sample,
    Spoiling,
    draw_sample,
    house,
    turned,
)
from chord_usd.workshop.training.yolo import Proposing, build_model, load_weights, save_model
from tests.every import later

KINDS: tuple[Kind, ...] = ("items", "rooms")


@pytest.fixture(scope="module")
def untrained(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("untrained")
    save_model("items", build_model("items"), folder, {})
    return folder


def test_a_missing_checkpoint_says_how_to_get_one(tmp_path: Path) -> None:
    for load in (load_item_detector, load_room_segmenter):
        with pytest.raises(CheckpointError, match="installing chord-usd again"):
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
    save_model("rooms", build_model("rooms"), tmp_path / "rooms", {})
    shutil.copytree(untrained, tmp_path / "d")
    shutil.copy(tmp_path / "rooms" / WEIGHTS_FILE, tmp_path / "d" / WEIGHTS_FILE)
    (tmp_path / "d" / SUMS_FILE).unlink()
    with pytest.raises(CheckpointError, match="cannot be built"):
        load_item_detector(tmp_path / "d")


def test_another_list_of_classes_is_an_error(untrained: Path, tmp_path: Path) -> None:
    shutil.copytree(untrained, tmp_path / "d")
    config = json.loads((tmp_path / "d" / CONFIG_FILE).read_text())
    config["classes"][0] = "throne"
    (tmp_path / "d" / CONFIG_FILE).write_text(json.dumps(config))
    with pytest.raises(CheckpointError, match="classes"):
        load_item_detector(tmp_path / "d")


def test_weights_survive_being_saved(untrained: Path, tmp_path: Path) -> None:
    rgb = np.random.default_rng(0).integers(0, 255, (256, 256, 3), dtype=np.uint8)
    shutil.copytree(untrained, tmp_path / "copy")
    first, second = (
        load_item_detector(folder).rows(rgb, LEAST_SCORE)
        for folder in (untrained, tmp_path / "copy")
    )
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("kind", KINDS)
def test_the_graph_computes_what_ultralytics_does(kind: Kind) -> None:
    folder = checkpoint_folder(f"detector_{kind}")
    model = build_model(kind)
    load_weights(kind, model, folder)
    graph = house(TEST_SEED)
    rgb = scaled(layout_image(draw_plan(graph.plan), graph.items).rgb, IMAGE_PX[kind])[None]
    with torch.inference_mode():
        truth = Proposing(kind, model.eval())(torch.from_numpy(rgb.copy()))
    found = load_network(folder, "").run({"rgb": rgb})
    rows, theirs = found[0][0], (truth[0] if kind == "rooms" else truth)[0].numpy()
    # Behind the proposals, rows without a score lie in any order.
    count = int((theirs[:, 4] >= LEAST_SCORE).sum())
    assert count > 5
    np.testing.assert_allclose(rows[:count], theirs[:count], atol=2e-3)
    assert (rows[count:, 4] < LEAST_SCORE).all()


def test_ultralytics_is_silent_and_changes_nothing_else(tmp_path: Path) -> None:
    """Neither the home folder nor the functions of other libraries.

    It replaces Image.open by one that installs packages when a file is no picture.
    """
    code = (
        "import cv2, PIL.Image as image\n"
        "def functions(): return image.open, cv2.imread, cv2.imwrite, cv2.imshow\n"
        "before = functions()\n"
        "from chord_usd.workshop.training.yolo import build_model\n"
        "build_model('items')\n"
        "import sys; assert 'ultralytics' in sys.modules\n"
        "assert functions() == before"
    )
    environment = {"HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout == ""
    assert done.stderr == ""
    assert not list(tmp_path.rglob("*ltralytics*"))


def samples(count: int) -> list[Sample]:
    return [draw_sample(house(seed), CLEAN, np.random.default_rng(seed)) for seed in range(count)]


def check_labels(sample: Sample) -> None:
    """Every box has a pixel of colour at its centre, every room its floor within its box."""
    step = CANVAS_PX / MASK_SIDE
    for label, x, y, *_ in sample.boxes:
        assert 0 <= label < len(CLASSES["items"])
        red, green, blue = sample.rgb[int(y), int(x)].astype(int)
        assert (red, green) != (green, blue)
    for index, label in enumerate(sample.room_classes):
        assert 0 <= label < len(CLASSES["rooms"])
        rows, columns = np.nonzero(sample.room_map == index + 1)
        x, y, width, height = sample.room_boxes[index]
        if len(rows):
            assert np.abs((columns + 0.5) * step - x).max() <= width / 2 + step
            assert np.abs((rows + 0.5) * step - y).max() <= height / 2 + step


def test_labels_outline_what_is_painted() -> None:
    for sample in samples(5):
        check_labels(sample)


@pytest.mark.parametrize("mirrored", [False, True], ids=["turned", "mirrored"])
@pytest.mark.parametrize("quarter_turns", range(4))
def test_labels_turn_with_the_picture(quarter_turns: int, mirrored: bool) -> None:
    for sample in samples(2):
        view = turned(sample, quarter_turns, mirrored)
        check_labels(view)
        assert len(view.boxes) == len(sample.boxes)
    # Four quarter turns, or two mirrors, are nothing.
    again = sample
    for _ in range(4):
        again = turned(again, 1, False)
    again = turned(turned(again, 0, True), 0, True)
    np.testing.assert_array_equal(again.rgb, sample.rgb)
    np.testing.assert_allclose(again.boxes, sample.boxes)
    np.testing.assert_allclose(again.room_boxes, sample.room_boxes)


def test_spoilt_samples_are_reproducible() -> None:
    graph = house(5)
    spoiling = Spoiling(1.0, 1.0, 1.0, 1.0, 1.0, 0.0)
    first, second = (draw_sample(graph, spoiling, np.random.default_rng(1)) for _ in range(2))
    np.testing.assert_array_equal(first.rgb, second.rgb)
    np.testing.assert_array_equal(first.boxes, second.boxes)


@pytest.mark.parametrize("kind", [KINDS[0], *later(*KINDS[1:])])
def test_training_leaves_a_checkpoint_and_goes_on_from_it(kind: Kind, tmp_path: Path) -> None:
    config = DetectorTraining(minutes=0.01, batch=2, warmup_steps=1)
    before = train_detector(kind, tmp_path, config)
    after = train_detector(kind, tmp_path, config, resume=True)
    assert after["images"] > before["images"] >= 2
    assert (
        json.loads((tmp_path / "checkpoint" / CONFIG_FILE).read_text())["images"] == after["images"]
    )
    log = [json.loads(line) for line in (tmp_path / LOG_FILE).read_text().splitlines()]
    assert log[-1]["images"] == after["images"]
    assert all(np.isfinite(value) for row in log for value in row.values())
    scores = score_checkpoint(kind, tmp_path / "checkpoint", list(clean_cases(1)))
    write_card(kind, tmp_path, after, {**asdict(scores), "layouts": 1, "split": "0"})
    assert "mAP50" in (tmp_path / "README.md").read_text()


def test_resuming_from_nothing_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(CheckpointError, match="resume"):
        train_detector("items", tmp_path, DetectorTraining(minutes=0.01), resume=True)


def test_the_shipped_detector_finds_most_furniture() -> None:
    scores = score_checkpoint("items", checkpoint_folder("detector_items"), list(clean_cases(6)))
    assert scores.by_class["bed"] > 0.8
    assert scores.map50 > 0.5


def test_the_shipped_detector_and_the_pixels_agree() -> None:
    graph = house(TEST_SEED + 3)
    layout = layout_image(draw_plan(graph.plan), graph.items)
    found = extract_graph(layout, graph.plan, detector=load_item_detector())
    assert len(found.items) == len(graph.items)
    assert np.mean([item.facts.detected is True for item in found.items]) > 0.6


def test_the_table_of_scores_and_the_sheet(untrained: Path, tmp_path: Path) -> None:
    """By colour alone drawn layouts come back right, so that a blind network loses nothing."""
    save_model("rooms", build_model("rooms"), tmp_path / "rooms", {})
    items, rooms = load_item_detector(untrained), load_room_segmenter(tmp_path / "rooms")
    cases = list(clean_cases(2))
    scores = score_detector(cases, items, rooms)
    assert scores.items.map50 < 0.1
    for step in (scores.with_plan, scores.alone):
        assert step is not None
        assert step.truths == sum(len(case.items) for case in cases)
        assert step.recall > 0.97
        assert step.orientation > 0.97
        assert step.edge_px < 0.5
    table = as_markdown({"clean": scores})
    assert table.count("\n") == 2 + len(ROWS)
    assert f"{scores.alone.recall:.4f}" in table
    sheet = cv2.imdecode(np.frombuffer(draw_sheet(cases, items, rooms), np.uint8), 1)
    assert sheet.shape == (2 * ENLARGE * CANVAS_PX, COLUMNS * ENLARGE * CANVAS_PX, 3)


def test_evaluate_detector_prints_its_table(tmp_path: Path, capsys) -> None:
    words = ["evaluate", "detector", "--houses", "2", "--generated", "0", "--progress", "none"]
    words += ["-o", str(tmp_path / "scores.md"), "--sheet", str(tmp_path / "sheet.png")]
    assert main(words) == 0
    table = capsys.readouterr().out
    assert table == (tmp_path / "scores.md").read_text()
    assert "items network alone, mAP50" in table
    assert (tmp_path / "sheet.png").stat().st_size > 10_000
    drawn = next(clean_cases(1))
    write_raster(drawn.layout, tmp_path / "mine.png")
    words = ["evaluate", "detector", "--houses", "0", "--generated", "0", "--progress", "none"]
    assert main([*words, "--layouts", str(tmp_path / "mine.png"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["given"]
    assert told["layouts"] == 1
    assert told["with_plan"] is None
    assert told["alone"]["recall"] > 0.9


def test_a_layout_alone_becomes_a_graph_with_rooms(tmp_path: Path, capsys) -> None:
    """The verb graph, for a raster whose plan nobody knows and whose floors are white."""
    drawn = list(clean_cases(2))[1]
    assert not drawn.shaded
    write_raster(drawn.layout, tmp_path / "layout.png")
    words = ["graph", str(tmp_path / "layout.png"), "-o", str(tmp_path / "scene.json")]
    assert main([*words, "--json", "--progress", "none"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["furniture"] == pytest.approx(len(drawn.items), abs=1)
    scene = read_scene(tmp_path / "scene.json")
    assert sum(room.kind != "unknown" for room in scene.rooms) > 0.5 * len(scene.rooms)
