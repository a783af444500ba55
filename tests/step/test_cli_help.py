"""Help answers before anything heavy could have been imported."""

from __future__ import annotations

import resource
import subprocess
import sys

import pytest

from tests.verbs import VERBS

HELP_SECONDS = 0.3


@pytest.mark.parametrize("verb", ["", *VERBS])
def test_help_answers_at_once(verb: str) -> None:
    """Processor seconds, up to three tries: the machine may be busy with other things."""
    assert any(_help_seconds(verb.split()) < HELP_SECONDS for _ in range(3))


def _help_seconds(words: list[str]) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [sys.executable, "-m", "chord_usd.cli", *words, "--help"], capture_output=True, check=True
    )
    assert done.stdout.startswith(b"usage: chord-usd")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
