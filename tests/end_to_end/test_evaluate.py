"""evaluate as a user runs it, with the mistakes users make."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
import torch

from chord_usd.base.runtime.targets import MANIFEST_FILE
from chord_usd.base.scene.chord_json import write_scene
from chord_usd.base.scene.types import SceneGraph
from chord_usd.cli import DONE, UNUSABLE, main
from chord_usd.line.layout.checkpoint import save_checkpoint
from chord_usd.line.layout.config import PRESETS
from chord_usd.line.layout.network import LayoutNetwork

TINY = replace(PRESETS["default"], channels=(16, 32), attention=(False, True), feature_channels=16)


@pytest.fixture
def checkpoint(tmp_path: Path) -> Path:
    folder = tmp_path / "checkpoint"
    torch.manual_seed(0)
    save_checkpoint(folder, LayoutNetwork(TINY), {})
    return folder


def truncated(folder: Path) -> None:
    weights = folder / "weights.safetensors"
    weights.write_bytes(weights.read_bytes()[:2000])


def empty(folder: Path) -> None:
    (folder / "config.json").write_text("")


def of_another_version(folder: Path) -> None:
    config = folder / "config.json"
    config.write_text(config.read_text().replace('"format": 1', '"format": 2'))


def of_another_network(folder: Path) -> None:
    config = folder / "config.json"
    config.write_text(config.read_text().replace('"patch_px": 4', '"patch_px": 8'))


def missing(folder: Path) -> None:
    (folder / "weights.safetensors").unlink()


def fails(words: list[object], capsys: pytest.CaptureFixture[str]) -> str:
    """Runs a command line that must end in one error line; returns it."""
    assert main([*map(str, words), "--progress", "none"]) == UNUSABLE
    told = capsys.readouterr()
    assert told.out == ""
    assert re.fullmatch(r"error: .+\n", told.err)
    assert "unexpected" not in told.err
    return told.err


@pytest.mark.parametrize("verb", ["layouts", "ood", "speed", "diversity"])
@pytest.mark.parametrize(
    "damage", [truncated, empty, of_another_version, of_another_network, missing]
)
def test_an_unusable_checkpoint_is_named(
    verb: str, damage, checkpoint: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    damage(checkpoint)
    error = fails(["evaluate", verb, "--n", 1, "--checkpoint", checkpoint], capsys)
    assert str(checkpoint) in error
    assert "Try:" in error


@pytest.mark.parametrize("verb", ["layouts", "ood", "speed", "diversity"])
def test_a_split_that_does_not_exist(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    error = fails(["evaluate", verb, "--split", "validation"], capsys)
    assert "no split 'validation'" in error
    assert "test, train, all" in error


@pytest.mark.skipif(torch.cuda.is_available(), reason="this machine has CUDA")
def test_cuda_asked_for_and_absent(checkpoint: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["evaluate", "layouts", "--n", 1, "--checkpoint", checkpoint, "--device", "cuda"]
    assert "no CUDA device" in fails(words, capsys)


@pytest.mark.parametrize("words", [["--steps", "5,x"], ["--steps", "0"], ["--sampler", "euler"]])
def test_steps_and_samplers_that_are_none(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert words[0] in fails(["evaluate", "speed", *words], capsys)


def test_a_folder_without_a_house(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "no such file" in fails(["evaluate", "layouts", "--from", tmp_path / "no"], capsys)
    (tmp_path / "broken.json").write_text("{")
    assert "broken.json" in fails(["evaluate", "layouts", "--from", tmp_path], capsys)


def test_anybodys_layouts_are_scored_and_broken_files_listed(
    furnished_house: SceneGraph, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    houses = tmp_path / "houses"
    houses.mkdir()
    write_scene(furnished_house, houses / "one.json")
    write_scene(furnished_house, houses / "two.json")
    (houses / "broken.json").write_text('{"rooms": 3}')
    words = ["evaluate", "layouts", "--from", houses, "-o", tmp_path / "scores.md", "--no-fid"]
    assert main([*map(str, words), "--json", "--progress", "none"]) == DONE
    told = json.loads(capsys.readouterr().out)
    assert told["rows"]["house"]["items_per_house"]["value"] == len(furnished_house.items)
    assert told["rows"]["house"]["por"]["count"] == 2
    assert told["warnings"][0] == "1 file skipped:"
    assert "broken.json" in told["warnings"][1]
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == [MANIFEST_FILE, "houses", "scores.json", "scores.md", "scores.png"]
    assert json.loads((tmp_path / "scores.json").read_text())["split"] == told["split"]


@pytest.mark.acceptance
def test_floors_are_scored_and_kept_on_record(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The second run plans nothing for the table, which says the same."""
    records = tmp_path / "records.jsonl"
    words = [
        "evaluate",
        "outlines",
        "--n",
        "1",
        "--steps",
        "2",
        "--records",
        str(records),
        "--json",
    ]
    told = []
    for _ in range(2):
        assert main([*words, "--progress", "none"]) == DONE
        told.append(json.loads(capsys.readouterr().out))
    assert told[0]["scores"] == told[1]["scores"]
    assert told[0]["scores"]["chosen"]["outline IoU"]["value"] > 0.9
    assert len(records.read_text().splitlines()) == 1
