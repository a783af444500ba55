"""A stage as a job: what openjd says of it, and what becomes of it when it runs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from render_house import write_house

from chord_usd.errors import RenderError
from chord_usd.farm.bundle import Work, template, write_bundle
from chord_usd.image.products import read_mask

BUNDLE = [
    "--camera", "Bedroom_0", "--resolution", "16x9", "--samples", "2", "--tiles", "2",
    "--passes", "rgb,instance", "--device", "cpu",
]  # fmt: skip

SCRIPTS = Path(sys.executable).parent
"""Where openjd and chord-usd are installed."""


@pytest.fixture(scope="module")
def bundle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("farm")
    house = write_house(folder / "house.usda")
    command = [sys.executable, "-m", "chord_usd.cli", "farm", "bundle", str(house), *BUNDLE]
    done = subprocess.run(
        [*command, "-o", str(folder / "job"), "--json"], capture_output=True, text=True, check=True
    )
    assert json.loads(done.stdout)["tasks"] == 2
    # The bundle is whole: the house it came from may go.
    house.unlink()
    return folder / "job"


def run(command: list[str], folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join([str(SCRIPTS), os.environ["PATH"]])
    return subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, "PATH": path, **variables},
        capture_output=True,
        text=True,
    )


def test_openjd_accepts_the_template(bundle: Path) -> None:
    pytest.importorskip("openjd.model", reason="the extra farm is not installed")
    done = run(["openjd", "check", "template.json"], bundle)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_slurm_scripts_run_the_tasks_and_the_merge(bundle: Path) -> None:
    """As the elements of an array would, one after the other, through openjd."""
    pytest.importorskip("openjd.sessions", reason="the extra farm is not installed")
    for element in range(2):
        done = run(["bash", "slurm_array.sh"], bundle, SLURM_ARRAY_TASK_ID=str(element))
        assert done.returncode == 0, done.stdout + done.stderr
        assert "openjd_progress: 100.0" in done.stdout
    assert len(list((bundle / "pictures").glob("*.tile-*-of-2.block-0-of-1.exr"))) == 2
    done = run(["bash", "slurm_merge.sh"], bundle)
    assert done.returncode == 0, done.stdout + done.stderr
    assert read_mask(bundle / "pictures" / "Bedroom_0.instance.png").shape == (9, 16)
    assert (bundle / "pictures" / "coco.json").exists()
    # A task that is given out again has nothing to do.
    again = run(["bash", "slurm_array.sh"], bundle, SLURM_ARRAY_TASK_ID="0")
    assert "rendered on" not in again.stdout


def test_there_is_a_task_for_each_camera_tile_and_block() -> None:
    work = Work(Path("house.usda"), (), ("A", "B"), ("--seed", "1"), tiles=3, blocks=2, gpu=True)
    assert len(work.tasks()) == 12
    render, merge = template(work)["steps"]
    space = render["parameterSpace"]
    assert space["combination"] == "Camera * Tile * Block"
    ranges = [definition["range"] for definition in space["taskParameterDefinitions"]]
    assert ranges == [["A", "B"], "0-2", "0-1"]
    assert {"name": "amount.worker.gpu", "min": 1} in render["hostRequirements"]["amounts"]
    assert merge["dependencies"] == [{"dependsOn": "Render"}]
    assert "--merge" in merge["script"]["actions"]["onRun"]["args"]


def test_a_stage_that_points_out_of_its_folder_cannot_travel(tmp_path: Path) -> None:
    stage = tmp_path / "in" / "house.usda"
    work = Work(stage, (stage, tmp_path / "elsewhere.png"), ("A",), ())
    with pytest.raises(RenderError, match=r"points to .*elsewhere\.png"):
        write_bundle(work, tmp_path / "job")
    assert list(tmp_path.iterdir()) == []


def test_a_job_has_as_many_tasks_as_a_template_may_have(tmp_path: Path) -> None:
    work = Work(tmp_path / "house.usda", (), ("A",), (), tiles=2000)
    with pytest.raises(RenderError, match="2000 tiles"):
        write_bundle(work, tmp_path / "job")
