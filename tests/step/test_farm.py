"""A stage as a job: what openjd says of it, and what becomes of it when it runs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from render_house import write_house

from chord_usd import __version__
from chord_usd.base.errors import RenderError
from chord_usd.base.runtime.stages import StageFiles
from chord_usd.faces.farm.bundle import Work, tasks_of, template, write_bundle
from chord_usd.line.image.exr import write_exr
from chord_usd.line.image.options import RenderOptions
from chord_usd.line.image.products import read_mask
from chord_usd.line.image.render import camera_names

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
    done = bundled(house, folder / "job", *BUNDLE)
    assert json.loads(done.stdout)["tasks"] == 2
    # The bundle is whole: the house it came from may go.
    house.unlink()
    (folder / "maps" / "red.png").unlink()
    return folder / "job"


def bundled(house: Path, job: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """What farm bundle says."""
    command = [sys.executable, "-m", "chord_usd.cli", "farm", "bundle", str(house), *words]
    return subprocess.run([*command, "-o", str(job), "--json"], capture_output=True, text=True)


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


def test_every_file_lies_in_a_folder_that_a_farm_copies(staged_house: Path, tmp_path: Path) -> None:
    """Deadline Cloud uploads what parameters of type PATH name, and nothing else."""
    sky, job = tmp_path / "studio.exr", tmp_path / "job"
    rows = np.linspace(1.0, 0.1, 64, dtype=np.float32)
    write_exr(sky, dict.fromkeys("RGB", np.tile(rows[:, None], 128)))
    done = bundled(staged_house, job, "--sky", str(sky))
    assert done.returncode == 0, done.stderr
    parameters = json.loads((job / "template.json").read_text())["parameterDefinitions"]
    sent = [
        job / one["default"]
        for one in parameters
        if one["type"] == "PATH" and one["dataFlow"] == "IN" and one["objectType"] == "DIRECTORY"
    ]
    files = {file for file in job.rglob("*") if file.is_file() and file.parent != job}
    assert len(files) > 20
    assert all(any(file.is_relative_to(folder) for folder in sent) for file in files)
    words, _ = tasks_of(job)
    named = words[words.index("--sky") + 1].replace("{{Param.Scene}}", str(job / "scene"))
    assert Path(named).read_bytes() == sky.read_bytes()


def due(bundle: Path) -> list[dict[str, object]]:
    done = run(["chord-usd", "farm", "due", ".", "-o", "pictures"], bundle)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.acceptance
def test_the_slurm_scripts_run_the_tasks_and_the_merge(bundle: Path) -> None:
    """As the elements of an array would, one after the other, through openjd."""
    pytest.importorskip("openjd.sessions", reason="the extra farm is not installed")
    assert [task["Tile"] for task in due(bundle)] == [0, 1]
    for element in range(2):
        done = run(["bash", "slurm_array.sh"], bundle, SLURM_ARRAY_TASK_ID=str(element))
        assert done.returncode == 0, done.stdout + done.stderr
        assert "openjd_progress: 100.0" in done.stdout
        assert [task["Tile"] for task in due(bundle)] == [1][element:]
    done = run(["bash", "slurm_merge.sh"], bundle)
    assert done.returncode == 0, done.stdout + done.stderr
    assert read_mask(bundle / "pictures" / "Bedroom_0.instance.png").shape == (9, 16)
    assert (bundle / "pictures" / "coco.json").exists()
    # A task that is given out again has nothing to do.
    again = run(["bash", "slurm_array.sh"], bundle, SLURM_ARRAY_TASK_ID="0")
    assert "rendered on" not in again.stdout


def test_an_element_of_an_array_runs_several_tasks_and_passes_over_failures(bundle: Path) -> None:
    pytest.importorskip("openjd.sessions", reason="the extra farm is not installed")
    words = {"SLURM_ARRAY_TASK_ID": "0", "EACH": "2", "PROGRAM": "false"}
    done = run(["bash", "slurm_array.sh"], bundle, **words)
    assert done.returncode == 1
    assert done.stdout.count("Tile(INT) = ") == 2


@pytest.mark.parametrize(
    ("template", "tasks"),
    [("{}", ""), ("[1", ""), (None, ""), ("whole", "[]"), ("whole", '{"Camera": "A"}')],
)
def test_what_is_no_bundle_is_one_line(
    bundle: Path, tmp_path: Path, template: str | None, tasks: str
) -> None:
    if template is not None:
        whole = (bundle / "template.json").read_text()
        (tmp_path / "template.json").write_text(whole if template == "whole" else template)
    (tmp_path / "tasks.jsonl").write_text(tasks + "\n")
    with pytest.raises(RenderError) as told:
        tasks_of(tmp_path)
    assert "\n" not in str(told.value)


def test_a_job_of_another_version_is_refused_by_its_worker(bundle: Path) -> None:
    words = ["render", "scene/house.usda", "-o", "other", "--require-version", "0.0.1"]
    done = run(["chord-usd", *words], bundle)
    assert done.returncode == 2
    assert "expected 0.0.1, which made the job" in done.stderr


def test_a_job_names_the_versions_of_what_renders_it(bundle: Path) -> None:
    lines = (bundle / "requirements.txt").read_text().split()
    assert {f"{name}=={version(name)}" for name in ("bpy", "usd-core", "numpy")} <= set(lines)
    assert f"chord-usd=={__version__}" in lines
    assert not any(line.startswith(("ray==", "pytest==")) for line in lines)


def test_a_stage_without_a_file_is_not_sent(tmp_path: Path) -> None:
    house = write_house(tmp_path / "house.usda")
    (tmp_path / "maps" / "red.png").unlink()
    done = bundled(house, tmp_path / "job")
    assert done.returncode == 2
    assert "1 file is missing" in done.stderr
    assert not (tmp_path / "job").exists()


@pytest.mark.parametrize(("device", "code"), [("auto", 0), ("cuda", 0), ("cpu", 2)])
def test_tasks_that_ask_for_a_gpu_take_no_other_device(
    tmp_path: Path, device: str, code: int
) -> None:
    house, job = write_house(tmp_path / "house.usda"), tmp_path / "job"
    done = bundled(house, job, "--gpu", "--device", device)
    assert done.returncode == code
    if code == 0:
        words, tasks = tasks_of(job)
        assert words[words.index("--device") + 1] == {"auto": "gpu"}.get(device, device)
        assert len(tasks) == 2
        # Whole pictures, and no data set of all: nothing is left to do after the tasks.
        assert not (job / "slurm_merge.sh").exists()


def test_there_is_a_task_for_each_camera_tile_and_block() -> None:
    nothing = StageFiles((), (), ())
    words = ("--seed", "1")
    work = Work(Path("house.usda"), nothing, ("A", "B"), words, tiles=3, blocks=2, gpu=True)
    assert len(work.tasks()) == 12
    render, merge = template(work)["steps"]
    space = render["parameterSpace"]
    assert space["combination"] == "Camera * Tile * Block"
    ranges = [definition["range"] for definition in space["taskParameterDefinitions"]]
    assert ranges == [["A", "B"], "0-2", "0-1"]
    assert {"name": "amount.worker.gpu", "min": 1} in render["hostRequirements"]["amounts"]
    assert merge["dependencies"] == [{"dependsOn": "Render"}]
    assert "--merge" in merge["script"]["actions"]["onRun"]["args"]


@pytest.mark.parametrize(
    ("frames", "views"), [(False, ["A,B", "C,D", "E"]), (True, ["0-1", "2-3", "4-4"])]
)
def test_cameras_and_frames_share_a_task(frames: bool, views: list[str]) -> None:
    work = Work(Path("h.usda"), StageFiles((), (), ()), tuple("ABCDE"), (), frames=frames, each=2)
    name = "Frame" if frames else "Camera"
    assert [task[name] for task in work.tasks()] == views
    render = template(work)["steps"][0]
    words = render["script"]["actions"]["onRun"]["args"]
    assert words[words.index(f"--{name.lower()}") + 1] == f"{{{{Task.Param.{name}}}}}"
    assert render["parameterSpace"]["taskParameterDefinitions"][0]["range"] == views


def test_tasks_of_frames_are_due_by_their_frames(staged_house: Path, tmp_path: Path) -> None:
    job = tmp_path / "job"
    done = bundled(staged_house, job, "--walkthrough", "5", "--per-task", "2")
    assert done.returncode == 0, done.stderr
    assert [task["Frame"] for task in due(job)] == ["0-1", "2-3", "4-4"]
    walk = RenderOptions(walkthrough=5, frame=(2, 3))
    assert camera_names(staged_house, walk) == ["Walk_002", "Walk_003"]


@pytest.mark.parametrize("wrong", [{}, {"walkthrough": 2}, {"turntable": "A", "frames": 3}])
def test_frames_that_are_not_there(wrong: dict[str, object]) -> None:
    with pytest.raises(RenderError, match="frames 1-3"):
        RenderOptions(frame=(1, 3), **wrong)


def test_a_stage_that_points_out_of_its_folder_cannot_travel(tmp_path: Path) -> None:
    stage = tmp_path / "in" / "house.usda"
    files = StageFiles((stage,), (tmp_path / "elsewhere.png",), ())
    work = Work(stage, files, ("A",), ())
    with pytest.raises(RenderError, match=r"points to .*elsewhere\.png"):
        write_bundle(work, tmp_path / "job")
    assert list(tmp_path.iterdir()) == []


def test_a_job_has_as_many_tasks_as_a_template_may_have(tmp_path: Path) -> None:
    work = Work(tmp_path / "house.usda", StageFiles((), (), ()), ("A",), (), tiles=2000)
    with pytest.raises(RenderError, match="2000 tiles"):
        write_bundle(work, tmp_path / "job")
