"""Help answers before anything heavy could have been imported."""

from __future__ import annotations

import resource

import pytest

from tests.verbs import VERBS

HELP_SECONDS = 0.3


@pytest.mark.alone
@pytest.mark.parametrize("verb", ["", *VERBS])
def test_help_answers_at_once(run_cli, verb: str) -> None:
    """Processor seconds, the best of six tries: other work on the machine only adds to them."""
    assert any(_help_seconds(run_cli, verb) < HELP_SECONDS for _ in range(6))


def _help_seconds(run_cli, verb: str) -> float:
    before = _seconds_of_children()
    done = run_cli(*verb.split(), "--help", fresh=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("usage: chord-usd")
    return _seconds_of_children() - before


def _seconds_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
