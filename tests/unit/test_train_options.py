"""What verbs of train make of their options before they learn."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

import pytest

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.faces.commands.train_options import judges_of, start_of


def test_shipped_networks_are_started_from_in_any_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    run = tmp_path / "run"
    named = start_of(Namespace(start=Path("checkpoints/reader"), output=run))
    assert named == checkpoint_folder("reader")
    (tmp_path / "mine").mkdir()
    assert start_of(Namespace(start=Path("mine"), output=run)) == Path("mine")
    for wrong in ("checkpoints/none", "elsewhere/reader"):
        with pytest.raises(CheckpointError, match="no checkpoint"):
            start_of(Namespace(start=Path(wrong), output=run))


def test_a_run_of_seconds_draws_few_held_out_examples() -> None:
    counts = [judges_of(Namespace(minutes=minutes), 96) for minutes in (0.001, 1.0, 60.0)]
    assert counts == [2, 4, 96]
