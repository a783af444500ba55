"""Every command line of the documents runs as it is written, with budgets as small as can be."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.documents import (
    DOCUMENTS,
    ELSEWHERE,
    ROOT,
    command_lines,
    python_blocks,
    verb_of,
    with_tiny_budgets,
    write_inputs,
)

LONGEST_S = 900
MAY_FAIL_A_CHECK = (
    "batch", "check", "diff", "generate", "regenerate", "stage", "dataset release", "dataset stats",
)  # fmt: skip
"""Verbs that judge: of a sample of one step, or of two houses, exit code 1 is a true answer."""

SERVERS = ("serve", "mcp")


def by_document() -> list[tuple[str, list[str]]]:
    lines = {d: command_lines(d.read_text()) for d in DOCUMENTS}
    return [(str(d.relative_to(ROOT)), found) for d, found in lines.items() if found]


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the inputs and the house that the documents name."""
    folder = tmp_path_factory.mktemp("reader")
    write_inputs(folder)
    ran(folder, "chord-usd generate examples/two_bedrooms.png -o house/house.usda --seed 3")
    ran(folder, "chord-usd dataset synth -o houses --count 3")
    return folder


def ran(folder: Path, line: str) -> None:
    """Run a line in a shell, as a reader types it in a folder."""
    verb = verb_of(line) or ""
    if verb in SERVERS:
        line = f"timeout --preserve-status 20 {line} < /dev/null"
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-c", line], cwd=folder, env={**os.environ, "PATH": path},
        capture_output=True, text=True, timeout=LONGEST_S, check=False,
    )  # fmt: skip
    good = (0, 1) if verb in MAY_FAIL_A_CHECK else (0,)
    assert done.returncode in good, f"{line}\n{done.stderr[-1500:]}"
    assert verb != "batch" or re.search(r'\b0 failed|"failed": 0', done.stdout), done.stderr[-1500:]


def reader(template: Path, tmp_path: Path) -> Path:
    """A folder of a reader: the inputs, and the house both there and in out/."""
    folder = tmp_path / "reader"
    shutil.copytree(template, folder, symlinks=True)
    shutil.copytree(template / "house", folder, dirs_exist_ok=True)
    shutil.copytree(template / "house", folder / "out")
    for name in ("before.usda", "after.usda"):
        shutil.copyfile(folder / "house.usda", folder / name)
    return folder


@pytest.mark.acceptance
@pytest.mark.parametrize(("document", "lines"), by_document(), ids=lambda value: str(value)[:30])
def test_lines_run_in_their_order(
    document: str, lines: list[str], template: Path, tmp_path: Path
) -> None:
    folder = reader(template, tmp_path)
    faults = []
    for line in lines:
        if any(word in line for word in ELSEWHERE):
            continue
        if (verb_of(line) or "").startswith(("train", "dataset")):
            make_room(folder, line)
        try:
            ran(folder, with_tiny_budgets(line))
        except (AssertionError, subprocess.TimeoutExpired) as error:
            faults.append(str(error))
    assert not faults, f"{document}\n" + "\n".join(faults)


@pytest.mark.acceptance
@pytest.mark.parametrize("document", ["README.md", "docs/python.md"])
def test_python_runs(document: str, template: Path, tmp_path: Path) -> None:
    folder = reader(template, tmp_path)
    for block in python_blocks((ROOT / document).read_text()):
        done = subprocess.run(
            [sys.executable, "-c", block], cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)},
            capture_output=True, text=True, timeout=LONGEST_S, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr[-1500:]


def make_room(folder: Path, line: str) -> None:
    """The next example writes to a folder of the one before: readers choose one of them."""
    words = line.split()
    target = folder / words[words.index("-o") + 1] if "-o" in words else None
    if target is not None and target.is_dir() and target.name in ("run", "houses", "plans"):
        target.rename(folder / f"{target.name}_{len(list(folder.iterdir()))}")


def test_the_two_commands_of_the_readme_and_its_edit(tmp_path: Path) -> None:
    """make house, then the sentence of README on that house."""
    out = tmp_path / "out"
    tiny = [f"OUT={out}", f"BIN={Path(sys.executable).parent}", "CAMERAS=Top", "SAMPLES=1",
            "SIZE=64x36"]  # fmt: skip
    # The program is installed: set-up is what called this test.
    command = ["make", "--assume-old=setup", "house", *tiny]
    done = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, timeout=LONGEST_S, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert {"house.usda", "layout.png", "plan.png", "pictures"} <= {p.name for p in out.iterdir()}
    (edit,) = (one for one in command_lines((ROOT / "README.md").read_text()) if " edit " in one)
    (out / "my_house.usda").write_bytes((out / "house.usda").read_bytes())
    ran(tmp_path, edit)
