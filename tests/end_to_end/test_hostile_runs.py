"""The benchmarks that look for faults find none: wrong inputs, other people's files, signals."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.acceptance


@pytest.mark.parametrize(
    "words",
    [
        ("fuzz.py", "--minutes", "5"),
        ("strangers_tree.py", "--runs", "60"),
        ("interrupts.py", "--rounds", "1"),
    ],
    ids=" ".join,
)
def test_nothing_is_reported(words: tuple[str, ...], tmp_path: Path) -> None:
    command = [sys.executable, ROOT / "benchmarks" / words[0], *words[1:]]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, timeout=3600, check=False
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]
