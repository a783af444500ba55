"""Training on somebody else's furnished houses: their training share, none of ours."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.scene.chord_json import write_scene
from chord_usd.base.scene.types import SceneGraph
from chord_usd.cli import main
from chord_usd.line.layout.config import PRESETS
from chord_usd.workshop.data.splits import part_of
from chord_usd.workshop.evaluation.cases import Case
from chord_usd.workshop.evaluation.layouts import Sampling
from chord_usd.workshop.evaluation.realism import reference_layouts
from chord_usd.workshop.training.lists_data import endless_houses
from chord_usd.workshop.training.stream import LayoutStream, StreamConfig

NAMES = [f"mine_{index}" for index in range(6)]
TRAINED = [name for name in NAMES if part_of(name) == "train"]
assert 0 < len(TRAINED) < len(NAMES)


@pytest.fixture
def houses(furnished_house: SceneGraph, tmp_path: Path) -> Path:
    folder = tmp_path / "houses"
    folder.mkdir()
    for name in NAMES:
        write_scene(furnished_house, folder / f"{name}.json")
    return folder


def test_streams_hold_nothing_else(furnished_house: SceneGraph) -> None:
    rng = np.random.default_rng(0)
    own = endless_houses([], rng, furnished=[furnished_house])
    assert [next(own)[0] for _ in range(3)] == [furnished_house] * 3
    houses = [furnished_house], [replace(furnished_house, items=())]
    stream = LayoutStream(StreamConfig(), [], PRESETS["small"], 1, *houses)
    assert stream._furnished_house(rng) is furnished_house
    assert [int(one.labels.max()) for one in stream.held_out(4)] == [0], "what sheets are of"


@pytest.mark.parametrize("verb", ["lists", "boxes"])
def test_a_run_learns_from_a_folder(
    verb: str, houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["train", verb, "--furnished", str(houses), "-o", str(tmp_path / "run")]
    assert main([*command, "--minutes", "0.01", "--batch", "2", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["furnished"] == len(TRAINED)


def test_a_folder_may_be_too_small_to_hold_anything_out(
    houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in set(NAMES) - set(TRAINED):
        (houses / f"{name}.json").unlink()
    command = ["train", "lists", "--furnished", str(houses), "-o", str(tmp_path / "run")]
    assert main([*command, "--minutes", "0.01", "--batch", "2", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["held_out_nats"] is None


@pytest.mark.parametrize("verb", ["plan2layout", "lists", "boxes"])
@pytest.mark.parametrize("wrong", ["missing", "bare", "houses", "flats"])
def test_what_cannot_be_learned_from_is_refused(
    verb: str, wrong: str, houses: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["train", verb, "-o", str(tmp_path / "run"), "--furnished", str(houses)]
    if wrong == "missing":
        command[-1] += "/none"
    elif wrong == "bare":
        for path in houses.iterdir():
            path.write_text(json.dumps({**json.loads(path.read_text()), "furniture": []}))
    else:
        command += [f"--{wrong}", "3"]
    assert main(command) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert error.count("\n") == 1
    assert not (tmp_path / "run").exists()


def test_furnished_houses_are_the_standard_for_what_is_made_in_them(
    furnished_house: SceneGraph,
) -> None:
    few = replace(furnished_house, items=furnished_house.items[:1])
    cases = [Case(name, few.plan, few) for name in NAMES]
    for part in reference_layouts(cases, Sampling()):
        assert [one.scene.items for one in part] == [few.items] * 3
