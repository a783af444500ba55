"""Folders and files that the user may read and not write: an error line, and nothing changed."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from chord_usd.base.scene.chord_json import write_plan, write_scene
from tests.strangers import tree

NOBODY = 65534

pytestmark = pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() != 0 or not shutil.which("setpriv"),
    reason="only root can become another user, and nothing is read-only for root",
)


@pytest.fixture(scope="module")
def home(furnished_house) -> Iterator[Path]:
    """A folder of root's that others may read, and in it one where they may write."""
    # The folders of pytest are closed to others.
    with tempfile.TemporaryDirectory() as name:
        home = Path(name)
        write_plan(furnished_house.plan, home / "plan.json")
        write_scene(furnished_house, home / "scene.json")
        (home / "empty").mkdir()
        (home / "open").mkdir()
        (home / "kept.png").write_bytes(b"somebody's")
        for path in (home, *home.rglob("*")):
            path.chmod(0o755 if path.is_dir() else 0o644)
        shutil.chown(home / "open", NOBODY, NOBODY)
        yield home


def as_nobody(
    home: Path, *words: str, cache: str = "open/cache"
) -> subprocess.CompletedProcess[str]:
    """Run the command line as a user who can read everything, also Python, and owns nothing."""
    reading = [f"--{caps}-caps=+dac_read_search" for caps in ("inh", "ambient")]
    who = ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups", *reading]
    return subprocess.run(
        [*who, sys.executable, "-m", "chord_usd.cli", *words, "--progress", "none"],
        cwd=home, text=True, capture_output=True, check=False,
        env={**os.environ, "HOME": str(home), "CHORD_USD_CACHE": str(home / cache)},
    )  # fmt: skip


WORDS = [
    ("plan", "draw", "plan.json", "-o", "drawn.png"),
    ("plan", "draw", "plan.json", "-o", "kept.png"),
    ("plan", "draw", "plan.json", "-o", "deeper/drawn.png"),
    ("stage", "scene.json", "-o", "empty/house.usda"),
    ("dataset", "synth", "--count", "1", "-o", "empty"),
    ("dataset", "synth", "--count", "1", "-o", "new"),
    ("train", "bubbles", "-o", "empty", "--minutes", "0.01"),
    ("batch", "plan.json", "-o", "empty", "--workers", "1"),
]


@pytest.mark.parametrize("words", WORDS, ids=lambda words: " ".join(words[:2]))
def test_what_cannot_be_written_is_told_and_stays(words: tuple[str, ...], home: Path) -> None:
    before = {name: value for name, value in tree(home).items() if not name.startswith("open")}
    done = as_nobody(home, *words)
    assert done.returncode == 2, done.stderr
    assert re.fullmatch(r"error: .+\n", done.stderr), done.stderr
    assert "unexpected" not in done.stderr
    after = {name: value for name, value in tree(home).items() if not name.startswith("open")}
    assert after == before


def test_a_cache_that_cannot_be_written_is_told(home: Path) -> None:
    done = as_nobody(home, "stage", "scene.json", "-o", "open/house.usda", cache="empty/cache")
    assert done.returncode == 2
    assert re.fullmatch(r"error: .*CHORD_USD_CACHE.*\n", done.stderr), done.stderr
    assert not (home / "open" / "house.usda").exists()
