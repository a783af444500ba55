"""What reaches standard error and output while a verb runs."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from chord_usd.base.runtime import progress
from chord_usd.base.runtime.progress import Stopwatch, held_lines, make_reporter

NOISE = """
import ctypes, logging, os, subprocess, sys, warnings
from chord_usd import cli
from chord_usd.faces.commands import describe
from chord_usd.faces.commands.common import Outcome, stopwatch
from chord_usd.base.errors import PlanError

def run(options):
    with stopwatch(options).step("read"):
        for stream in (1, 2):
            os.write(stream, b"NOISE of C\\n")
            subprocess.run(["sh", "-c", f"echo NOISE of a child >&{stream}"])
        ctypes.CDLL(None).printf(b"NOISE in C's own buffer\\n")
        print("NOISE")
        print("NOISE", file=sys.stderr)
        logging.getLogger("library").error("NOISE")
        warnings.warn("NOISE")
    if str(options.stage) == "broken":
        raise PlanError("is broken", where="house.usda")
    return Outcome("all well", {"valid": True})

describe.run = run
sys.exit(cli.main(sys.argv[1:]))
"""


def described(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """describe, by a verb and libraries that are anything but quiet."""
    script = folder / "noise.py"
    script.write_text(NOISE)
    (folder / words[0]).touch()
    command = [sys.executable, str(script), "describe", *words]
    return subprocess.run(
        command, capture_output=True, text=True, timeout=60, check=False, cwd=folder
    )


def test_an_error_stands_alone(tmp_path: Path) -> None:
    done = described(tmp_path, "broken")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "error: house.usda: is broken\n"


def test_json_is_one_object_and_steps_come_at_the_end(tmp_path: Path) -> None:
    done = described(tmp_path, "house.usda", "--json")
    assert json.loads(done.stdout) == {"valid": True}
    assert done.stdout.count("\n") == 1
    # On a busy machine it takes longer.
    assert re.fullmatch(r"read: \d+\.\d s\n", done.stderr)


def test_lines_are_live(tmp_path: Path) -> None:
    done = described(tmp_path, "broken", "--progress", "json")
    *steps, error = done.stderr.splitlines()
    assert [json.loads(line)["step"] for line in steps] == ["read", "read"]
    assert error.startswith("error: ")


def test_debug_shows_what_libraries_say_on_stderr(tmp_path: Path) -> None:
    done = described(tmp_path, "house.usda", "--json", "--debug")
    assert json.loads(done.stdout) == {"valid": True}
    assert done.stderr.count("NOISE") >= 7


def test_what_is_held_is_told_live_after_a_minute(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 0.0
    monkeypatch.setattr(progress.time, "monotonic", lambda: now)
    with held_lines():
        watch = Stopwatch(make_reporter("auto"))
        with watch.step("plan"):
            pass
        assert capsys.readouterr().err == ""
        with watch.step("render") as done:
            now = progress.HOLD_SECONDS
            done(1, 100)
            assert capsys.readouterr().err.startswith("plan: ")
        assert capsys.readouterr().err.startswith("render: ")
    assert capsys.readouterr().err == ""


def test_a_long_step_says_how_far_it_is_and_what_is_left(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 0.0
    monkeypatch.setattr(progress.time, "monotonic", lambda: now)
    with Stopwatch(make_reporter("lines")).step("houses") as done:
        done(0, 40)
        for made in range(1, 41):
            now = made * 12.0
            done(made, 40)
            done(made, 40)
    lines = capsys.readouterr().err.splitlines()
    assert lines[:2] == ["houses: 1 of 40, 8 min left", "houses: 2 of 40, 8 min left"]
    assert lines[38] == "houses: 39 of 40, 12 s left"
    assert len(lines) == 40  # the last one says how long it took


def test_what_is_held_is_dropped_with_an_error(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(OSError, match="full"), held_lines():
        with Stopwatch(make_reporter("auto")).step("plan"):
            pass
        raise OSError("full")
    with held_lines():
        pass
    assert capsys.readouterr().err == ""
