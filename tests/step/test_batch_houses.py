"""Real houses by the batch: what is in their folders, and what a second run makes again."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.scene.chord_json import write_plan
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.workshop.data.houses import random_plan

PLAIN = ["--steps", "1", "--redraws", "0", "--no-tabletop", "--no-dressing"]
QUICK = [*PLAIN, "--workers", "1", "--json"]
PICTURES = ["--renders", "--quality", "draft", "--samples", "1", "--resolution", "32x18"]


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A home of two rooms: each camera costs seconds."""
    path = tmp_path_factory.mktemp("plans") / "studio.json"
    write_plan(random_plan(np.random.default_rng(1), rooms=2), path)
    return path


@pytest.fixture(scope="module")
def folder(run_cli, plan: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One house with pictures, and one plan that is none."""
    folder = tmp_path_factory.mktemp("batch")
    (folder / "broken.png").write_text("not a picture")
    plans = [plan, folder / "broken.png"]
    done = run_cli("batch", *plans, "-o", folder / "houses", *QUICK, *PICTURES)
    assert done.returncode == 1, done.stderr
    told = json.loads(done.stdout)
    assert (told["made"], told["kept"], told["failed"]) == (1, 0, 1)
    assert "is not a picture" in told["failures"]["broken-0"]
    return folder / "houses"


def test_a_house_is_whole_and_its_folder_can_be_moved(folder: Path, tmp_path: Path) -> None:
    names = {path.name for path in (folder / "studio-0").iterdir()}
    assert names == {
        "house.usda", "house_architecture", "assets", "materials", "plan.png", "layout.png",
        "scene.json", "house.json", "pictures", "pictures.json", ".chord-usd.manifest",
        "house_attribution.txt", "costs.json",
    }  # fmt: skip
    moved = (folder / "studio-0").rename(tmp_path / "moved")
    report = check_stage(moved / "house.usda")
    moved.rename(folder / "studio-0")
    assert report.errors == ()
    scene = (folder / "studio-0/scene.json").read_text()
    assert str(Path.home()) not in scene


@pytest.mark.acceptance
def test_only_what_is_damaged_is_made_again(run_cli, plan: Path, folder: Path) -> None:
    house = folder / "studio-0"
    before = times(house)
    for file in ("pictures/Top.png", "pictures/Top.exr"):
        (house / file).write_bytes(b"")
    done = run_cli("batch", plan, "-o", folder, *QUICK, *PICTURES)
    assert done.returncode == 0, done.stderr
    changed = {file for file, time in times(house).items() if before[file] != time}
    assert changed == {"costs.json", "pictures/Top.png", "pictures/Top.exr"}

    pictures = {file: time for file, time in times(house).items() if "pictures/" in file}
    (house / "scene.json").write_text("{}")
    done = run_cli("batch", plan, "-o", folder, *QUICK, "--synth", "1")
    assert json.loads(done.stdout)["made"] == 2
    assert len(json.loads((house / "scene.json").read_text())["furniture"]) > 3
    assert {file: times(house)[file] for file in pictures} == pictures
    assert (folder / "procedural_000000-0/plan.json").is_file()


def times(house: Path) -> dict[str, int]:
    files = (path for path in house.rglob("[!.]*") if path.is_file())
    return {str(file.relative_to(house)): file.stat().st_mtime_ns for file in files}
