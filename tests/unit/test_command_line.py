"""The command line as people type it: help pages, misspelt words, quiet runs, completion."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from chord_usd.cli import UNUSABLE, VERBS, build_parser, main
from chord_usd.faces.commands.completion import SHELLS


def test_the_help_page_lists_every_verb_once() -> None:
    words = [
        line.split()[0] for line in build_parser().format_help().splitlines() if line[:2] == "  "
    ]
    assert sorted(words) == sorted(VERBS)


@pytest.mark.parametrize(
    ("words", "nearest"),
    [
        ("genrate plan.png", "generate"),
        ("generate plan.png -o h.usda --sede 3", "--seed"),
        ("generate plan.png -o h.usda --roof gabel", "gable"),
        ("assets lst", "list"),
    ],
)
def test_a_misspelt_word_is_an_error_with_the_nearest(
    words: str, nearest: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words.split()) == UNUSABLE
    error = capsys.readouterr().err
    assert f"did you mean {nearest}" in error
    assert error.count("\n") == 1


def test_quiet_runs_print_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assets", "list", "--category", "bed", "-q"]) == 0
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("shell", SHELLS)
def test_shells_read_their_completion(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert "--texture-size" in script
    if shutil.which(shell):
        subprocess.run([shell, "-n"], input=script, text=True, check=True)
