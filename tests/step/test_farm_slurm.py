"""Bundles on a real Slurm of one node, and what Deadline Cloud's own client makes of one."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from render_house import write_house
from slurm_here import slurm_here

pytestmark = pytest.mark.acceptance

SCRIPTS = Path(sys.executable).parent
"""Where openjd and chord-usd are installed."""

MINUTES = 60.0


@pytest.fixture(scope="module")
def slurm() -> Iterator[Callable[..., str]]:
    """Runs a command line where Slurm is reached; returns what it printed."""
    pytest.importorskip("openjd.sessions", reason="the extra farm is not installed")
    with slurm_here() as environment:
        path = os.pathsep.join([str(SCRIPTS), environment["PATH"]])

        def run(*command: str, **variables: str) -> str:
            done = subprocess.run(
                command,
                env={**environment, "PATH": path, **variables},
                capture_output=True,
                text=True,
            )
            assert done.returncode == 0, done.stdout + done.stderr
            return done.stdout

        yield run


def bundle(folder: Path, *words: str) -> Path:
    house = write_house(folder / "house.usda")
    command = [str(SCRIPTS / "chord-usd"), "farm", "bundle", str(house), "-o", str(folder / "job")]
    subprocess.run([*command, "--device", "cpu", *words], check=True, capture_output=True)
    return folder / "job"


def submit(slurm: Callable[..., str], job: Path, **variables: str) -> str:
    return slurm("bash", str(job / "slurm_submit.sh"), **variables)


def wait_until(held: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + 8 * MINUTES
    while not held():
        assert time.monotonic() < deadline, f"waited in vain: {what}"
        time.sleep(0.5)


def queued(slurm: Callable[..., str]) -> list[str]:
    return slurm("squeue", "--noheader", "--array", "--format=%i %T %r").splitlines()


def test_more_tasks_than_an_array_may_have_are_accepted(slurm, tmp_path: Path) -> None:
    """12,960; Slurm's own limit is 1,001 elements."""
    words = ["--resolution", "160x90", "--samples", "72", "--tiles", "90", "--sample-blocks", "72"]
    job = bundle(tmp_path, *words)
    assert "submitted 12960 tasks" in submit(slurm, job)
    assert 900 < len(queued(slurm)) <= 1002  # with the merge
    slurm("scancel", "--name=chord-usd")
    wait_until(lambda: not queued(slurm), "the merge of a cancelled array goes")


def test_a_second_submission_sends_what_is_missing_and_merges(slurm, tmp_path: Path) -> None:
    words = ["--camera", "Bedroom_0", "--resolution", "16x9", "--samples", "2"]
    job = bundle(tmp_path, *words, "--tiles", "3", "--sample-blocks", "2")
    pictures = job / "pictures"
    # Two elements of three tasks each.
    said = submit(slurm, job, ELEMENTS="2")
    array = said.split("as job ")[1].split()[0]
    assert "submitted 6 tasks" in said
    wait_until(lambda: list(pictures.glob("*.block-*.exr")), "a first part")
    slurm("scancel", array)
    # The merge waits for a job that will never succeed, and goes.
    wait_until(lambda: not queued(slurm), "the merge of a cancelled array goes")
    assert not (pictures / "Bedroom_0.png").exists()
    made = {file: file.stat().st_mtime_ns for file in pictures.glob("*.block-*.exr")}
    assert 0 < len(made) < 6
    assert f"submitted {6 - len(made)} tasks" in submit(slurm, job)
    wait_until(lambda: not queued(slurm), "all tasks and the merge")
    logs = "\n".join(log.read_text() for log in (job / "logs").glob("*.log"))
    assert (pictures / "Bedroom_0.png").exists(), logs[-3000:]
    assert all(file.stat().st_mtime_ns == then for file, then in made.items())
    # Nothing is missing now: the merge alone is sent, and finds its picture.
    assert "all tasks are finished" in submit(slurm, job)


def test_deadline_cloud_uploads_every_file(tmp_path: Path) -> None:
    """By the classes that `deadline bundle submit` itself uses."""
    python = Path(os.environ.get("DEADLINE_PYTHON", SCRIPTS.parent / "deadline/bin/python"))
    if not python.exists():
        pytest.skip("make acceptance installs Deadline's client")
    job = bundle(tmp_path)
    script = Path(__file__).parents[1] / "deadline_upload.py"
    done = subprocess.run([python, script, job], check=True, capture_output=True, text=True)
    uploaded = {Path(line) for line in done.stdout.split("\n") if line}
    assert uploaded == {file for file in (job / "scene").rglob("*") if file.is_file()}
    assert {file.name for file in uploaded} == {"house.usda", "red.png"}
