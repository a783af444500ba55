"""Ctrl-C and a farm's kill: no output, no hidden folder, the documented exit code."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
MANY_STEPS = 1000


@pytest.mark.parametrize(
    ("how", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["ctrl-c", "kill"]
)
def test_an_interrupted_job_leaves_nothing(how: signal.Signals, code: int, tmp_path: Path) -> None:
    output = tmp_path / "out" / "house.usda"
    words = ["generate", str(EXAMPLES / "studio.png"), "-o", str(output)]
    words += ["--preview", str(tmp_path / "preview.png")]
    words += ["--steps", str(MANY_STEPS), "--progress", "json"]
    with subprocess.Popen(
        [sys.executable, "-m", "chord_usd.cli", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stderr
        steps = []
        for line in process.stderr:
            steps.append(json.loads(line)["step"])
            if steps[-1] == "layout":
                break
        process.send_signal(how)
        rest = process.stderr.read()
        assert process.stdout
        assert process.stdout.read() == ""
        assert process.wait(60) == code
    assert "Traceback" not in rest
    assert list(tmp_path.iterdir()) == []
