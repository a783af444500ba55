"""What the exit code of a verb that writes houses says."""

from __future__ import annotations

import json
import subprocess
from typing import Any

from chord_usd.cli import DONE, NOT_HELD


def written(done: subprocess.CompletedProcess[str]) -> dict[str, Any]:
    """The answer of a verb with --json that wrote a house; its exit code is that of the
    certificate."""
    assert done.returncode in (DONE, NOT_HELD), done.stderr
    told: dict[str, Any] = json.loads(done.stdout)
    check = told["certificate"]
    assert done.returncode == (DONE if check is None or check["holds"] else NOT_HELD)
    return told
