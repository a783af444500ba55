"""What the tests share: the command line as a user runs it, and a house to work on."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

if TYPE_CHECKING:
    from chord_usd.types import SceneGraph

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # Whoever runs the tests in the background of a script makes them, and all that they start, deaf
    # to the interrupts that some of them are about.
    signal.signal(signal.SIGINT, signal.default_int_handler)

RunCli = Callable[..., "subprocess.CompletedProcess[str]"]

TIMEOUT_S = 300

# The same examples every time: a change is judged by what it changes, not by luck.
settings.register_profile("steady", derandomize=True, deadline=None)
settings.load_profile("steady")


@pytest.fixture(scope="session")
def run_cli() -> RunCli:
    """Runs `chord-usd ARGUMENTS` in a process of its own and returns what it did."""

    def run(
        *arguments: object, cwd: Path | None = None, env: dict[str, str] | None = None
    ) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "chord_usd.cli", *map(str, arguments)],
            cwd=cwd,
            env={**os.environ, **(env or {})},
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
            check=False,
        )

    return run


@pytest.fixture(scope="session")
def furnished_house() -> SceneGraph:
    """A house of a few rooms with all its furniture, read from a file."""
    from chord_usd.chord_json import read_scene

    return read_scene(Path(__file__).parent / "fixtures" / "furnished_house.json")
